// SPDX-License-Identifier: MIT
// Keyboard files (docs/reference/keyboard.md).
#pragma once

#include <optional>
#include <string_view>

#include "generator/material/contact_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/resonator/keyboard.hpp"

namespace contactspline {

/// Parses the text of a keyboard file: JSON with comments, SI units in the key names (docs/reference/keyboard.md).
/// `file` stands in messages only. Throws BadInput.
[[nodiscard]] Keyboard parse_keyboard(std::string_view text, std::string_view file);

/// The body and the knock that a keyboard names: resonators that ship, or files beside the keyboard's, which `read`
/// reads; nothing where it names none. Throws BadInput.
[[nodiscard]] KeyboardResonators resonators_of(const Keyboard& keyboard, const NamedText& file, const ReadFile& read);

}  // namespace contactspline
