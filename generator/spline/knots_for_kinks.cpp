// SPDX-License-Identifier: MIT
#include "generator/spline/knots_for_kinks.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "generator/spline/duration_error.hpp"
#include "generator/spline/least_squares.hpp"
#include "generator/support/interpolation.hpp"

namespace contactspline {
namespace {

/// The number of segments that a law needs from `low` to y, up to a factor: the integral of sqrt(|F''|/F), which for
/// a power law is proportional to log y. A chord of width h has the error h^2 F''/8, so equal steps of this integral
/// give equal relative errors.
struct KnotDensity {
  std::vector<double> y, sum;

  KnotDensity(double low, double high, const FitTarget& target) : y{low}, sum{0} {
    constexpr int kPoints = 400;
    constexpr double kMin = 0.15;  // gives a straight force some knots, too
    const auto point = [&](double i) { return low * std::pow(high / low, i / kPoints); };
    for (int i = 1; i < kPoints; ++i) {
      const double before = point(i - 1), at = point(i), after = point(i + 1), exact = target.force(at);
      const double left = (exact - target.force(before)) / (at - before);
      const double right = (target.force(after) - exact) / (after - at);
      const double bend = exact > 0 ? 2 * std::abs(right - left) / (after - before) : 0;  // a curve may begin with 0
      const double end = i + 1 == kPoints ? high : point(i + 0.5);
      sum.push_back(sum.back() + (end - y.back()) * std::max(bend > 0 ? std::sqrt(bend / exact) : 0, kMin / at));
      y.push_back(end);
    }
  }

  [[nodiscard]] double total() const { return sum.back(); }
  // The compression up to which the law needs this fraction of the segments.
  [[nodiscard]] double knot_at(double fraction) const { return interpolated_within(sum, y, fraction * total()); }
};

/// A force with its knots placed for a law, before or after the fit.
struct Guess {
  PiecewiseLinearForce force;
  std::vector<double> kinks;  ///< those that have a knot
  std::size_t end;            ///< the fit may move the knots before this one
};

bool is_among(const std::vector<double>& values, double value) {
  return std::ranges::find(values, value) != values.end();
}

// The kinks beyond the first knot, at most `max` of them: the sharpest ones.
std::vector<double> kinks_beyond(double first, int max, const FitTarget& target) {
  std::vector<double> kinks;
  for (const Break& at : target.breaks)
    if (at.kink && at.compression > 1.02 * first && at.compression < 0.9999) kinks.push_back(at.compression);
  const auto bend = [&](double y) {
    return (target.force(1.1 * y) - 2 * target.force(y) + target.force(0.9 * y)) / target.force(y);
  };
  std::ranges::stable_sort(kinks, std::greater<>(), bend);
  kinks.resize(std::min(kinks.size(), static_cast<std::size_t>(std::max(0, max))));
  std::ranges::sort(kinks);
  return kinks;
}

// Distributes the segments over the ranges between kinks: one to each, and each further one to the range with the
// widest segments.
std::vector<int> segment_counts(int segments, const std::vector<KnotDensity>& densities) {
  std::vector<int> counts(densities.size(), 1);
  for (int remaining = segments - static_cast<int>(densities.size()); remaining > 0; --remaining) {
    std::size_t widest = 0;
    const auto width = [&](std::size_t i) { return densities[i].total() / counts[i]; };
    for (std::size_t i = 1; i < densities.size(); ++i)
      if (width(i) > width(widest)) widest = i;
    ++counts[widest];
  }
  return counts;
}

// Knots from `first` to 1 with their forces; with `at_kinks`, one knot at each kink.
Guess guess_from(int segments, double first, bool at_kinks, const FitTarget& target) {
  if (segments == 1) return {{{0, 1}, {0, 1}}, {}, 1};
  Guess guess{{{0, first}, {0}}, at_kinks ? kinks_beyond(first, segments - 2, target) : std::vector<double>{}, 0};
  PiecewiseLinearForce& force = guess.force;
  std::vector<double> ends = guess.kinks;
  ends.push_back(1);
  std::vector<KnotDensity> densities;
  for (std::size_t i = 0; i < ends.size(); ++i) densities.emplace_back(i == 0 ? first : ends[i - 1], ends[i], target);
  const std::vector<int> counts = segment_counts(segments - 1, densities);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (int k = 1; k < counts[i]; ++k) force.y.push_back(densities[i].knot_at(static_cast<double>(k) / counts[i]));
    force.y.push_back(ends[i]);
  }
  for (std::size_t j = 1; j < force.y.size(); ++j) {
    const bool is_smooth = j > 1 && j + 1 < force.y.size() && !is_among(guess.kinks, force.y[j]);
    force.f.push_back(is_smooth ? force_between(target, force.y[j - 1], force.y[j], force.y[j + 1])
                                : target.force(force.y[j]));
  }
  guess.end = static_cast<std::size_t>(guess.kinks.empty() ? segments : counts[0] + 1);
  return guess;
}

// Scales the forces before each kink so that the energy stored there is that of the law. The error of the duration
// grows like the square root of a difference of these energies.
PiecewiseLinearForce match_kink_energies(PiecewiseLinearForce force, const FitTarget& target) {
  constexpr double kGrowth = 0.01, kMax = 0.5;
  std::size_t from = 1;
  for (const Break& at : target.breaks) {
    const auto kink = static_cast<std::size_t>(std::ranges::find(force.y, at.compression) - force.y.begin());
    if (!at.kink || kink == force.y.size() || from >= kink) continue;
    PiecewiseLinearForce grown = force;
    for (std::size_t j = from; j < kink; ++j) grown.f[j] *= 1 + kGrowth;
    const double stored = force.energies()[kink];
    const double growth = kGrowth * (at.energy - stored) / (grown.energies()[kink] - stored);
    for (std::size_t j = from; j < kink && std::abs(growth) < kMax; ++j) force.f[j] *= 1 + growth;
    from = kink + 1;
  }
  return make_monotone(std::move(force));
}

// A first guess whose first knot is at `fraction` of the compression of the slowest impact.
Guess coarse_guess(int segments, double fraction, bool at_kinks, const FitTarget& target) {
  Guess guess = guess_from(segments, std::min(fraction * target.min_compression, 0.95), at_kinks, target);
  guess.force = match_kink_energies(make_monotone(match_slowest_impact(std::move(guess.force), target)), target);
  return guess;
}

// A first guess from a fit with fewer segments: the first point of that fit, then forces whose ratio to those of
// force_between() is interpolated from that fit.
Guess refined_guess(int segments, const Guess& from, const FitTarget& target) {
  const PiecewiseLinearForce& coarse = from.force;
  const double ratio = coarse.y[3] / coarse.y[2];
  std::vector<double> x, ratios;
  for (std::size_t j = 1; j + 1 < coarse.y.size(); ++j) {
    if (is_among(from.kinks, coarse.y[j])) continue;
    const double before = j == 1 ? coarse.y[1] / ratio : coarse.y[j - 1];
    x.push_back(std::log(coarse.y[j]));
    ratios.push_back(coarse.f[j] / force_between(target, before, coarse.y[j], coarse.y[j + 1]));
  }
  x.push_back(0);
  ratios.push_back(1);
  Guess guess = guess_from(segments - 1, coarse.y[2] * std::pow(ratio, -0.3), !from.kinks.empty(), target);
  PiecewiseLinearForce& force = guess.force;
  force.f[1] = force_between(target, force.y[1] / ratio, force.y[1], force.y[2]);
  for (std::size_t j = 1; j + 1 < force.y.size(); ++j)
    if (!is_among(guess.kinks, force.y[j])) force.f[j] *= interpolated_within(x, ratios, std::log(force.y[j]));
  ++guess.end;
  force = match_kink_energies(make_monotone(insert_first_point(std::move(force), coarse)), target);
  return guess;
}

Guess fitted(Guess guess, const FitTarget& target) {
  constexpr int kSteps = 40, kPoints = 6;  // energies per segment
  constexpr double kConverged = 1e-3;
  if (guess.force.rises())
    guess.force = least_squares(guess.force, guess.end, target, sampled_log_energies(guess.force, target, kPoints),
                                {kSteps, kConverged});
  return guess;
}

double worst_of(const PiecewiseLinearForce& force, const FitTarget& target) {
  constexpr double kMaxForce = 100;  // relative to the largest force of the law; beyond it the fit has failed
  return force.rises() && force.f.back() < kMaxForce ? worst_duration_error(force, target)
                                                     : std::numeric_limits<double>::infinity();
}

Guess best_fit(int segments, bool at_kinks, const FitTarget& target) {
  constexpr int kMaxCoarse = 8;
  Guess best = fitted(coarse_guess(segments, 0.85, at_kinks, target), target);
  Guess other = segments <= kMaxCoarse
                    ? fitted(coarse_guess(segments, 0.5, at_kinks, target), target)
                    : fitted(refined_guess(segments, best_fit(segments / 2, at_kinks, target), target), target);
  return worst_of(other.force, target) < worst_of(best.force, target) ? other : best;
}

}  // namespace

PiecewiseLinearForce better_of(const PiecewiseLinearForce& one, const PiecewiseLinearForce& other,
                               const FitTarget& target) {
  return worst_of(other, target) < worst_of(one, target) ? other : one;
}

PiecewiseLinearForce knots_for_kinks(int segments, const FitTarget& target) {
  constexpr int kMaxCoarse = 8;  // with so few segments a knot may be more useful elsewhere than at a kink
  const bool kinks = std::ranges::any_of(target.breaks, &Break::kink);
  PiecewiseLinearForce force = best_fit(segments, kinks, target).force;
  return kinks && segments <= kMaxCoarse ? better_of(force, best_fit(segments, false, target).force, target) : force;
}

PiecewiseLinearForce unfitted_knots_for_kinks(int segments, const FitTarget& target, double first) {
  return match_kink_energies(make_monotone(guess_from(segments, first * target.min_compression, true, target).force),
                             target);
}

PiecewiseLinearForce recursion_force(int segments, const FitTarget& target) {
  constexpr int kParts = 64;  // for Simpson's rule
  const double width = 1.0 / segments, part = width / kParts;
  PiecewiseLinearForce force{{0}, {0}};
  for (int j = 0; j < segments; ++j) {
    double sum = 0;
    for (int i = 0; i < kParts; ++i) {
      const double y = width * j + part * i;
      sum += (target.force(y) + 4 * target.force(y + part / 2) + target.force(y + part)) / 6;
    }
    force.f.push_back(2 * sum / kParts - force.f.back());
    force.y.push_back(j + 1 == segments ? 1 : width * (j + 1));
  }
  return force;
}

}  // namespace contactspline
