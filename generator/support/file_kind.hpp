// SPDX-License-Identifier: MIT
// Kinds of input: what a file is by its keys, and what ships under a name.
#pragma once

#include <optional>
#include <string_view>

#include "generator/support/embedded_files.hpp"

namespace contactspline {

/// The kind of the files in a folder: material, friction, resonator, keyboard, instrument or score.
[[nodiscard]] std::string_view kind_name(Shipped folder);

/// The kind that the keys of a JSON file show, or a score for MIDI; nothing if they show none. `what`, the kind that
/// is expected, and `file` appear in messages only. Throws BadInput for wrong syntax and for an output of this
/// program.
[[nodiscard]] std::optional<Shipped> kind_of_file(std::string_view text, std::string_view file,
                                                  std::string_view what);

/// The folder of what ships under a name, or nothing.
[[nodiscard]] std::optional<Shipped> kind_of_name(std::string_view name);

}  // namespace contactspline
