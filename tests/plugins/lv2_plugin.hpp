// SPDX-License-Identifier: MIT
// An LV2 plug-in behind the interface of the other formats.
#pragma once

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

  [[nodiscard]] const std::vector<Lv2Port>& ports() const { return instance_.ports(); }

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

  void process(std::array<float*, 2> outputs, std::uint32_t samples) override {
    std::size_t side = 0;
    for (std::uint32_t i = 0; i < instance_.ports().size(); ++i)
      if (instance_.ports()[i].is_audio) lilv_instance_connect_port(instance_.instance(), i, outputs[side++]);
    instance_.advance(samples);
  }

  const Lv2World& world_;
  const LilvPlugin* plugin_;
  Lv2Instance instance_;
  std::map<std::string, State> presets_;  // by URI, in the order of the programs
};

}  // namespace contactspline::testing
