// SPDX-License-Identifier: MIT
// Controls, strikes and plucks of an instrument file.
#pragma once

#include "generator/instrument/instrument_draft.hpp"
#include "generator/instrument/moved_masses.hpp"

namespace contactspline {

/// Reads `strikes` and `controls`: the parameters of the model, first those of the controls, and its events.
void read_controls(InstrumentDraft& draft, MovedMasses& masses);

}  // namespace contactspline
