// SPDX-License-Identifier: MIT
// What `inspect` prints, as JSON: SI units, all digits, errors as fractions.
#pragma once

#include <string>

#include "generator/resonator/resonator.hpp"
#include "generator/spline/design.hpp"

namespace contactspline {

/// Coefficients and errors of a spline.
[[nodiscard]] std::string json_of(const Design& design);

/// The modes of a resonator that a simulation at this rate keeps.
[[nodiscard]] std::string json_of(const Resonator& resonator, double sample_rate_hz);

}  // namespace contactspline
