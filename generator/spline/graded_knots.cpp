// SPDX-License-Identifier: MIT
#include "generator/spline/graded_knots.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "generator/spline/knots_for_kinks.hpp"
#include "generator/spline/least_squares.hpp"
#include "generator/support/interpolation.hpp"

namespace contactspline {
namespace {

// Knots in geometric progression, with the forces of force_between().
PiecewiseLinearForce geometric_knots(int segments, double first, const FitTarget& target) {
  PiecewiseLinearForce force{{0}, {0}};
  const double ratio = segments == 1 ? 2 : std::pow(1 / first, 1.0 / (segments - 1));
  for (int j = 1; j <= segments; ++j) {
    const double y = j == segments ? 1 : first * std::pow(ratio, j - 1);
    force.y.push_back(y);
    force.f.push_back(force_between(target, y / ratio, y, y * ratio));
  }
  return force;
}

// A first guess for few segments.
PiecewiseLinearForce coarse_guess(int segments, const FitTarget& target) {
  const double first = std::min(0.85 * target.min_compression, 0.95);
  return make_monotone(match_slowest_impact(geometric_knots(segments, first, target), target));
}

// A first guess for many segments, from a fit with fewer: the first point of that fit, then forces whose ratio to
// those of force_between() is interpolated from that fit.
PiecewiseLinearForce refined_guess(int segments, const PiecewiseLinearForce& coarse, const FitTarget& target) {
  const double ratio = coarse.y[3] / coarse.y[2];
  std::vector<double> x, ratios;
  for (std::size_t j = 1; j < coarse.y.size(); ++j) {
    x.push_back(std::log(coarse.y[j]));
    ratios.push_back(coarse.f[j] / force_between(target, coarse.y[j] / ratio, coarse.y[j], coarse.y[j] * ratio));
  }
  PiecewiseLinearForce force = geometric_knots(segments - 1, coarse.y[2] * std::pow(ratio, -0.3), target);
  for (std::size_t j = 1; j < force.y.size(); ++j) force.f[j] *= interpolated_within(x, ratios, std::log(force.y[j]));
  return make_monotone(insert_first_point(std::move(force), coarse));
}

PiecewiseLinearForce smooth_graded_knots(int segments, const FitTarget& target) {
  constexpr int kMaxCoarse = 8, kSteps = 40, kPoints = 6;  // energies per segment
  const PiecewiseLinearForce guess = segments <= kMaxCoarse
                                         ? coarse_guess(segments, target)
                                         : refined_guess(segments, smooth_graded_knots(segments / 2, target), target);
  const double low = std::log(target.min_energy), high = std::log(target.max_energy);
  const int points = kPoints * (segments + 1);
  std::vector<double> energies;
  for (int i = 0; i < points; ++i) energies.push_back(low + (high - low) * i / (points - 1));
  return least_squares(guess, guess.segments(), target, energies, {kSteps});
}

// For very many segments: the widths are in geometric progression and begin far below the compression of the slowest
// impact, so the forces need no fit.
PiecewiseLinearForce fine_knots(int segments, const FitTarget& target) {
  const double offset = 0.03 * target.min_compression;
  const double rate = std::log1p(1 / offset) / segments;
  const auto knot = [&](int j) { return j == segments ? 1 : offset * std::expm1(rate * j); };
  PiecewiseLinearForce force{{0}, {0}};
  for (int j = 1; j <= segments; ++j) {
    force.y.push_back(knot(j));
    force.f.push_back(force_between(target, knot(j - 1), knot(j), offset * std::expm1(rate * (j + 1))));
  }
  return make_monotone(std::move(force));
}

}  // namespace

PiecewiseLinearForce graded_knots(int segments, const FitTarget& target) {
  constexpr int kMaxCoarse = 8;
  if (target.breaks.empty())
    return segments > kMaxFittedSegments ? fine_knots(segments, target) : smooth_graded_knots(segments, target);
  if (segments > kMaxFittedSegments) return unfitted_knots_for_kinks(segments, target);
  PiecewiseLinearForce force = knots_for_kinks(segments, target);
  if (segments <= kMaxCoarse) force = better_of(force, smooth_graded_knots(segments, target), target);
  return better_of(force, recursion_force(segments, target), target);
}

}  // namespace contactspline
