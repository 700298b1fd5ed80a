// SPDX-License-Identifier: MIT
// One hammer on one resonator, with a damper, as an instrument.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/model_parameters.hpp"
#include "contactspline/data/string_parts.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/parameter_values.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/models/hammer_voice.hpp"

namespace contactspline {

/// A felt hammer on a string or another resonator (docs/how-to/hammer-string.md). Meets Instrument.
template <std::floating_point T>
class HammerStringInstrument : public HammerStringParameter,
                               public ParameterValues<T, HammerStringParameter::kParameters>,
                               public PlayedByEvents<HammerStringInstrument<T>> {
  using Values = ParameterValues<T, kParameters>;

 public:
  using value_type = T;
  using Values::value;

  explicit HammerStringInstrument(HammerStringParts parts)
      : Values(kList), parts_(std::move(parts)), felt_(table_in<T>(parts_.felt)) {
    const ControlRange<double> places{0, parts_.resonator.length_m};
    this->limit(kPlace, places, places);
    if (!parts_.resonator.string) this->limit(kBend, {0, 0}, {0, 0});
    this->set_initial(kHammerMass, parts_.hammer_mass_kg);
    this->set_initial(kLoss, parts_.loss_s_per_m);
    this->set_initial(kPlace, parts_.resonator.strike_m);
    add_presets();
  }

  static constexpr bool kSleeps = true;  ///< silent until a strike

  static const char* name() { return "hammer_string"; }
  static const char* description() { return "Felt hammer on a string: contact without iteration, exact modes"; }
  static std::span<const Event> events() { return kEvents; }
  [[nodiscard]] std::span<const Output> outputs() const { return parts_.resonator.outputs(); }
  [[nodiscard]] std::span<const Preset> presets() const { return presets_; }

  void prepare(double sample_rate_hz) {
    time_step_s_ = 1 / sample_rate_hz;
    const ResonatorParts& resonator = parts_.resonator;
    place_m_.reset();
    bend_ = {};
    sample_ = 0;
    tuned_ = resonator.modes;
    rows_.clear();
    for (std::size_t i = 0; i < resonator.wavenumbers_per_m.size(); ++i)
      rows_.push_back({resonator.modes[i], resonator.wavenumbers_per_m[i]});
    shapes_.resize(resonator.modes.size());
    strike_ = ModeShapes<T>(resonator.modes.size());
    voice_.emplace(HammerVoiceParts<T>{.felt = felt_,
                                       .modes = resonator.modes,
                                       .strike = strike_,
                                       .output = ModeShapes<T>(std::span<const double>(resonator.pickup)),
                                       .controls = controls(),
                                       .damper = parts_.damper,
                                       .memories = parts_.memories},
                   sample_rate_hz);
    outputs_ = StringOutputs(resonator, voice_->model().string());
    reset();
  }

  void set(std::size_t parameter, double to) {
    Values::set(parameter, to);
    if (parameter == kSustain && voice_) release_if_free();
  }

  void strike(std::size_t number, T speed_m_per_s) {
    if (number != 0 || !is_number(speed_m_per_s)) return;
    is_held_ = true;
    if (speed_m_per_s == 0) return voice_->lift();
    if (value(kPlace) != place_m_) move_strike();
    voice_->controls() = controls();
    voice_->strike(speed_m_per_s);
  }
  void release(std::size_t number) {
    if (number != 0) return;
    is_held_ = false;
    release_if_free();
  }

  void process(Outputs<T> outputs, std::span<T> force = {}) {
    voice_->controls() = controls();
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (std::size_t done = 0; done < length;) {
      follow_bend();
      const std::size_t samples = (std::min)(length - done, is_bending() ? kBendStep : kLongest);
      process_steady(outputs, force, done, samples);
      done += samples;
      sample_ += samples;
    }
  }

  void reset() {
    voice_->reset();
    this->let_keys_go();
    is_held_ = false;
  }
  [[nodiscard]] bool is_silent(double limit_j) const { return voice_->is_silent(limit_j); }
  /// Of string, hammer and felt.
  [[nodiscard]] double energy() const { return voice_->energy(); }
  [[nodiscard]] double string_energy() const { return voice_->model().string().energy(); }
  [[nodiscard]] const HammerVoice<T>& voice() const { return *voice_; }

 private:
  using StringOutputs = detail::StringOutputs<T>;
  using Values::value_of;
  static constexpr std::size_t kBendStep = 16, kLongest = 1024;  // samples

  [[nodiscard]] HammerStringControls<T> controls() const {
    return {.hammer_mass_kg = value_of(kHammerMass),
            .felt = {value_of(kStiffnessRatio), value_of(kLoss)},
            .damping_per_s = value_of(kDamping)};
  }

  void add_presets() {
    const double length_m = parts_.resonator.length_m;
    const auto add = [&](const char* name, std::initializer_list<std::pair<std::size_t, double>> changes) {
      Preset preset{name, {}};
      for (const Parameter& parameter : this->parameters()) preset.values.push_back(parameter.initial);
      for (const auto& [parameter, changed] : changes) preset.values[parameter] = changed;
      presets_.push_back(std::move(preset));
    };
    add("felt hammer", {});
    add("soft mallet", {{kHammerMass, 4 * parts_.hammer_mass_kg},
                        {kStiffnessRatio, 0.05},
                        {kLoss, 0.2},
                        {kPlace, 0.2 * length_m},
                        {kSpeed, 1.5}});
    add("hard hammer", {{kStiffnessRatio, 50}, {kSpeed, 4}});
    add("muted", {{kDamping, 20}, {kPlace, 0.3 * length_m}, {kSpeed, 3}});
  }

  void move_strike() {
    place_m_ = value(kPlace);
    parts_.resonator.strike_shapes(*place_m_, shapes_);
    for (std::size_t i = 0; i < shapes_.size(); ++i) strike_[i] = static_cast<T>(shapes_[i]);
    voice_->strike_at(strike_);
  }

  void release_if_free() {
    if (!is_held_ && value(kSustain) < 0.5) voice_->release();
  }

  [[nodiscard]] bool is_bending() const { return value(kBend) != bend_.cents(); }

  void follow_bend() {
    if (!is_bending()) return;
    const StiffString& string = *parts_.resonator.string;
    const std::span<const StringMode> rows(rows_);
    const double energy = detail::tension_energy(string, rows, voice_->model().string());
    if (!bend_.follow(value(kBend), energy, static_cast<double>(sample_) * time_step_s_)) return;
    std::ranges::transform(rows, tuned_.begin(),
                           [&](const StringMode& row) { return retuned(string, row, bend_.cents()); });
    voice_->retune(tuned_);
  }

  // A block in which nothing changes. The kernels compute the contact force and one other output.
  void process_steady(Outputs<T> outputs, std::span<T> force, std::size_t begin, std::size_t samples) {
    const auto part = [&](std::size_t output) {
      return output < outputs.size() ? detail::part_of(outputs[output], begin, samples) : std::span<T>();
    };
    const auto displacement = part(StringOutputs::kDisplacement), velocity = part(StringOutputs::kVelocity),
               bridge = part(StringOutputs::kBridge);
    const auto forces = part(StringOutputs::kForce), more_forces = detail::part_of(force, begin, samples);
    if (velocity.empty() && (displacement.empty() || bridge.empty())) {
      auto sound = displacement.empty() ? bridge : displacement;
      if (sound.empty()) sound = std::span(scratch_).first(samples);
      const auto first = forces.empty() ? more_forces : forces;
      voice_->process(bridge.empty() ? outputs_.pickup() : outputs_.bridge(), sound,
                      first.empty() ? nullptr : first.data());
      if (!forces.empty() && !more_forces.empty()) std::ranges::copy(forces, more_forces.begin());
      return;
    }
    for (std::size_t n = begin; n < begin + samples; ++n) {
      voice_->tick();
      outputs_.write(outputs, n, voice_->model().string(), voice_->model().force());
      if (!force.empty()) force[n] = voice_->model().force();
    }
  }

  HammerStringParts parts_;
  std::vector<Segment<T>> felt_;
  std::vector<Preset> presets_;
  double time_step_s_ = 0;
  std::optional<double> place_m_;  // of the last strike
  std::vector<StringMode> rows_;
  std::vector<Mode> tuned_;     // the same under the bend
  std::vector<double> shapes_;  // at the place of the strike
  ModeShapes<T> strike_;
  std::optional<HammerVoice<T>> voice_;
  StringOutputs outputs_;
  std::array<T, kLongest> scratch_;  // the kernels write a sound where nobody asks for it
  detail::Bend bend_;
  std::size_t sample_ = 0;
  bool is_held_ = false;
};

}  // namespace contactspline
