// SPDX-License-Identifier: MIT
// Bodies and places of an instrument file.
#pragma once

#include "generator/instrument/instrument_draft.hpp"
#include "generator/material/contact_reader.hpp"

namespace contactspline {

/// Reads `bodies` and `places`. `read` reads the resonators that the bodies name.
void read_bodies(InstrumentDraft& draft, const ReadFile& read);

}  // namespace contactspline
