// SPDX-License-Identifier: MIT
// A hammer on a modal string with the same one-step discrete gradient as HammerString. Newton's method solves it on
// the power law itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/baselines/one_step.hpp"
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

/// The update by Newton's method for OneStepHammerString.
template <std::floating_point T>
class NewtonUpdate {
 public:
  explicit NewtonUpdate(const PowerLawHammer& hammer)
      : mean_force_(static_cast<T>(hammer.stiffness_n_per_m_alpha), static_cast<T>(hammer.exponent)) {}

  void begin(T, T guess) { guess_ = guess; }

  [[nodiscard]] ContactStep<T> meet(const Approach<T>& approach) {
    const auto [y0, xf, xi] = approach;
    if (y0 <= 0 && y0 + xf <= 0) {
      guess_ = xf;
      return {0, y0 + xf, 0};
    }
    const T x = increment(approach);
    return {(xf - x) / xi, y0 + x, 0};
  }

 private:
  static constexpr int kMaxIterations = 50;
  // Relative to the increment; limited by the precision of T.
  static constexpr T kTolerance = std::max(T(1e-12), 4 * std::numeric_limits<T>::epsilon());

  /// The root of h(x) = x - xf + xi mean(x), whose slope is at least 1. A Newton step that leaves the bracket of the
  /// root is replaced by bisection. Steps may grow where h turns flat, as at the end of a stiff contact. Small ones
  /// shrink until only rounding is left.
  T increment(const Approach<T>& approach) {
    const T free = approach.free_increment, receptance = approach.receptance;
    mean_force_.begin(approach.compression);
    T low = std::numeric_limits<T>::lowest(), high = free;
    T x = std::min(guess_, high), last = std::numeric_limits<T>::max();
    for (int i = 0; i < kMaxIterations; ++i) {
      const auto [mean, slope] = mean_force_.over(x);
      const T h = x - free + receptance * mean;
      (h > 0 ? high : low) = x;
      T next = x - h / (1 + receptance * slope);
      const bool inside = next >= low && next <= high;
      if (!inside) next = low / 2 + high / 2;
      const T step = std::abs(next - x);
      x = next;
      const T scale = std::max(std::abs(x), std::abs(free));
      if (step <= kTolerance * scale || (inside && step >= last && step * step <= kTolerance * scale * scale)) break;
      last = inside ? step : std::numeric_limits<T>::max();
    }
    return guess_ = x;
  }

  MeanForce<T> mean_force_;
  T guess_ = 0;
};

template <std::floating_point T>
using NewtonHammerString = OneStepHammerString<T, NewtonUpdate<T>>;

}  // namespace contactspline::bench
