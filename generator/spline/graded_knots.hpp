// SPDX-License-Identifier: MIT
// Graded knots and their forces, for a range of impacts (docs/how-it-works/knots.md). Compression and force are
// relative to the largest ones; the mass is 1.
#pragma once

#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// The knots, except the first one, are in geometric progression up to 1. All forces, the first and the second knot
/// minimise the mean square of the errors of contact duration and max compression, the latter weighted by 0.3.
/// Above kMaxFittedSegments the widths are in geometric progression from 0, and the forces are those of
/// force_between(). A law with breaks has its knots where it bends, one at each kink (knots_for_kinks.hpp), or
/// uniform knots if these are better. segments >= 1.
[[nodiscard]] PiecewiseLinearForce graded_knots(int segments, const FitTarget& target);

}  // namespace contactspline
