// SPDX-License-Identifier: MIT
// The last forces at a place, filtered: what they add at once to the pressure at listening places
// (docs/how-it-works/listening.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/modal/mode.hpp"
#include "contactspline/simd/portable_kernels.hpp"

namespace contactspline::detail {

/// Taps at another sample rate, by sinc interpolation below half of the lower rate. Tap n is for the time (n +
/// 1/2)/rate.
[[nodiscard]] inline std::vector<double> taps_at(std::span<const double> taps, double rate_hz, double new_rate_hz) {
  if (rate_hz == new_rate_hz) return {taps.begin(), taps.end()};
  const double step = rate_hz / new_rate_hz, width = (std::max)(step, 1.0);
  std::vector<double> made(static_cast<std::size_t>(static_cast<double>(taps.size()) / step) + 1);
  for (std::size_t n = 0; n < made.size(); ++n)
    for (std::size_t k = 0; k < taps.size(); ++k) {
      const double x = std::numbers::pi * ((double(n) + 0.5) * step - (double(k) + 0.5)) / width;
      made[n] += step / width * taps[k] * (x == 0 ? 1 : std::sin(x) / x);
    }
  return made;
}

/// The same as numbers of the precision in which they filter.
template <std::floating_point T>
[[nodiscard]] std::vector<T> taps_in(std::span<const double> taps, double rate_hz, double new_rate_hz) {
  std::vector<T> made;
  for (const double tap : taps_at(taps, rate_hz, new_rate_hz)) made.push_back(static_cast<T>(tap));
  return made;
}

/// The last `length` forces at a place, the newest first. They are kept twice, so that any number of them lie in one
/// row. Only reset() allocates, after widen().
template <std::floating_point T>
class ForceHistory {
 public:
  explicit ForceHistory(std::size_t length = 0) : length_(length) { reset(); }

  /// Before reset(): it keeps at least so many.
  void widen(std::size_t length) { length_ = (std::max)(length_, length); }

  void add(T force_n) {
    begin_ = begin_ == 0 ? length_ - 1 : begin_ - 1;
    values_[begin_] = values_[begin_ + length_] = force_n;
    acting_ = force_n != 0 ? length_ : acting_ - (acting_ > 0 ? 1 : 0);
  }

  /// The sum of taps times forces: tap 0 is for the last one. At most `length` taps.
  [[nodiscard]] T filtered(std::span<const T> taps) const {
    if (acting_ == 0) return 0;
    const T* const last = values_.data() + begin_;
    return sum_of<T>(taps.size(), [&](std::size_t i) { return taps[i] * last[i]; });
  }

  void reset() {
    values_.assign(2 * length_, T(0));
    begin_ = acting_ = 0;
  }

 private:
  std::size_t length_, begin_ = 0;
  std::size_t acting_ = 0;  // so many more samples have one of these forces in their row
  std::vector<T> values_;
};

}  // namespace contactspline::detail
