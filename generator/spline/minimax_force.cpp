// SPDX-License-Identifier: MIT
#include "generator/spline/minimax_force.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "generator/spline/golden_section.hpp"
#include "generator/spline/graded_knots.hpp"

namespace contactspline {
namespace {

// End of the longest chord from (y, f) whose error stays within `max`; the end lies `shift` above the force of the
// law. At most 1. `bend` is 1 for a convex force, -1 for a concave one.
double chord_end(const FitTarget& target, double y, double f, double shift, double max, double bend) {
  const auto gap = [&](double end) {
    const double slope = (target.force(end) + shift - f) / (end - y);
    return find_maximum(y, end, 40, [&](double at) { return bend * (f + slope * (at - y) - target.force(at)); })
        .value;
  };
  if (gap(1) <= max) return 1;
  double low = y, high = 1;
  for (int i = 0; i < 52; ++i) {
    const double middle = (low + high) / 2;
    (gap(middle) > max ? high : low) = middle;
  }
  return low;
}

// A force from (0, 0) to compression 1 whose error is `error` at every knot and once between any two. Nothing if that
// takes more segments.
std::optional<PiecewiseLinearForce> equal_error_force(int segments, const FitTarget& target, double error) {
  const double bend = 2 * target.force(0.5) < target.force(1) ? 1 : -1;
  const double shift = -bend * error;  // the chords of a convex force lie above it
  PiecewiseLinearForce force{{0}, {0}};
  for (int j = 1; j <= segments; ++j) {
    const double y = chord_end(target, force.y.back(), force.f.back(), shift, error, bend);
    force.y.push_back(y);
    force.f.push_back(target.force(y) + shift);
    if (y < 1) continue;
    return force.rises() ? std::optional(force) : std::nullopt;
  }
  return std::nullopt;
}

double worst_force_error(const PiecewiseLinearForce& force, const FitTarget& target) {
  constexpr int kPoints = 64;  // per segment
  double worst = 0;
  for (std::size_t j = 0; j < force.segments(); ++j)
    for (int i = 1; i <= kPoints; ++i) {
      const double t = static_cast<double>(i) / kPoints;
      const double exact = target.force(std::lerp(force.y[j], force.y[j + 1], t));
      worst = std::max(worst, std::abs(std::lerp(force.f[j], force.f[j + 1], t) - exact));
    }
  return worst;
}

}  // namespace

PiecewiseLinearForce minimax_force(int segments, const FitTarget& target) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {  // bisects down to rounding
    const double middle = (low + high) / 2;
    (equal_error_force(segments, target, middle) ? high : low) = middle;
  }
  PiecewiseLinearForce force = *equal_error_force(segments, target, high);
  if (target.breaks.empty()) return force;
  // Graded knots are better for a law that is partly convex and partly concave.
  PiecewiseLinearForce graded = graded_knots(segments, target);
  return worst_force_error(graded, target) < worst_force_error(force, target) ? graded : force;
}

}  // namespace contactspline
