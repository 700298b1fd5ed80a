// SPDX-License-Identifier: MIT
// Keys of an instrument file.
#pragma once

#include "generator/instrument/instrument_draft.hpp"

namespace contactspline {

/// Reads `keys`, `polyphony` and `damper`, with the parameters that they bring: sustain and bend.
void read_keys(InstrumentDraft& draft);

}  // namespace contactspline
