// SPDX-License-Identifier: MIT
// Instrument files (docs/reference/instruments.md).
#pragma once

#include <string_view>

#include "generator/instrument/instrument.hpp"
#include "generator/material/contact_reader.hpp"
#include "generator/spline/designed_materials.hpp"

namespace contactspline {

/// Parses the text of an instrument file: JSON with comments, SI units in the key names. `file` stands in messages
/// only; `read` reads the materials and resonators that it names. Throws BadInput.
[[nodiscard]] InstrumentModel parse_instrument(std::string_view text, std::string_view file,
                                               const ReadFile& read = shipped_file);

/// The same with materials that several files have in common.
[[nodiscard]] InstrumentModel parse_instrument(std::string_view text, std::string_view file, const ReadFile& read,
                                               DesignedMaterials& materials);

}  // namespace contactspline
