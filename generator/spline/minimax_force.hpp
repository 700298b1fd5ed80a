// SPDX-License-Identifier: MIT
// Knots that make the worst error of the force as small as possible (docs/how-it-works/knots.md).
#pragma once

#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// Knots and forces with the smallest worst error of the force, for a law whose force is convex or concave
/// everywhere: the error has that magnitude at every knot and once between any two. For a law with breaks, the graded
/// force if that is better. 1 to kMaxFittedSegments.
[[nodiscard]] PiecewiseLinearForce minimax_force(int segments, const FitTarget& target);

}  // namespace contactspline
