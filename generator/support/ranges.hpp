// SPDX-License-Identifier: MIT
// Ranges of numbers that several readers of files allow: wide enough for every collision in an instrument, narrow
// enough to catch a wrong unit.
#pragma once

#include "generator/support/json_reader.hpp"

namespace contactspline::ranges {

inline constexpr Range kMass{1e-9, 1e4};        // kg
inline constexpr Range kSpeed{1e-6, 1e3};       // m/s
inline constexpr Range kCompression{1e-9, 1};   // m
inline constexpr Range kTension{1e-3, 1e6};     // N or N/m
inline constexpr Range kModulus{1e3, 2e12};     // Pa
inline constexpr Range kLoss{0, 1e3};           // s/m
inline constexpr Range kStiffness{1e-3, 1e18};  // N/m^exponent
inline constexpr Range kExponent{0.1, 10};
inline constexpr Range kOffset{0, 0.1};  // m
inline constexpr Range kWeight{1e-6, 0.999};
inline constexpr Range kRelaxation{1e-7, 10};  // s

}  // namespace contactspline::ranges
