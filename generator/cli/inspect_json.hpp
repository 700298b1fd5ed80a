// SPDX-License-Identifier: MIT
// What `inspect` prints, as JSON: SI units, all digits, errors as fractions.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "generator/material/friction_reader.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/spline/design.hpp"

namespace contactspline {

/// Coefficients and errors of a spline.
[[nodiscard]] std::string json_of(const Design& design);

/// A family of knots in a comparison: its errors with the material's number of segments, and how many segments it
/// needs for an error of the contact duration of 1 % and of 0.1 %, if any number reaches it.
struct ComparedFamily {
  std::string_view name;
  std::size_t segments;
  Quality quality;
  std::optional<SpectrumError> spectrum;
  std::optional<std::size_t> segments_for_1_percent, segments_for_01_percent;
};

/// The law of friction.
[[nodiscard]] std::string json_of(const RubbingSurfaces& surfaces);

/// A comparison of families of knots for a material, which must have an impact.
[[nodiscard]] std::string json_of(const Material& material, std::span<const ComparedFamily> families);

/// The modes of a resonator that a simulation at this rate keeps.
[[nodiscard]] std::string json_of(const Resonator& resonator, double sample_rate_hz);

/// A key of a keyboard: its pitch, its inharmonicity B, as f_n = n f_0 sqrt(1 + B n^2) without losses, and the number
/// of modes of a string that a simulation keeps.
struct KeyRow {
  int key;
  KeyboardNote note;
  double pitch_hz, inharmonicity;
  std::size_t modes;
};

/// The row of a key, first_key to last_key.
[[nodiscard]] KeyRow key_row(const Keyboard& keyboard, int key, double sample_rate_hz);

/// Some keys of a keyboard.
[[nodiscard]] std::string json_of(const Keyboard& keyboard, std::span<const KeyRow> rows, double sample_rate_hz);

}  // namespace contactspline
