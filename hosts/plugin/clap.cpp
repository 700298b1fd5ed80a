// SPDX-License-Identifier: MIT
// The CLAP side of a plug-in. What version 1.6 of the framework lacks is here: `reset`, parameters that change within
// a block, units with the values, a version, tails, notes with names, their expressions and modulations; and it
// writes beyond an array where a host names a parameter that is not there. It forgets all once one of several users
// in a process has left it, and damages states where a host takes or gives a part of the bytes at a time.
#include <src/clap/plugin.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <src/DistrhoPluginInternal.hpp>
#include <string>
#include <string_view>

#include "contactspline/step/version.hpp"
#include "windowed_plugin.hpp"

START_NAMESPACE_DISTRHO
static CLAP_ABI void clap_plugin_reset(const clap_plugin_t*);
static CLAP_ABI clap_process_status clap_plugin_process(const clap_plugin_t*, const clap_process_t*);
static CLAP_ABI const void* clap_plugin_get_extension(const clap_plugin_t*, const char*);
END_NAMESPACE_DISTRHO

#include <src/clap/ext/params.h>
#include <src/clap/ext/state.h>
#include <src/clap/plugin-factory.h>

START_NAMESPACE_DISTRHO
static CLAP_ABI bool clap_plugin_params_get_info(const clap_plugin_t*, uint32_t, clap_param_info_t*);
static CLAP_ABI bool clap_plugin_params_get_value(const clap_plugin_t*, clap_id, double*);
static CLAP_ABI bool clap_plugin_params_value_to_text(const clap_plugin_t*, clap_id, double, char*, uint32_t);
static CLAP_ABI bool clap_plugin_params_text_to_value(const clap_plugin_t*, clap_id, const char*, double*);
static CLAP_ABI void clap_plugin_params_flush(const clap_plugin_t*, const clap_input_events_t*,
                                              const clap_output_events_t*);
static const clap_plugin_descriptor_t* clap_get_plugin_descriptor(const clap_plugin_factory_t*, uint32_t);
static const clap_plugin_t* clap_create_plugin(const clap_plugin_factory_t*, const clap_host_t*, const char*);
static CLAP_ABI bool clap_plugin_state_save(const clap_plugin_t*, const clap_ostream_t*);
static CLAP_ABI bool clap_plugin_state_load(const clap_plugin_t*, const clap_istream_t*);
static bool clap_plugin_entry_init(const char*);
static void clap_plugin_entry_deinit(void);
END_NAMESPACE_DISTRHO

#include <src/DistrhoPlugin.cpp>

#include "instrument_clap.cpp"  // the framework's source; CMake renames what is defined below

#define DISTRHO_IS_STANDALONE 0
#include <src/DistrhoUtils.cpp>

START_NAMESPACE_DISTRHO

namespace {

// An event as what it says it is, or null.
template <typename Event>
const Event* as(const clap_event_header_t& event, uint16_t type) {
  const bool is_one = event.space_id == CLAP_CORE_EVENT_SPACE_ID && event.type == type && event.size == sizeof(Event);
  return is_one ? reinterpret_cast<const Event*>(&event) : nullptr;
}

template <typename Event>
contactspline::NoteName name_of(const Event& event) {
  return {event.note_id, event.channel, event.key};
}

contactspline::WindowedPlugin& instrument_of(const clap_plugin_t* plugin) {
  return contactspline::WindowedPlugin::of(static_cast<PluginCLAP*>(plugin->plugin_data)->instrument());
}

// Reads events of notes into a list.
class NoteReader {
 public:
  NoteReader(contactspline::WindowedPlugin& plugin, uint32_t frame) : plugin_(plugin), frame_(frame) {}

  void take(const clap_event_header_t& event) {
    if (const auto* const on = as<clap_event_note_t>(event, CLAP_EVENT_NOTE_ON))
      push({.kind = Kind::kBegin, .name = name_of(*on), .value = on->velocity});
    // Voices that have a level of their own fall silent at once.
    if (const auto* const choked = as<clap_event_note_t>(event, CLAP_EVENT_NOTE_CHOKE))
      push({.kind = Kind::kExpress, .name = name_of(*choked), .expression = contactspline::NoteExpression::kVolume});
    for (const uint16_t type : {CLAP_EVENT_NOTE_OFF, CLAP_EVENT_NOTE_CHOKE})
      if (const auto* const off = as<clap_event_note_t>(event, type))
        push({.kind = Kind::kEnd, .name = name_of(*off), .value = off->velocity});
    if (const auto* const expression = as<clap_event_note_expression_t>(event, CLAP_EVENT_NOTE_EXPRESSION))
      express(*expression);
    if (const auto* const value = as<clap_event_param_value_t>(event, CLAP_EVENT_PARAM_VALUE))
      if (!contactspline::is_of_all(name_of(*value)))
        push({.kind = Kind::kSet, .name = name_of(*value), .value = value->value, .parameter = value->param_id});
    if (const auto* const moved = as<clap_event_param_mod_t>(event, CLAP_EVENT_PARAM_MOD))
      push({.kind = Kind::kModulate, .name = name_of(*moved), .value = moved->amount, .parameter = moved->param_id});
    if (const auto* const midi = as<clap_event_midi_t>(event, CLAP_EVENT_MIDI))
      push({.kind = Kind::kMidi, .bytes = midi->data});
    if (const auto* const exclusive = as<clap_event_midi_sysex_t>(event, CLAP_EVENT_MIDI_SYSEX))
      push({.kind = Kind::kMidi, .bytes = {exclusive->buffer, exclusive->size}});
  }

 private:
  using Kind = contactspline::HostNote::Kind;

  void push(contactspline::HostNote note) {
    note.frame = frame_;
    plugin_.push(note);
  }

  // Their ranges are those of CLAP.
  void express(const clap_event_note_expression_t& event) {
    using E = contactspline::NoteExpression;
    const auto push_as = [&](E expression, double value) {
      push({.kind = Kind::kExpress, .name = name_of(event), .value = value, .expression = expression});
    };
    switch (event.expression_id) {
      case CLAP_NOTE_EXPRESSION_VOLUME:
        return push_as(E::kVolume, event.value);
      case CLAP_NOTE_EXPRESSION_EXPRESSION:
        return push_as(E::kExpression, event.value);
      case CLAP_NOTE_EXPRESSION_PAN:
        return push_as(E::kPan, 2 * event.value - 1);
      case CLAP_NOTE_EXPRESSION_TUNING:
        return push_as(E::kTuning, 100 * event.value);
      case CLAP_NOTE_EXPRESSION_BRIGHTNESS:
        return push_as(E::kBrightness, event.value);
      case CLAP_NOTE_EXPRESSION_PRESSURE:
        return push_as(E::kPressure, event.value);
    }
  }

  contactspline::WindowedPlugin& plugin_;
  uint32_t frame_;
};

// What the plug-in tells a host in a part of a block, with the times of the block.
class OutputsWithin {
 public:
  OutputsWithin(const clap_output_events_t* all, uint32_t begin) : all_(all), begin_(begin) {}
  OutputsWithin(const OutputsWithin&) = delete;

  [[nodiscard]] const clap_output_events_t* events() const { return &events_; }

  // That notes have ended with their keys: the host has to know it, to end their modulations. Told at the end of the
  // part, as times must not go back.
  void tell_ends(const clap_input_events_t& in, uint32_t first, uint32_t last, uint32_t frames) const {
    for (uint32_t i = first; i < last; ++i) {
      const clap_event_header_t* const event = in.get(&in, i);
      if (event == nullptr) continue;
      for (const uint16_t type : {CLAP_EVENT_NOTE_OFF, CLAP_EVENT_NOTE_CHOKE}) {
        const auto* const off = as<clap_event_note_t>(*event, type);
        if (off == nullptr || off->channel < 0 || off->key < 0) continue;
        clap_event_note_t ended = *off;
        ended.header.type = CLAP_EVENT_NOTE_END;
        ended.header.time = frames > 0 ? frames - 1 : 0;
        events_.try_push(&events_, &ended.header);
      }
    }
  }

 private:
  static bool push(const clap_output_events_t* list, const clap_event_header_t* event) {
    const auto& self = *static_cast<const OutputsWithin*>(list->ctx);
    union {
      clap_event_header_t header;
      clap_event_param_value_t value;
      clap_event_note_t note;
    } copy;
    if (self.all_ == nullptr || event->size > sizeof copy) return false;
    std::memcpy(&copy, event, event->size);
    copy.header.time += self.begin_;
    return self.all_->try_push(self.all_, &copy.header);
  }

  const clap_output_events_t* all_;
  uint32_t begin_;
  clap_output_events_t events_ = {this, push};
};

// A part of a host's events, in the order of their times, for a block that begins with a sample: what the framework
// takes, which are changes of parameters.
class EventsWithin {
 public:
  EventsWithin(const clap_input_events_t* all, uint32_t first, uint32_t last, uint32_t begin)
      : all_(all), first_(first), count_(last - first), begin_(begin) {}
  EventsWithin(const EventsWithin&) = delete;

  [[nodiscard]] const clap_input_events_t* events() const { return &events_; }

  // A parameter that is there, for all notes, and a value, which the instrument moves into its range.
  static bool is_change(const clap_event_header_t& event) {
    const auto* const change = as<clap_event_param_value_t>(event, CLAP_EVENT_PARAM_VALUE);
    return change != nullptr && contactspline::is_of_all(name_of(*change)) &&
           change->param_id < sPlugin->getParameterCount() && !sPlugin->isParameterOutput(change->param_id) &&
           !std::isnan(change->value);
  }

 private:
  static const clap_event_header_t* get(const clap_input_events_t* list, uint32_t i) {
    auto& self = *static_cast<EventsWithin*>(list->ctx);
    const clap_event_header_t* const event = self.all_->get(self.all_, self.first_ + i);
    if (event == nullptr || !is_change(*event)) return &self.nothing_;
    std::memcpy(&self.change_, event, sizeof self.change_);
    self.change_.header.time -= std::min(self.change_.header.time, self.begin_);
    return &self.change_.header;
  }

  const clap_input_events_t* all_;
  uint32_t first_, count_, begin_;
  clap_event_param_value_t change_ = {};  // the framework is done with one before it asks for the next
  clap_event_header_t nothing_ = {sizeof nothing_, 0, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_NOTE_END, 0};
  clap_input_events_t events_ = {
      this, [](const clap_input_events_t* list) { return static_cast<EventsWithin*>(list->ctx)->count_; }, get};
};

// The inputs of a part of a block, as the framework wants them: where a host has none, a null pointer.
class InputsWithin {
 public:
  InputsWithin(const clap_process_t& process, uint32_t begin) {
    const bool is_there = process.audio_inputs_count > 0 && process.audio_inputs[0].channel_count > 0 &&
                          process.audio_inputs[0].data32 != nullptr && process.audio_inputs[0].data32[0] != nullptr;
    if (is_there) channel_ = process.audio_inputs[0].data32[0] + begin;
  }
  InputsWithin(const InputsWithin&) = delete;
  InputsWithin& operator=(const InputsWithin&) = delete;

  void give_to(clap_process_t& part) const {
    part.audio_inputs = &bus_;
    part.audio_inputs_count = DISTRHO_PLUGIN_NUM_INPUTS;
  }

 private:
  float* channel_ = nullptr;
  clap_audio_buffer_t bus_ = {&channel_, nullptr, 1, 0, 0};
};

bool is_parameter(clap_id id) {
  return id < sPlugin->getParameterCount();
}

}  // namespace

// Plays the parts of a block between changes of parameters.
static CLAP_ABI clap_process_status clap_plugin_process(const clap_plugin_t* plugin, const clap_process_t* process) {
  const clap_input_events_t* const in = process->in_events;
  const uint32_t count = in == nullptr ? 0 : in->size(in), length = process->frames_count;
  const bool is_stereo =
      process->audio_outputs_count == 1 && process->audio_outputs[0].channel_count == DISTRHO_PLUGIN_NUM_OUTPUTS;
  clap_process_t part = *process;
  if (count == 0) {
    const InputsWithin inputs(*process, 0);
    inputs.give_to(part);
    return clap_plugin_process_of_framework(plugin, &part);
  }
  contactspline::WindowedPlugin& instrument = instrument_of(plugin);
  clap_audio_buffer_t bus = is_stereo ? process->audio_outputs[0] : clap_audio_buffer_t{};
  float* channels[DISTRHO_PLUGIN_NUM_OUTPUTS];
  if (is_stereo) part.audio_outputs = &bus;
  for (uint32_t begin = 0, first = 0;;) {
    uint32_t end = length, last = first;
    for (; last < count && end == length; last += end == length) {
      const clap_event_header_t* const event = in->get(in, last);
      if (event != nullptr && is_stereo && EventsWithin::is_change(*event) && event->time > begin &&
          event->time < length)
        end = event->time;
    }
    const EventsWithin events(in, first, last, begin);
    const OutputsWithin outputs(process->out_events, begin);
    const InputsWithin inputs(*process, begin);
    for (uint32_t i = first; i < last; ++i)
      if (const clap_event_header_t* const event = in->get(in, i))
        NoteReader(instrument, event->time - std::min(event->time, begin)).take(*event);
    if (!is_stereo || end == begin) instrument.take_notes();
    for (uint32_t c = 0; is_stereo && c < DISTRHO_PLUGIN_NUM_OUTPUTS; ++c)
      channels[c] = process->audio_outputs[0].data32[c] + begin;
    bus.data32 = channels;
    inputs.give_to(part);
    part.in_events = events.events();
    part.out_events = outputs.events();
    part.frames_count = end - begin;
    if (process->steady_time >= 0) part.steady_time = process->steady_time + begin;
    const clap_process_status status = clap_plugin_process_of_framework(plugin, &part);
    outputs.tell_ends(*in, first, last, end - begin);
    if (status == CLAP_PROCESS_ERROR || end == length) return status;
    begin = end;
    first = last;
  }
}

// As the MIDI message "all sound off". The framework passes events on with a block only: one of a sample, which
// nobody hears.
static CLAP_ABI void clap_plugin_reset(const clap_plugin_t* const plugin) {
  static const clap_event_midi_t all_sound_off = {
      {sizeof(clap_event_midi_t), 0, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_MIDI, 0}, 0, {0xb0, 120, 0}};
  const clap_input_events_t events = {nullptr, [](const clap_input_events_t*) -> uint32_t { return 1; },
                                      [](const clap_input_events_t*, uint32_t) { return &all_sound_off.header; }};
  float samples[DISTRHO_PLUGIN_NUM_OUTPUTS] = {};
  float* channels[] = {&samples[0], &samples[1]};
  clap_audio_buffer_t bus = {channels, nullptr, DISTRHO_PLUGIN_NUM_OUTPUTS, 0, 0};
  const clap_output_events_t none = {nullptr,
                                     [](const clap_output_events_t*, const clap_event_header_t*) { return true; }};
  clap_process_t block = {-1, 1, nullptr, nullptr, &bus, 0, 1, &events, &none};
  const InputsWithin no_inputs(block, 0);
  no_inputs.give_to(block);
  clap_plugin_process_of_framework(plugin, &block);
}

static CLAP_ABI bool clap_plugin_params_get_info(const clap_plugin_t* plugin, uint32_t index,
                                                 clap_param_info_t* info) {
  if (!is_parameter(index) || !clap_plugin_params_get_info_of_framework(plugin, index, info)) return false;
  if (instrument_of(plugin).is_modulated(index)) info->flags |= CLAP_PARAM_IS_MODULATABLE;
  if (instrument_of(plugin).is_of_notes(index))
    info->flags |= CLAP_PARAM_IS_AUTOMATABLE_PER_NOTE_ID | CLAP_PARAM_IS_AUTOMATABLE_PER_KEY |
                   CLAP_PARAM_IS_AUTOMATABLE_PER_CHANNEL | CLAP_PARAM_IS_MODULATABLE_PER_NOTE_ID |
                   CLAP_PARAM_IS_MODULATABLE_PER_KEY | CLAP_PARAM_IS_MODULATABLE_PER_CHANNEL;
  return true;
}

static CLAP_ABI bool clap_plugin_params_get_value(const clap_plugin_t* plugin, clap_id id, double* value) {
  return is_parameter(id) && clap_plugin_params_get_value_of_framework(plugin, id, value);
}

static CLAP_ABI bool clap_plugin_params_value_to_text(const clap_plugin_t*, clap_id id, double value, char* text,
                                                      uint32_t size) {
  if (!is_parameter(id) || size == 0) return false;
  const String& unit = sPlugin->getParameterUnit(id);
  std::snprintf(text, size, unit.isEmpty() ? "%.4g%s" : "%.4g %s", value, unit.buffer());
  return true;
}

static CLAP_ABI bool clap_plugin_params_text_to_value(const clap_plugin_t*, clap_id id, const char* text,
                                                      double* value) {
  char* end = nullptr;
  *value = std::strtod(text, &end);
  return is_parameter(id) && end != text && std::isfinite(*value);
}

static CLAP_ABI void clap_plugin_params_flush(const clap_plugin_t* plugin, const clap_input_events_t* in,
                                              const clap_output_events_t* out) {
  const uint32_t count = in == nullptr ? 0 : in->size(in);
  const EventsWithin events(in, 0, count, 0);
  clap_plugin_params_flush_of_framework(plugin, events.events(), out);
  for (uint32_t i = 0; i < count; ++i)
    if (const clap_event_header_t* const event = in->get(in, i))
      if (const auto* const moved = as<clap_event_param_mod_t>(*event, CLAP_EVENT_PARAM_MOD))
        if (contactspline::is_of_all(name_of(*moved))) instrument_of(plugin).modulate(moved->param_id, moved->amount);
}

// Notes come by name, or by MIDI, with MPE.
static const clap_plugin_note_ports_t note_ports = {
    [](const clap_plugin_t*, bool is_input) -> uint32_t { return is_input ? 1 : 0; },
    [](const clap_plugin_t*, uint32_t index, bool is_input, clap_note_port_info_t* info) {
      if (!is_input || index != 0) return false;
      *info = {0, CLAP_NOTE_DIALECT_CLAP | CLAP_NOTE_DIALECT_MIDI | CLAP_NOTE_DIALECT_MIDI_MPE,
               CLAP_NOTE_DIALECT_CLAP, "notes"};
      return true;
    }};

// CLAP's "tail": instruments ring as long as they are not damped.
static CLAP_ABI const void* clap_plugin_get_extension(const clap_plugin_t* plugin, const char* id) {
  struct Tail {
    uint32_t(CLAP_ABI* get)(const clap_plugin_t*);
  };
  static const Tail tail = {[](const clap_plugin_t*) { return UINT32_MAX; }};
  if (std::strcmp(id, CLAP_EXT_NOTE_PORTS) == 0) return &note_ports;
  return std::strcmp(id, "clap.tail") == 0 ? &tail : clap_plugin_get_extension_of_framework(plugin, id);
}

static const clap_plugin_descriptor_t* clap_get_plugin_descriptor(const clap_plugin_factory_t* factory,
                                                                  uint32_t index) {
  if (index != 0) return nullptr;
  static const clap_plugin_descriptor_t descriptor = [factory] {
    clap_plugin_descriptor_t complete = *clap_get_plugin_descriptor_of_framework(factory, 0);
    static char version[32];
    std::snprintf(version, sizeof version, "%d.%d.%d", contactspline::kVersionMajor, contactspline::kVersionMinor,
                  contactspline::kVersionPatch);
    complete.version = version;
    return complete;
  }();
  return &descriptor;
}

static const clap_plugin_t* clap_create_plugin(const clap_plugin_factory_t* factory, const clap_host_t* host,
                                               const char* id) {
  if (std::strcmp(id, DISTRHO_PLUGIN_CLAP_ID) != 0) return nullptr;
  auto* const plugin = const_cast<clap_plugin_t*>(clap_create_plugin_of_framework(factory, host, id));
  if (plugin != nullptr) plugin->desc = clap_get_plugin_descriptor(factory, 0);
  return plugin;
}

// The framework writes to and reads from memory, the whole state at once.
static CLAP_ABI bool clap_plugin_state_save(const clap_plugin_t* plugin, const clap_ostream_t* stream) {
  std::string state;
  const clap_ostream_t memory = {&state, [](const clap_ostream_t* self, const void* bytes, uint64_t size) {
                                   static_cast<std::string*>(self->ctx)->append(static_cast<const char*>(bytes),
                                                                                size);
                                   return static_cast<int64_t>(size);
                                 }};
  if (!clap_plugin_state_save_of_framework(plugin, &memory)) return false;
  for (std::size_t done = 0; done < state.size();) {
    const int64_t written = stream->write(stream, state.data() + done, state.size() - done);
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

static CLAP_ABI bool clap_plugin_state_load(const clap_plugin_t* plugin, const clap_istream_t* stream) {
  constexpr std::size_t kMax = 1 << 20;  // bytes, a thousand times as many as a state has
  std::string state;
  char bytes[512];
  for (int64_t read = 1; read > 0 && state.size() < kMax;) {
    read = stream->read(stream, bytes, sizeof bytes);
    if (read < 0) return false;
    state.append(bytes, static_cast<std::size_t>(read));
  }
  std::string_view rest = state;
  const clap_istream_t memory = {&rest, [](const clap_istream_t* self, void* taken, uint64_t size) {
                                   auto& rest_of_state = *static_cast<std::string_view*>(self->ctx);
                                   const std::size_t count = rest_of_state.copy(static_cast<char*>(taken), size);
                                   rest_of_state.remove_prefix(count);
                                   return static_cast<int64_t>(count);
                                 }};
  return clap_plugin_state_load_of_framework(plugin, &memory);
}

static std::atomic<int> users = 0;

static bool clap_plugin_entry_init(const char* path) {
  ++users;
  return clap_plugin_entry_init_of_framework(path);
}

static void clap_plugin_entry_deinit() {
  if (--users == 0) clap_plugin_entry_deinit_of_framework();
}

END_NAMESPACE_DISTRHO
