// SPDX-License-Identifier: MIT
// An instrument as source text: C++ header, JSON.
#pragma once

#include <string>
#include <string_view>

#include "generator/emit/emitter.hpp"
#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// Source text of an instrument with its modes below `max_frequency_hz`: a C++ class or JSON. Several coupled
/// contacts cannot be written in Faust: throws std::logic_error for it.
[[nodiscard]] std::string emit(const Emitter& emitter, const InstrumentModel& model, double max_frequency_hz,
                               std::string_view command);

}  // namespace contactspline
