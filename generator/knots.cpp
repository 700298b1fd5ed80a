// SPDX-License-Identifier: MIT
#include "generator/knots.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

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

// Logarithms of energies: the ends of the range, the knots between, and `points` steps from each to the next.
std::vector<double> sampled_log_energies(const ForceLine& line, const FitTarget& target, int points) {
  std::vector<double> ends{std::log(target.least_energy)};
  const std::vector<double> stored = line.energies();
  for (std::size_t j = 1; j < line.segments(); ++j)
    if (stored[j] > target.least_energy && stored[j] < target.most_energy) ends.push_back(std::log(stored[j]));
  ends.push_back(std::log(target.most_energy));
  std::vector<double> samples;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    for (int k = 0; k < points; ++k) samples.push_back(ends[i] + (ends[i + 1] - ends[i]) * k / points);
  samples.push_back(ends.back());
  return samples;
}

double worst_of(const std::vector<DurationError>& errors) {
  double worst = 0;
  for (const auto& e : errors) worst = std::max(worst, std::abs(e.error));
  return worst;
}

/// A line whose points move by parameters in logarithms, so that all stay positive.
ForceLine moved(ForceLine line, const Eigen::VectorXd& y, const Eigen::VectorXd& f) {
  for (Index j = 0; j < y.size(); ++j) line.y[static_cast<std::size_t>(j) + 1] *= std::exp(y(j));
  for (Index j = 0; j < f.size(); ++j) line.f[static_cast<std::size_t>(j) + 1] *= std::exp(f(j));
  return line;
}

// The free logarithms of a graded line: its forces, its first knot, and its second knot, which takes the later ones
// along: y_j = y_2^((n - j)/(n - 2)) keeps them in geometric progression up to 1.
class GradedWays {
 public:
  explicit GradedWays(std::size_t segments) : n_(segments) {}

  [[nodiscard]] Index count() const { return static_cast<Index>(n_) + (n_ > 2 ? 2 : n_ > 1 ? 1 : 0); }

  // Derivatives by the free logarithms, of those by the points.
  [[nodiscard]] Eigen::RowVectorXd chain(const ForceLine& line, const ForceLine& slopes) const {
    Eigen::RowVectorXd free = Eigen::RowVectorXd::Zero(count());
    for (std::size_t j = 1; j <= n_; ++j) {
      free(static_cast<Index>(j) - 1) = slopes.f[j] * line.f[j];
      if (j < n_) free(column(j)) += slopes.y[j] * line.y[j] * share(j);
    }
    return free;
  }

  [[nodiscard]] ForceLine moved_by(const ForceLine& line, const Eigen::VectorXd& step) const {
    Eigen::VectorXd knots(static_cast<Index>(n_) - 1);
    for (std::size_t j = 1; j < n_; ++j) knots(static_cast<Index>(j) - 1) = step(column(j)) * share(j);
    return moved(line, knots, step.head(static_cast<Index>(n_)));
  }

 private:
  [[nodiscard]] Index column(std::size_t j) const { return static_cast<Index>(n_) + (j == 1 ? 0 : 1); }
  [[nodiscard]] double share(std::size_t j) const {
    return j == 1 ? 1 : static_cast<double>(n_ - j) / static_cast<double>(n_ - 2);
  }

  std::size_t n_;
};

/// Errors of contact duration and max compression at energies in geometric progression, and their derivatives by the
/// free logarithms. Without the compression a fit would trade it for a little duration at the softest impacts.
struct Linearised {
  Eigen::VectorXd errors;
  Eigen::MatrixXd jacobian;

  Linearised(const ForceLine& line, const FitTarget& target) {
    constexpr Index kPoints = 6;  // energies a segment
    constexpr double kWeight = 0.3;
    const GradedWays ways(line.segments());
    const Index points = kPoints * (static_cast<Index>(line.segments()) + 1);
    const double low = std::log(target.least_energy), high = std::log(target.most_energy);
    errors.resize(2 * points);
    jacobian.resize(2 * points, ways.count());
    ForceLine slopes;
    for (Index i = 0; i < points; ++i) {
      const double energy = std::exp(low + (high - low) * static_cast<double>(i) / static_cast<double>(points - 1));
      const double duration = target.half_duration(energy), compression = target.compression(energy) / kWeight;
      errors(i) = half_duration(line, energy, &slopes) / duration - 1;
      jacobian.row(i) = ways.chain(line, slopes) / duration;
      errors(points + i) = turning_point(line, energy, &slopes) / compression - kWeight;
      jacobian.row(points + i) = ways.chain(line, slopes) / compression;
    }
  }
};

// Forces and knots of a graded line by Levenberg's and Marquardt's method.
ForceLine least_squares(ForceLine line, const FitTarget& target, int iterations) {
  const GradedWays ways(line.segments());
  Linearised at(line, target);
  double damping = 1e-3;
  for (int i = 0; i < iterations && damping < 1e9; ++i) {
    Eigen::MatrixXd normal = at.jacobian.transpose() * at.jacobian;
    normal.diagonal() *= 1 + damping;
    const Eigen::VectorXd step = normal.ldlt().solve(-(at.jacobian.transpose() * at.errors));
    const ForceLine tried = ways.moved_by(line, step);
    damping *= 10;
    if (!step.allFinite() || !tried.rises()) continue;
    Linearised there(tried, target);
    if (there.errors.squaredNorm() < at.errors.squaredNorm()) {
      line = tried;
      at = std::move(there);
      damping /= 100;
    }
    if (step.lpNorm<Eigen::Infinity>() < 1e-10) break;
  }
  return line;
}

// Force at a knot between two others. A chord lies above a convex force, by two thirds of the most on average.
double force_between(const FitTarget& target, double before, double y, double after) {
  const double left = y - before, right = after - y, middle = target.force(y);
  const double bend =
      2 * ((target.force(after) - middle) / right - (middle - target.force(before)) / left) / (left + right);
  return std::max(middle - bend * left * right / 12, middle / 2);
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

// Lowers forces that a later one falls below.
ForceLine made_rising(ForceLine line) {
  for (std::size_t j = line.segments(); j-- > 1;) line.f[j] = std::min(line.f[j], 0.999 * line.f[j + 1]);
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
  constexpr int kFew = 8, kIterations = 40;
  if (segments > kMostFittedSegments) return fine_line(segments, target);
  const ForceLine guess = segments <= kFew ? coarse_line(segments, target)
                                           : refined_line(segments, graded_line(segments / 2, target), target);
  return least_squares(guess, target, kIterations);
}

ForceLine optimal_line(int segments, const FitTarget& target) {
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
  return *equal_error_line(segments, target, high);
}

}  // namespace contactspline
