// SPDX-License-Identifier: MIT
// Resonator files (docs/resonators.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "generator/resonator/resonator.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// Parses the text of a resonator file: JSON with comments, SI units in the key names (docs/resonators.md). `file`
/// stands in messages only. Throws BadInput.
[[nodiscard]] Resonator parse_resonator(std::string_view text, std::string_view file);

/// The keys of an object that name the kind of a body with a shape: string, bar, membrane, plate.
[[nodiscard]] const std::vector<std::string>& body_keys();

/// Reads the body of an object that has one of these keys. Throws BadInput.
[[nodiscard]] decltype(Resonator::body) read_shaped_body(const JsonObject& object);

/// Largest position on a body [m]: length or radius; 0 for a table of modes.
[[nodiscard]] double extent_of(const decltype(Resonator::body)& body);

inline constexpr int kMaxModes = 4096;  ///< of a resonator

}  // namespace contactspline
