// SPDX-License-Identifier: MIT
// The maximum of a function on an interval, by golden-section search.
#pragma once

#include <numbers>

namespace contactspline {

/// A maximum of a function: its argument and its value.
struct Maximum {
  double x, value;
};

/// Golden-section search on [low, high] for the maximum of f, which must have only one there, in `steps` steps. Each
/// step shrinks the interval by 0.618.
template <typename Function>
[[nodiscard]] Maximum find_maximum(double low, double high, int steps, Function f) {
  constexpr double kFraction = 2 - std::numbers::phi;
  Maximum left{low + kFraction * (high - low), 0}, right{high - kFraction * (high - low), 0};
  left.value = f(left.x);
  right.value = f(right.x);
  for (int i = 0; i < steps; ++i) {
    const bool rises = left.value < right.value;
    (rises ? low : high) = (rises ? left : right).x;
    (rises ? left : right) = rises ? right : left;
    Maximum& next = rises ? right : left;
    next.x = rises ? high - kFraction * (high - low) : low + kFraction * (high - low);
    next.value = f(next.x);
  }
  return left.value < right.value ? right : left;
}

}  // namespace contactspline
