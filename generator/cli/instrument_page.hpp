// SPDX-License-Identifier: MIT
// What `inspect` shows of an instrument: a table of its parts.
#pragma once

#include <string>

#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// Bodies, places, connections, controls, strikes and outputs, with the modes that a simulation at this rate keeps.
[[nodiscard]] std::string instrument_table(const InstrumentModel& model, double sample_rate_hz);

}  // namespace contactspline
