// SPDX-License-Identifier: MIT
// Comparisons that fail on NaN, infinity, wrong values and missing data.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "support/finite.hpp"

namespace contactspline::testing {

/// Does a compiler round all copies of an inlined function alike? Not where it may reorder sums (-Ofast) or join a
/// product and a sum.
#if defined(__FAST_MATH__) || defined(__FMA__)
inline constexpr bool kCopiesRoundAlike = false;
#else
inline constexpr bool kCopiesRoundAlike = true;
#endif

/// Passes where all are finite and |actual - expected| <= bound, also under -Ofast.
inline ::testing::AssertionResult within(double actual, double expected, double bound) {
  const double error = std::abs(actual - expected);
  if (is_finite(actual) && is_finite(expected) && is_finite(bound) && error <= bound)
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << actual << " is not within " << bound << " of " << expected << " (error "
                                       << error << ")";
}

/// within() with a bound relative to |expected|; equal zeros pass.
inline ::testing::AssertionResult relatively_within(double actual, double expected, double bound) {
  return within(actual, expected, bound * std::abs(expected));
}

/// Sample-by-sample: same non-zero length, every sample finite and within `bound` of the largest |expected|, which
/// must not be zero: silence proves nothing.
template <typename T>
::testing::AssertionResult sequences_within(std::span<const T> actual, std::span<const T> expected, double bound) {
  if (actual.size() != expected.size() || expected.empty())
    return ::testing::AssertionFailure() << "lengths " << actual.size() << " and " << expected.size();
  double scale = 0;
  for (const T value : expected) scale = std::max(scale, std::abs(static_cast<double>(value)));
  if (!(scale > 0)) return ::testing::AssertionFailure() << "the expected sequence is silent";
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (const auto result = within(static_cast<double>(actual[i]), static_cast<double>(expected[i]), bound * scale);
        !result)
      return ::testing::AssertionFailure() << "at " << i << ": " << result.message();
  return ::testing::AssertionSuccess();
}

}  // namespace contactspline::testing
