// SPDX-License-Identifier: MIT
// An instrument on the runtime as a plug-in of the DISTRHO Plugin Framework, which makes CLAP, VST3 and LV2 of it.
#pragma once

#include <DistrhoPlugin.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "contactspline/controls.hpp"
#include "contactspline/flush_denormals.hpp"
#include "contactspline/version.hpp"

/// A parameter as the host shows it. Letters and spaces only in the name.
struct PluginControl {
  const char* name;
  const char* unit;
  float initial, min, max;
  bool is_logarithmic = false;
  std::uint8_t controller = 0;  ///< MIDI controller that hosts may connect; 0: none
};

/// A program: a value for every parameter except the volume, which stays.
template <std::size_t controls>
struct PluginProgram {
  const char* name;
  std::array<float, controls> values;
};

/// The plug-in of an Instrument, which has
///   name, description, unique_id, controls, programs     static constants
///   Instrument(sample_rate_hz)                           allocates
///   set(values), note_on, note_off, move_pedal, reset, process(left, right)     safe on an audio thread
/// move_pedal(controller, position): of the MIDI controllers 64 to 67, from 0 to 1.
/// The plug-in adds a volume as the last parameter.
template <typename Instrument>
class InstrumentPlugin : public DISTRHO_NAMESPACE::Plugin {
 public:
  InstrumentPlugin() : Plugin(kControls, Instrument::programs.size(), 0) {
    for (std::size_t i = 0; i < kControls; ++i) values_[i] = control(i).initial;
  }

 private:
  static constexpr std::size_t kVolume = Instrument::controls.size();
  static constexpr std::size_t kControls = kVolume + 1;
  static constexpr PluginControl kVolumeControl{"volume", "", 0.5f, 0, 1, false, 7};
  static constexpr double kVolumeTime_s = 0.01;  // time constant with which the volume follows

  static const PluginControl& control(std::size_t index) {
    return index == kVolume ? kVolumeControl : Instrument::controls[index];
  }

  const char* getLabel() const override { return Instrument::name; }
  const char* getDescription() const override { return Instrument::description; }
  const char* getMaker() const override { return DISTRHO_PLUGIN_BRAND; }
  const char* getLicense() const override { return "https://spdx.org/licenses/MIT"; }
  std::uint32_t getVersion() const override {
    using namespace contactspline;
    return d_version(kVersionMajor, kVersionMinor, kVersionPatch);
  }
  std::int64_t getUniqueId() const override { return Instrument::unique_id; }

  void initAudioPort(bool is_input, std::uint32_t index, DISTRHO_NAMESPACE::AudioPort& port) override {
    port.groupId = DISTRHO_NAMESPACE::kPortGroupStereo;
    Plugin::initAudioPort(is_input, index, port);
  }

  void initParameter(std::uint32_t index, DISTRHO_NAMESPACE::Parameter& parameter) override {
    using namespace DISTRHO_NAMESPACE;
    const PluginControl& c = control(index);
    parameter.hints = kParameterIsAutomatable | (c.is_logarithmic ? kParameterIsLogarithmic : 0u);
    parameter.name = c.name;
    parameter.symbol = c.name;
    parameter.symbol.replace(' ', '_');
    parameter.unit = c.unit;
    parameter.ranges = {c.initial, c.min, c.max};
    parameter.midiCC = c.controller;
  }

  void initProgramName(std::uint32_t index, DISTRHO_NAMESPACE::String& name) override {
    name = Instrument::programs[index].name;
  }

  float getParameterValue(std::uint32_t index) const override { return values_[index]; }

  // On any thread.
  void setParameterValue(std::uint32_t index, float value) override {
    const PluginControl& c = control(index);
    values_[index] = contactspline::held(values_[index].load(), value, {c.min, c.max});
  }

  void loadProgram(std::uint32_t index) override {
    if (index >= Instrument::programs.size()) return;
    for (std::size_t i = 0; i < kVolume; ++i)
      setParameterValue(static_cast<std::uint32_t>(i), Instrument::programs[index].values[i]);
  }

  // Not on the audio thread.
  void activate() override {
    instrument_.emplace(getSampleRate());
    volume_ = values_[kVolume];
    volume_rate_ = static_cast<float>(-std::expm1(-1 / (kVolumeTime_s * getSampleRate())));
  }

  void run(const float**, float** outputs, std::uint32_t samples, const DISTRHO_NAMESPACE::MidiEvent* events,
           std::uint32_t count) override {
    const contactspline::FlushDenormals flushed;
    std::array<float, kVolume> values;
    std::ranges::copy_n(values_.begin(), kVolume, values.begin());
    instrument_->set(values);
    const std::span<float> left(outputs[0], samples), right(outputs[1], samples);
    std::size_t done = 0;
    for (const DISTRHO_NAMESPACE::MidiEvent& event : std::span(events, count)) {
      const std::size_t time = std::clamp<std::size_t>(event.frame, done, samples);
      process(left.subspan(done, time - done), right.subspan(done, time - done));
      done = time;
      if (event.size == 3) take(event.data[0] & 0xf0, event.data[1], event.data[2]);
    }
    process(left.subspan(done), right.subspan(done));
  }

  void process(std::span<float> left, std::span<float> right) {
    if (left.empty()) return;
    instrument_->process(left, right);
    const float volume = values_[kVolume];
    for (std::size_t n = 0; n < left.size(); ++n) {
      volume_ += volume_rate_ * (volume - volume_);
      left[n] *= volume_;
      right[n] *= volume_;
    }
  }

  void take(int status, int first, int second) {
    if (status == 0x90 && second > 0) {
      instrument_->note_on(first, static_cast<float>(second) / 127);
    } else if (status == 0x80 || status == 0x90) {
      instrument_->note_off(first);
    } else if (status == 0xb0 && first >= 64 && first <= 67) {
      instrument_->move_pedal(first, static_cast<float>(second) / 127);
    } else if (status == 0xb0 && first == 120) {  // all sound off
      instrument_->reset();
    } else if (status == 0xb0 && first == 123) {  // all notes off
      for (int note = 0; note < 128; ++note) instrument_->note_off(note);
    }
  }

  std::array<std::atomic<float>, kControls> values_;
  std::optional<Instrument> instrument_;  // of the current sample rate
  float volume_ = 0, volume_rate_ = 0;
};
