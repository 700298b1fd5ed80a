// SPDX-License-Identifier: MIT
// A small LV2 host on lilv: finds plug-ins on LV2_PATH as any host does, plays one.
#pragma once

#include <lilv/lilv.h>
#include <lv2/atom/util.h>
#include <lv2/midi/midi.h>
#include <lv2/options/options.h>
#include <lv2/presets/presets.h>
#include <lv2/units/units.h>
#include <lv2/urid/urid.h>

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace contactspline::testing {

/// Names as small numbers, as the urid extension wants them.
class Urids {
 public:
  LV2_URID operator()(const std::string& uri) {
    return ids_.try_emplace(uri, static_cast<LV2_URID>(ids_.size() + 1)).first->second;
  }
  /// The feature to hand to plug-ins; valid as long as this object.
  [[nodiscard]] const LV2_Feature* feature() const { return &feature_; }
  [[nodiscard]] LV2_URID_Map* map() { return &map_; }
  [[nodiscard]] LV2_URID_Unmap* unmap() { return &unmap_; }

 private:
  static LV2_URID map(void* self, const char* uri) { return (*static_cast<Urids*>(self))(uri); }
  static const char* unmap(void* self, LV2_URID id) {
    for (const auto& [uri, known] : static_cast<Urids*>(self)->ids_)
      if (known == id) return uri.c_str();
    return nullptr;
  }

  std::map<std::string, LV2_URID> ids_;
  LV2_URID_Map map_ = {this, &Urids::map};
  LV2_URID_Unmap unmap_ = {this, &Urids::unmap};
  LV2_Feature feature_ = {LV2_URID__map, &map_};
};

/// All plug-ins on LV2_PATH.
class Lv2World {
 public:
  Lv2World() : world_(lilv_world_new(), lilv_world_free) { lilv_world_load_all(world_.get()); }

  [[nodiscard]] LilvWorld* get() const { return world_.get(); }

  /// A node of RDF that frees itself.
  using Node = std::unique_ptr<LilvNode, decltype(&lilv_node_free)>;
  [[nodiscard]] Node uri(const char* text) const { return {lilv_new_uri(world_.get(), text), lilv_node_free}; }

  /// Throws where LV2_PATH has no such plug-in.
  [[nodiscard]] const LilvPlugin* plugin(const std::string& plugin_uri) const {
    const LilvPlugin* found =
        lilv_plugins_get_by_uri(lilv_world_get_all_plugins(world_.get()), uri(plugin_uri.c_str()).get());
    if (!found) throw std::runtime_error("LV2_PATH has no " + plugin_uri);
    return found;
  }

 private:
  std::unique_ptr<LilvWorld, decltype(&lilv_world_free)> world_;
};

/// A port as its description has it.
struct Lv2Port {
  std::string symbol, name;
  bool is_input, is_output, is_control, is_audio, is_midi, is_button;
  float initial, min, max;  ///< values of a control input; NaN where it does not say
};

[[nodiscard]] inline std::vector<Lv2Port> ports_of(const Lv2World& world, const LilvPlugin* plugin) {
  const std::uint32_t count = lilv_plugin_get_num_ports(plugin);
  std::vector<float> min(count), max(count), initial(count);
  lilv_plugin_get_port_ranges_float(plugin, min.data(), max.data(), initial.data());
  std::vector<Lv2Port> ports;
  for (std::uint32_t i = 0; i < count; ++i) {
    const LilvPort* port = lilv_plugin_get_port_by_index(plugin, i);
    const auto is_a = [&](const char* type) { return lilv_port_is_a(plugin, port, world.uri(type).get()); };
    const Lv2World::Node name(lilv_port_get_name(plugin, port), lilv_node_free);
    ports.push_back({.symbol = lilv_node_as_string(lilv_port_get_symbol(plugin, port)),
                     .name = name ? lilv_node_as_string(name.get()) : "",
                     .is_input = is_a(LV2_CORE__InputPort),
                     .is_output = is_a(LV2_CORE__OutputPort),
                     .is_control = is_a(LV2_CORE__ControlPort),
                     .is_audio = is_a(LV2_CORE__AudioPort),
                     .is_midi = is_a(LV2_ATOM__AtomPort) &&
                                lilv_port_supports_event(plugin, port, world.uri(LV2_MIDI__MidiEvent).get()),
                     .is_button = lilv_port_has_property(plugin, port, world.uri(LV2_CORE__toggled).get()),
                     .initial = initial[i],
                     .min = min[i],
                     .max = max[i]});
  }
  return ports;
}

/// A plug-in that plays, in blocks of kBlock samples.
class Lv2Instance {
 public:
  static constexpr std::size_t kBlock = 256;

  Lv2Instance(const Lv2World& world, const std::string& plugin_uri, double sample_rate_hz)
      : sample_rate_hz_(sample_rate_hz),
        ports_(ports_of(world, world.plugin(plugin_uri))),
        controls_(ports_.size()),
        audio_(ports_.size(), std::vector<float>(kBlock)),
        instance_(open(world.plugin(plugin_uri), sample_rate_hz), lilv_instance_free) {
    if (!instance_) throw std::runtime_error(plugin_uri + " cannot be instantiated");
    for (std::uint32_t i = 0; i < ports_.size(); ++i) {
      controls_[i] = ports_[i].initial;
      lilv_instance_connect_port(instance_.get(), i, buffer(i));
    }
    clear_events();
    lilv_instance_activate(instance_.get());
  }
  Lv2Instance(const Lv2Instance&) = delete;
  Lv2Instance& operator=(const Lv2Instance&) = delete;
  ~Lv2Instance() { lilv_instance_deactivate(instance_.get()); }

  [[nodiscard]] const std::vector<Lv2Port>& ports() const { return ports_; }

  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_; }
  [[nodiscard]] Urids& urids() { return urids_; }
  [[nodiscard]] LilvInstance* instance() { return instance_.get(); }

  /// The control of that name or symbol. Throws where there is none.
  [[nodiscard]] float& control(const std::string& name) {
    for (std::size_t i = 0; i < ports_.size(); ++i)
      if (ports_[i].is_input && &controls_[i] == &control_port(name)) return controls_[i];
    throw std::invalid_argument("no input " + name);
  }
  /// The same, of inputs and outputs.
  [[nodiscard]] float& control_port(const std::string& name) {
    for (std::size_t i = 0; i < ports_.size(); ++i)
      if (ports_[i].is_control && (ports_[i].name == name || ports_[i].symbol == name)) return controls_[i];
    throw std::invalid_argument("no control " + name);
  }
  void set(const std::string& name, float value) { control(name) = value; }

  /// A MIDI message for the next block, so many samples after its beginning.
  void send(std::span<const std::uint8_t> message, std::uint32_t time = 0) {
    struct {
      LV2_Atom_Event head;
      std::uint8_t bytes[3];
    } event = {};
    event.head.time.frames = time;
    event.head.body.type = midi_event_;
    event.head.body.size = static_cast<std::uint32_t>(message.size());
    std::copy(message.begin(), message.end(), event.bytes);
    if (!lv2_atom_sequence_append_event(&events()->seq, sizeof events_, &event.head))
      throw std::length_error("too many events for a block");
  }
  void send(std::initializer_list<std::uint8_t> message) { send(std::span(message.begin(), message.size())); }
  void note_on(int note, int velocity) {
    send({0x90, static_cast<std::uint8_t>(note), static_cast<std::uint8_t>(velocity)});
  }
  void note_off(int note) { send({0x80, static_cast<std::uint8_t>(note), 64}); }

  /// The audio outputs over `blocks` blocks: [channel][sample].
  [[nodiscard]] std::vector<std::vector<float>> run(std::size_t blocks) {
    std::vector<std::vector<float>> sound;
    for (std::size_t block = 0; block < blocks; ++block) {
      advance();
      std::size_t channel = 0;
      for (std::size_t i = 0; i < ports_.size(); ++i) {
        if (!ports_[i].is_audio || !ports_[i].is_output) continue;
        if (sound.size() == channel) sound.emplace_back();
        sound[channel].insert(sound[channel].end(), audio_[i].begin(), audio_[i].end());
        ++channel;
      }
    }
    return sound;
  }

  /// Plays a block into the connected ports.
  void advance(std::uint32_t samples = kBlock) {
    lilv_instance_run(instance_.get(), samples);
    clear_events();
  }

 private:
  struct EventBuffer {
    LV2_Atom_Sequence seq;
    std::uint8_t bytes[4096];
  };

  LilvInstance* open(const LilvPlugin* plugin, double sample_rate_hz) {
    const LV2_Feature* const features[] = {urids_.feature(), nullptr};  // all that a small host has
    return lilv_plugin_instantiate(plugin, sample_rate_hz, features);
  }

  void* buffer(std::size_t port) {
    if (ports_[port].is_control) return &controls_[port];
    if (ports_[port].is_audio) return audio_[port].data();
    return &events_;
  }

  EventBuffer* events() { return &events_; }

  void clear_events() {
    lv2_atom_sequence_clear(&events_.seq);
    events_.seq.atom.type = sequence_;
  }

  double sample_rate_hz_;
  Urids urids_;
  LV2_URID sequence_ = urids_(LV2_ATOM__Sequence), midi_event_ = urids_(LV2_MIDI__MidiEvent);
  std::vector<Lv2Port> ports_;
  std::vector<float> controls_;
  std::vector<std::vector<float>> audio_;
  alignas(8) EventBuffer events_ = {};
  std::unique_ptr<LilvInstance, decltype(&lilv_instance_free)> instance_;
};

}  // namespace contactspline::testing
