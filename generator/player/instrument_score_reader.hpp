// SPDX-License-Identifier: MIT
// Scores of instruments that a file describes (docs/scores.md).
#pragma once

#include <string_view>

#include "generator/material/contact_reader.hpp"
#include "generator/player/score.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// Reads a score whose key `instrument` names an instrument file. `file` stands in messages only; `read` reads the
/// files that it names. Throws BadInput.
[[nodiscard]] Score parse_instrument_score(const JsonObject& score, std::string_view file, const ReadFile& read);

}  // namespace contactspline
