// SPDX-License-Identifier: MIT
#include "generator/spline/duration_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/spline/golden_section.hpp"

namespace contactspline {
namespace {

// Logarithms of energies ever closer to that of a kink. Above it the duration changes like the square root of the
// energy difference, so even steps would miss the largest error.
void append_near(std::vector<double>& samples, double kink, double end) {
  constexpr int kSteps = 8;
  for (int m = 1; m <= kSteps; ++m) samples.push_back(kink + (end - kink) * std::pow(4, -m));
}

double error_at(const PiecewiseLinearForce& force, const FitTarget& target, double log_energy) {
  const double energy = std::exp(log_energy);
  return half_duration(force, energy) / target.half_duration(energy) - 1;
}

}  // namespace

std::vector<double> sampled_log_energies(const PiecewiseLinearForce& force, const FitTarget& target, int points) {
  const double low = std::log(target.min_energy), high = std::log(target.max_energy);
  const auto between = [&](double energy) { return energy > target.min_energy && energy < target.max_energy; };
  std::vector<double> ends{low}, samples;
  const std::vector<double> stored = force.energies();
  for (std::size_t j = 1; j < force.segments(); ++j)
    if (between(stored[j])) ends.push_back(std::log(stored[j]));
  for (const Break& at : target.breaks) {
    if (!between(at.energy)) continue;
    ends.push_back(std::log(at.energy));
    if (!at.kink) continue;
    append_near(samples, ends.back(), low);
    append_near(samples, ends.back(), high);
  }
  ends.push_back(high);
  if (!target.breaks.empty()) std::ranges::sort(ends);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    for (int k = 0; k < points; ++k) samples.push_back(ends[i] + (ends[i + 1] - ends[i]) * k / points);
  samples.push_back(ends.back());
  if (!target.breaks.empty()) {
    std::ranges::sort(samples);
    samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  }
  return samples;
}

double worst_of(const std::vector<DurationError>& errors) {
  double worst = 0;
  for (const auto& e : errors) {
    if (!std::isfinite(e.error)) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, std::abs(e.error));
  }
  return worst;
}

std::vector<DurationError> duration_errors(const PiecewiseLinearForce& force, const FitTarget& target, int points) {
  constexpr int kSteps = 20;
  const std::vector<double> x = sampled_log_energies(force, target, points);
  std::vector<double> e;
  for (const double at : x) e.push_back(error_at(force, target, at));
  std::vector<DurationError> found{{x.front(), e.front()}};
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double before = e[i] - e[i - 1], after = e[i + 1] - e[i];
    if (!(before * after <= 0 && before != 0)) continue;
    const double sign = before > 0 ? 1 : -1;
    const Maximum extremum =
        find_maximum(x[i - 1], x[i + 1], kSteps, [&](double at) { return sign * error_at(force, target, at); });
    found.push_back({extremum.x, sign * extremum.value});
  }
  found.push_back({x.back(), e.back()});
  return found;
}

double worst_duration_error(const PiecewiseLinearForce& force, const FitTarget& target) {
  return worst_of(duration_errors(force, target));
}

}  // namespace contactspline
