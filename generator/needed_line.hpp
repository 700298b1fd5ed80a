// SPDX-License-Identifier: MIT
// Graded lines for laws with breaks: knots where the law bends, one at each kink.
#pragma once

#include "generator/knots.hpp"

namespace contactspline {

/// Knots as dense as a chord needs that stays within some part of the force, which for a power law is a geometric
/// progression; one at each kink, where the line stores what the law does. Forces and first knots as in graded_line,
/// by least squares from several guesses, the best of which is taken. 1 to kMostFittedSegments.
[[nodiscard]] ForceLine needed_line(int segments, const FitTarget& target);

/// The same knots for any number of segments, their forces not fitted.
[[nodiscard]] ForceLine unfitted_needed_line(int segments, const FitTarget& target);

/// What the paper's uniform knots come to: each potential met, by its recursion; it rises only where that is convex.
[[nodiscard]] ForceLine recursion_line(int segments, const FitTarget& target);

/// Of two lines the one with the lesser worst_duration_error; one that does not rise is no choice.
[[nodiscard]] ForceLine better_of(ForceLine one, ForceLine other, const FitTarget& target);

}  // namespace contactspline
