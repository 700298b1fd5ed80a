// SPDX-License-Identifier: MIT
// What plays a name, a file or a description: the instruments of Python.
#pragma once

#include <string>

#include "hosts/named_instruments.hpp"

namespace contactspline::python {

/// source: an instrument that ships, the path of an instrument file, or, with is_text, the text of one. parts: a JSON
/// object of what mass_barrier, hammer_string, slide_string and fret_string are made of instead of their own parts:
/// the keys of a voice of a score (docs/reference/scores.md), where resonator and material may be whole objects, and
/// first values of parameters; of piano, `keyboard`, a name, a path or an object; empty for all others. Throws
/// BadInput.
[[nodiscard]] InstrumentMaker maker_of(const std::string& source, bool is_text, const std::string& parts);

}  // namespace contactspline::python
