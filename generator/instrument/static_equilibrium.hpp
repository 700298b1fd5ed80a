// SPDX-License-Identifier: MIT
// Where an instrument rests.
#pragma once

#include <vector>

#include "contactspline/data/instrument_data.hpp"

namespace contactspline {

/// What counts displacements from where an instrument rests.
struct StaticEquilibrium {
  std::vector<double> gaps_m;       ///< of the connections: as they are at rest, less the shifts of controls
  std::vector<double> forces_n;     ///< of the connections at rest
  std::vector<HoldingForce> holds;  ///< of bodies other than free masses
};

/// Where an instrument rests under its pressed contacts, strained springs and links, and the first values of its
/// controls. The gaps stay as they are where all balances at displacement 0 or where nothing holds a mass within 0.1
/// m (docs/how-it-works/several-contacts.md). Numbers are rounded to 13 digits.
[[nodiscard]] StaticEquilibrium static_equilibrium(const InstrumentData& data);

}  // namespace contactspline
