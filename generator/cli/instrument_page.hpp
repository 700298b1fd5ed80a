// SPDX-License-Identifier: MIT
// What `inspect` shows of an instrument: a table of its parts.
#pragma once

#include <string>
#include <vector>

#include "generator/cli/output_peaks.hpp"
#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// Bodies, places, connections, controls, strikes and outputs, with the modes that a simulation at this rate keeps,
/// and the peaks of the outputs, unless they are empty.
[[nodiscard]] std::string instrument_table(const InstrumentModel& model, double sample_rate_hz,
                                           const std::vector<OutputPeak>& peaks = {});

}  // namespace contactspline
