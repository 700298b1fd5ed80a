// SPDX-License-Identifier: MIT
// Hammer-strings, a key each, as one instrument.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <concepts>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/models/ensemble.hpp"

namespace contactspline {

/// What an ensemble is built of.
struct EnsembleParts {
  std::vector<HammerStringParts> strings;  ///< 1 to 128, by rising key
  int first_key = 60;                      ///< of MIDI
};

/// The parameters of an ensemble, for all strings: those of a hammer-string that need no place and no pitch.
struct EnsembleParameter {
  enum : std::size_t { kStiffnessRatio, kLoss, kDamping, kSpeed, kSustain, kParameters };
  static constexpr std::array<Parameter, kParameters> kList = [] {
    using One = HammerStringParameter;
    return std::array{One::kList[One::kStiffnessRatio], One::kList[One::kLoss], One::kList[One::kDamping],
                      One::kList[One::kSpeed], One::kList[One::kSustain]};
  }();
};

/// The strings of a dulcimer or a harpsichord, a hammer and a damper each, computed side by side (Ensemble). Silent
/// ones sleep. The first loss is that of the first string. Meets Instrument.
template <std::floating_point T>
class EnsembleInstrument : public EnsembleParameter, public ParameterValues<T, EnsembleParameter::kParameters> {
  using Values = ParameterValues<T, kParameters>;

 public:
  using value_type = T;

  explicit EnsembleInstrument(EnsembleParts parts) : Values(kList), parts_(std::move(parts)) {
    this->set_initial(kLoss, parts_.strings.front().loss_s_per_m);
    for (const HammerStringParts& string : parts_.strings) felts_.push_back(table_in<T>(string.felt));
  }

  static const char* name() { return "ensemble"; }
  static const char* description() { return "Felt hammers on many strings: contact without iteration, exact modes"; }
  static std::span<const Event> events() { return {}; }
  /// Displacement at the pickups and contact force, summed over the strings.
  static std::span<const Output> outputs() { return std::span(StringOutput::kList).first(StringOutput::kOfHosts); }
  static std::span<const Preset> presets() { return {}; }

  void prepare(double sample_rate_hz) {
    dampers_.clear();
    ensemble_.emplace(sample_rate_hz);
    for (std::size_t i = 0; i < parts_.strings.size(); ++i) {
      const HammerStringParts& string = parts_.strings[i];
      const ResonatorParts& resonator = string.resonator;
      std::vector<double> strike(resonator.modes.size());
      resonator.strike_shapes(resonator.strike_m, strike);
      ensemble_->add(felts_[i], resonator.modes, ModeShapes<T>(std::span<const double>(strike)),
                     ModeShapes<T>(std::span<const double>(resonator.pickup)),
                     {.hammer_mass_kg = static_cast<T>(string.hammer_mass_kg)}, string.memories);
      dampers_.emplace_back(string.damper, sample_rate_hz);
    }
    reset();
  }

  void set(std::size_t parameter, double to) {
    Values::set(parameter, to);
    if (parameter == kSustain && ensemble_) lower_free_dampers();
  }

  /// velocity: 0 to 1, clamped; multiplies the speed. Keys without a string do nothing.
  void note_on(int key, double velocity) {
    strike(string_of(key), static_cast<T>(std::clamp(velocity, 0.0, 1.0) * this->value(kSpeed)));
  }
  void note_off(int key) { release(string_of(key)); }
  [[nodiscard]] bool has_key(int key) const { return string_of(key) < parts_.strings.size(); }

  void strike(std::size_t number, T speed_m_per_s) {
    if (number >= dampers_.size() || !is_number(speed_m_per_s)) return;
    held_.set(number);
    dampers_[number].move_to(0);
    if (speed_m_per_s == 0) return;
    set_felt(number);
    ensemble_->strike(number, speed_m_per_s, HammerVoice<T>::kThrowDistance_m);
  }
  void release(std::size_t number) {
    if (number >= dampers_.size()) return;
    held_.reset(number);
    lower_free_dampers();
  }
  void pluck(std::size_t, T, double = 0) {}

  void process(Outputs<T> outputs, std::span<T> force = {}) {
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (std::size_t done = 0; done < length;) {
      std::size_t samples = (std::min)(length - done, Ensemble<T>::kBlock);
      for (const detail::FallingDamper& damper : dampers_) samples = (std::min)(samples, damper.samples());
      process_steady(outputs, force, done, samples);
      done += samples;
    }
  }

  void reset() {
    ensemble_->reset();
    held_.reset();
    for (detail::FallingDamper& damper : dampers_) damper.move_to(0);
  }
  /// Is each string so silent?
  [[nodiscard]] bool is_silent(double limit_j) const {
    for (std::size_t i = 0; i < ensemble_->voices(); ++i)
      if (const auto& model = ensemble_->model(i); model.is_hammer_flying() || model.string().energy() >= limit_j)
        return false;
    return true;
  }
  /// Of strings, hammers and felts.
  [[nodiscard]] double energy() const { return ensemble_->energy(); }
  [[nodiscard]] const Ensemble<T>& ensemble() const { return *ensemble_; }

 private:
  using Values::value_of;

  // A key without a string: a number above all strings.
  [[nodiscard]] std::size_t string_of(int key) const { return static_cast<std::size_t>(key - parts_.first_key); }

  void set_felt(std::size_t number) {
    ensemble_->controls(number).felt = {value_of(kStiffnessRatio), value_of(kLoss)};
  }

  void lower_free_dampers() {
    if (this->value(kSustain) >= 0.5) return;
    for (std::size_t i = 0; i < dampers_.size(); ++i)
      if (!held_[i]) dampers_[i].move_to(1);
  }

  // A block in which no damping changes.
  void process_steady(Outputs<T> outputs, std::span<T> force, std::size_t begin, std::size_t samples) {
    for (std::size_t i = 0; i < dampers_.size(); ++i)
      ensemble_->controls(i).damping_per_s = value_of(kDamping) + static_cast<T>(dampers_[i].value());
    const auto part = [&](std::size_t output) {
      return output < outputs.size() ? detail::part_of(outputs[output], begin, samples) : std::span<T>();
    };
    const auto sound = part(0), forces = part(1), more_forces = detail::part_of(force, begin, samples);
    ensemble_->process(sound.empty() ? std::span(scratch_).first(samples) : sound, {}, OneThread(),
                       forces.empty() ? more_forces : forces);
    if (!forces.empty() && !more_forces.empty()) std::ranges::copy(forces, more_forces.begin());
    for (detail::FallingDamper& damper : dampers_) damper.advance(samples);
  }

  EnsembleParts parts_;
  std::deque<std::vector<Segment<T>>> felts_;
  std::optional<Ensemble<T>> ensemble_;
  std::vector<detail::FallingDamper> dampers_;
  std::bitset<128> held_;
  std::array<T, Ensemble<T>::kBlock> scratch_;
};

}  // namespace contactspline
