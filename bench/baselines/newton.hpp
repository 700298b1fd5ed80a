// SPDX-License-Identifier: MIT
// A hammer on a modal string with the same one-step discrete gradient as HammerString. Newton's method solves it on
// the power law itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/baselines/modal_string.hpp"
#include "bench/baselines/power_law_hammer.hpp"

namespace contactspline::bench {

/// The mean of F(y) = k y^a over [y0, y0 + x], and the derivative of this mean with respect to x.
template <std::floating_point T>
class MeanForce {
 public:
  MeanForce(T stiffness, T exponent) : stiffness_(stiffness), exponent_(exponent) {}

  /// Sets y0.
  void begin(T compression) {
    y0_ = compression;
    energy_ = energy(y0_, force(y0_));
  }

  struct Value {
    T mean, slope;
  };
  /// The difference quotient of V(y) = k y^(a+1)/(a+1). It suffers from cancellation as x -> 0. For small x the force
  /// in the middle and the next term of its series are used; the relative error is below a(a-1)(a-2)(a-3)/1920
  /// (x/y)^4.
  [[nodiscard]] Value over(T x) const {
    const T middle = y0_ + x / 2;
    if (std::abs(x) <= T(kNear) * middle) {
      const T f = force(middle), ratio = x / middle;
      return {f * (1 + exponent_ * (exponent_ - 1) / 24 * ratio * ratio), exponent_ * f / (2 * middle)};
    }
    if (x == 0) return {0, 0};
    const T f = force(y0_ + x);
    const T mean = (energy(y0_ + x, f) - energy_) / x;
    return {mean, (f - mean) / x};
  }

 private:
  // Where truncation and rounding errors are equal: about the fifth root of the rounding error.
  static constexpr double kNear = std::numeric_limits<T>::digits > 24 ? 1e-3 : 4e-2;

  [[nodiscard]] T force(T y) const { return y > 0 ? stiffness_ * std::pow(y, exponent_) : T(0); }
  [[nodiscard]] T energy(T y, T force) const { return y * force / (exponent_ + 1); }

  T stiffness_, exponent_;
  T y0_ = 0;
  T energy_ = 0;
};

template <std::floating_point T>
class NewtonHammerString {
 public:
  NewtonHammerString(const PowerLawHammer& hammer, std::span<const Mode> modes, std::span<const double> strike_shapes,
                     std::span<const double> pickup_shapes, double sample_rate_hz)
      : string_(modes, strike_shapes, pickup_shapes, sample_rate_hz),
        mean_force_(static_cast<T>(hammer.stiffness_n_per_m_alpha), static_cast<T>(hammer.exponent)),
        time_step_(static_cast<T>(1 / sample_rate_hz)),
        velocity_step_per_force_(static_cast<T>(1 / (sample_rate_hz * sample_rate_hz * hammer.mass_kg))),
        admittance_(velocity_step_per_force_ / 2 + string_.admittance()),
        per_admittance_(1 / admittance_) {}

  /// Throws the hammer from a distance [m] with a velocity [m/s].
  void strike(T velocity_m_per_s, T distance_m) {
    compression_ = -distance_m;
    velocity_step_ = velocity_m_per_s * time_step_;
    guess_ = velocity_step_;
  }

  /// Writes the displacement at the pickup [m].
  void process(std::span<T> out) {
    for (T& sample : out) sample = tick();
  }

  [[nodiscard]] T force() const { return force_; }              ///< over the last sample [N]
  [[nodiscard]] T compression() const { return compression_; }  ///< [m]
  [[nodiscard]] T hammer_velocity() const { return velocity_step_ / time_step_; }
  [[nodiscard]] const ModalString<T>& string() const { return string_; }

 private:
  static constexpr int kMaxIterations = 50;
  // Relative to the increment; limited by the precision of T.
  static constexpr T kTolerance = std::max(T(1e-12), 4 * std::numeric_limits<T>::epsilon());

  T tick() {
    const T last = force_;
    const T free = velocity_step_ - (string_.increment() + string_.admittance() * last);
    const T x = increment(free);
    force_ = (free - x) * per_admittance_;
    compression_ += x;
    velocity_step_ -= velocity_step_per_force_ * force_;
    return string_.advance(force_ + last);
  }

  /// The root of h(x) = x - xf + xi mean(x), whose slope is at least 1. A Newton step that leaves the bracket of the
  /// root is replaced by bisection. h is convex, so the steps shrink until only rounding is left.
  T increment(T free) {
    if (compression_ <= 0 && compression_ + free <= 0) return guess_ = free;
    mean_force_.begin(compression_);
    T low = std::numeric_limits<T>::lowest(), high = free;
    T x = std::min(guess_, high), last = std::numeric_limits<T>::max();
    for (int i = 0; i < kMaxIterations; ++i) {
      const auto [mean, slope] = mean_force_.over(x);
      const T h = x - free + admittance_ * mean;
      (h > 0 ? high : low) = x;
      T next = x - h / (1 + admittance_ * slope);
      const bool inside = next >= low && next <= high;
      if (!inside) next = low / 2 + high / 2;
      const T step = std::abs(next - x);
      x = next;
      if (step <= kTolerance * std::max(std::abs(x), std::abs(free)) || (inside && step >= last)) break;
      last = inside ? step : std::numeric_limits<T>::max();
    }
    return guess_ = x;
  }

  ModalString<T> string_;
  MeanForce<T> mean_force_;
  T time_step_, velocity_step_per_force_, admittance_, per_admittance_;
  T compression_ = -1;   // no contact until the first throw
  T velocity_step_ = 0;  // hammer velocity times time_step_ [m]
  T guess_ = 0;
  T force_ = 0;
};

}  // namespace contactspline::bench
