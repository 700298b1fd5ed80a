// SPDX-License-Identifier: MIT
#include "generator/spline/spectrum_knots.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "generator/spline/knots_for_kinks.hpp"
#include "generator/spline/least_squares.hpp"
#include "generator/spline/spectrum_error.hpp"

namespace contactspline {
namespace {

PiecewiseLinearForce growing_widths(int segments, double offset, double growth, const FitTarget& target) {
  const double power = 1 - growth, from = std::pow(offset, power), to = std::pow(offset + 1, power);
  const auto knot = [&](int j) {
    return j == 0          ? 0.0
           : j == segments ? 1.0
                           : std::pow(from + (to - from) * j / segments, 1 / power) - offset;
  };
  PiecewiseLinearForce force{{0}, {0}};
  for (int j = 1; j <= segments; ++j) {
    const double before = knot(j - 1), y = knot(j), after = j < segments ? knot(j + 1) : 2 * y - before;
    force.y.push_back(y);
    force.f.push_back(force_between(target, before, y, after));
  }
  return make_monotone(std::move(force));
}

}  // namespace

PiecewiseLinearForce spectrum_knots(int segments, const FitTarget& target) {
  constexpr int kSteps = 4;  // in a factor of 2
  const ExactSpectra exact(target);
  PiecewiseLinearForce best;
  double smallest = std::numeric_limits<double>::infinity();
  const auto try_force = [&](PiecewiseLinearForce force) {
    const double error = force.rises() ? exact.rms_error_of(force) : std::numeric_limits<double>::infinity();
    if (!best.y.empty() && !(error < smallest)) return;
    smallest = error;
    best = std::move(force);
  };
  for (int step = -8 * kSteps; step <= 3 * kSteps; ++step)
    for (const double growth : {1.5, 3.0})
      try_force(growing_widths(segments, std::exp2(static_cast<double>(step) / kSteps), growth, target));
  if (!target.breaks.empty())
    for (int step = -5 * kSteps; step <= 0; ++step)
      try_force(unfitted_knots_for_kinks(segments, target, std::exp2(static_cast<double>(step) / kSteps)));
  return best;
}

}  // namespace contactspline
