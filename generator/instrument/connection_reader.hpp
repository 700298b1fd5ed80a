// SPDX-License-Identifier: MIT
// Contacts, springs and rigid links of an instrument file.
#pragma once

#include "generator/instrument/instrument_draft.hpp"
#include "generator/instrument/moved_masses.hpp"
#include "generator/spline/designed_materials.hpp"

namespace contactspline {

/// Reads `contacts`, `springs` and `links` between the places. `materials` has those that contacts name.
void read_connections(InstrumentDraft& draft, DesignedMaterials& materials, MovedMasses& masses);

}  // namespace contactspline
