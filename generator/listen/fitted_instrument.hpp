// SPDX-License-Identifier: MIT
// What a fit of an instrument found, as text.
#pragma once

#include <string>
#include <string_view>

#include "generator/listen/instrument_fit.hpp"

namespace contactspline {

/// The numbers with their intervals, and how far each recording was and is.
[[nodiscard]] std::string report_of(const InstrumentFit& fit, const RecordedInstrument& recorded);

/// The same as JSON.
[[nodiscard]] std::string json_of(const InstrumentFit& fit, const RecordedInstrument& recorded);

/// The instrument file with these numbers, and the report in comments above it. mark: of the program.
[[nodiscard]] std::string instrument_text(const InstrumentFit& fit, const RecordedInstrument& recorded,
                                          std::string_view mark);

}  // namespace contactspline
