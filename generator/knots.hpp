// SPDX-License-Identifier: MIT
// Where the knots of a spline lie and which forces stand there, for a range of impacts (docs/knots.md). In pure
// numbers: compression and force as parts of the largest ones, a unit mass.
#pragma once

#include <functional>
#include <vector>

#include "generator/force_line.hpp"

namespace contactspline {

/// A compression at which a law is not smooth, with the energy stored there: a kink where a layer begins to act.
struct Break {
  double compression, energy;
  bool kink;
};

/// What a fit aims at.
struct FitTarget {
  std::function<double(double)> force;          ///< at a compression from 0 to 1; force(1) = 1, rising
  std::function<double(double)> compression;    ///< the largest, of a contact with a kinetic energy
  std::function<double(double)> half_duration;  ///< of that contact
  double least_compression;                     ///< of the slowest impact; the fastest reaches 1
  double least_energy, most_energy;
  std::vector<Break> breaks = {};  ///< by rising compression, all below 1
};

/// Relative error of half the contact duration at a local extremum over the energies; positive where it is too long.
struct DurationError {
  double log_energy, error;
};

/// Every local extremum of the error of the contact duration between least and most energy, the two ends included, by
/// rising energy. `points`: samples a segment before refinement.
[[nodiscard]] std::vector<DurationError> duration_errors(const ForceLine& line, const FitTarget& target,
                                                         int points = 6);

/// The largest magnitude of duration_errors.
[[nodiscard]] double worst_duration_error(const ForceLine& line, const FitTarget& target);

/// Most segments whose forces are fitted to the contact duration.
constexpr int kMostFittedSegments = 128;

/// Knots in geometric progression up to 1, but for the first one; all forces, the first and the second knot such that
/// the errors of contact duration and max compression are least in the mean square, the latter weighed by 0.3. Above
/// kMostFittedSegments widths in geometric progression from 0 on, and forces off the law by two thirds of what a
/// chord is. Where the law has breaks knots lie where it bends, one at each kink (needed_line.hpp), or uniformly
/// where that is better. segments >= 1.
[[nodiscard]] ForceLine graded_line(int segments, const FitTarget& target);

/// Knots and forces that make the worst error of the contact duration least, from the graded line on: where the
/// method ends it reaches that size 2 N times, with alternating signs (Newton's method on the alternating extrema,
/// after Remez). Never worse than the graded line. 1 to kMostFittedSegments.
[[nodiscard]] ForceLine optimal_line(int segments, const FitTarget& target);

/// Knots and forces that make the worst error of the force least, for a force that is convex or concave throughout:
/// the error reaches that size at every knot and once between any two. Where the law has breaks, the graded line if
/// that is better. 1 to kMostFittedSegments.
[[nodiscard]] ForceLine least_force_error_line(int segments, const FitTarget& target);

}  // namespace contactspline
