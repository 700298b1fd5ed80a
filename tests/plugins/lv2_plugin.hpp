// SPDX-License-Identifier: MIT
// An LV2 plug-in behind the interface of the other formats.
#pragma once

#include <lv2/data-access/data-access.h>
#include <lv2/instance-access/instance-access.h>
#include <lv2/parameters/parameters.h>
#include <lv2/ui/ui.h>

#include <algorithm>
#include <cstdlib>

#include "plugins/hosted_plugin.hpp"
#include "plugins/lv2_host.hpp"

namespace contactspline::testing {

class Lv2Plugin : public HostedPlugin {
 public:
  static_assert(Lv2Instance::kBlock == kBlock);

  Lv2Plugin(const Lv2World& world, const std::string& uri, double sample_rate_hz)
      : world_(world), plugin_(world.plugin(uri)), instance_(world, uri, sample_rate_hz) {
    const Lv2World::Node preset = world.uri(LV2_PRESETS__Preset);
    LilvNodes* const presets = lilv_plugin_get_related(plugin_, preset.get());
    LILV_FOREACH(nodes, i, presets) {
      const LilvNode* const node = lilv_nodes_get(presets, i);
      lilv_world_load_resource(world.get(), node);
      presets_.emplace(lilv_node_as_uri(node),
                       State(lilv_state_new_from_world(world.get(), instance_.urids().map(), node), lilv_state_free));
    }
    lilv_nodes_free(presets);
  }

  [[nodiscard]] std::vector<HostedParameter> parameters() const override { return controls(true); }
  [[nodiscard]] std::vector<HostedParameter> readings() const override { return controls(false); }

  [[nodiscard]] double value(const std::string& parameter) override { return instance_.control_port(parameter); }
  void set(const std::string& parameter, double value, std::uint32_t time = 0) override {
    if (time != 0) throw std::invalid_argument("LV2: controls change with a block");
    instance_.set(parameter, static_cast<float>(value));
  }
  void send(std::uint32_t time, std::array<std::uint8_t, 3> message) override { instance_.send(message, time); }

  [[nodiscard]] std::vector<std::string> programs() override {
    std::vector<std::string> names;
    for (const auto& [uri, state] : presets_) names.emplace_back(lilv_state_get_label(state.get()));
    return names;
  }
  void load_program(std::size_t index) override {
    take(std::next(presets_.begin(), static_cast<std::ptrdiff_t>(index))->second.get());
  }

  [[nodiscard]] std::uint32_t latency() override {
    if (!lilv_plugin_has_latency(plugin_)) throw std::runtime_error("LV2: no latency");
    return static_cast<std::uint32_t>(
        instance_.control_port(ports().at(lilv_plugin_get_latency_port_index(plugin_)).symbol));
  }
  [[nodiscard]] std::size_t latency_changes() const override { return 0; }

  [[nodiscard]] std::string save() override {
    const State state = this->state();
    char* const text = lilv_state_to_string(world_.get(), instance_.urids().map(), instance_.urids().unmap(),
                                            state.get(), "urn:saved", nullptr);
    std::string saved = text;
    lilv_free(text);
    return saved;
  }

  /// As state.ttl in a folder.
  void save_into(const std::string& folder) {
    const State state = this->state();
    lilv_state_save(world_.get(), instance_.urids().map(), instance_.urids().unmap(), state.get(), nullptr,
                    folder.c_str(), "state.ttl");
  }

  void restore(std::string saved) override {
    const State state(lilv_state_new_from_string(world_.get(), instance_.urids().map(), saved.c_str()),
                      lilv_state_free);
    if (!state) throw std::runtime_error("LV2: no state");
    take(state.get());
  }

  [[nodiscard]] bool has_input() override {
    const auto is_one = [](const Lv2Port& port) { return port.is_audio && port.is_input; };
    const auto found = std::ranges::find_if(ports(), is_one);
    if (found == ports().end()) return false;
    const Lv2World::Node symbol(lilv_new_string(world_.get(), found->symbol.c_str()), lilv_node_free);
    if (std::ranges::count_if(ports(), is_one) != 1 || found->name != "body" ||
        !lilv_port_has_property(plugin_, lilv_plugin_get_port_by_symbol(plugin_, symbol.get()),
                                world_.uri(LV2_CORE_PREFIX "isSideChain").get()))
      throw std::runtime_error("LV2: another input");
    return true;
  }

  [[nodiscard]] const std::vector<Lv2Port>& ports() const { return instance_.ports(); }

  /// The library of the window lives as long as the plug-in's object: it may be opened again.
  void open_window(std::uintptr_t parent, double scale) override {
    LilvUIs* const uis = lilv_plugin_get_uis(plugin_);
    if (lilv_uis_size(uis) != 1) throw std::runtime_error("LV2: no window");
    const LilvUI* const ui = lilv_uis_get(uis, lilv_uis_begin(uis));
    const std::string binary = path(lilv_ui_get_binary_uri(ui)), bundle = path(lilv_ui_get_bundle_uri(ui));
    lilv_uis_free(uis);
    if (!window_library_) window_library_ = std::make_unique<Library>(binary);
    window_ = window_library_->symbol<const LV2UI_Descriptor*(std::uint32_t)>("lv2ui_descriptor")(0);
    Urids& urids = instance_.urids();
    const auto rate = static_cast<float>(instance_.sample_rate_hz()), factor = static_cast<float>(scale);
    const LV2_URID type = urids(LV2_ATOM__Float);
    const LV2_Options_Option options[] = {
        {LV2_OPTIONS_INSTANCE, 0, urids(LV2_PARAMETERS__sampleRate), sizeof rate, type, &rate},
        {LV2_OPTIONS_INSTANCE, 0, urids(LV2_UI__scaleFactor), sizeof factor, type, &factor},
        {}};
    LV2_Extension_Data_Feature data = {lilv_instance_get_descriptor(instance_.instance())->extension_data};
    LV2UI_Resize resize = {this, [](void* self, int width, int height) {
                             static_cast<Lv2Plugin*>(self)->window_size_ = {width, height};
                             return 0;
                           }};
    const LV2_Feature features[] = {{LV2_UI__parent, reinterpret_cast<void*>(parent)},
                                    {LV2_OPTIONS__options, const_cast<LV2_Options_Option*>(options)},
                                    {LV2_INSTANCE_ACCESS_URI, lilv_instance_get_handle(instance_.instance())},
                                    {LV2_DATA_ACCESS_URI, &data},
                                    {LV2_UI__resize, &resize},
                                    {LV2_URID__map, urids.map()},
                                    {LV2_URID__unmap, urids.unmap()}};
    const LV2_Feature* list[std::size(features) + 1] = {};
    for (std::size_t i = 0; i < std::size(features); ++i) list[i] = &features[i];
    LV2UI_Widget widget = nullptr;
    handle_ = window_->instantiate(window_, lilv_node_as_uri(lilv_plugin_get_uri(plugin_)), bundle.c_str(),
                                   &Lv2Plugin::write, this, &widget, list);
    if (handle_ == nullptr) throw std::runtime_error("LV2: no window");
    idle_ = static_cast<const LV2UI_Idle_Interface*>(window_->extension_data(LV2_UI__idleInterface));
  }
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> window_size() override { return window_size_; }
  void resize_window(std::uint32_t width, std::uint32_t height) override { window_size_ = {width, height}; }
  void idle_window() override { idle_->idle(handle_); }
  void close_window() override { window_->cleanup(handle_); }
  [[nodiscard]] std::vector<std::pair<std::string, double>> told() override { return told_; }

 private:
  using State = std::unique_ptr<LilvState, decltype(&lilv_state_free)>;

  [[nodiscard]] State state() {
    return {lilv_state_new_from_instance(plugin_, instance_.instance(), instance_.urids().map(), nullptr, nullptr,
                                         nullptr, nullptr, &Lv2Plugin::get, this, 0, nullptr),
            lilv_state_free};
  }

  [[nodiscard]] std::vector<HostedParameter> controls(bool are_inputs) const {
    std::vector<HostedParameter> controls;
    for (const Lv2Port& port : instance_.ports())
      if (port.is_control && port.is_input == are_inputs)
        controls.push_back({port.name, unit(port), port.min, port.max, port.initial});
    return controls;
  }

  [[nodiscard]] std::string unit(const Lv2Port& port) const {
    const Lv2World::Node symbol(lilv_new_string(world_.get(), port.symbol.c_str()), lilv_node_free);
    const LilvPort* const found = lilv_plugin_get_port_by_symbol(plugin_, symbol.get());
    const Lv2World::Node unit(lilv_port_get(plugin_, found, world_.uri(LV2_UNITS__unit).get()), lilv_node_free);
    if (!unit) return "";
    const Lv2World::Node text(lilv_world_get(world_.get(), unit.get(), world_.uri(LV2_UNITS__symbol).get(), nullptr),
                              lilv_node_free);
    return text ? lilv_node_as_string(text.get()) : lilv_node_as_string(unit.get());
  }

  void take(const LilvState* state) {
    lilv_state_restore(state, instance_.instance(), &Lv2Plugin::set, this, 0, nullptr);
  }

  static std::string path(const LilvNode* uri) {
    char* const file = lilv_file_uri_parse(lilv_node_as_uri(uri), nullptr);
    std::string path = file;
    lilv_free(file);
    return path;
  }

  // What the window writes: values of ports, and events.
  static void write(void* self, std::uint32_t port, std::uint32_t, std::uint32_t protocol, const void* buffer) {
    auto& plugin = *static_cast<Lv2Plugin*>(self);
    if (protocol != 0) {
      const auto* const atom = static_cast<const LV2_Atom*>(buffer);
      std::array<std::uint8_t, 3> message = {};
      std::memcpy(message.data(), atom + 1, std::min<std::size_t>(atom->size, message.size()));
      return plugin.messages_.push(message);
    }
    plugin.told_.emplace_back(plugin.ports().at(port).name, *static_cast<const float*>(buffer));
    plugin.moves_.push(plugin.told_.back());
  }

  static const void* get(const char* symbol, void* self, std::uint32_t* size, std::uint32_t* type) {
    Lv2Instance& instance = static_cast<Lv2Plugin*>(self)->instance_;
    *size = sizeof(float);
    *type = instance.urids()(LV2_ATOM__Float);
    return &instance.control(symbol);
  }
  static void set(const char* symbol, void* self, const void* value, std::uint32_t, std::uint32_t type) {
    Lv2Instance& instance = static_cast<Lv2Plugin*>(self)->instance_;
    if (std::ranges::none_of(instance.ports(), [symbol](const Lv2Port& port) { return port.symbol == symbol; }))
      return;
    const bool is_float = type == instance.urids()(LV2_ATOM__Float);  // else an integer
    instance.set(symbol, is_float ? *static_cast<const float*>(value)
                                  : static_cast<float>(*static_cast<const std::int32_t*>(value)));
  }

  void process(float* input, std::array<float*, 2> outputs, std::uint32_t samples) override {
    for (const auto& [name, value] : moves_.take()) instance_.set(name, static_cast<float>(value));
    for (const auto& message : messages_.take()) instance_.send(message);
    std::size_t side = 0;
    for (std::uint32_t i = 0; i < ports().size(); ++i)
      if (ports()[i].is_audio)
        lilv_instance_connect_port(instance_.instance(), i,
                                   !ports()[i].is_input ? outputs[side++]
                                   : input != nullptr   ? input
                                                        : silence_.data());
    instance_.advance(samples);
  }

  const Lv2World& world_;
  const LilvPlugin* plugin_;
  Lv2Instance instance_;
  std::map<std::string, State> presets_;                        // by URI, in the order of the programs
  std::vector<float> silence_ = std::vector<float>(kMaxBlock);  // a host connects every port
  std::unique_ptr<Library> window_library_;
  const LV2UI_Descriptor* window_ = nullptr;
  const LV2UI_Idle_Interface* idle_ = nullptr;
  LV2UI_Handle handle_ = nullptr;
  std::pair<std::uint32_t, std::uint32_t> window_size_;
  std::vector<std::pair<std::string, double>> told_;
  HandOver<std::pair<std::string, double>> moves_;  // of the window
  HandOver<std::array<std::uint8_t, 3>> messages_;  // of MIDI
};

}  // namespace contactspline::testing
