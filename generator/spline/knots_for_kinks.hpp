// SPDX-License-Identifier: MIT
// Graded knots for laws with breaks: knots where the law bends, one at each kink.
#pragma once

#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// The density of the knots keeps the relative error of all chords about equal; for a power law that is a geometric
/// progression. There is one knot at each kink, where the stored energy is that of the law. Forces and first knots
/// are fitted as in graded_knots(), from several guesses; the best fit is returned. 1 to kMaxFittedSegments.
[[nodiscard]] PiecewiseLinearForce knots_for_kinks(int segments, const FitTarget& target);

/// The same knots for any number of segments, without fitted forces. `first`: the first knot, in compressions of the
/// slowest impact; by default so low that no force needs a fit.
[[nodiscard]] PiecewiseLinearForce unfitted_knots_for_kinks(int segments, const FitTarget& target,
                                                            double first = 0.03);

/// The paper's uniform knots: the spline has the law's potential at each knot, by the paper's recursion. The force
/// rises only if that spline is convex.
[[nodiscard]] PiecewiseLinearForce recursion_force(int segments, const FitTarget& target);

/// The force with the smaller worst_duration_error. A force that does not rise is never chosen over one that does.
[[nodiscard]] PiecewiseLinearForce better_of(const PiecewiseLinearForce& one, const PiecewiseLinearForce& other,
                                             const FitTarget& target);

}  // namespace contactspline
