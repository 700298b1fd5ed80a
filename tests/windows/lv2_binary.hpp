// SPDX-License-Identifier: MIT
// The binary of an LV2 plug-in in a host of its own: lilv is not for Windows. Of the description beside the binary it
// reads the ports, as the framework writes them.
#pragma once

#include <src/lv2/atom-util.h>
#include <src/lv2/lv2.h>
#include <src/lv2/midi.h>
#include <src/lv2/urid.h>

#include <fstream>
#include <map>
#include <regex>

#include "plugins/hosted_plugin.hpp"

namespace contactspline::testing {

/// Two audio outputs, one port of events, controls by name. It plays what HostedPlugin plays.
class Lv2Binary {
 public:
  static constexpr std::size_t kBlock = HostedPlugin::kBlock;

  Lv2Binary(const std::filesystem::path& file, double sample_rate_hz) : library_(file) {
    read_ports(std::filesystem::path(file).replace_extension(".ttl"));
    const LV2_Feature map = {LV2_URID__map, &map_};
    const LV2_Feature* const features[] = {&map, nullptr};
    descriptor_ = library_.symbol<const LV2_Descriptor*(std::uint32_t)>("lv2_descriptor")(0);
    handle_ =
        descriptor_->instantiate(descriptor_, sample_rate_hz, (file.parent_path() / "").string().c_str(), features);
    if (handle_ == nullptr) throw std::runtime_error("LV2: cannot be instantiated");
    for (auto& [name, port] : controls_) descriptor_->connect_port(handle_, port.index, &port.value);
    descriptor_->connect_port(handle_, 2, &events_);
    clear_events();
    descriptor_->activate(handle_);
  }
  Lv2Binary(const Lv2Binary&) = delete;
  ~Lv2Binary() {
    descriptor_->deactivate(handle_);
    descriptor_->cleanup(handle_);
  }

  void set(const std::string& name, double value) { controls_.at(name).value = static_cast<float>(value); }

  void send(std::uint32_t time, std::array<std::uint8_t, 3> message) {
    struct {
      LV2_Atom_Event head;
      std::array<std::uint8_t, 3> bytes;
    } event = {};
    event.head.time.frames = time;
    event.head.body = {3, urid(LV2_MIDI__MidiEvent)};
    event.bytes = message;
    if (lv2_atom_sequence_append_event(&events_.sequence, sizeof events_.bytes, &event.head) == nullptr)
      throw std::length_error("LV2: too many events for a block");
  }

  [[nodiscard]] HostedPlugin::Sound run(std::size_t blocks) {
    HostedPlugin::Sound sound;
    for (auto& side : sound) side.resize(blocks * kBlock);
    for (std::size_t begin = 0; begin < blocks * kBlock; begin += kBlock) {
      for (std::uint32_t side = 0; side < 2; ++side)
        descriptor_->connect_port(handle_, side, sound[side].data() + begin);
      descriptor_->run(handle_, kBlock);
      clear_events();
    }
    return sound;
  }

 private:
  struct Control {
    std::uint32_t index;
    float value;
  };
  struct Events {
    LV2_Atom_Sequence sequence;
    std::array<std::uint8_t, 4096> bytes;
  };

  // A control has an index, a name and, as an input, a default.
  void read_ports(const std::filesystem::path& description) {
    static const std::regex line(R"raw(\s*lv2:(index|name|default) "?([^"]*)"? ;)raw");
    std::ifstream file(description);
    Control control = {};
    std::string name;
    for (std::string text; std::getline(file, text);) {
      std::smatch found;
      if (!std::regex_match(text, found, line)) continue;
      if (found[1] == "index") control = {static_cast<std::uint32_t>(std::stoul(found[2])), 0};
      if (found[1] == "name") name = found[2];
      if (found[1] == "default") control.value = std::stof(found[2]);
      if (found[1] != "index" && control.index > 2) controls_[name] = control;
    }
    if (controls_.empty()) throw std::runtime_error("LV2: no control in " + description.string());
  }

  LV2_URID urid(const std::string& uri) {
    return urids_.try_emplace(uri, static_cast<LV2_URID>(urids_.size() + 1)).first->second;
  }

  void clear_events() {
    lv2_atom_sequence_clear(&events_.sequence);
    events_.sequence.atom.type = urid(LV2_ATOM__Sequence);
  }

  Library library_;
  std::map<std::string, LV2_URID> urids_;
  LV2_URID_Map map_ = {this, [](void* self, const char* uri) { return static_cast<Lv2Binary*>(self)->urid(uri); }};
  std::map<std::string, Control> controls_;
  alignas(8) Events events_ = {};
  const LV2_Descriptor* descriptor_ = nullptr;
  LV2_Handle handle_ = nullptr;
};

}  // namespace contactspline::testing
