// SPDX-License-Identifier: MIT
// Knots that make the error of the spectrum of impacts small (docs/how-it-works/knots.md).
#pragma once

#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// Widths in proportion to (y + offset)^growth, with the forces of force_between(). Searches the offset for a growth
/// of 1.5 and of 3 and returns the force with the smallest error: the root mean square of the spectra's differences,
/// and beside it a hundred times the worst error of the contact duration beyond 0.1 %. Also tries graded knots if the
/// contact duration is off by more than 0.1 % or the law has breaks, and for a law with breaks knots at its kinks
/// (unfitted_knots_for_kinks) with several first knots. segments >= 1.
[[nodiscard]] PiecewiseLinearForce spectrum_knots(int segments, const FitTarget& target);

}  // namespace contactspline
