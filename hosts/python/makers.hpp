// SPDX-License-Identifier: MIT
// What plays a name, a file or a description: the instruments of Python.
#pragma once

#include <string>

#include "hosts/named_instruments.hpp"

namespace contactspline::python {

/// source: an instrument that ships, the path of an instrument file, or, with is_text, the text of one. parts: a JSON
/// object of what hammer_string, mass_barrier and piano are made of instead of their own parts, with the keys of
/// all_made_of_parts(); empty for all others. Throws BadInput.
[[nodiscard]] InstrumentMaker maker_of(const std::string& source, bool is_text, const std::string& parts);

}  // namespace contactspline::python
