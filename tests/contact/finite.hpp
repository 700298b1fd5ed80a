// SPDX-License-Identifier: MIT
// Finite or not, asked of the bits: -Ofast takes std::isfinite for granted.
#pragma once

#include <bit>
#include <cstdint>

namespace contactspline::testing {

[[nodiscard]] inline bool is_finite(float value) {
  constexpr std::uint32_t kExponent = 0x7f80'0000;
  return (std::bit_cast<std::uint32_t>(value) & kExponent) != kExponent;
}

[[nodiscard]] inline bool is_finite(double value) {
  constexpr std::uint64_t kExponent = 0x7ff0'0000'0000'0000;
  return (std::bit_cast<std::uint64_t>(value) & kExponent) != kExponent;
}

}  // namespace contactspline::testing
