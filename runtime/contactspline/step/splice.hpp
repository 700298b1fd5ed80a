// SPDX-License-Identifier: MIT
// Takes the steps out of a sum of signals some of which begin or end.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <concepts>

namespace contactspline {

/// A sum without the steps by which its parts begin and end: each dies away by exp(-t/time_s). time_s: above 0.
template <std::floating_point T>
class Splice {
 public:
  Splice(double time_s, double sample_rate_hz) : keeps_(static_cast<T>(std::exp(-1 / (time_s * sample_rate_hz)))) {}

  /// A part of this value begins with the next sample.
  void begins(T value) { missing_ -= value; }
  /// A part that had this value at the last sample has ended.
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
