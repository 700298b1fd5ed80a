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

/// The body that a keyboard names: a resonator that ships, or a file beside the keyboard's, which `read` reads;
/// nothing if it names none. Throws BadInput.
[[nodiscard]] std::optional<Resonator> body_of(const Keyboard& keyboard, const NamedText& file, const ReadFile& read);

}  // namespace contactspline
