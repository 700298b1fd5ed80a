// SPDX-License-Identifier: MIT
// Resonators and keyboards for Python, as `contactspline inspect --json` prints them.
#pragma once

#include <string>

namespace contactspline::python {

/// The modes that a simulation at this rate keeps, of a resonator by name, path or text. Throws BadInput.
[[nodiscard]] std::string resonator_json(const std::string& source, bool is_text, double sample_rate_hz);

/// All keys of a keyboard by name, path or text, with the modes that a simulation keeps. Throws BadInput.
[[nodiscard]] std::string keyboard_json(const std::string& source, bool is_text, double sample_rate_hz);

}  // namespace contactspline::python
