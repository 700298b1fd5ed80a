// SPDX-License-Identifier: MIT
#include "generator/knots.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "generator/line_fit.hpp"
#include "generator/needed_line.hpp"

namespace contactspline {
namespace {

using Eigen::Index;

/// A function's greatest value between two places.
struct Peak {
  double place, value;
};

// Golden-section search; `steps` of it.
template <typename Function>
Peak peak(double low, double high, int steps, Function f) {
  constexpr double kShare = 2 - std::numbers::phi;
  Peak left{low + kShare * (high - low), 0}, right{high - kShare * (high - low), 0};
  left.value = f(left.place);
  right.value = f(right.place);
  for (int i = 0; i < steps; ++i) {
    const bool rises = left.value < right.value;
    (rises ? low : high) = (rises ? left : right).place;
    (rises ? left : right) = rises ? right : left;
    Peak& next = rises ? right : left;
    next.place = rises ? high - kShare * (high - low) : low + kShare * (high - low);
    next.value = f(next.place);
  }
  return left.value < right.value ? right : left;
}

double error_at(const ForceLine& line, const FitTarget& target, double log_energy) {
  const double energy = std::exp(log_energy);
  return half_duration(line, energy) / target.half_duration(energy) - 1;
}

double worst_of(const std::vector<DurationError>& errors) {
  double worst = 0;
  for (const auto& e : errors) {
    if (!std::isfinite(e.error)) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, std::abs(e.error));
  }
  return worst;
}

// Knots in geometric progression with such forces.
ForceLine geometric_line(int segments, double first, const FitTarget& target) {
  ForceLine line{{0}, {0}};
  const double ratio = segments == 1 ? 2 : std::pow(1 / first, 1.0 / (segments - 1));
  for (int j = 1; j <= segments; ++j) {
    const double y = j == segments ? 1 : first * std::pow(ratio, j - 1);
    line.y.push_back(y);
    line.f.push_back(force_between(target, y / ratio, y, y * ratio));
  }
  return line;
}

// A first guess for few segments: a first force with which the slowest impact lasts as long as it should.
ForceLine coarse_line(int segments, const FitTarget& target) {
  ForceLine line = geometric_line(segments, std::min(0.85 * target.least_compression, 0.95), target);
  const double spring = line.y[1] * std::pow(std::numbers::pi / 2 / target.half_duration(target.least_energy), 2);
  if (segments == 1 || spring < line.f[2]) line.f[1] = spring;
  return made_rising(std::move(line));
}

// A first guess for many: the first knot of a coarser line, then knots as far from the law as its knots are, between
// them in proportion.
ForceLine refined_line(int segments, const ForceLine& coarse, const FitTarget& target) {
  const double ratio = coarse.y[3] / coarse.y[2];
  std::vector<double> x, offsets;
  for (std::size_t j = 1; j < coarse.y.size(); ++j) {
    x.push_back(std::log(coarse.y[j]));
    offsets.push_back(coarse.f[j] / force_between(target, coarse.y[j] / ratio, coarse.y[j], coarse.y[j] * ratio));
  }
  ForceLine line = geometric_line(segments - 1, coarse.y[2] * std::pow(ratio, -0.3), target);
  for (std::size_t j = 1; j < line.y.size(); ++j) {
    const double at = std::log(line.y[j]);
    const auto above = std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(x, at) - x.begin(), 1, std::ssize(x) - 1);
    const auto i = static_cast<std::size_t>(above);
    const double share = std::clamp((at - x[i - 1]) / (x[i] - x[i - 1]), 0.0, 1.0);
    line.f[j] *= std::lerp(offsets[i - 1], offsets[i], share);
  }
  line.y.insert(line.y.begin() + 1, std::min(coarse.y[1], 0.95 * line.y[1]));
  line.f.insert(line.f.begin() + 1, std::min(coarse.f[1], 0.9 * line.f[1]));
  return made_rising(std::move(line));
}

// By geometric progression and least squares.
ForceLine smooth_graded_line(int segments, const FitTarget& target) {
  constexpr int kFew = 8, kSteps = 40, kPoints = 6;  // energies a segment
  const ForceLine guess = segments <= kFew ? coarse_line(segments, target)
                                           : refined_line(segments, smooth_graded_line(segments / 2, target), target);
  const double low = std::log(target.least_energy), high = std::log(target.most_energy);
  const int points = kPoints * (segments + 1);
  std::vector<double> energies;
  for (int i = 0; i < points; ++i) energies.push_back(low + (high - low) * i / (points - 1));
  return least_squares(guess, guess.segments(), target, energies, {kSteps});
}

// Many segments: widths in geometric progression from far below the slowest impact, so that no force need be fitted.
ForceLine fine_line(int segments, const FitTarget& target) {
  const double offset = 0.03 * target.least_compression;
  const double rate = std::log1p(1 / offset) / segments;
  const auto knot = [&](int j) { return j == segments ? 1 : offset * std::expm1(rate * j); };
  ForceLine line{{0}, {0}};
  for (int j = 1; j <= segments; ++j) {
    line.y.push_back(knot(j));
    line.f.push_back(force_between(target, knot(j - 1), knot(j), offset * std::expm1(rate * (j + 1))));
  }
  return made_rising(std::move(line));
}

// Where there are more than the equal-error line has, drops those that stand out least, two neighbours at a time.
void keep_alternating(std::vector<DurationError>& extrema, std::size_t most) {
  while (extrema.size() > most) {
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

// What to do while fewer extrema alternate than there are unknowns.
enum class Missing { level, lower };

// Newton's step in logarithms (knots, forces, level) towards errors of one magnitude with alternating signs. Where
// extrema are missing it is the least such step, or the least one that lowers all errors at once.
Eigen::VectorXd levelling_step(const ForceLine& line, const FitTarget& target,
                               const std::vector<DurationError>& extrema, Missing missing) {
  const auto n = static_cast<Index>(line.segments());
  const auto rows = static_cast<Index>(extrema.size());
  Eigen::MatrixXd jacobian(rows, 2 * n);
  Eigen::VectorXd errors(rows);
  ForceLine slopes;
  for (Index i = 0; i < rows; ++i) {
    const double energy = std::exp(extrema[static_cast<std::size_t>(i)].log_energy);
    const double exact = target.half_duration(energy);
    errors(i) = half_duration(line, energy, &slopes) / exact - 1;
    for (Index j = 0; j < n; ++j) {
      const auto at = static_cast<std::size_t>(j) + 1;
      if (j + 1 < n) jacobian(i, j) = slopes.y[at] * line.y[at] / exact;
      jacobian(i, n - 1 + j) = slopes.f[at] * line.f[at] / exact;
    }
    jacobian(i, 2 * n - 1) = i % 2 == 0 ? 1 : -1;
  }
  if (rows == 2 * n) return jacobian.partialPivLu().solve(-errors);
  if (missing == Missing::lower) jacobian.col(2 * n - 1).setZero();
  return jacobian.completeOrthogonalDecomposition().solve(-errors);
}

/// A line and the extrema of its error.
struct Levelled {
  ForceLine line;
  std::vector<DurationError> extrema;
  double worst;

  Levelled(ForceLine of, const FitTarget& target)
      : line(std::move(of)), extrema(duration_errors(line, target)), worst(worst_of(extrema)) {}
};

// The longest of the halved steps that makes the worst error less.
std::optional<Levelled> lower(const Levelled& at, const FitTarget& target, const Eigen::VectorXd& step) {
  const auto n = static_cast<Index>(at.line.segments());
  for (double share = 1; share > 1e-4; share /= 2) {
    ForceLine line = moved(at.line, share * step.head(n - 1), share * step.segment(n - 1, n));
    if (!line.rises()) continue;
    Levelled tried(std::move(line), target);
    if (tried.worst < at.worst) return tried;
  }
  return std::nullopt;
}

Levelled level(Levelled at, const FitTarget& target, Missing missing, int iterations) {
  const std::size_t n = at.line.segments();
  for (int i = 0; i < iterations; ++i) {
    auto alternating = at.extrema;
    keep_alternating(alternating, 2 * n);
    const Eigen::VectorXd step = levelling_step(at.line, target, alternating, missing);
    if (!step.allFinite()) break;
    auto next = lower(at, target, step);
    if (!next) break;
    at = std::move(*next);
  }
  return at;
}

// The segment in which a mass of that energy turns.
std::size_t turning_segment(const ForceLine& line, double energy) {
  const std::vector<double> stored = line.energies();
  const auto above = std::upper_bound(stored.begin() + 1, stored.end() - 1, energy);
  return static_cast<std::size_t>(above - stored.begin()) - 1;
}

// The same line with one knot more, amid the segment in which the error is worst.
ForceLine split(const Levelled& at) {
  const auto height = [](const DurationError& e) { return std::abs(e.error); };
  const double energy = std::exp(std::ranges::max(at.extrema, {}, height).log_energy);
  ForceLine line = at.line;
  const auto j = static_cast<std::ptrdiff_t>(turning_segment(line, energy));
  for (auto* values : {&line.y, &line.f}) {
    const auto right = values->begin() + j + 1;
    values->insert(right, (*(right - 1) + *right) / 2);
  }
  return line;
}

// Where a law has breaks the levelling may end early. So it also starts from what smaller numbers of segments came
// to: from the first one on where there are few, so that the error falls with each segment; from some below where
// there are more, as time allows.
ForceLine optimal_line_with_breaks(int segments, const FitTarget& target) {
  const int steps = segments <= 32 ? 20 : 8;
  const int begin = segments <= 14 ? 1 : segments <= 32 ? segments - 7 : segments <= 48 ? segments - 1 : segments;
  const auto levelled = [&](ForceLine from) {
    return level({std::move(from), target}, target, Missing::level, steps);
  };
  ForceLine graded = graded_line(begin, target);
  Levelled best = levelled(graded);
  for (int more = begin + 1; more <= segments; ++more) {
    graded = graded_line(more, target);
    best = levelled(split(best));
    Levelled other = levelled(graded);
    if (other.worst < best.worst) best = std::move(other);
  }
  constexpr int kFine = 24;  // points a segment: peaks that the levelling did not see
  const auto worst = [&](const ForceLine& line) { return worst_of(duration_errors(line, target, kFine)); };
  return worst(best.line) < worst(graded) ? best.line : graded;
}

// Where a chord from one point meets a later one so that force and chord are `most` apart between them, with both
// ends `shift` off the force; 1 where they never are. `bend` is 1 for a convex force, -1 for a concave one.
double reach(const FitTarget& target, double y, double f, double shift, double most, double bend) {
  const auto gap = [&](double end) {
    const double slope = (target.force(end) + shift - f) / (end - y);
    return peak(y, end, 40, [&](double at) { return bend * (f + slope * (at - y) - target.force(at)); }).value;
  };
  if (gap(1) <= most) return 1;
  double low = y, high = 1;
  for (int i = 0; i < 52; ++i) {
    const double middle = (low + high) / 2;
    (gap(middle) > most ? high : low) = middle;
  }
  return low;
}

// A line from (0, 0) on whose error is `error` at every knot and between any two; nothing where it needs more
// segments to come to 1.
std::optional<ForceLine> equal_error_line(int segments, const FitTarget& target, double error) {
  const double bend = 2 * target.force(0.5) < target.force(1) ? 1 : -1;
  const double shift = -bend * error;  // chords of a convex force lie above it
  ForceLine line{{0}, {0}};
  for (int j = 1; j <= segments; ++j) {
    const double y = reach(target, line.y.back(), line.f.back(), shift, error, bend);
    line.y.push_back(y);
    line.f.push_back(target.force(y) + shift);
    if (y < 1) continue;
    return line.rises() ? std::optional(line) : std::nullopt;
  }
  return std::nullopt;
}

double worst_force_error(const ForceLine& line, const FitTarget& target) {
  constexpr int kPoints = 64;  // a segment
  double worst = 0;
  for (std::size_t j = 0; j < line.segments(); ++j)
    for (int i = 1; i <= kPoints; ++i) {
      const double share = static_cast<double>(i) / kPoints;
      const double force = std::lerp(line.f[j], line.f[j + 1], share);
      worst = std::max(worst, std::abs(force - target.force(std::lerp(line.y[j], line.y[j + 1], share))));
    }
  return worst;
}

}  // namespace

std::vector<DurationError> duration_errors(const ForceLine& line, const FitTarget& target, int points) {
  constexpr int kSteps = 20;
  const std::vector<double> x = sampled_log_energies(line, target, points);
  std::vector<double> e;
  for (const double at : x) e.push_back(error_at(line, target, at));
  std::vector<DurationError> found{{x.front(), e.front()}};
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double before = e[i] - e[i - 1], after = e[i + 1] - e[i];
    if (!(before * after <= 0 && before != 0)) continue;
    const double sign = before > 0 ? 1 : -1;
    const Peak top = peak(x[i - 1], x[i + 1], kSteps, [&](double at) { return sign * error_at(line, target, at); });
    found.push_back({top.place, sign * top.value});
  }
  found.push_back({x.back(), e.back()});
  return found;
}

double worst_duration_error(const ForceLine& line, const FitTarget& target) {
  return worst_of(duration_errors(line, target));
}

ForceLine graded_line(int segments, const FitTarget& target) {
  constexpr int kFew = 8;
  if (target.breaks.empty())
    return segments > kMostFittedSegments ? fine_line(segments, target) : smooth_graded_line(segments, target);
  if (segments > kMostFittedSegments) return unfitted_needed_line(segments, target);
  ForceLine line = needed_line(segments, target);
  if (segments <= kFew) line = better_of(std::move(line), smooth_graded_line(segments, target), target);
  return better_of(std::move(line), recursion_line(segments, target), target);
}

ForceLine optimal_line(int segments, const FitTarget& target) {
  if (!target.breaks.empty()) return optimal_line_with_breaks(segments, target);
  const bool few = segments <= 64;  // enough to afford a second try
  const Levelled graded(graded_line(segments, target), target);
  Levelled best = level(graded, target, Missing::level, few ? 30 : 12);
  if (few && best.extrema.size() < 2 * best.line.segments())
    best = level(level(best, target, Missing::lower, 10), target, Missing::level, 30);
  return best.line;
}

ForceLine least_force_error_line(int segments, const FitTarget& target) {
  // Equal to the last bit of the largest force.
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (equal_error_line(segments, target, middle) ? high : low) = middle;
  }
  ForceLine line = *equal_error_line(segments, target, high);
  if (target.breaks.empty()) return line;
  ForceLine graded = graded_line(segments, target);  // where the law bends both ways
  return worst_force_error(graded, target) < worst_force_error(line, target) ? graded : line;
}

}  // namespace contactspline
