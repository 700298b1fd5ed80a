// SPDX-License-Identifier: MIT
#include "generator/line_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace contactspline {
namespace {

using Eigen::Index;

// Logarithms closer and closer to that of a kink: beyond it the duration departs like a root of the energy.
void append_near(std::vector<double>& samples, double kink, double end) {
  constexpr int kSteps = 8;
  for (int m = 1; m <= kSteps; ++m) samples.push_back(kink + (end - kink) * std::pow(4, -m));
}

// The free logarithms of a graded line: its forces, its first knot, and its second knot, which takes the later ones
// along up to knot `end`: y_j = y_2^((n - j)/(n - 2)), n = end, keeps them in geometric progression up to 1.
class GradedWays {
 public:
  GradedWays(std::size_t segments, std::size_t end) : n_(segments), end_(end) {}

  [[nodiscard]] Index count() const { return static_cast<Index>(n_) + (end_ > 2 ? 2 : end_ > 1 ? 1 : 0); }

  // Derivatives by the free logarithms, of those by the points.
  [[nodiscard]] Eigen::RowVectorXd chain(const ForceLine& line, const ForceLine& slopes) const {
    Eigen::RowVectorXd free = Eigen::RowVectorXd::Zero(count());
    for (std::size_t j = 1; j <= n_; ++j) {
      free(static_cast<Index>(j) - 1) = slopes.f[j] * line.f[j];
      if (j < end_) free(column(j)) += slopes.y[j] * line.y[j] * share(j);
    }
    return free;
  }

  [[nodiscard]] ForceLine moved_by(const ForceLine& line, const Eigen::VectorXd& step) const {
    Eigen::VectorXd knots = Eigen::VectorXd::Zero(static_cast<Index>(n_) - 1);
    for (std::size_t j = 1; j < end_; ++j) knots(static_cast<Index>(j) - 1) = step(column(j)) * share(j);
    return moved(line, knots, step.head(static_cast<Index>(n_)));
  }

 private:
  [[nodiscard]] Index column(std::size_t j) const { return static_cast<Index>(n_) + (j == 1 ? 0 : 1); }
  [[nodiscard]] double share(std::size_t j) const {
    return j == 1 ? 1 : static_cast<double>(end_ - j) / static_cast<double>(end_ - 2);
  }

  std::size_t n_, end_;
};

/// Errors of contact duration and max compression at some energies, and their derivatives by the
/// free logarithms. Without the compression a fit would trade it for a little duration at the softest impacts.
struct Linearised {
  Eigen::VectorXd errors;
  Eigen::MatrixXd jacobian;

  Linearised(const ForceLine& line, const GradedWays& ways, const FitTarget& target,
             const std::vector<double>& log_energies) {
    constexpr double kWeight = 0.3;
    const Index points = std::ssize(log_energies);
    errors.resize(2 * points);
    jacobian.resize(2 * points, ways.count());
    ForceLine slopes;
    for (Index i = 0; i < points; ++i) {
      const double energy = std::exp(log_energies[static_cast<std::size_t>(i)]);
      const double duration = target.half_duration(energy), compression = target.compression(energy) / kWeight;
      errors(i) = half_duration(line, energy, &slopes) / duration - 1;
      jacobian.row(i) = ways.chain(line, slopes) / duration;
      errors(points + i) = turning_point(line, energy, &slopes) / compression - kWeight;
      jacobian.row(points + i) = ways.chain(line, slopes) / compression;
    }
  }
};

}  // namespace

std::vector<double> sampled_log_energies(const ForceLine& line, const FitTarget& target, int points) {
  const double low = std::log(target.least_energy), high = std::log(target.most_energy);
  const auto between = [&](double energy) { return energy > target.least_energy && energy < target.most_energy; };
  std::vector<double> ends{low}, samples;
  const std::vector<double> stored = line.energies();
  for (std::size_t j = 1; j < line.segments(); ++j)
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
    samples.erase(std::ranges::unique(samples).begin(), samples.end());
  }
  return samples;
}

double force_between(const FitTarget& target, double before, double y, double after) {
  const double left = y - before, right = after - y, middle = target.force(y);
  const double bend =
      2 * ((target.force(after) - middle) / right - (middle - target.force(before)) / left) / (left + right);
  return std::max(middle - bend * left * right / 12, middle / 2);
}

ForceLine made_rising(ForceLine line) {
  constexpr double kLeast = 1e-3;  // exponent: so little that ever so many knots on a plateau rise by next to nothing
  for (std::size_t j = line.segments(); j-- > 1;)
    line.f[j] = std::min(line.f[j], line.f[j + 1] * std::pow(line.y[j] / line.y[j + 1], kLeast));
  return line;
}

ForceLine moved(ForceLine line, const Eigen::VectorXd& y, const Eigen::VectorXd& f) {
  for (Index j = 0; j < y.size(); ++j) line.y[static_cast<std::size_t>(j) + 1] *= std::exp(y(j));
  for (Index j = 0; j < f.size(); ++j) line.f[static_cast<std::size_t>(j) + 1] *= std::exp(f(j));
  return line;
}

ForceLine least_squares(ForceLine line, std::size_t end, const FitTarget& target,
                        const std::vector<double>& log_energies, Patience patience) {
  const GradedWays ways(line.segments(), end);
  Linearised at(line, ways, target, log_energies);
  constexpr double kFarthest = 10;  // in logarithms
  double damping = 1e-3;
  for (int i = 0; i < patience.steps && damping < 1e9; ++i) {
    Eigen::MatrixXd normal = at.jacobian.transpose() * at.jacobian;
    normal.diagonal() *= 1 + damping;
    const Eigen::VectorXd step = normal.ldlt().solve(-(at.jacobian.transpose() * at.errors));
    const ForceLine tried = ways.moved_by(line, step);
    damping *= 10;
    if (!step.allFinite() || step.lpNorm<Eigen::Infinity>() > kFarthest || !tried.rises()) continue;
    Linearised there(tried, ways, target, log_energies);
    const double before = at.errors.squaredNorm(), after = there.errors.squaredNorm();
    if (after < before) {
      line = tried;
      at = std::move(there);
      damping /= 100;
      if (after > (1 - patience.settled) * before) break;
    }
    if (step.lpNorm<Eigen::Infinity>() < 1e-10) break;
  }
  return line;
}

}  // namespace contactspline
