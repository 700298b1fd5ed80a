// SPDX-License-Identifier: MIT
// An instrument as source text: C++ header, Faust program, JSON.
#pragma once

#include <string>
#include <string_view>

#include "generator/emit/emitter.hpp"
#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// Source text of an instrument with its modes below `max_frequency_hz`: a C++ class, JSON, or a Faust program if it
/// has no faust_obstacle.
[[nodiscard]] std::string emit(const Emitter& emitter, const InstrumentModel& model, double max_frequency_hz,
                               std::string_view command);

}  // namespace contactspline
