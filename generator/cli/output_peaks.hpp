// SPDX-License-Identifier: MIT
// How loud the outputs of an instrument are.
#pragma once

#include <string>
#include <vector>

#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// The largest magnitude of an output, and what was played then.
struct OutputPeak {
  double peak = 0;    ///< in the unit of the output; 0 where nothing was played or heard
  std::string event;  ///< the name of an event, or "key 60"
};

/// The peak of each output within half a second after each event, alone, with the values at the beginning, or where
/// there are keys after the lowest and the highest key of each range, with velocity 1. Throws BadInput where a body
/// has no mode below half the rate.
[[nodiscard]] std::vector<OutputPeak> output_peaks(const InstrumentModel& model, double sample_rate_hz);

}  // namespace contactspline
