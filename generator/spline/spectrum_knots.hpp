// SPDX-License-Identifier: MIT
// Knots that make the error of the spectrum of impacts small (docs/knots.md).
#pragma once

#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// Widths in proportion to (y + offset)^growth, with the forces of force_between(). Tries many offsets, with a growth
/// of 1.5 and of 3, and returns the force whose spectra have the smallest root-mean-square error. A law with breaks
/// also tries knots at its kinks (unfitted_knots_for_kinks) with many first knots. segments >= 1.
[[nodiscard]] PiecewiseLinearForce spectrum_knots(int segments, const FitTarget& target);

}  // namespace contactspline
