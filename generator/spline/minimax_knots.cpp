// SPDX-License-Identifier: MIT
#include "generator/spline/minimax_knots.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "generator/spline/duration_error.hpp"
#include "generator/spline/graded_knots.hpp"
#include "generator/spline/least_squares.hpp"

namespace contactspline {
namespace {

using Eigen::Index;

// Removes the least prominent extrema, two neighbours at a time, until at most `max` are left. Signs still alternate.
void keep_alternating(std::vector<DurationError>& extrema, std::size_t max) {
  while (extrema.size() > max) {
    std::size_t flattest = 0;
    const auto height = [&](std::size_t i) { return std::abs(extrema[i + 1].error - extrema[i].error); };
    for (std::size_t i = 1; i + 1 < extrema.size(); ++i)
      if (height(i) < height(flattest)) flattest = i;
    const auto at = extrema.begin() + static_cast<std::ptrdiff_t>(flattest);
    if (flattest == 0)
      extrema.erase(at);
    else if (flattest + 2 == extrema.size())
      extrema.pop_back();
    else
      extrema.erase(at, at + 2);
  }
}

// Aim of a step if there are fewer alternating extrema than unknowns: errors of one magnitude, or no errors.
enum class Aim { kEqualErrors, kNoErrors };

// Newton's step for the logarithms of knots and forces, and for the magnitude of the errors, towards errors of one
// magnitude with alternating signs. If the equations are fewer than the unknowns it is the shortest step for the aim.
Eigen::VectorXd equioscillation_step(const PiecewiseLinearForce& force, const FitTarget& target,
                                     const std::vector<DurationError>& extrema, Aim aim) {
  const auto n = static_cast<Index>(force.segments());
  const auto rows = static_cast<Index>(extrema.size());
  Eigen::MatrixXd jacobian(rows, 2 * n);
  Eigen::VectorXd errors(rows);
  PiecewiseLinearForce gradient;
  for (Index i = 0; i < rows; ++i) {
    const double energy = std::exp(extrema[static_cast<std::size_t>(i)].log_energy);
    const double exact = target.half_duration(energy);
    errors(i) = half_duration(force, energy, &gradient) / exact - 1;
    for (Index j = 0; j < n; ++j) {
      const auto at = static_cast<std::size_t>(j) + 1;
      if (j + 1 < n) jacobian(i, j) = gradient.y[at] * force.y[at] / exact;
      jacobian(i, n - 1 + j) = gradient.f[at] * force.f[at] / exact;
    }
    jacobian(i, 2 * n - 1) = i % 2 == 0 ? 1 : -1;
  }
  if (rows == 2 * n) return jacobian.partialPivLu().solve(-errors);
  if (aim == Aim::kNoErrors) jacobian.col(2 * n - 1).setZero();
  return jacobian.completeOrthogonalDecomposition().solve(-errors);
}

/// A force and the extrema of its error.
struct EquioscillatingFit {
  PiecewiseLinearForce force;
  std::vector<DurationError> extrema;
  double worst;

  EquioscillatingFit(PiecewiseLinearForce candidate, const FitTarget& target)
      : force(std::move(candidate)), extrema(duration_errors(force, target)), worst(worst_of(extrema)) {}
};

// Halves the step until it reduces the worst error. Nothing if no step longer than 1e-4 does.
std::optional<EquioscillatingFit> line_search(const EquioscillatingFit& at, const FitTarget& target,
                                              const Eigen::VectorXd& step) {
  const std::size_t n = at.force.segments();
  for (double fraction = 1; fraction > 1e-4; fraction /= 2) {
    const Eigen::VectorXd part = fraction * step;
    PiecewiseLinearForce force = moved(at.force, {part.data(), n - 1}, {part.data() + n - 1, n});
    if (!force.rises()) continue;
    EquioscillatingFit tried(std::move(force), target);
    if (tried.worst < at.worst) return tried;
  }
  return std::nullopt;
}

// Newton iterations until no step reduces the worst error, at most `iterations`.
EquioscillatingFit improved(EquioscillatingFit at, const FitTarget& target, Aim aim, int iterations) {
  const std::size_t n = at.force.segments();
  for (int i = 0; i < iterations; ++i) {
    auto alternating = at.extrema;
    keep_alternating(alternating, 2 * n);
    const Eigen::VectorXd step = equioscillation_step(at.force, target, alternating, aim);
    if (!step.allFinite()) break;
    auto next = line_search(at, target, step);
    if (!next) break;
    at = std::move(*next);
  }
  return at;
}

// The segment in which a mass with that kinetic energy turns.
std::size_t turning_segment(const PiecewiseLinearForce& force, double energy) {
  const std::vector<double> stored = force.energies();
  const auto above = std::upper_bound(stored.begin() + 1, stored.end() - 1, energy);
  return static_cast<std::size_t>(above - stored.begin()) - 1;
}

// The same force with one more knot, in the middle of the segment with the worst error.
PiecewiseLinearForce split_worst_segment(const EquioscillatingFit& at) {
  const auto height = [](const DurationError& e) { return std::abs(e.error); };
  const double energy = std::exp(std::ranges::max(at.extrema, {}, height).log_energy);
  PiecewiseLinearForce force = at.force;
  const auto j = static_cast<std::ptrdiff_t>(turning_segment(force, energy));
  for (auto* values : {&force.y, &force.f}) {
    const auto right = values->begin() + j + 1;
    values->insert(right, (*(right - 1) + *right) / 2);
  }
  return force;
}

// With breaks the iterations may end too early. So they also start from the best fit with one segment fewer and one
// inserted knot. Up to 14 segments this begins with one segment, so the error falls with every segment; for more
// segments it begins a few segments below, to save time.
PiecewiseLinearForce minimax_knots_with_breaks(int segments, const FitTarget& target) {
  const int steps = segments <= 32 ? 20 : 8;
  const int begin = segments <= 14 ? 1 : segments <= 32 ? segments - 7 : segments <= 48 ? segments - 1 : segments;
  const auto equioscillating = [&](PiecewiseLinearForce from) {
    return improved({std::move(from), target}, target, Aim::kEqualErrors, steps);
  };
  PiecewiseLinearForce graded = graded_knots(begin, target);
  EquioscillatingFit best = equioscillating(graded);
  for (int count = begin + 1; count <= segments; ++count) {
    graded = graded_knots(count, target);
    best = equioscillating(split_worst_segment(best));
    EquioscillatingFit other = equioscillating(graded);
    if (other.worst < best.worst) best = std::move(other);
  }
  constexpr int kFine = 24;  // points per segment, to find peaks that the iterations missed
  const auto worst = [&](const PiecewiseLinearForce& force) {
    return worst_of(duration_errors(force, target, kFine));
  };
  return worst(best.force) < worst(graded) ? best.force : graded;
}

}  // namespace

PiecewiseLinearForce minimax_knots(int segments, const FitTarget& target) {
  if (!target.breaks.empty()) return minimax_knots_with_breaks(segments, target);
  const bool is_affordable = segments <= 64;  // a second try takes too long for more
  const EquioscillatingFit graded(graded_knots(segments, target), target);
  EquioscillatingFit best = improved(graded, target, Aim::kEqualErrors, is_affordable ? 30 : 12);
  if (is_affordable && best.extrema.size() < 2 * best.force.segments())
    best = improved(improved(best, target, Aim::kNoErrors, 10), target, Aim::kEqualErrors, 30);
  return best.force;
}

}  // namespace contactspline
