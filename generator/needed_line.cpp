// SPDX-License-Identifier: MIT
#include "generator/needed_line.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "generator/line_fit.hpp"

namespace contactspline {
namespace {

// Value at `at` of the straight lines through (x, values), the ends going on.
double between(const std::vector<double>& x, const std::vector<double>& values, double at) {
  const auto above = std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(x, at) - x.begin(), 1, std::ssize(x) - 1);
  const auto i = static_cast<std::size_t>(above);
  return std::lerp(values[i - 1], values[i], std::clamp((at - x[i - 1]) / (x[i] - x[i - 1]), 0.0, 1.0));
}

/// How many segments a law needs from `low` on: the integral of sqrt(|F''|/F), which for a power law grows as log y
/// does. A chord of width h is off by h^2 F''/8, so that with one segment to each unit of it all are off by a like
/// part of the force.
struct Need {
  std::vector<double> y, sum;

  Need(double low, double high, const FitTarget& target) : y{low}, sum{0} {
    constexpr int kPoints = 400;
    constexpr double kLeast = 0.15;  // even a straight force gets a knot now and then
    const auto place = [&](double i) { return low * std::pow(high / low, i / kPoints); };
    for (int i = 1; i < kPoints; ++i) {
      const double before = place(i - 1), at = place(i), after = place(i + 1), force = target.force(at);
      const double left = (force - target.force(before)) / (at - before);
      const double right = (target.force(after) - force) / (after - at);
      const double bend = 2 * std::abs(right - left) / (after - before);
      const double end = i + 1 == kPoints ? high : place(i + 0.5);
      sum.push_back(sum.back() + (end - y.back()) * std::max(std::sqrt(bend / force), kLeast / at));
      y.push_back(end);
    }
  }

  [[nodiscard]] double total() const { return sum.back(); }
  [[nodiscard]] double place(double share) const { return between(sum, y, share * total()); }
};

/// A line whose knots lie where a law needs them, before and after it is fitted.
struct Guess {
  ForceLine line;
  std::vector<double> kinks;  ///< that have a knot
  std::size_t end;            ///< knots before this one may move along
};

bool is_among(const std::vector<double>& values, double value) {
  return std::ranges::find(values, value) != values.end();
}

// Those beyond the first knot; of more than there are knots for, the sharpest.
std::vector<double> kinks_beyond(double first, int most, const FitTarget& target) {
  std::vector<double> kinks;
  for (const Break& at : target.breaks)
    if (at.kink && at.compression > 1.02 * first && at.compression < 0.9999) kinks.push_back(at.compression);
  const auto bend = [&](double y) {
    return (target.force(1.1 * y) - 2 * target.force(y) + target.force(0.9 * y)) / target.force(y);
  };
  std::ranges::stable_sort(kinks, std::greater<>(), bend);
  kinks.resize(std::min(kinks.size(), static_cast<std::size_t>(std::max(0, most))));
  std::ranges::sort(kinks);
  return kinks;
}

// Shares out segments, one at least to each part, the next always to where most is needed.
std::vector<int> shared_out(int segments, const std::vector<Need>& needs) {
  std::vector<int> counts(needs.size(), 1);
  for (int left = segments - static_cast<int>(needs.size()); left > 0; --left) {
    std::size_t neediest = 0;
    const auto each = [&](std::size_t i) { return needs[i].total() / counts[i]; };
    for (std::size_t i = 1; i < needs.size(); ++i)
      if (each(i) > each(neediest)) neediest = i;
    ++counts[neediest];
  }
  return counts;
}

// Knots from `first` on. `at_kinks`: one at each of them.
Guess guess_from(int segments, double first, bool at_kinks, const FitTarget& target) {
  if (segments == 1) return {{{0, 1}, {0, 1}}, {}, 1};
  Guess guess{{{0, first}, {0}}, at_kinks ? kinks_beyond(first, segments - 2, target) : std::vector<double>{}, 0};
  ForceLine& line = guess.line;
  std::vector<double> ends = guess.kinks;
  ends.push_back(1);
  std::vector<Need> needs;
  for (std::size_t i = 0; i < ends.size(); ++i) needs.emplace_back(i == 0 ? first : ends[i - 1], ends[i], target);
  const std::vector<int> counts = shared_out(segments - 1, needs);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (int k = 1; k < counts[i]; ++k) line.y.push_back(needs[i].place(static_cast<double>(k) / counts[i]));
    line.y.push_back(ends[i]);
  }
  for (std::size_t j = 1; j < line.y.size(); ++j) {
    const bool amid = j > 1 && j + 1 < line.y.size() && !is_among(guess.kinks, line.y[j]);
    line.f.push_back(amid ? force_between(target, line.y[j - 1], line.y[j], line.y[j + 1]) : target.force(line.y[j]));
  }
  guess.end = static_cast<std::size_t>(guess.kinks.empty() ? segments : counts[0] + 1);
  return guess;
}

// Makes the line store at each kink what the law does: the duration is off like the root of the difference.
ForceLine stored_right(ForceLine line, const FitTarget& target) {
  constexpr double kGrowth = 0.01, kMost = 0.5;
  std::size_t from = 1;
  for (const Break& at : target.breaks) {
    const auto pin = static_cast<std::size_t>(std::ranges::find(line.y, at.compression) - line.y.begin());
    if (!at.kink || pin == line.y.size() || from >= pin) continue;
    ForceLine grown = line;
    for (std::size_t j = from; j < pin; ++j) grown.f[j] *= 1 + kGrowth;
    const double stored = line.energies()[pin];
    const double growth = kGrowth * (at.energy - stored) / (grown.energies()[pin] - stored);
    for (std::size_t j = from; j < pin && std::abs(growth) < kMost; ++j) line.f[j] *= 1 + growth;
    from = pin + 1;
  }
  return made_rising(std::move(line));
}

// With a first force such that the slowest impact lasts as long as it should; the first knot at a share of its
// compression.
Guess coarse_guess(int segments, double share, bool at_kinks, const FitTarget& target) {
  Guess guess = guess_from(segments, std::min(share * target.least_compression, 0.95), at_kinks, target);
  ForceLine& line = guess.line;
  const double spring = line.y[1] * std::pow(std::numbers::pi / 2 / target.half_duration(target.least_energy), 2);
  if (segments == 1 || spring < line.f[2]) line.f[1] = spring;
  line = stored_right(made_rising(std::move(line)), target);
  return guess;
}

// With the first knot of a coarser line, and forces as far from the law as its forces are.
Guess refined_guess(int segments, const Guess& from, const FitTarget& target) {
  const ForceLine& coarse = from.line;
  const double ratio = coarse.y[3] / coarse.y[2];
  std::vector<double> x, offsets;
  for (std::size_t j = 1; j + 1 < coarse.y.size(); ++j) {
    if (is_among(from.kinks, coarse.y[j])) continue;
    const double before = j == 1 ? coarse.y[1] / ratio : coarse.y[j - 1];
    x.push_back(std::log(coarse.y[j]));
    offsets.push_back(coarse.f[j] / force_between(target, before, coarse.y[j], coarse.y[j + 1]));
  }
  x.push_back(0);
  offsets.push_back(1);
  Guess guess = guess_from(segments - 1, coarse.y[2] * std::pow(ratio, -0.3), !from.kinks.empty(), target);
  ForceLine& line = guess.line;
  line.f[1] = force_between(target, line.y[1] / ratio, line.y[1], line.y[2]);
  for (std::size_t j = 1; j + 1 < line.y.size(); ++j)
    if (!is_among(guess.kinks, line.y[j])) line.f[j] *= between(x, offsets, std::log(line.y[j]));
  line.y.insert(line.y.begin() + 1, std::min(coarse.y[1], 0.95 * line.y[1]));
  line.f.insert(line.f.begin() + 1, std::min(coarse.f[1], 0.9 * line.f[1]));
  ++guess.end;
  line = stored_right(made_rising(std::move(line)), target);
  return guess;
}

Guess fitted(Guess guess, const FitTarget& target) {
  constexpr int kSteps = 40, kPoints = 6;  // energies a segment
  constexpr double kSettled = 1e-3;
  if (guess.line.rises())
    guess.line = least_squares(guess.line, guess.end, target, sampled_log_energies(guess.line, target, kPoints),
                               {kSteps, kSettled});
  return guess;
}

double worst_of(const ForceLine& line, const FitTarget& target) {
  constexpr double kAbsurd = 100;  // a force in largest ones
  return line.rises() && line.f.back() < kAbsurd ? worst_duration_error(line, target)
                                                 : std::numeric_limits<double>::infinity();
}

Guess best_fit(int segments, bool at_kinks, const FitTarget& target) {
  constexpr int kFew = 8;
  Guess best = fitted(coarse_guess(segments, 0.85, at_kinks, target), target);
  Guess other = segments <= kFew
                    ? fitted(coarse_guess(segments, 0.5, at_kinks, target), target)
                    : fitted(refined_guess(segments, best_fit(segments / 2, at_kinks, target), target), target);
  return worst_of(other.line, target) < worst_of(best.line, target) ? other : best;
}

}  // namespace

ForceLine better_of(ForceLine one, ForceLine other, const FitTarget& target) {
  return worst_of(other, target) < worst_of(one, target) ? other : one;
}

ForceLine needed_line(int segments, const FitTarget& target) {
  constexpr int kFew = 8;  // for which a knot may be too dear for a kink
  const bool kinks = std::ranges::any_of(target.breaks, &Break::kink);
  ForceLine line = best_fit(segments, kinks, target).line;
  return kinks && segments <= kFew ? better_of(line, best_fit(segments, false, target).line, target) : line;
}

ForceLine unfitted_needed_line(int segments, const FitTarget& target) {
  constexpr double kShare = 0.03;  // so far below the slowest impact no force need be fitted
  return stored_right(made_rising(guess_from(segments, kShare * target.least_compression, true, target).line),
                      target);
}

ForceLine recursion_line(int segments, const FitTarget& target) {
  constexpr int kParts = 64;  // of Simpson's rule
  const double width = 1.0 / segments, part = width / kParts;
  ForceLine line{{0}, {0}};
  for (int j = 0; j < segments; ++j) {
    double sum = 0;
    for (int i = 0; i < kParts; ++i) {
      const double y = width * j + part * i;
      sum += (target.force(y) + 4 * target.force(y + part / 2) + target.force(y + part)) / 6;
    }
    line.f.push_back(2 * sum / kParts - line.f.back());
    line.y.push_back(j + 1 == segments ? 1 : width * (j + 1));
  }
  return line;
}

}  // namespace contactspline
