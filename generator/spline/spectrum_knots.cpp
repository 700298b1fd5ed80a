// SPDX-License-Identifier: MIT
#include "generator/spline/spectrum_knots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "generator/spline/graded_knots.hpp"
#include "generator/spline/knots_for_kinks.hpp"
#include "generator/spline/least_squares.hpp"
#include "generator/spline/spectrum_error.hpp"
#include "generator/spline/spline_error.hpp"

namespace contactspline {
namespace {

// The compression up to which a measured curve has no force.
double slack_of(const FitTarget& target) {
  double slack = 0;
  for (const Break& at : target.breaks)
    if (at.energy == 0) slack = at.compression;
  return slack;
}

// Widths in proportion to (y + offset)^growth, from where the force begins.
PiecewiseLinearForce growing_widths(int segments, double offset, double growth, const FitTarget& target) {
  const double power = 1 - growth, from = std::pow(offset, power), to = std::pow(offset + 1, power);
  const double slack = slack_of(target);
  const auto knot = [&](int j) {
    if (j == 0 || j == segments) return j == 0 ? 0.0 : 1.0;
    return slack + (1 - slack) * (std::pow(from + (to - from) * j / segments, 1 / power) - offset);
  };
  PiecewiseLinearForce force{{0}, {0}};
  for (int j = 1; j <= segments; ++j) {
    const double before = knot(j - 1), y = knot(j), after = j < segments ? knot(j + 1) : 2 * y - before;
    force.y.push_back(y);
    force.f.push_back(force_between(target, before, y, after));
  }
  return make_monotone(std::move(force));
}

constexpr double kMaxDurationError = 0.001;  // relative

/// Keeps the force with the smallest error among those tried: the root mean square of the spectra's differences, and
/// beside it the error of the contact duration beyond 0.1 %, a hundredfold.
class BestForce {
 public:
  explicit BestForce(const FitTarget& target) : exact_(target, kSpeeds, kExactSegments) {
    for (int i = 0; i < kSpeeds; ++i) {
      energies_.push_back(target.min_energy * std::pow(target.max_energy / target.min_energy, i / (kSpeeds - 1.0)));
      half_durations_.push_back(target.half_duration(energies_.back()));
    }
  }

  /// The error of a force, infinite if it does not rise. Keeps the force if it is the best so far.
  double try_force(PiecewiseLinearForce force) {
    constexpr double kWeight = 100;
    const double duration = force.rises() ? worst_duration(force) : std::numeric_limits<double>::infinity();
    const double excess = std::max(0.0, duration - kMaxDurationError);
    const double error = std::isfinite(excess) ? std::hypot(exact_.rms_error_of(force), kWeight * excess) : excess;
    if (force_.y.empty() || error < error_) {
      error_ = error;
      duration_ = duration;
      force_ = std::move(force);
    }
    return error;
  }
  [[nodiscard]] const PiecewiseLinearForce& force() const { return force_; }
  [[nodiscard]] double worst_duration() const { return duration_; }

 private:
  static constexpr int kSpeeds = 64, kExactSegments = 256;

  [[nodiscard]] double worst_duration(const PiecewiseLinearForce& force) const {
    double worst = 0;
    for (std::size_t i = 0; i < energies_.size(); ++i)
      worst = worse(worst, half_duration(force, energies_[i]) / half_durations_[i] - 1);
    return worst;
  }

  ExactSpectra exact_;
  std::vector<double> energies_, half_durations_;
  PiecewiseLinearForce force_;
  double error_ = std::numeric_limits<double>::infinity(), duration_ = error_;
};

// Climbs to the best offset from a usual one, first in steps of a factor of 2, then in smaller ones.
void try_growing_widths(int segments, double growth, double usual_exponent, const FitTarget& target,
                        BestForce& best) {
  constexpr double kMin = -8, kMax = 3;
  double exponent = usual_exponent, error = std::numeric_limits<double>::infinity();
  const auto is_better = [&](double tried) {
    if (tried < kMin || tried > kMax) return false;
    const double found = best.try_force(growing_widths(segments, std::exp2(tried), growth, target));
    if (!(found < error)) return false;
    exponent = tried;
    error = found;
    return true;
  };
  is_better(exponent);
  for (const double step : {1.0, 0.5, 0.25})
    for (const double direction : {-step, step})
      while (is_better(exponent + direction)) {
      }
}

}  // namespace

PiecewiseLinearForce spectrum_knots(int segments, const FitTarget& target) {
  BestForce best(target);
  try_growing_widths(segments, 1.5, -2, target, best);
  try_growing_widths(segments, 3, 0, target, best);
  if (!target.breaks.empty() || !(best.worst_duration() <= kMaxDurationError))
    best.try_force(graded_knots(segments, target));
  if (!target.breaks.empty())
    for (double first = 1; first > 0.03; first /= std::numbers::sqrt2)
      best.try_force(unfitted_knots_for_kinks(segments, target, first));
  return best.force();
}

}  // namespace contactspline
