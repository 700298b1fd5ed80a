// SPDX-License-Identifier: MIT
// Linear interpolation between the entries of a table.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

namespace contactspline {

/// Linear interpolation of the points (x, values) at `at`, extrapolated beyond the ends by the first and the last
/// straight piece. x must rise and have two entries or more.
[[nodiscard]] inline double interpolated(const std::vector<double>& x, const std::vector<double>& values, double at) {
  const auto above = std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(x, at) - x.begin(), 1, std::ssize(x) - 1);
  const auto i = static_cast<std::size_t>(above);
  return std::lerp(values[i - 1], values[i], (at - x[i - 1]) / (x[i] - x[i - 1]));
}

/// The same, but constant beyond the ends.
[[nodiscard]] inline double interpolated_within(const std::vector<double>& x, const std::vector<double>& values,
                                                double at) {
  return interpolated(x, values, std::clamp(at, x.front(), x.back()));
}

}  // namespace contactspline
