// SPDX-License-Identifier: MIT
#include "generator/spline/spectrum_knots.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "generator/spline/graded_knots.hpp"
#include "generator/spline/knots_for_kinks.hpp"
#include "generator/spline/least_squares.hpp"
#include "generator/spline/spectrum_error.hpp"

namespace contactspline {
namespace {

PiecewiseLinearForce growing_widths(int segments, double offset, double growth, const FitTarget& target) {
  const double power = 1 - growth, from = std::pow(offset, power), to = std::pow(offset + 1, power);
  const auto knot = [&](int j) {
    return j == 0 ? 0.0 : j == segments ? 1.0 : std::pow(from + (to - from) * j / segments, 1 / power) - offset;
  };
  PiecewiseLinearForce force{{0}, {0}};
  for (int j = 1; j <= segments; ++j) {
    const double before = knot(j - 1), y = knot(j), after = j < segments ? knot(j + 1) : 2 * y - before;
    force.y.push_back(y);
    force.f.push_back(force_between(target, before, y, after));
  }
  return make_monotone(std::move(force));
}

/// Keeps the force with the smallest error among those tried.
class BestForce {
 public:
  explicit BestForce(const FitTarget& target) : exact_(target, kSpeeds) {}

  /// True if this force is the best so far.
  bool improves(PiecewiseLinearForce force) {
    const double error = force.rises() ? exact_.rms_error_of(force) : std::numeric_limits<double>::infinity();
    if (!force_.y.empty() && !(error < error_)) return false;
    error_ = error;
    force_ = std::move(force);
    return true;
  }
  [[nodiscard]] const PiecewiseLinearForce& force() const { return force_; }

 private:
  static constexpr int kSpeeds = 64;

  ExactSpectra exact_;
  PiecewiseLinearForce force_;
  double error_ = std::numeric_limits<double>::infinity();
};

// Offsets in steps of a factor of 2, then in two smaller steps to either side of the best one.
void try_growing_widths(int segments, const FitTarget& target, BestForce& best) {
  for (const double growth : {1.5, 3.0}) {
    double exponent = 0;
    const auto is_better = [&](double tried) {
      return best.improves(growing_widths(segments, std::exp2(tried), growth, target));
    };
    for (int tried = -8; tried <= 3; ++tried)
      if (is_better(tried)) exponent = tried;
    for (const double step : {0.5, 0.25})
      for (const double tried : {exponent - step, exponent + step})
        if (is_better(tried)) exponent = tried;
  }
}

}  // namespace

PiecewiseLinearForce spectrum_knots(int segments, const FitTarget& target) {
  constexpr int kMaxCoarse = 8;
  BestForce best(target);
  try_growing_widths(segments, target, best);
  if (segments <= kMaxCoarse || !target.breaks.empty()) best.improves(graded_knots(segments, target));
  if (!target.breaks.empty())
    for (double first = 1; first > 0.03; first /= std::numbers::sqrt2)
      best.improves(unfitted_knots_for_kinks(segments, target, first));
  return best.force();
}

}  // namespace contactspline
