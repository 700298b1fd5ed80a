// SPDX-License-Identifier: MIT
// What hammer_string.dsp plays: its felt, its string, and a sound of it.
#pragma once

#include <vector>

#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"

namespace contactspline::testing {

using Felt = materials::felt_c4;
using String = resonators::string_c4;

/// Displacement at the pickup, and force.
struct Sound {
  std::vector<double> displacement, force;
};

}  // namespace contactspline::testing
