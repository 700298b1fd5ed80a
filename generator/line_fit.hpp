// SPDX-License-Identifier: MIT
// What fits of a force line share: where they look, how they guess a force, how they move points (knots.cpp,
// needed_line.cpp).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "generator/knots.hpp"

namespace contactspline {

/// Logarithms of the energies at which a line is looked at: the ends of the range, the knots and the law's breaks
/// between them, `points` even steps from each to the next; closer and closer to a kink.
[[nodiscard]] std::vector<double> sampled_log_energies(const ForceLine& line, const FitTarget& target, int points);

/// Force at a knot between two others, such that the chords to them are right on average. A chord lies above a convex
/// force, by two thirds of the most on average.
[[nodiscard]] double force_between(const FitTarget& target, double before, double y, double after);

/// Lowers forces that a later one falls below: between any two knots they rise at least like y^0.001.
[[nodiscard]] ForceLine made_rising(ForceLine line);

/// A line whose points move by logarithms, so that all stay positive: knots 1 to N - 1, forces 1 to N.
[[nodiscard]] ForceLine moved(ForceLine line, const Eigen::VectorXd& y, const Eigen::VectorXd& f);

/// How long a fit goes on: so many steps at most, until one gains less than `settled` of the sum of squares.
struct Patience {
  int steps;
  double settled = 0;
};

/// The errors of contact duration and max compression (weighed by 0.3) at these energies made least in the mean
/// square, by Levenberg's and Marquardt's method: moves all forces, the first knot and the second; knots between that
/// and `end` are taken along.
[[nodiscard]] ForceLine least_squares(ForceLine line, std::size_t end, const FitTarget& target,
                                      const std::vector<double>& log_energies, Patience patience);

}  // namespace contactspline
