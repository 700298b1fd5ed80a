// SPDX-License-Identifier: MIT
// What version 1.6 of the framework lacks in VST3. contactspline_plugin() includes it in the framework's source,
// behind its class PluginVst3, which this one takes the place of:
// - parameters that MIDI moves are these themselves, not one of 2,080 hidden ones for all controllers of all channels
// - programs are a list of the host, logarithmic parameters are logarithmic, units stand with the values
// - parameters change at their sample, and the sound does not end with the last note
// - notes have names, and are tuned, pressed and mixed by them
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "contactspline/midi/midi_meaning.hpp"
#include "host_values.hpp"
#include "src/travesty/unit.h"
#include "vst3_note_expression.h"
#include "windowed_plugin.hpp"

START_NAMESPACE_DISTRHO

// Objects as VST3 passes them: a pointer to one of these is what their functions are called with. Their functions
// stand first. They live on the stack or in the plug-in, so nobody counts references.
namespace vst3_object {

inline v3_result V3_API query(void*, const v3_tuid, void**) {
  return V3_NO_INTERFACE;
}
inline uint32_t V3_API one(void*) {
  return 1;
}

template <typename Functions>
struct Table {
  v3_funknown unknown = {query, one, one};
  Functions functions;
};

/// A controller that moves at the first sample of a block.
struct ControllerPoint {
  static const Table<v3_param_value_queue>& table() {
    static const Table<v3_param_value_queue> kTable = {
        {query, one, one},
        {[](void* self) { return static_cast<ControllerPoint*>(self)->id; }, [](void*) { return int32_t(1); },
         [](void* self, int32_t, int32_t* offset, double* value) -> v3_result {
           *offset = 0;
           *value = static_cast<ControllerPoint*>(self)->value;
           return V3_OK;
         },
         [](void*, int32_t, double, int32_t*) -> v3_result { return V3_NOT_IMPLEMENTED; }}};
    return kTable;
  }
  const Table<v3_param_value_queue>* functions = &table();
  v3_param_id id = 0;
  double value = 0;
};

/// The controllers that move at the first sample of a block.
struct ControllerPoints {
  static constexpr int32_t kMax = 36;
  static const Table<v3_param_changes>& table() {
    static const Table<v3_param_changes> kTable = {
        {query, one, one},
        {[](void* self) { return static_cast<ControllerPoints*>(self)->count; },
         [](void* self, int32_t i) {
           auto& points = *static_cast<ControllerPoints*>(self);
           return reinterpret_cast<v3_param_value_queue**>(&points.points[i]);
         },
         [](void*, v3_param_id*, int32_t*) -> v3_param_value_queue** { return nullptr; }}};
    return kTable;
  }
  const Table<v3_param_changes>* functions = &table();
  ControllerPoint points[kMax];
  int32_t count = 0;
};

/// What a host can express of single notes, by the numbers of VST3; pressure has one of our own.
struct Expression {
  uint32_t id;
  const char *title, *unit;
  double initial;  ///< part of its way, 0 to 1
  contactspline::NoteExpression meaning;
  double first, last;  ///< at 0 and 1, as MidiInterpreter has it
};
inline constexpr uint32_t kPressure = 100000;
inline constexpr Expression kExpressions[] = {
    {0, "volume", "", 0.25, contactspline::NoteExpression::kVolume, 0, 4},
    {4, "expression", "", 1, contactspline::NoteExpression::kExpression, 0, 1},
    {1, "pan", "", 0.5, contactspline::NoteExpression::kPan, -1, 1},
    {2, "tuning", "semitones", 0.5, contactspline::NoteExpression::kTuning, -12000, 12000},
    {5, "brightness", "", 0.5, contactspline::NoteExpression::kBrightness, 0, 1},
    {kPressure, "pressure", "", 0, contactspline::NoteExpression::kPressure, 0, 1}};

inline const Expression* expression(uint32_t id) {
  const auto* const found = std::find_if(std::begin(kExpressions), std::end(kExpressions),
                                         [id](const Expression& known) { return known.id == id; });
  return found == std::end(kExpressions) ? nullptr : found;
}

/// A velocity that a host has made of one of MIDI is that again, which single precision had rounded.
inline double velocity_of(float velocity) {
  const double steps = 127.0 * velocity;
  return std::abs(steps - std::round(steps)) < 1e-4 ? std::round(steps) / 127 : velocity;
}

/// An event of a host as the instrument takes it; nothing where it has no meaning. A note off without an identity is
/// that of the first note of its key and channel.
inline std::optional<contactspline::HostNote> note_of(const v3_event& event) {
  using contactspline::HostNote, contactspline::NoteExpression;
  using Kind = HostNote::Kind;
  switch (event.type) {
    case V3_EVENT_NOTE_ON: {
      const v3_event_note_on& on = event.note_on;
      return HostNote{.kind = on.velocity > 0 ? Kind::kBegin : Kind::kEndFirst,
                      .frame = 0,
                      .name = {on.note_id, on.channel, on.pitch},
                      .value = velocity_of(on.velocity),
                      .cents = on.tuning};
    }
    case V3_EVENT_NOTE_OFF: {
      const v3_event_note_off& off = event.note_off;
      return HostNote{.kind = Kind::kEndFirst,
                      .frame = 0,
                      .name = {off.note_id, off.channel, off.pitch},
                      .value = velocity_of(off.velocity)};
    }
    case V3_EVENT_POLY_PRESSURE: {
      const v3_event_poly_pressure& pressed = event.poly_pressure;
      return HostNote{.kind = Kind::kExpress,
                      .frame = 0,
                      .name = {-1, pressed.channel, pressed.pitch},
                      .value = pressed.pressure,
                      .expression = NoteExpression::kPressure};
    }
    case V3_EVENT_NOTE_EXP_VALUE:
      if (const Expression* const known = expression(event.note_exp_value.type_id))
        return HostNote{.kind = Kind::kExpress,
                        .frame = 0,
                        .name = {.id = event.note_exp_value.note_id},
                        .value = known->first + (known->last - known->first) * event.note_exp_value.value,
                        .expression = known->meaning};
      break;
    case V3_EVENT_DATA:
      return HostNote{.kind = Kind::kMidi, .frame = 0, .bytes = {event.data.bytes, event.data.size}};
    default:
      break;
  }
  return {};
}

}  // namespace vst3_object

class InstrumentVst3 : public PluginVst3 {
 public:
  InstrumentVst3(v3_host_application** host, bool is_component) : PluginVst3(host, is_component) {
    static_assert(kVst3InternalParameterProgram == 0 && kVst3InternalParameterMidiCC_start == 1);
    // "All sound off" and, of each channel, "all notes off"; pedals, which are down from 64 on; the pitch wheels of
    // all channels where the instrument bends.
    hide(kAllSoundOff, 0);
    for (int channel = 0; channel < kChannels; ++channel) hide(kAllNotesOff, channel);
    for (const int pedal : contactspline::kMidiPedals)
      for (uint32_t i = 0; i < fParameterCount; ++i)
        if (fPlugin.getParameterMidiCC(i) == pedal) hide(pedal, 0);
    for (uint32_t i = 0; i < fParameterCount; ++i)
      if (fPlugin.getParameterSymbol(i) == "bend_cents")
        for (int channel = 0; channel < kChannels; ++channel) hide(kPitchWheel, channel);
  }

  // The host's list: programs, parameters, hidden controllers.

  int32_t getParameterCount() const noexcept {
    return static_cast<int32_t>(program_parameters() + fParameterCount + hidden_count_);
  }

  v3_result getParameterInfo(int32_t number, v3_param_info* info) const noexcept {
    std::memset(info, 0, sizeof *info);
    uint32_t index = static_cast<uint32_t>(number);
    if (number < 0 || number >= getParameterCount()) return V3_INVALID_ARG;
    if (index < program_parameters()) {
      info->param_id = kVst3InternalParameterProgram;
      info->flags = V3_PARAM_CAN_AUTOMATE | V3_PARAM_IS_LIST | V3_PARAM_PROGRAM_CHANGE;
      info->step_count = static_cast<int32_t>(fProgramCountMinusOne);
      strncpy_utf16(info->title, "preset", 128);
      strncpy_utf16(info->short_title, "preset", 128);
      return V3_OK;
    }
    index -= program_parameters();
    if (index >= fParameterCount) {
      info->param_id = hidden_[index - fParameterCount];
      info->flags = V3_PARAM_CAN_AUTOMATE | V3_PARAM_IS_HIDDEN;
      const int controller = controller_of(info->param_id);
      info->default_normalised_value = controller == kPitchWheel ? 0.5 : 0;
      const char* const meaning = controller == kPitchWheel                      ? "pitch wheel"
                                  : controller == kAllSoundOff                   ? "all sound off"
                                  : controller == kAllNotesOff                   ? "all notes off"
                                  : controller == contactspline::kSustainPedal   ? "sustain pedal"
                                  : controller == contactspline::kSostenutoPedal ? "sostenuto pedal"
                                                                                 : "soft pedal";
      char title[32];
      std::snprintf(title, sizeof title, "%s", meaning);
      if (is_of_channel(controller))
        std::snprintf(title, sizeof title, "%s %d", meaning, 1 + channel_of(info->param_id));
      strncpy_utf16(info->title, title, 128);
      strncpy_utf16(info->short_title, title, 128);
      return V3_OK;
    }
    info->param_id = kVst3InternalParameterCount + index;
    const uint32_t hints = fPlugin.getParameterHints(index);
    info->flags = (hints & kParameterIsAutomatable ? V3_PARAM_CAN_AUTOMATE : 0) |
                  (hints & kParameterIsOutput ? V3_PARAM_READ_ONLY : 0);
    info->default_normalised_value = scale(index).part_of(fPlugin.getParameterRanges(index).def);
    if (const uint32_t values = fPlugin.getParameterEnumValues(index).count; values > 0) {
      info->flags |= V3_PARAM_IS_LIST;
      info->step_count = static_cast<int32_t>(values) - 1;
    }
    strncpy_utf16(info->title, fPlugin.getParameterName(index), 128);
    strncpy_utf16(info->short_title, fPlugin.getParameterShortName(index), 128);
    strncpy_utf16(info->units, fPlugin.getParameterUnit(index), 128);
    return V3_OK;
  }

  /// The parameter that a controller of MIDI moves on a channel, 0 to 15; 129 for the pitch wheel.
  bool controllerAssignment(int channel, int controller, v3_param_id* id) const noexcept {
    if (channel < 0 || channel >= kChannels || controller < 0 || controller >= kControllers) return false;
    const bool is_pedal = contactspline::midi_pedal(controller) < contactspline::kMidiPedals.size();
    for (uint32_t i = 0; i < fParameterCount; ++i)
      if (controller > 0 && !is_pedal && fPlugin.getParameterMidiCC(i) == controller) {
        *id = kVst3InternalParameterCount + i;
        return true;
      }
    *id = hidden_id(controller, is_of_channel(controller) ? channel : 0);
    return is_hidden(*id);
  }

  // Values: `part` is 0 to 1 along the slider.

  double normalizedParameterToPlain(v3_param_id id, double part) {
    if (id == kVst3InternalParameterProgram) return std::round(part * fProgramCountMinusOne);
    return is_parameter(id) ? scale(index_of(id)).value_at(part) : part;
  }

  double plainParameterToNormalized(v3_param_id id, double plain) {
    if (id == kVst3InternalParameterProgram)
      return fProgramCountMinusOne == 0 ? 0 : std::clamp(plain / fProgramCountMinusOne, 0.0, 1.0);
    return is_parameter(id) ? scale(index_of(id)).part_of(plain) : plain;
  }

  double getParameterNormalized(v3_param_id id) {
    if (id == kVst3InternalParameterProgram) return plainParameterToNormalized(id, program_);
    if (is_parameter(id)) return scale(index_of(id)).part_of(fPlugin.getParameterValue(index_of(id)));
    // Ardour 7.3 sends what it reads here before the first note.
    return is_hidden(id) && controller_of(id) == kPitchWheel ? 0.5 : 0;
  }

  /// Of a value that the window has set.
  double _getNormalizedParameterValue(uint32_t index, double plain) override { return scale(index).part_of(plain); }

  v3_result setParameterNormalized(v3_param_id id, double part) {
    if (!(part >= 0 && part <= 1)) return V3_INVALID_ARG;
    if (id == kVst3InternalParameterProgram) {
      // The framework would call the host back at once: Ardour 7.3 then waits for itself.
      load_program(program_of(part));
      has_new_program_ = true;
      return V3_OK;
    }
    if (!is_parameter(id)) return is_hidden(id) ? V3_OK : V3_INVALID_ARG;
    move(index_of(id), part);
    tell_latency();  // a host that has moved it in the processor moves it in the controller, too
    return V3_OK;
  }

  v3_result setState(v3_bstream** stream) {
    const v3_result result = PluginVst3::setState(stream);
    tell_latency();
    return result;
  }

  uint32_t getLatencySamples() const noexcept {
    return static_cast<uint32_t>(fPlugin.getParameterValue(fParameterCount - 1));
  }

  v3_result getParameterStringForValue(v3_param_id id, double part, v3_str_128 text) {
    if (!(part >= 0 && part <= 1)) return V3_INVALID_ARG;
    if (!is_parameter(id) && id != kVst3InternalParameterProgram) return V3_INVALID_ARG;
    const double value = normalizedParameterToPlain(id, part);
    char shown[128];
    if (id == kVst3InternalParameterProgram)
      std::snprintf(shown, sizeof shown, "%s", fPlugin.getProgramName(static_cast<uint32_t>(value)).buffer());
    else
      std::snprintf(shown, sizeof shown, "%.4g", value);  // the host adds the unit
    strncpy_utf16(text, shown, 128);
    return V3_OK;
  }

  v3_result getParameterValueForString(v3_param_id id, int16_t* text, double* part) {
    if (!is_parameter(id)) return PluginVst3::getParameterValueForString(id, text, part);
    const ScopedUTF8String typed(text);
    char* end = nullptr;
    const double value = std::strtod(typed, &end);
    if (end == static_cast<const char*>(typed) || !std::isfinite(value)) return V3_INVALID_ARG;
    *part = scale(index_of(id)).part_of(value);
    return V3_OK;
  }

  /// Instruments ring as long as they are not damped.
  uint32_t getTailSamples() const noexcept { return ~uint32_t(0); }

  /// Plays the parts of a block between changes of parameters.
  v3_result process(v3_process_data* data) {
    const int32_t length = data->nframes;
    if (has_new_program_.exchange(false))  // tells the host the values of a program
      for (uint32_t i = 0; i < fParameterCount; ++i)
        fParameterValuesChangedDuringProcessing[kVst3InternalParameterBaseCount + i] =
            !fPlugin.isParameterOutputOrTrigger(i);
    const bool has_changes =
        data->input_params != nullptr && v3_cpp_obj(data->input_params)->get_param_count(data->input_params) > 0;
    v3_process_data part = *data;
    part.input_events = nullptr;
    float* input = nullptr;
    v3_audio_bus_buffers input_bus = {};
    input_bus.num_channels = 1;
    input_bus.channel_buffers_32 = &input;
    part.inputs = has_input(*data) ? &input_bus : nullptr;
    if (part.inputs != nullptr) input = data->inputs[0].channel_buffers_32[0];
    if (!has_changes) {
      read_notes(data->input_events, 0, (std::numeric_limits<int32_t>::max)(), length <= 0);
      return PluginVst3::process(&part);
    }
    v3_audio_bus_buffers bus = data->num_output_buses > 0 ? data->outputs[0] : v3_audio_bus_buffers();
    float* channels[DISTRHO_PLUGIN_NUM_OUTPUTS] = {};
    part.outputs = data->num_output_buses > 0 ? &bus : nullptr;
    bus.num_channels = std::min<int32_t>(bus.num_channels, DISTRHO_PLUGIN_NUM_OUTPUTS);
    for (int32_t begin = 0;;) {
      vst3_object::ControllerPoints points;
      const int32_t end = change_parameters(data->input_params, begin, length, points);
      // What a host sends outside of the block belongs to its ends.
      read_notes(data->input_events, begin, end == length ? (std::numeric_limits<int32_t>::max)() : end,
                 end <= begin);
      for (int32_t c = 0; c < bus.num_channels; ++c) channels[c] = data->outputs[0].channel_buffers_32[c] + begin;
      bus.channel_buffers_32 = channels;
      part.nframes = end - begin;
      part.input_params = reinterpret_cast<v3_param_changes**>(&points);
      const v3_result result = PluginVst3::process(&part);
      if (result != V3_OK || end >= length) return result;
      if (input != nullptr) input += end - begin;
      begin = end;
    }
  }

  /// What a host may ask the controller for and the framework does not have; null for all else.
  void* interface(const v3_tuid id) {
    if (v3_tuid_match(id, v3_unit_information_iid)) return &programs_;
    if (v3_tuid_match(id, v3_note_expression_controller_iid)) return &expressions_;
    if (v3_tuid_match(id, v3_note_expression_physical_iid)) return &fingers_;
    return v3_tuid_match(id, v3_midi_mapping_iid) ? &mapping_ : nullptr;
  }

 private:
  static constexpr int kAllSoundOff = 120, kAllNotesOff = 123, kPitchWheel = 129;
  static constexpr int kControllers = 130, kChannels = 16;  // as the framework numbers them

  [[nodiscard]] static bool is_of_channel(int controller) {
    return controller == kPitchWheel || controller == kAllNotesOff;
  }
  [[nodiscard]] static v3_param_id hidden_id(int controller, int channel) {
    return static_cast<v3_param_id>(kVst3InternalParameterMidiCC_start + kControllers * channel + controller);
  }
  [[nodiscard]] static int controller_of(v3_param_id id) {
    return static_cast<int>(id - kVst3InternalParameterMidiCC_start) % kControllers;
  }
  [[nodiscard]] static int channel_of(v3_param_id id) {
    return static_cast<int>(id - kVst3InternalParameterMidiCC_start) / kControllers;
  }
  void hide(int controller, int channel) {
    const v3_param_id id = hidden_id(controller, channel);
    if (!is_hidden(id)) hidden_[hidden_count_++] = id;
  }

  // Does the host give the input a signal?
  [[nodiscard]] bool has_input([[maybe_unused]] const v3_process_data& data) const {
#if DISTRHO_PLUGIN_NUM_INPUTS > 0
    return fEnabledInputs[0] && data.num_input_buses > 0 && data.inputs != nullptr &&
           data.inputs[0].num_channels > 0 && data.inputs[0].channel_buffers_32 != nullptr &&
           data.inputs[0].channel_buffers_32[0] != nullptr;
#else
    return false;
#endif
  }

  [[nodiscard]] uint32_t program_parameters() const {
    return fProgramCountMinusOne > 0 ? 1 : 0;
  }
  [[nodiscard]] bool is_parameter(v3_param_id id) const {
    return id >= kVst3InternalParameterCount && index_of(id) < fParameterCount;
  }
  [[nodiscard]] static uint32_t index_of(v3_param_id id) {
    return id - kVst3InternalParameterCount;
  }
  [[nodiscard]] bool is_hidden(v3_param_id id) const {
    return std::find(hidden_, hidden_ + hidden_count_, id) != hidden_ + hidden_count_;
  }
  [[nodiscard]] contactspline::HostScale scale(uint32_t index) const {
    const ParameterRanges& ranges = fPlugin.getParameterRanges(index);
    return {ranges.min, ranges.max, (fPlugin.getParameterHints(index) & kParameterIsLogarithmic) != 0};
  }

  // The framework's own copies of the values are not for two threads: the instrument's are read and set.
  void move(uint32_t index, double part) {
    if (fPlugin.isParameterOutputOrTrigger(index) || !(part >= 0 && part <= 1)) return;
    // Some hosts keep parts in single precision: what they repeat is no change.
    if (std::abs(scale(index).part_of(fPlugin.getParameterValue(index)) - part) < 1e-7) return;
    fPlugin.setParameterValue(index, static_cast<float>(scale(index).value_at(part)));
  }

  [[nodiscard]] uint32_t program_of(double part) const {
    return static_cast<uint32_t>(std::round(std::clamp(part, 0.0, 1.0) * fProgramCountMinusOne));
  }

  void tell_latency() {
    const uint32_t latency = getLatencySamples();
    if (latency != std::exchange(told_latency_, latency) && fComponentHandler != nullptr)
      v3_cpp_obj(fComponentHandler)->restart_component(fComponentHandler, V3_RESTART_LATENCY_CHANGED);
  }

  void load_program(uint32_t program) {
    program_ = program;
    fPlugin.loadProgram(program);
  }

  // Moves what changes at a sample, and returns where the next change is, or the end of the block.
  int32_t change_parameters(v3_param_changes** changes, int32_t begin, int32_t length,
                            vst3_object::ControllerPoints& points) {
    int32_t next = length;
    const int32_t count = v3_cpp_obj(changes)->get_param_count(changes);
    for (int32_t i = 0; i < count; ++i) {
      v3_param_value_queue** const queue = v3_cpp_obj(changes)->get_param_data(changes, i);
      if (queue == nullptr) continue;
      const v3_param_id id = v3_cpp_obj(queue)->get_param_id(queue);
      const int32_t moves = v3_cpp_obj(queue)->get_point_count(queue);
      for (int32_t m = 0; m < moves; ++m) {
        int32_t offset = 0;
        double part = 0;
        if (v3_cpp_obj(queue)->get_point(queue, m, &offset, &part) != V3_OK) break;
        offset = std::clamp(offset, 0, (std::max)(0, length - 1));
        if (offset > begin) next = (std::min)(next, offset);
        if (offset == begin) change(id, part, points);
      }
    }
    return next;
  }

  void change(v3_param_id id, double part, vst3_object::ControllerPoints& points) {
    if (is_parameter(id)) return move(index_of(id), part);
    if (id == kVst3InternalParameterProgram) {
      // What the controller was told before is no change.
      if (program_of(part) != program_) load_program(program_of(part));
      return;
    }
    if (!is_hidden(id) || !(part >= 0 && part <= 1)) return;
    vst3_object::ControllerPoint* point =
        std::find_if(points.points, points.points + points.count, [id](const auto& known) { return known.id == id; });
    if (point == points.points + points.count) ++points.count;
    point->id = id;
    // At its upper end the framework would make a byte of the wheel that is none of MIDI's.
    point->value = std::min(part, controller_of(id) == kPitchWheel ? 16383.0 / 16384 : 1.0);
  }

  struct Mapping {
    using Table = vst3_object::Table<v3_midi_mapping>;
    static const Table& table() {
      static const Table kTable = {
          {vst3_object::query, vst3_object::one, vst3_object::one},
          {[](void* self, int32_t bus, int16_t channel, int16_t controller, v3_param_id* id) -> v3_result {
            const InstrumentVst3& plugin = *static_cast<Mapping*>(self)->plugin;
            return bus == 0 && plugin.controllerAssignment(channel, controller, id) ? V3_TRUE : V3_FALSE;
          }}};
      return kTable;
    }
    const Table* functions = &table();
    const InstrumentVst3* plugin;
  };

  // Passes the notes from a sample on and before another one to a block that begins with the first. What a host sends
  // before the block belongs to its first sample.
  void read_notes(v3_event_list** list, int32_t begin, int32_t end, bool is_empty) {
    contactspline::WindowedPlugin& instrument = contactspline::WindowedPlugin::of(fPlugin.getInstancePointer());
    const uint32_t count = list == nullptr ? 0 : v3_cpp_obj(list)->get_event_count(list);
    for (uint32_t i = 0; i < count; ++i) {
      v3_event event;
      if (v3_cpp_obj(list)->get_event(list, static_cast<int32_t>(i), &event) != V3_OK) break;
      const int32_t sample = (std::max)(0, event.sample_offset);
      if (sample < begin || sample >= end) continue;
      auto note = vst3_object::note_of(event);
      if (!note) continue;
      note->frame = static_cast<uint32_t>(sample - begin);
      instrument.push(*note);
    }
    if (is_empty) instrument.take_notes();
  }

  // What hosts can express of notes.
  struct Expressions {
    using Table = vst3_object::Table<v3_note_expression_controller>;
    static int32_t V3_API count(void*, int32_t bus, int16_t) {
      return bus == 0 ? static_cast<int32_t>(std::size(vst3_object::kExpressions)) : 0;
    }
    static v3_result V3_API info(void*, int32_t bus, int16_t, int32_t number, v3_note_expression_type_info* info) {
      if (number < 0 || number >= count(nullptr, bus, 0)) return V3_INVALID_ARG;
      const vst3_object::Expression& known = vst3_object::kExpressions[number];
      *info = {};
      info->type_id = known.id;
      info->unit_id = -1;
      info->initial = known.initial;
      info->max = 1;
      info->flags = known.first < 0 ? v3_note_expression_type_info::kIsBipolar : 0;
      strncpy_utf16(info->title, known.title, 128);
      strncpy_utf16(info->short_title, known.title, 128);
      strncpy_utf16(info->units, known.unit, 128);
      return V3_OK;
    }
    // As people read it: of the tuning semitones.
    static double shown(const vst3_object::Expression& known) { return known.last > 100 ? 100 : 1; }
    static v3_result V3_API text(void*, int32_t, int16_t, uint32_t id, double part, v3_str_128 text) {
      const vst3_object::Expression* const known = vst3_object::expression(id);
      if (known == nullptr) return V3_INVALID_ARG;
      char digits[32];
      std::snprintf(digits, sizeof digits, "%.4g",
                    (known->first + (known->last - known->first) * part) / shown(*known));
      strncpy_utf16(text, digits, 128);
      return V3_OK;
    }
    static v3_result V3_API value(void*, int32_t, int16_t, uint32_t id, const int16_t* text, double* part) {
      const vst3_object::Expression* const known = vst3_object::expression(id);
      if (known == nullptr) return V3_INVALID_ARG;
      const ScopedUTF8String typed(text);
      char* end = nullptr;
      const double value = std::strtod(typed, &end) * shown(*known);
      if (end == static_cast<const char*>(typed) || !std::isfinite(value)) return V3_INVALID_ARG;
      *part = std::clamp((value - known->first) / (known->last - known->first), 0.0, 1.0);
      return V3_OK;
    }
    static const Table& table() {
      static const Table kTable = {{vst3_object::query, vst3_object::one, vst3_object::one},
                                   {count, info, text, value}};
      return kTable;
    }
    const Table* functions = &table();
  };

  // What a finger does on a controller with MPE: its way along the keys, across them, and its pressure.
  struct Fingers {
    using Table = vst3_object::Table<v3_note_expression_physical>;
    static v3_result V3_API mapping(void*, int32_t bus, int16_t, v3_physical_ui_map_list* list) {
      if (bus != 0 || list == nullptr) return V3_INVALID_ARG;
      for (uint32_t i = 0; i < list->count; ++i) {
        constexpr uint32_t kMeanings[] = {2, 5, vst3_object::kPressure};
        v3_physical_ui_map& map = list->maps[i];
        map.expression = map.movement < std::size(kMeanings) ? kMeanings[map.movement] : 0xffffffff;
      }
      return V3_OK;
    }
    static const Table& table() {
      static const Table kTable = {{vst3_object::query, vst3_object::one, vst3_object::one}, {mapping}};
      return kTable;
    }
    const Table* functions = &table();
  };

  // The programs, for hosts that ask for units. All stand in the root.
  struct Programs {
    using Table = vst3_object::Table<v3_unit_information>;
    static const Programs& of(void* self) { return *static_cast<Programs*>(self); }
    [[nodiscard]] int32_t count() const { return static_cast<int32_t>(plugin->getProgramCount()); }
    [[nodiscard]] int32_t lists() const { return count() > 1 ? 1 : 0; }
    [[nodiscard]] bool has(int32_t list, int32_t program) const {
      return list == 0 && lists() == 1 && program >= 0 && program < count();
    }

    static int32_t V3_API unit_count(void*) { return 1; }
    static v3_result V3_API unit_info(void* self, int32_t unit, v3_unit_info* info) {
      if (unit != 0) return V3_INVALID_ARG;
      *info = {};
      info->parent_unit_id = -1;
      info->program_list_id = of(self).lists() - 1;
      strncpy_utf16(info->name, "root", 128);
      return V3_OK;
    }
    static int32_t V3_API list_count(void* self) { return of(self).lists(); }
    static v3_result V3_API list_info(void* self, int32_t list, v3_program_list_info* info) {
      if (!of(self).has(list, 0)) return V3_INVALID_ARG;
      *info = {};
      info->programCount = of(self).count();
      strncpy_utf16(info->name, "presets", 128);
      return V3_OK;
    }
    static v3_result V3_API program_name(void* self, int32_t list, int32_t program, v3_str_128 name) {
      if (!of(self).has(list, program)) return V3_INVALID_ARG;
      strncpy_utf16(name, of(self).plugin->getProgramName(static_cast<uint32_t>(program)), 128);
      return V3_OK;
    }
    static const Table& table() {
      static const Table kTable = {
          {vst3_object::query, vst3_object::one, vst3_object::one},
          {unit_count, unit_info, list_count, list_info, program_name,
           [](void*, int32_t, int32_t, const char*, v3_str_128) -> v3_result { return V3_NOT_IMPLEMENTED; },
           [](void*, int32_t, int32_t) -> v3_result { return V3_FALSE; },
           [](void*, int32_t, int32_t, int16_t, v3_str_128) -> v3_result { return V3_NOT_IMPLEMENTED; },
           [](void*) { return int32_t(0); },
           [](void*, int32_t unit) -> v3_result { return unit == 0 ? V3_OK : V3_INVALID_ARG; },
           [](void*, int32_t, int32_t, int32_t, int32_t, int32_t* unit) -> v3_result {
             *unit = 0;
             return V3_OK;
           },
           [](void*, int32_t, int32_t, v3_bstream**) -> v3_result { return V3_NOT_IMPLEMENTED; }}};
      return kTable;
    }

    const Table* functions = &table();
    const PluginExporter* plugin;
  };

  Programs programs_ = {.plugin = &fPlugin};
  Expressions expressions_;
  Fingers fingers_;
  Mapping mapping_ = {.plugin = this};
  v3_param_id hidden_[vst3_object::ControllerPoints::kMax] = {};
  uint32_t hidden_count_ = 0;
  uint32_t told_latency_ = 0;
  std::atomic_ref<uint32_t> program_{fCurrentProgram};
  std::atomic<bool> has_new_program_ = false;  ///< the host does not know its values yet
};

END_NAMESPACE_DISTRHO
