// SPDX-License-Identifier: MIT
// Random numbers for tests: the same with every compiler and standard library.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace contactspline::testing {

/// Steele, Lea and Flood's SplitMix64. Any number is a seed. A copy draws the same numbers again.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// 64 random bits.
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  /// From 0 to n - 1.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits() % n); }
  /// True once in so many draws on average.
  bool once_in(std::uint64_t draws) { return bits() % draws == 0; }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * uniform(); }
  /// The logarithm is uniform.
  double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  /// 10 to the power of a number between `low` and `high`.
  double decades(double low, double high) { return std::pow(10.0, between(low, high)); }
  double sign() { return (bits() >> 63) == 0 ? 1.0 : -1.0; }

 private:
  std::uint64_t state_;
};

}  // namespace contactspline::testing
