// SPDX-License-Identifier: MIT
// Knots that make the worst error of the contact duration as small as possible (docs/how-it-works/knots.md).
#pragma once

#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// Minimises the worst error of the contact duration, starting from the graded knots. At the minimum the error has
/// that magnitude 2 N times, with alternating signs (Newton's method on the alternating extrema, after Remez). Never
/// worse than the graded knots. 1 to kMaxFittedSegments.
[[nodiscard]] PiecewiseLinearForce minimax_knots(int segments, const FitTarget& target);

}  // namespace contactspline
