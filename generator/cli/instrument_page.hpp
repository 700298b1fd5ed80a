// SPDX-License-Identifier: MIT
// What `inspect` shows of an instrument: a table of its parts, and a drawing of what joins them.
#pragma once

#include <string>

#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// Bodies, places, connections, controls, strikes and outputs, with the modes that a simulation at this rate keeps.
[[nodiscard]] std::string instrument_table(const InstrumentModel& model, double sample_rate_hz);

/// gnuplot commands that draw bodies, places and connections, one body in each row, in a frame of 0 to 1.
[[nodiscard]] std::string instrument_diagram(const InstrumentModel& model);

}  // namespace contactspline
