// SPDX-License-Identifier: MIT
// Contacts, springs and rigid links of an instrument file.
#pragma once

#include "generator/instrument/instrument_draft.hpp"
#include "generator/instrument/moved_masses.hpp"
#include "generator/material/contact_reader.hpp"

namespace contactspline {

/// Reads `contacts`, `springs` and `links` between the places. `read` reads the materials that contacts name.
void read_connections(InstrumentDraft& draft, const ReadFile& read, MovedMasses& masses);

}  // namespace contactspline
