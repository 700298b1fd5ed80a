// SPDX-License-Identifier: MIT
// Contacts, springs and rigid links of an instrument file.
#pragma once

#include "generator/instrument/instrument_draft.hpp"
#include "generator/instrument/moved_masses.hpp"
#include "generator/material/contact_reader.hpp"
#include "generator/spline/designed_materials.hpp"

namespace contactspline {

/// Reads `contacts`, `springs`, `links` and `frictions` between the places. `materials` has those that contacts name;
/// `read` reads files of frictions.
void read_connections(InstrumentDraft& draft, DesignedMaterials& materials, MovedMasses& masses,
                      const ReadFile& read);

}  // namespace contactspline
