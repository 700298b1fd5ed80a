// SPDX-License-Identifier: MIT
// A hammer on a two-step modal string with quadratised contact energy V = psi^2 / 2, without iteration (Ducceschi and
// Bilbao, DAFx 2019 and JSV 2021; van Walstijn et al., JSV 2023).
#pragma once

#include <cmath>

#include "bench/baselines/modal_string.hpp"
#include "bench/baselines/power_law_hammer.hpp"

namespace contactspline::bench {

/// The gradient g of psi that a sample uses.
enum class PsiGradient {
  potential,    ///< the power law's potential: linearly implicit, as first published ("EXP-0"); the force may pull
  never_pulls,  ///< the same, limited so that psi does not become negative ("EXP-3")
};

/// kCatches: stops a hammer that is 5 cm away from the string until the next throw, as HammerString does. Then only
/// the string is computed.
template <std::floating_point T, PsiGradient kGradient, bool kCatches = false>
class QuadratisedHammerString {
 public:
  using Sample = T;

  QuadratisedHammerString(const PowerLawHammer& hammer, std::span<const Mode> modes,
                          std::span<const double> strike_shapes, std::span<const double> pickup_shapes,
                          double sample_rate_hz)
      : string_(modes, strike_shapes, pickup_shapes, sample_rate_hz),
        time_step_(static_cast<T>(1 / sample_rate_hz)),
        velocity_step_per_force_(static_cast<T>(1 / (sample_rate_hz * sample_rate_hz * hammer.mass_kg))),
        receptance_(velocity_step_per_force_ + 2 * string_.receptance()),
        scale_(static_cast<T>(std::sqrt(hammer.stiffness_n_per_m_alpha * (hammer.exponent + 1) / 2))),
        power_(static_cast<T>((hammer.exponent - 1) / 2)),
        per_power_(static_cast<T>(2 / (hammer.exponent + 1))) {}

  /// Throws the hammer from a distance [m] with a velocity [m/s]. A negative distance starts with a compressed felt.
  void strike(T velocity_m_per_s, T distance_m) {
    if (kCatches) string_.listen();
    compression_ = -distance_m;
    velocity_step_ = velocity_m_per_s * time_step_ - press_step_ / 2;  // of the sample before
    last_increment_ = velocity_step_ - string_.last_increment();
    psi_ = per_power_ * compression_ * gradient();
  }

  /// A constant force that presses the hammer on the string [N]; set it before the throw.
  void press(T force_n) { press_step_ = force_n * velocity_step_per_force_; }

  /// Writes the displacement at the pickup [m].
  void process(std::span<T> out) {
    for (T& sample : out) sample = tick();
  }

  [[nodiscard]] T force() const { return force_; }              ///< the force of the last sample [N]
  [[nodiscard]] T compression() const { return compression_; }  ///< [m]
  [[nodiscard]] T hammer_velocity() const { return velocity_step_ / time_step_; }
  [[nodiscard]] T psi() const { return psi_; }  ///< between the last sample and this one [sqrt(J)]
  [[nodiscard]] const ModalString<T>& string() const { return string_; }

 private:
  T tick() {
    if (kCatches && compression_ < T(-0.05)) return string_.ring();
    velocity_step_ += press_step_;
    const T free = velocity_step_ - string_.increment();
    force_ = meet(free + last_increment_);
    const T increment = free - receptance_ * force_;
    was_touching_ = compression_ > 0;
    compression_ += increment;
    last_increment_ = increment;
    velocity_step_ -= velocity_step_per_force_ * force_;
    return string_.advance(2 * force_);
  }

  /// d psi / dy of psi = sqrt(2 V).
  [[nodiscard]] T gradient() const { return compression_ > 0 ? scale_ * std::pow(compression_, power_) : T(0); }

  /// Returns the force and advances psi by g s / 2. s = s_free - q f is the increment over two samples, q the
  /// receptance.
  T meet(T free) {
    if (compression_ > 0) {
      const T g = kGradient == PsiGradient::potential && psi_ < 0 ? -gradient() : gradient();
      const T qg = receptance_ * g;
      const T s = (free - qg * psi_) / (1 + qg * g / 4);
      const T next = psi_ + g * s / 2;
      if (kGradient == PsiGradient::potential || next >= 0) return carry(g, next);
      return leave(free);
    }
    if (kGradient == PsiGradient::never_pulls && was_touching_) return leave(free);
    return 0;
  }

  /// The force with the largest gradient that keeps psi >= 0, g_max = 2 (sqrt(z^2 + q psi^2) - z)/(q psi) with
  /// z = -s_free/2. psi becomes 0.
  T leave(T free) {
    const T z = -free / 2;
    const T root = std::sqrt(z * z + receptance_ * psi_ * psi_);
    // g psi / 2, in the form without cancellation
    const T force = z > 0 ? psi_ * psi_ / (root + z) : (root - z) / receptance_;
    const bool stored = psi_ > 0;
    psi_ = 0;
    return stored ? force : T(0);
  }

  T carry(T g, T next) {
    const T force = g * (psi_ + next) / 2;
    psi_ = next;
    return force;
  }

  ModalString<T> string_;
  T time_step_, velocity_step_per_force_, receptance_;
  T scale_, power_, per_power_;
  T compression_ = -1;   // no contact until the first throw
  T velocity_step_ = 0;  // hammer velocity times time_step_ [m]
  T press_step_ = 0;     // what the pressing force adds to it in a sample [m]
  T last_increment_ = 0;
  T psi_ = 0;
  T force_ = 0;
  bool was_touching_ = false;
};

/// The linearly implicit scheme of Ducceschi and Bilbao.
template <std::floating_point T>
using LinearlyImplicitHammerString = QuadratisedHammerString<T, PsiGradient::potential>;

/// EXP-3 of van Walstijn et al.
template <std::floating_point T>
using Exp3HammerString = QuadratisedHammerString<T, PsiGradient::never_pulls>;

/// EXP-3 with a hammer that is stopped 5 cm away from the string.
template <std::floating_point T>
using CatchingExp3HammerString = QuadratisedHammerString<T, PsiGradient::never_pulls, true>;

}  // namespace contactspline::bench
