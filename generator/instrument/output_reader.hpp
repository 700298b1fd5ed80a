// SPDX-License-Identifier: MIT
// Outputs, input and presets of an instrument file.
#pragma once

#include "generator/instrument/instrument_draft.hpp"

namespace contactspline {

/// Reads `outputs`.
void read_outputs(InstrumentDraft& draft);

/// Reads `input`, if there is one.
void read_input(InstrumentDraft& draft);

/// Reads `presets`: values of all parameters of the model.
void read_presets(InstrumentDraft& draft);

}  // namespace contactspline
