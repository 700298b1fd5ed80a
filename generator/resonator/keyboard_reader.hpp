// SPDX-License-Identifier: MIT
// Keyboard files (docs/keyboard.md).
#pragma once

#include <string_view>

#include "generator/resonator/keyboard.hpp"

namespace contactspline {

/// Parses the text of a keyboard file: JSON with comments, SI units in the key names (docs/keyboard.md). `file`
/// stands in messages only. Throws BadInput.
[[nodiscard]] Keyboard parse_keyboard(std::string_view text, std::string_view file);

}  // namespace contactspline
