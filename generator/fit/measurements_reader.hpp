// SPDX-License-Identifier: MIT
// Fit files (docs/how-to/fit.md).
#pragma once

#include <string_view>

#include "generator/fit/measurements.hpp"
#include "generator/material/contact_reader.hpp"

namespace contactspline {

/// Reads a fit file (docs/how-to/fit.md) and the data it names, and looks for what cannot be right: no contact, a
/// saturated sensor, a wrong unit. `file` appears in messages and begins the paths of the data in them. Throws
/// BadInput.
[[nodiscard]] Measurements parse_measurements(std::string_view text, std::string_view file, const ReadFile& read);

}  // namespace contactspline
