// SPDX-License-Identifier: MIT
// A high-pass filter of second order.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <numbers>

namespace contactspline {

/// Butterworth high-pass of second order: (s/w)^2/((s/w)^2 + sqrt(2) s/w + 1), by the bilinear transform with its
/// -3 dB point kept (two trapezoidal integrators). frequency_hz: above 0; above 0.45 of the sample rate it counts as
/// that.
template <std::floating_point T>
class HighPass {
 public:
  HighPass(double frequency_hz, double sample_rate_hz)
      : gain_(static_cast<T>(std::tan(std::numbers::pi * std::min(frequency_hz / sample_rate_hz, 0.45)))),
        scale_(1 / (1 + gain_ * (std::numbers::sqrt2_v<T> + gain_))) {}

  T tick(T in) {
    const T high = scale_ * (in - (std::numbers::sqrt2_v<T> + gain_) * band_ - low_);
    const T to_band = gain_ * high, band = to_band + band_;
    band_ = band + to_band;
    const T to_low = gain_ * band;
    low_ += 2 * to_low;
    return high;
  }

  void reset() { band_ = low_ = 0; }

 private:
  T gain_, scale_;
  T band_ = 0, low_ = 0;
};

}  // namespace contactspline
