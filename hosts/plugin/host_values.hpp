// SPDX-License-Identifier: MIT
// Values of parameters as hosts keep them.
#pragma once

#include <algorithm>
#include <cmath>

namespace contactspline {

/// The decimal number of fewest digits within a distance of a value; the value itself if that takes more than 6. A
/// host that keeps a part of the slider in single precision gives back 3 as 2.9999998: this makes it 3 again.
inline double shortest_within(double value, double distance) {
  if (std::abs(value) <= distance) return 0;
  const int leading = static_cast<int>(std::floor(std::log10(std::abs(value))));
  for (int digits = 1; digits <= 6; ++digits) {
    const double unit = std::pow(10.0, leading + 1 - digits);
    // Powers of 10 below 1 are not exact: a quotient by a whole one is.
    const double rounded =
        unit < 1 ? std::round(value * std::round(1 / unit)) / std::round(1 / unit) : std::round(value / unit) * unit;
    if (std::abs(rounded - value) <= distance) return rounded;
  }
  return value;
}

/// The slider of a parameter: values from min to max, or their logarithms, as parts from 0 to 1.
struct HostScale {
  double min, max;
  bool is_logarithmic;

  /// The value at a part of the slider, in as few digits as single precision of the part can tell.
  [[nodiscard]] double value_at(double part) const {
    if (part <= 0) return min;
    if (part >= 1) return max;
    constexpr double kRounding = 1.2e-7;  // of a part in single precision, twice
    if (!is_logarithmic) return within(shortest_within(min + part * (max - min), kRounding * (max - min)));
    const double value = min * std::pow(max / min, part);
    return within(shortest_within(value, kRounding * value * std::log(max / min)));
  }

  /// The part of the slider at a value; values outside are at the nearer end.
  [[nodiscard]] double part_of(double value) const {
    if (!(value > min)) return 0;
    if (value >= max) return 1;
    return is_logarithmic ? std::log(value / min) / std::log(max / min) : (value - min) / (max - min);
  }

 private:
  [[nodiscard]] double within(double value) const { return std::clamp(value, min, max); }
};

}  // namespace contactspline
