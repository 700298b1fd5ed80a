// SPDX-License-Identifier: MIT
// Resonator files (docs/resonators.md).
#pragma once

#include <string_view>

#include "generator/resonator/resonator.hpp"

namespace contactspline {

/// Parses the text of a resonator file: JSON with comments, SI units in the key names (docs/resonators.md). `file`
/// stands in messages only. Throws BadInput.
[[nodiscard]] Resonator parse_resonator(std::string_view text, std::string_view file);

}  // namespace contactspline
