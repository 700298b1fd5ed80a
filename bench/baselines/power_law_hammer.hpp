// SPDX-License-Identifier: MIT
// Parameters of a hammer and its felt for the baselines.
#pragma once

namespace contactspline::bench {

/// A hammer whose felt follows the power law F = stiffness y^exponent.
struct PowerLawHammer {
  double stiffness_n_per_m_alpha;
  double exponent;  ///< >= 1
  double mass_kg;
};

}  // namespace contactspline::bench
