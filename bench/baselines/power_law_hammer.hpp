// SPDX-License-Identifier: MIT
// What a baseline needs to know of a hammer and its felt.
#pragma once

namespace contactspline::bench {

/// A hammer whose felt follows the power law F = stiffness y^exponent.
struct PowerLawHammer {
  double stiffness_n_per_m_alpha;
  double exponent;  ///< >= 1
  double mass_kg;
};

}  // namespace contactspline::bench
