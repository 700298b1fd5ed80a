// SPDX-License-Identifier: MIT
// The least-squares fit of a piecewise-linear force to a target, and the steps that the first guesses of the fits
// share (graded_knots.cpp, knots_for_kinks.cpp, minimax_knots.cpp).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// Force at a knot y between the knots `before` and `after`, such that the mean error of the chords is 0: F - h^2
/// F''/12 for neighbours at distance h, at least F/2. A chord of a convex force lies above it, by h^2 F''/12 on
/// average.
[[nodiscard]] double force_between(const FitTarget& target, double before, double y, double after);

/// Lowers each force that is above a later one: between any two knots the force then rises at least like y^0.001.
[[nodiscard]] PiecewiseLinearForce make_monotone(PiecewiseLinearForce force);

/// Sets the first force so that the slowest impact, on the first segment alone, lasts as long as in the target.
/// Leaves the force as it is if the first force would exceed the second.
[[nodiscard]] PiecewiseLinearForce match_slowest_impact(PiecewiseLinearForce force, const FitTarget& target);

/// Inserts the first point of a coarser force before the first point, lowered to at most 0.95 of its knot and 0.9 of
/// its force.
[[nodiscard]] PiecewiseLinearForce insert_first_point(PiecewiseLinearForce force, const PiecewiseLinearForce& coarse);

/// Adds y to the logarithms of knots 1 to N - 1 and f to those of forces 1 to N, so that all of them stay positive.
[[nodiscard]] PiecewiseLinearForce moved(PiecewiseLinearForce force, std::span<const double> y,
                                         std::span<const double> f);

/// When a fit stops: after `max_steps`, or when a step reduces the sum of squares by a fraction less than `min_gain`.
struct StopCriterion {
  int max_steps;
  double min_gain = 0;
};

/// Minimises the sum of squares of the errors of contact duration and max compression (weighted by 0.3) at the given
/// energies, by the Levenberg-Marquardt method. The free parameters are all forces, the first knot and the second;
/// the knots between the second and knot `end` move with the second one.
[[nodiscard]] PiecewiseLinearForce least_squares(PiecewiseLinearForce force, std::size_t end, const FitTarget& target,
                                                 const std::vector<double>& log_energies, StopCriterion stop);

}  // namespace contactspline
