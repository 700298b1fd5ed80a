// SPDX-License-Identifier: MIT
// A pluck: a force that rises gently and lets go at once.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace contactspline {

inline constexpr double kPluckRise_s = 0.004;  ///< of a pluck by a finger

/// A movement from 0 to 1 that eases in and out, so that neither place nor speed jumps; u: 0 to 1.
[[nodiscard]] constexpr double eased(double u) {
  return u * u * (3 - 2 * u);
}

/// Force of a pluck over time: force (3 u^2 - 2 u^3), u = time/rise, up to its end.
class Pluck {
 public:
  static constexpr double kLongest_s = 3600;

  /// Begins with the next sample. rise_s: 0 to kLongest_s, clamped. The impulse is half of force times rise: without
  /// a rise there is no pluck.
  void begin(double force_n, double rise_s, double sample_rate_hz) {
    force_n_ = force_n;
    length_ = static_cast<std::size_t>(std::llround(std::clamp(rise_s, 0.0, kLongest_s) * sample_rate_hz));
    sample_ = 0;
  }
  void stop() { sample_ = length_; }
  [[nodiscard]] bool is_active() const { return sample_ < length_; }

  /// Force in the next sample [N]; 0 if it has ended.
  double next() {
    if (!is_active()) return 0;
    return force_n_ * eased(static_cast<double>(sample_++) / static_cast<double>(length_));
  }

 private:
  double force_n_ = 0;
  std::size_t length_ = 0, sample_ = 0;
};

}  // namespace contactspline
