// SPDX-License-Identifier: MIT
// A small CLAP host.
#pragma once

#include <clap/entry.h>
#include <clap/ext/audio-ports.h>
#include <clap/ext/note-ports.h>
#include <clap/ext/params.h>
#include <clap/ext/state.h>
#include <clap/plugin-factory.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "plugins/hosted_plugin.hpp"

namespace contactspline::testing {

class ClapPlugin : public HostedPlugin {
 public:
  ClapPlugin(const std::filesystem::path& file, double sample_rate_hz)
      : library_(file), entry_(library_.symbol<const clap_plugin_entry_t>("clap_entry")) {
    require(clap_version_is_compatible(entry_->clap_version) && entry_->init(file.string().c_str()), "no entry");
    const auto* factory = static_cast<const clap_plugin_factory_t*>(entry_->get_factory(CLAP_PLUGIN_FACTORY_ID));
    require(factory != nullptr && factory->get_plugin_count(factory) == 1, "no factory");
    descriptor_ = factory->get_plugin_descriptor(factory, 0);
    plugin_ = factory->create_plugin(factory, &host_, descriptor_->id);
    require(plugin_ != nullptr && plugin_->init(plugin_), "no plug-in");
    params_ = extension<clap_plugin_params_t>(CLAP_EXT_PARAMS);
    require(plugin_->activate(plugin_, sample_rate_hz, 1, kBlock) && plugin_->start_processing(plugin_),
            "not active");
    for (std::uint32_t i = 0; i < params_->count(plugin_); ++i) {
      clap_param_info_t info;
      require(params_->get_info(plugin_, i, &info), "no parameter");
      ids_[info.name] = info.id;
    }
    events_.reserve(64);
  }
  ~ClapPlugin() override {
    plugin_->stop_processing(plugin_);
    plugin_->deactivate(plugin_);
    plugin_->destroy(plugin_);
    entry_->deinit();
  }

  [[nodiscard]] const clap_plugin_descriptor_t& descriptor() const { return *descriptor_; }

  /// Null if the plug-in has no such extension.
  template <typename Extension>
  [[nodiscard]] const Extension* extension(const char* id) const {
    return static_cast<const Extension*>(plugin_->get_extension(plugin_, id));
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

  [[nodiscard]] double value(const std::string& parameter) override {
    double value = 0;
    require(params_->get_value(plugin_, ids_.at(parameter), &value), "no value");
    return value;
  }

  void set(const std::string& parameter, double value, std::uint32_t time = 0) override {
    set(ids_.at(parameter), value, time);
  }
  void set(clap_id parameter, double value, std::uint32_t time) {
    Event event = {};
    event.parameter = {.header = header(sizeof event.parameter, time, CLAP_EVENT_PARAM_VALUE),
                       .param_id = parameter,
                       .cookie = nullptr,
                       .note_id = -1,
                       .port_index = -1,
                       .channel = -1,
                       .key = -1,
                       .value = value};
    events_.push_back(event);
  }

  void send(std::uint32_t time, std::array<std::uint8_t, 3> message) override {
    Event event = {};
    event.midi = {header(sizeof event.midi, time, CLAP_EVENT_MIDI), 0, {message[0], message[1], message[2]}};
    events_.push_back(event);
  }

  /// The framework has no programs for this format.
  [[nodiscard]] std::vector<std::string> programs() override { return {}; }
  void load_program(std::size_t) override {}

  [[nodiscard]] std::string save() override {
    std::string saved;
    const clap_ostream_t stream = {&saved, [](const clap_ostream_t* self, const void* buffer, std::uint64_t size) {
                                     static_cast<std::string*>(self->ctx)->append(static_cast<const char*>(buffer),
                                                                                  size);
                                     return static_cast<std::int64_t>(size);
                                   }};
    require(state().save(plugin_, &stream), "not saved");
    return saved;
  }

  void restore(std::string saved) override {
    const clap_istream_t stream = {&saved, [](const clap_istream_t* self, void* buffer, std::uint64_t size) {
                                     auto& rest = *static_cast<std::string*>(self->ctx);
                                     const std::size_t read = std::min<std::size_t>(size, rest.size());
                                     std::memcpy(buffer, rest.data(), read);
                                     rest.erase(0, read);
                                     return static_cast<std::int64_t>(read);
                                   }};
    require(state().load(plugin_, &stream), "not restored");
  }

 private:
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
  };

  static void require(bool holds, const char* what) {
    if (!holds) throw std::runtime_error(std::string("CLAP: ") + what);
  }

  static clap_event_header_t header(std::size_t size, std::uint32_t time, std::uint16_t type) {
    return {static_cast<std::uint32_t>(size), time, CLAP_CORE_EVENT_SPACE_ID, type, 0};
  }

  [[nodiscard]] const clap_plugin_state_t& state() const {
    const auto* const state = extension<clap_plugin_state_t>(CLAP_EXT_STATE);
    require(state != nullptr, "no state");
    return *state;
  }

  void process(std::array<float*, 2> outputs) override {
    clap_audio_buffer_t bus = {outputs.data(), nullptr, 2, 0, 0};
    const clap_input_events_t input = {
        &events_,
        [](const clap_input_events_t* self) {
          return static_cast<std::uint32_t>(static_cast<std::vector<Event>*>(self->ctx)->size());
        },
        [](const clap_input_events_t* self, std::uint32_t i) -> const clap_event_header_t* {
          return &(*static_cast<std::vector<Event>*>(self->ctx))[i].head;
        }};
    const clap_output_events_t output = {
        nullptr, [](const clap_output_events_t*, const clap_event_header_t*) { return true; }};
    const clap_process_t block = {-1, kBlock, nullptr, nullptr, &bus, 0, 1, &input, &output};
    require(plugin_->process(plugin_, &block) != CLAP_PROCESS_ERROR, "process");
    events_.clear();
  }

  Library library_;
  const clap_plugin_entry_t* entry_;
  const clap_plugin_descriptor_t* descriptor_ = nullptr;
  const clap_plugin_t* plugin_ = nullptr;
  const clap_plugin_params_t* params_ = nullptr;
  clap_host_t host_ = {CLAP_VERSION,
                       nullptr,
                       "test",
                       "test",
                       "",
                       "1",
                       [](const clap_host_t*, const char*) -> const void* { return nullptr; },
                       [](const clap_host_t*) {},
                       [](const clap_host_t*) {},
                       [](const clap_host_t*) {}};
  std::map<std::string, clap_id> ids_;
  std::vector<Event> events_;
};

}  // namespace contactspline::testing
