// SPDX-License-Identifier: MIT
// The sample rates that instruments play at.
#pragma once

#include "generator/support/json_reader.hpp"

namespace contactspline {

inline constexpr Range kSampleRates_hz{1000, 768000};

}  // namespace contactspline
