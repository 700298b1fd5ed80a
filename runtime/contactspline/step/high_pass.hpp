// SPDX-License-Identifier: MIT
// A high-pass filter of second order.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <numbers>

namespace contactspline {

/// High-pass of second order: (s/w)^2/((s/w)^2 + s/(Q w) + 1), by the bilinear transform with w kept (two trapezoidal
/// integrators). frequency_hz: above 0; above 0.45 of the sample rate it counts as that. quality: Q > 0, the gain at
/// w; sqrt(1/2) is a Butterworth.
template <std::floating_point T>
class HighPass {
 public:
  HighPass(double frequency_hz, double sample_rate_hz, double quality = std::numbers::sqrt2 / 2)
      : gain_(static_cast<T>(std::tan(std::numbers::pi * (std::min)(frequency_hz / sample_rate_hz, 0.45)))),
        loss_(static_cast<T>(1 / quality)),
        scale_(1 / (1 + gain_ * (loss_ + gain_))) {}

  T tick(T in) {
    const T high = scale_ * (in - (loss_ + gain_) * band_ - low_);
    const T to_band = gain_ * high, band = to_band + band_;
    band_ = band + to_band;
    const T to_low = gain_ * band;
    low_ += 2 * to_low;
    return high;
  }

  void reset() { band_ = low_ = 0; }

 private:
  T gain_, loss_, scale_;
  T band_ = 0, low_ = 0;
};

}  // namespace contactspline
