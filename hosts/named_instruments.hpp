// SPDX-License-Identifier: MIT
// Every instrument that ships, and those of files, by name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "generator/player/instrument_maker.hpp"

namespace contactspline {

/// Names of what ships: the models of the runtime, the keyboard, the instruments of files.
[[nodiscard]] std::vector<std::string> instrument_names();

/// The instrument that ships under a name, or that the file at a path describes. Throws BadInput.
[[nodiscard]] InstrumentMaker maker_of_name(const std::string& name);

/// The instrument of the text of a file. `file` stands in messages; what the text names is read beside it. Throws
/// BadInput.
[[nodiscard]] InstrumentMaker maker_of_text(std::string_view text, const std::string& file);

}  // namespace contactspline
