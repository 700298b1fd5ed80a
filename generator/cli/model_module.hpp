// SPDX-License-Identifier: MIT
// A user's own class in a shared library, as an instrument of the command line.
#pragma once

#include <string>

#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// The lists of the class in a library of contactspline_model(); its `module` makes the class. The library stays
/// loaded. Throws BadInput.
[[nodiscard]] InstrumentModel load_model_module(const std::string& file);

}  // namespace contactspline
