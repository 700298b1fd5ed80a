// SPDX-License-Identifier: MIT
// Measures the time of a few instructions.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>
#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace contactspline::bench {

/// The unit of ticks().
#if defined(__x86_64__)
inline constexpr const char* kTickName = "cycles of the time stamp counter";
#else
inline constexpr const char* kTickName = "ns";
#endif

/// The current time. The compiler and the processor do not move instructions across this call.
inline std::uint64_t ticks() {
#if defined(__x86_64__)
  _mm_lfence();
  const std::uint64_t now = __rdtsc();
  _mm_lfence();
  return now;
#else
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch() /
                                    std::chrono::nanoseconds(1));
#endif
}

/// The value below which a fraction of all values lies; fraction 0.5: the median.
template <typename T>
T percentile(std::vector<T> values, double fraction) {
  const auto at =
      std::min(values.size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

template <typename T>
T median(std::vector<T> values) {
  return percentile(std::move(values), 0.5);
}

/// Median time between two consecutive calls of ticks().
inline std::uint64_t ticks_of_nothing() {
  std::vector<std::uint64_t> counts;
  for (int i = 0; i < 1001; ++i) {
    const std::uint64_t begin = ticks();
    counts.push_back(ticks() - begin);
  }
  return median(counts);
}

}  // namespace contactspline::bench
