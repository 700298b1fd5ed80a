// SPDX-License-Identifier: MIT
// A small CLAP host.
#pragma once

#include <clap/entry.h>
#include <clap/ext/audio-ports.h>
#include <clap/ext/gui.h>
#include <clap/ext/latency.h>
#include <clap/ext/note-ports.h>
#include <clap/ext/params.h>
#include <clap/ext/state.h>
#include <clap/ext/timer-support.h>
#include <clap/plugin-factory.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <span>

#include "contactspline/midi/midi_interpreter.hpp"
#include "plugins/hosted_plugin.hpp"

namespace contactspline::testing {

class ClapPlugin : public HostedPlugin {
 public:
  ClapPlugin(const std::filesystem::path& file, double sample_rate_hz)
      : library_(file), entry_(library_.symbol<const clap_plugin_entry_t>("clap_entry")) {
    require(clap_version_is_compatible(entry_->clap_version) && entry_->init(file.string().c_str()), "no entry");
    require(factory() != nullptr && factory()->get_plugin_count(factory()) == 1, "no factory");
    descriptor_ = factory()->get_plugin_descriptor(factory(), 0);
    plugin_ = factory()->create_plugin(factory(), &host_, descriptor_->id);
    require(plugin_ != nullptr && plugin_->init(plugin_), "no plug-in");
    params_ = extension<clap_plugin_params_t>(CLAP_EXT_PARAMS);
    require(plugin_->activate(plugin_, sample_rate_hz, 1, kMaxBlock) && plugin_->start_processing(plugin_),
            "not active");
    for (std::uint32_t i = 0; i < params_->count(plugin_); ++i) {
      clap_param_info_t info;
      require(params_->get_info(plugin_, i, &info), "no parameter");
      ids_[info.name] = info.id;
    }
    events_.reserve(64);
    told_.reserve(kMaxTold);
    ended_.reserve(kMaxTold);
  }
  ~ClapPlugin() override {
    plugin_->stop_processing(plugin_);
    plugin_->deactivate(plugin_);
    plugin_->destroy(plugin_);
    entry_->deinit();
  }

  [[nodiscard]] const clap_plugin_descriptor_t& descriptor() const { return *descriptor_; }

  /// Null if the plug-in has no such factory.
  [[nodiscard]] const clap_plugin_factory_t* factory(const char* id = CLAP_PLUGIN_FACTORY_ID) const {
    return static_cast<const clap_plugin_factory_t*>(entry_->get_factory(id));
  }
  /// Does the factory make a plug-in of this identity?
  [[nodiscard]] bool makes(const std::string& id) const {
    const clap_plugin_t* const made = factory()->create_plugin(factory(), &host_, id.c_str());
    if (made != nullptr) made->destroy(made);
    return made != nullptr;
  }

  /// Null if the plug-in has no such extension.
  template <typename Extension>
  [[nodiscard]] const Extension* extension(const char* id) const {
    return static_cast<const Extension*>(plugin_->get_extension(plugin_, id));
  }

  void open_window(std::uintptr_t parent, double scale) override {
    require(gui().is_api_supported(plugin_, kSystem, false), "no window of this system");
    require(gui().create(plugin_, kSystem, false), "no window");
    require(gui().set_scale(plugin_, scale), "no scale");
    clap_window_t window = {kSystem, {}};
    window.uptr = parent;
    require(gui().set_parent(plugin_, &window) && gui().show(plugin_), "no window");
    if (kIsTimedByHost) require(timer_period_ms_ > 0 && timer_period_ms_ <= 17, "no timer");
  }
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> window_size() override {
    std::uint32_t width = 0, height = 0;
    require(gui().get_size(plugin_, &width, &height), "no size");
    return {width, height};
  }
  void resize_window(std::uint32_t width, std::uint32_t height) override {
    require(gui().can_resize(plugin_) && gui().set_size(plugin_, width, height), "no resize");
  }
  void idle_window() override {
    if (kIsTimedByHost) extension<clap_plugin_timer_support_t>(CLAP_EXT_TIMER_SUPPORT)->on_timer(plugin_, 1);
  }
  void close_window() override { gui().destroy(plugin_); }

  [[nodiscard]] std::vector<std::pair<std::string, double>> told() override {
    std::vector<std::pair<std::string, double>> told;
    for (const clap_event_param_value_t& event : told_)
      for (const auto& [name, id] : ids_)
        if (id == event.param_id) told.emplace_back(name, event.value);
    return told;
  }

  /// As a host does on its audio thread, when the user stops all sound.
  void reset() { plugin_->reset(plugin_); }

  [[nodiscard]] std::vector<HostedParameter> parameters() const override { return parameters(false); }
  [[nodiscard]] std::vector<HostedParameter> readings() const override { return parameters(true); }

  /// A value as hosts show it, empty where the plug-in has no such parameter.
  [[nodiscard]] std::string text(clap_id id, double value) const {
    char shown[64];
    return params_->value_to_text(plugin_, id, value, shown, sizeof shown) ? shown : "";
  }

  [[nodiscard]] clap_id id(const std::string& parameter) const { return ids_.at(parameter); }
  [[nodiscard]] double value_of(clap_id id, const std::string& text) const {
    double value = 0;
    require(params_->text_to_value(plugin_, id, text.c_str(), &value), "no value of a text");
    return value;
  }
  /// Passes the events on without a block.
  void flush() {
    const auto [input, output] = lists();
    params_->flush(plugin_, &input, &output);
    events_.clear();
  }

  [[nodiscard]] double value(const std::string& parameter) override {
    double value = 0;
    require(params_->get_value(plugin_, ids_.at(parameter), &value), "no value");
    return value;
  }

  void set(const std::string& parameter, double value, std::uint32_t time = 0) override {
    set(ids_.at(parameter), value, time);
  }
  void set(clap_id parameter, double value, std::uint32_t time, std::uint16_t space = CLAP_CORE_EVENT_SPACE_ID) {
    Event event = {};
    event.parameter = {.header = header(sizeof event.parameter, time, CLAP_EVENT_PARAM_VALUE),
                       .param_id = parameter,
                       .cookie = nullptr,
                       .note_id = -1,
                       .port_index = -1,
                       .channel = -1,
                       .key = -1,
                       .value = value};
    event.head.space_id = space;
    events_.push_back(event);
  }

  void send(std::uint32_t time, std::array<std::uint8_t, 3> message) override {
    Event event = {};
    event.midi = {header(sizeof event.midi, time, CLAP_EVENT_MIDI), 0, {message[0], message[1], message[2]}};
    events_.push_back(event);
  }

  // Notes by name, as hosts of this format have them.
  void note_on(const NoteName& name, double velocity, std::uint32_t time = 0) {
    push_note(CLAP_EVENT_NOTE_ON, name, velocity, time);
  }
  void choke(const NoteName& name) { push_note(CLAP_EVENT_NOTE_CHOKE, name, 0, 0); }
  void note_off(const NoteName& name, double velocity, std::uint32_t time = 0) {
    push_note(CLAP_EVENT_NOTE_OFF, name, velocity, time);
  }
  /// expression: of CLAP.
  void express(std::int32_t expression, const NoteName& name, double value, std::uint32_t time = 0) {
    Event event = {};
    event.expression = {header(sizeof event.expression, time, CLAP_EVENT_NOTE_EXPRESSION),
                        expression,
                        name.id,
                        0,
                        static_cast<std::int16_t>(name.channel),
                        static_cast<std::int16_t>(name.key),
                        value};
    events_.push_back(event);
  }
  /// The value of a parameter of single notes, or how far it is moved.
  void set_of_note(const std::string& parameter, const NoteName& name, double value) {
    push_value(CLAP_EVENT_PARAM_VALUE, parameter, name, value);
  }
  void modulate(const std::string& parameter, const NoteName& name, double amount) {
    push_value(CLAP_EVENT_PARAM_MOD, parameter, name, amount);
  }
  /// bytes: of an exclusive message of MIDI; they must outlive the block.
  void send_exclusive(std::span<const std::uint8_t> bytes) {
    Event event = {};
    event.exclusive = {header(sizeof event.exclusive, 0, CLAP_EVENT_MIDI_SYSEX), 0, bytes.data(),
                       static_cast<std::uint32_t>(bytes.size())};
    events_.push_back(event);
  }
  /// The notes whose end the plug-in has told.
  [[nodiscard]] const std::vector<clap_event_note_t>& ended() const { return ended_; }
  /// Flags of a parameter.
  [[nodiscard]] std::uint32_t flags(const std::string& parameter) const {
    clap_param_info_t info = {};
    require(params_->get_info(plugin_, ids_.at(parameter), &info), "no parameter");
    return info.flags;
  }

  [[nodiscard]] bool has_input() override {
    const auto* const ports = extension<clap_plugin_audio_ports_t>(CLAP_EXT_AUDIO_PORTS);
    require(ports != nullptr && ports->count(plugin_, false) == 1, "no port");
    const std::uint32_t inputs = ports->count(plugin_, true);
    if (inputs == 0) return false;
    clap_audio_port_info_t info = {};
    require(inputs == 1 && ports->get(plugin_, 0, true, &info) && info.channel_count == 1 &&
                (info.flags & CLAP_AUDIO_PORT_IS_MAIN) == 0 && std::string(info.name) == "body",
            "another input");
    return true;
  }

  /// The framework has no programs for this format.
  [[nodiscard]] std::vector<std::string> programs() override { return {}; }
  void load_program(std::size_t) override {}

  [[nodiscard]] std::uint32_t latency() override {
    return extension<clap_plugin_latency_t>(CLAP_EXT_LATENCY)->get(plugin_);
  }
  [[nodiscard]] std::size_t latency_changes() const override { return latency_changes_; }
  /// Whether the plug-in has asked for a restart since the last call.
  [[nodiscard]] bool wants_restart() { return std::exchange(wants_restart_, false); }
  void restart(double sample_rate_hz) {
    plugin_->stop_processing(plugin_);
    plugin_->deactivate(plugin_);
    require(plugin_->activate(plugin_, sample_rate_hz, 1, kMaxBlock) && plugin_->start_processing(plugin_),
            "not active");
  }

  [[nodiscard]] std::string save() override {
    std::string saved;
    const clap_ostream_t stream = {&saved, [](const clap_ostream_t* self, const void* buffer, std::uint64_t size) {
                                     const std::size_t written = std::min<std::size_t>(size, kPiece);
                                     static_cast<std::string*>(self->ctx)->append(static_cast<const char*>(buffer),
                                                                                  written);
                                     return static_cast<std::int64_t>(written);
                                   }};
    require(state().save(plugin_, &stream), "not saved");
    return saved;
  }

  void restore(std::string saved) override {
    const clap_istream_t stream = {
        &saved, [](const clap_istream_t* self, void* buffer, std::uint64_t size) {
          auto& rest = *static_cast<std::string*>(self->ctx);
          const std::size_t read = std::min({static_cast<std::size_t>(size), rest.size(), kPiece});
          std::memcpy(buffer, rest.data(), read);
          rest.erase(0, read);
          return static_cast<std::int64_t>(read);
        }};
    require(state().load(plugin_, &stream), "not restored");
  }

 private:
#ifdef _WIN32
  static constexpr const char* kSystem = CLAP_WINDOW_API_WIN32;
  static constexpr bool kIsTimedByHost = false;
#else
  static constexpr const char* kSystem = CLAP_WINDOW_API_X11;
  static constexpr bool kIsTimedByHost = true;
#endif
  static constexpr std::size_t kMaxTold = 1000;  // values that are kept: more would be allocated while it plays
  static constexpr std::size_t kPiece = 23;      // bytes: streams may take and give fewer than asked for

  // The format has no units: they stand in the text of a value.
  [[nodiscard]] std::vector<HostedParameter> parameters(bool are_readings) const {
    std::vector<HostedParameter> parameters;
    for (std::uint32_t i = 0; i < params_->count(plugin_); ++i) {
      clap_param_info_t info;
      require(params_->get_info(plugin_, i, &info), "no parameter");
      if (((info.flags & CLAP_PARAM_IS_READONLY) != 0) != are_readings) continue;
      const std::string shown = text(info.id, info.max_value);
      const std::size_t space = shown.find(' ');
      parameters.push_back({info.name, space == std::string::npos ? "" : shown.substr(space + 1), info.min_value,
                            info.max_value, info.default_value});
    }
    return parameters;
  }

  union Event {
    clap_event_header_t head;
    clap_event_midi_t midi;
    clap_event_param_value_t parameter;
    clap_event_note_t note;
    clap_event_note_expression_t expression;
    clap_event_param_mod_t moved;
    clap_event_midi_sysex_t exclusive;
  };

  void push_note(std::uint16_t type, const NoteName& name, double velocity, std::uint32_t time) {
    Event event = {};
    event.note = {header(sizeof event.note, time, type), name.id, 0, static_cast<std::int16_t>(name.channel),
                  static_cast<std::int16_t>(name.key),   velocity};
    events_.push_back(event);
  }
  void push_value(std::uint16_t type, const std::string& parameter, const NoteName& name, double value) {
    static_assert(sizeof(clap_event_param_value_t) == sizeof(clap_event_param_mod_t));
    Event event = {};
    event.parameter = {header(sizeof event.parameter, 0, type),
                       ids_.at(parameter),
                       nullptr,
                       name.id,
                       -1,
                       static_cast<std::int16_t>(name.channel),
                       static_cast<std::int16_t>(name.key),
                       value};
    events_.push_back(event);
  }

  static void require(bool holds, const char* what) {
    if (!holds) throw std::runtime_error(std::string("CLAP: ") + what);
  }

  static clap_event_header_t header(std::size_t size, std::uint32_t time, std::uint16_t type) {
    return {static_cast<std::uint32_t>(size), time, CLAP_CORE_EVENT_SPACE_ID, type, 0};
  }

  [[nodiscard]] const clap_plugin_gui_t& gui() const {
    const auto* const gui = extension<clap_plugin_gui_t>(CLAP_EXT_GUI);
    require(gui != nullptr, "no window");
    return *gui;
  }

  static const void* host_extension(const clap_host_t*, const char* id) {
    static const clap_host_gui_t gui = {[](const clap_host_t*) {},
                                        [](const clap_host_t*, std::uint32_t, std::uint32_t) { return true; },
                                        [](const clap_host_t*) { return true; },
                                        [](const clap_host_t*) { return true; }, [](const clap_host_t*, bool) {}};
    static const clap_host_timer_support_t timer = {
        [](const clap_host_t* host, std::uint32_t period_ms, clap_id* timer_id) {
          static_cast<ClapPlugin*>(host->host_data)->timer_period_ms_ = period_ms;
          *timer_id = 1;
          return true;
        },
        [](const clap_host_t*, clap_id) { return true; }};
    static const clap_host_latency_t latency = {
        [](const clap_host_t* host) { ++static_cast<ClapPlugin*>(host->host_data)->latency_changes_; }};
    if (std::strcmp(id, CLAP_EXT_LATENCY) == 0) return &latency;
    if (std::strcmp(id, CLAP_EXT_GUI) == 0) return &gui;
    return std::strcmp(id, CLAP_EXT_TIMER_SUPPORT) == 0 ? &timer : nullptr;
  }

  [[nodiscard]] const clap_plugin_state_t& state() const {
    const auto* const state = extension<clap_plugin_state_t>(CLAP_EXT_STATE);
    require(state != nullptr, "no state");
    return *state;
  }

  void process(float* signal, std::array<float*, 2> outputs, std::uint32_t samples) override {
    clap_audio_buffer_t bus = {outputs.data(), nullptr, 2, 0, 0};
    const clap_audio_buffer_t input_bus = {&signal, nullptr, 1, 0, 0};
    const auto [input, output] = lists();
    const clap_process_t block = {-1, samples, nullptr, &input_bus, &bus, signal == nullptr ? 0u : 1u,
                                  1,  &input,  &output};
    require(plugin_->process(plugin_, &block) != CLAP_PROCESS_ERROR, "process");
    events_.clear();
  }

  [[nodiscard]] std::pair<clap_input_events_t, clap_output_events_t> lists() {
    const clap_input_events_t input = {
        &events_,
        [](const clap_input_events_t* self) {
          return static_cast<std::uint32_t>(static_cast<std::vector<Event>*>(self->ctx)->size());
        },
        [](const clap_input_events_t* self, std::uint32_t i) -> const clap_event_header_t* {
          return &(*static_cast<std::vector<Event>*>(self->ctx))[i].head;
        }};
    const clap_output_events_t output = {
        this, [](const clap_output_events_t* self, const clap_event_header_t* event) {
          auto& told = static_cast<ClapPlugin*>(self->ctx)->told_;
          if (event->type == CLAP_EVENT_PARAM_VALUE && told.size() < kMaxTold)
            told.push_back(*reinterpret_cast<const clap_event_param_value_t*>(event));
          auto& ended = static_cast<ClapPlugin*>(self->ctx)->ended_;
          if (event->type == CLAP_EVENT_NOTE_END && ended.size() < kMaxTold)
            ended.push_back(*reinterpret_cast<const clap_event_note_t*>(event));
          return true;
        }};
    return {input, output};
  }

  Library library_;
  const clap_plugin_entry_t* entry_;
  const clap_plugin_descriptor_t* descriptor_ = nullptr;
  const clap_plugin_t* plugin_ = nullptr;
  const clap_plugin_params_t* params_ = nullptr;
  clap_host_t host_ = {
      CLAP_VERSION,
      this,
      "test",
      "test",
      "",
      "1",
      host_extension,
      [](const clap_host_t* host) { static_cast<ClapPlugin*>(host->host_data)->wants_restart_ = true; },
      [](const clap_host_t*) {},
      [](const clap_host_t*) {}};
  std::map<std::string, clap_id> ids_;
  std::vector<Event> events_;
  std::vector<clap_event_param_value_t> told_;
  std::vector<clap_event_note_t> ended_;
  std::uint32_t timer_period_ms_ = 0;
  bool wants_restart_ = false;
  std::size_t latency_changes_ = 0;
};

}  // namespace contactspline::testing
