// SPDX-License-Identifier: MIT
// The error of the contact duration of a piecewise-linear force over the energies of a fit target.
#pragma once

#include <vector>

#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// A local extremum of the relative error of the contact duration. The error is positive if the duration is too long.
struct DurationError {
  double log_energy, error;
};

/// All local extrema of the error of the contact duration between the target's min_energy and max_energy, including
/// both ends, by rising energy. `points`: samples per segment before the extrema are refined.
[[nodiscard]] std::vector<DurationError> duration_errors(const PiecewiseLinearForce& force, const FitTarget& target,
                                                         int points = 6);

/// Logarithms of the energies at which a force is sampled, in rising order: the ends of the range, the knots and the
/// law's breaks between them, and `points` equal steps from each of these to the next. Towards a kink there are more.
[[nodiscard]] std::vector<double> sampled_log_energies(const PiecewiseLinearForce& force, const FitTarget& target,
                                                       int points);

/// The largest magnitude of duration_errors().
[[nodiscard]] double worst_duration_error(const PiecewiseLinearForce& force, const FitTarget& target);

/// The largest magnitude of these errors; infinite if any of them is not finite.
[[nodiscard]] double worst_of(const std::vector<DurationError>& errors);

}  // namespace contactspline
