// SPDX-License-Identifier: MIT
// Hides the jump of a sum of signals where one of them joins or leaves.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <concepts>

namespace contactspline {

/// A sum of signals without the jumps where one joins or leaves: each jump decays as exp(-t/time_s). time_s [s]:
/// above 0.
template <std::floating_point T>
class Splice {
 public:
  Splice(double time_s, double sample_rate_hz) : keeps_(static_cast<T>(std::exp(-1 / (time_s * sample_rate_hz)))) {}

  /// A signal of this value joins with the next sample.
  void begins(T value) { missing_ -= value; }
  /// A signal that had this value at the last sample has left.
  void ended(T value) { missing_ += value; }

  T tick(T sum) {
    const T out = sum + missing_;
    missing_ *= keeps_;
    return out;
  }

  void reset() { missing_ = 0; }

 private:
  T keeps_;
  T missing_ = 0;
};

}  // namespace contactspline
