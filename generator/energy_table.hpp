// SPDX-License-Identifier: MIT
// Functions of energy that are dear to compute, tabulated for a fit.
#pragma once

#include "generator/knots.hpp"

namespace contactspline {

/// The same target, its compressions and durations interpolated in tables between its breaks, to about 1e-8. For
/// laws without closed forms, which take a quadrature for every duration, of which a fit needs thousands.
[[nodiscard]] FitTarget tabulated(FitTarget target);

}  // namespace contactspline
