// SPDX-License-Identifier: MIT
// Material files (docs/reference/materials.md).
#pragma once

#include <string_view>

#include "generator/material/contact_reader.hpp"
#include "generator/material/material.hpp"

namespace contactspline {

/// Parses the text of a material file: JSON with comments, SI units in the key names. `file` appears in messages
/// only; `read` reads the files that the material names. If max_compression_m is missing, it is the largest
/// compression of the fastest impact; for graded and optimal knots it always is. Throws BadInput for unknown,
/// duplicate, missing, wrong-typed, non-finite and out-of-range keys.
[[nodiscard]] Material parse_material(std::string_view text, std::string_view file,
                                      const ReadFile& read = shipped_file);

}  // namespace contactspline
