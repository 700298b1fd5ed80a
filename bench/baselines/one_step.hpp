// SPDX-License-Identifier: MIT
// A hammer on a modal string with the one-step discrete gradient of HammerString, whatever solves it for the force.
#pragma once

#include <concepts>
#include <span>
#include <utility>

#include "bench/baselines/modal_string.hpp"
#include "bench/baselines/power_law_hammer.hpp"
#include "contactspline/step/contact.hpp"

namespace contactspline::bench {

/// Update: begin(compression [m], guess of the first increment [m]), and meet(approach), which solves a contact step.
/// Without modes the string is a rigid barrier.
template <std::floating_point T, typename Update>
class OneStepHammerString {
 public:
  using Sample = T;

  OneStepHammerString(double hammer_kg, Update update, std::span<const Mode> modes,
                      std::span<const double> strike_shapes, std::span<const double> pickup_shapes,
                      double sample_rate_hz)
      : string_(modes, strike_shapes, pickup_shapes, sample_rate_hz),
        update_(std::move(update)),
        time_step_(static_cast<T>(1 / sample_rate_hz)),
        velocity_step_per_force_(static_cast<T>(1 / (sample_rate_hz * sample_rate_hz * hammer_kg))),
        receptance_(velocity_step_per_force_ / 2 + string_.receptance()) {}

  /// The same with an update that is made from the hammer's law.
  OneStepHammerString(const PowerLawHammer& hammer, std::span<const Mode> modes,
                      std::span<const double> strike_shapes, std::span<const double> pickup_shapes,
                      double sample_rate_hz) requires std::constructible_from<Update, const PowerLawHammer&>
      : OneStepHammerString(hammer.mass_kg, Update(hammer), modes, strike_shapes, pickup_shapes, sample_rate_hz) {}

  /// Throws the hammer from a distance [m] with a velocity [m/s].
  void strike(T velocity_m_per_s, T distance_m) {
    compression_ = -distance_m;
    velocity_step_ = velocity_m_per_s * time_step_;
    update_.begin(compression_, velocity_step_);
  }

  /// A constant force that presses the hammer on the string [N].
  void press(T force_n) { press_step_ = force_n * velocity_step_per_force_; }

  /// Writes the displacement at the pickup [m].
  void process(std::span<T> out) {
    for (T& sample : out) sample = tick();
  }

  [[nodiscard]] T force() const { return force_; }              ///< over the last sample [N]
  [[nodiscard]] T compression() const { return compression_; }  ///< [m]
  [[nodiscard]] T hammer_velocity() const { return velocity_step_ / time_step_; }
  [[nodiscard]] const ModalString<T>& string() const { return string_; }

 private:
  T tick() {
    const T last = force_;
    const T free = velocity_step_ + press_step_ / 2 - (string_.increment() + string_.receptance() * last);
    const auto step = update_.meet(Approach<T>{compression_, free, receptance_});
    force_ = step.force;
    compression_ = step.compression;
    velocity_step_ += press_step_ - velocity_step_per_force_ * force_;
    return string_.advance(force_ + last);
  }

  ModalString<T> string_;
  Update update_;
  T time_step_, velocity_step_per_force_, receptance_;
  T compression_ = -1;   // no contact until the first throw
  T velocity_step_ = 0;  // hammer velocity times time_step_ [m]
  T press_step_ = 0;     // what the pressing force adds to it in a sample [m]
  T force_ = 0;
};

}  // namespace contactspline::bench
