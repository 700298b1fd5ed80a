// SPDX-License-Identifier: MIT
// The instrument of a plan.
#pragma once

#include "generator/material/contact_reader.hpp"
#include "generator/player/instrument_maker.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// Reads the keys `instrument` and `parts` of a plan: hammer_string, mass_barrier or piano with what they are made
/// of, an instrument that ships, an instrument file, or an object with the keys of one. Throws BadInput.
[[nodiscard]] InstrumentMaker read_plan_instrument(const JsonObject& plan, const ReadFile& read);

}  // namespace contactspline
