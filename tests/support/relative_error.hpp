// SPDX-License-Identifier: MIT
// How far one sound is from another.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace contactspline::testing {

/// Root of the summed squares of the error over that of the exact samples; not a number where the lengths differ or a
/// sample is none, so that no bound holds.
[[nodiscard]] inline double relative_error(std::span<const double> found, std::span<const double> exact) {
  if (found.size() != exact.size()) return std::numeric_limits<double>::quiet_NaN();
  double error = 0, sum = 0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    error += std::pow(found[n] - exact[n], 2);
    sum += std::pow(exact[n], 2);
  }
  return std::sqrt(error / sum);
}

}  // namespace contactspline::testing
