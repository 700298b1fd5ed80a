// SPDX-License-Identifier: MIT
// How well two sounds agree.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace contactspline::testing {

/// Signal over error in decibels; not a number where the lengths differ or a sample is none, so that no bound holds.
template <typename Expected>
double agreement_db(std::span<const float> actual, std::span<const Expected> expected) {
  if (actual.size() != expected.size()) return std::numeric_limits<double>::quiet_NaN();
  double error = 0, power = 0;
  for (std::size_t n = 0; n < expected.size(); ++n) {
    error += std::pow(static_cast<double>(actual[n]) - static_cast<double>(expected[n]), 2);
    power += std::pow(static_cast<double>(expected[n]), 2);
  }
  return 10 * std::log10(power / error);
}

}  // namespace contactspline::testing
