// SPDX-License-Identifier: MIT
// A felt hammer thrown at a string, or at any other modal resonator.
#pragma once

#include <utility>

#include "contactspline/contact.hpp"
#include "contactspline/modal.hpp"

namespace contactspline {

/// Live controls of the hammer-string model. Those of the hammer are taken at the throw and hold until the next one:
/// a felt that hardens or a hammer that gains weight in the midst of a contact would add energy of its own.
template <std::floating_point T>
struct HammerStringControls {
  T hammer_mass_kg;              ///< > 0
  ContactControls<T> felt = {};  ///< stiffness ratio and loss
  T damping_per_s = 0;           ///< of the damper, at any time: extra decay of every mode, >= 0
};

/// A hammer in free flight before a resonator that it strikes at one place. Several strings under one hammer are one
/// resonator: their modes side by side, each shape divided by the number of strings.
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class HammerString {
 public:
  HammerString(SegmentTable<T, Extent> felt, std::span<const Mode> modes, ModeShapes<T> strike, double sample_rate_hz)
      : felt_(felt),
        string_(modes, sample_rate_hz),
        strike_(std::move(strike)),
        next_strike_(strike_),
        time_step_(T(1 / sample_rate_hz)) {}

  /// Moves the place of the strike, from the next throw on.
  void strike_at(const ModeShapes<T>& strike) { next_strike_ = strike; }

  /// Throws the hammer at the string, from a distance [m] >= 0, with a velocity [m/s]; the string may be sounding.
  void strike(T velocity_m_per_s, T distance_m) {
    strike_ = next_strike_;
    string_admittance_ = string_.admittance(strike_, strike_);
    compression_ = -distance_m;
    segment_ = segment_index(felt_, compression_);
    velocity_ = velocity_m_per_s;
    is_thrown_ = is_flying_ = true;
  }

  /// Advances one sample. Safe in an audio thread: no allocation, no lock, bounded time.
  void tick(const HammerStringControls<T>& controls) {
    const T damping = controls.damping_per_s * time_step_;
    if (!is_flying_) {
      force_ = 0;
      return string_.advance(damping);
    }
    if (damping > 0)
      string_.predict(damping);
    else
      string_.predict();
    if (is_thrown_) hammer_ = {controls.hammer_mass_kg, controls.felt};
    is_thrown_ = false;
    force_ = meet(1 / (1 + damping));
    string_.commit();
  }

  [[nodiscard]] T force() const { return force_; }               ///< contact force over the last sample [N]
  [[nodiscard]] T compression() const { return compression_; }   ///< of the felt [m], negative while apart
  [[nodiscard]] T hammer_velocity() const { return velocity_; }  ///< towards the string [m/s]
  [[nodiscard]] const ModalBank<T>& string() const { return string_; }

 private:
  // A hammer this far back is caught; only a new throw brings it back.
  static constexpr T kCaught = T(-0.05);

  struct Hammer {
    T mass_kg;
    ContactControls<T> felt;
  };

  T meet(T share) {
    const T give = time_step_ / hammer_.mass_kg;
    const T free_increment = time_step_ * velocity_ - string_.increment(strike_);
    const T admittance = time_step_ * give / 2 + share * string_admittance_;
    const Approach<T> approach{compression_, free_increment, admittance};
    const auto step = contact_step(felt_, hammer_.felt, time_step_, approach, segment_);
    string_.push(strike_, share * step.force);
    compression_ = step.compression;
    segment_ = step.segment;
    velocity_ -= give * step.force;
    is_flying_ = compression_ > kCaught;
    return step.force;
  }

  SegmentTable<T, Extent> felt_;
  ModalBank<T> string_;
  ModeShapes<T> strike_, next_strike_;
  T time_step_;
  T string_admittance_ = 0;
  Hammer hammer_ = {1, {}};
  T compression_ = 0;
  std::size_t segment_ = 0;  // that holds the compression
  T velocity_ = 0;
  T force_ = 0;
  bool is_thrown_ = false;  // by strike(); the next tick takes the hammer's controls
  bool is_flying_ = false;
};

}  // namespace contactspline
