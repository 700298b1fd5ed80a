// SPDX-License-Identifier: MIT
// Finiteness by bit pattern: -Ofast takes std::isfinite for always true.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace contactspline::testing {

[[nodiscard]] constexpr bool is_finite(double value) {
  return (~std::bit_cast<std::uint64_t>(value) & 0x7ff0'0000'0000'0000) != 0;
}

[[nodiscard]] constexpr bool is_finite(float value) {
  return (~std::bit_cast<std::uint32_t>(value) & 0x7f80'0000) != 0;
}

template <typename T>
[[nodiscard]] bool all_finite(const std::vector<T>& values) {
  return std::ranges::all_of(values, [](T value) { return is_finite(value); });
}

}  // namespace contactspline::testing
