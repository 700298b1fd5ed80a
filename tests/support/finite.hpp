// SPDX-License-Identifier: MIT
// Finiteness by the bits: -Ofast assumes that std::isfinite is always true.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace contactspline::testing {

[[nodiscard]] inline bool is_finite(float value) {
  constexpr std::uint32_t kExponent = 0x7f80'0000;
  return (std::bit_cast<std::uint32_t>(value) & kExponent) != kExponent;
}

[[nodiscard]] inline bool is_finite(double value) {
  constexpr std::uint64_t kExponent = 0x7ff0'0000'0000'0000;
  return (std::bit_cast<std::uint64_t>(value) & kExponent) != kExponent;
}

template <typename T>
[[nodiscard]] bool all_finite(const std::vector<T>& values) {
  return std::ranges::all_of(values, [](T value) { return is_finite(value); });
}

}  // namespace contactspline::testing
