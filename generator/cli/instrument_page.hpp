// SPDX-License-Identifier: MIT
// What `inspect` shows of an instrument: a table of its parts.
#pragma once

#include <string>
#include <string_view>

#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// Bodies, places, connections, controls, strikes and outputs, with the modes that a simulation at this rate keeps.
[[nodiscard]] std::string instrument_table(const InstrumentModel& model, double sample_rate_hz);

/// The kind of a body: of a resonator, or "mass".
[[nodiscard]] std::string_view kind_of(const InstrumentBody& body);

/// Distance from the middle of a membrane, negative on its other side, or from an end of another body [m].
[[nodiscard]] double position_of(const Place& point);

}  // namespace contactspline
