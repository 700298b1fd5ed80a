// SPDX-License-Identifier: MIT
#include "generator/spline/least_squares.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace contactspline {
namespace {

using Eigen::Index;

// The free parameters of a graded force are the logarithms of its forces, of its first knot and of its second knot.
// The knots from the second to `end` move with the second: y_j = y_2^((n - j)/(n - 2)), n = end, keeps them in
// geometric progression up to 1.
class GradedParameters {
 public:
  GradedParameters(std::size_t segments, std::size_t end) : n_(segments), end_(end) {}

  [[nodiscard]] Index count() const { return static_cast<Index>(n_) + (end_ > 2 ? 2 : end_ > 1 ? 1 : 0); }

  // Derivatives with respect to the free parameters, from those with respect to the points.
  [[nodiscard]] Eigen::RowVectorXd chain_rule(const PiecewiseLinearForce& force,
                                              const PiecewiseLinearForce& gradient) const {
    Eigen::RowVectorXd free = Eigen::RowVectorXd::Zero(count());
    for (std::size_t j = 1; j <= n_; ++j) {
      free(static_cast<Index>(j) - 1) = gradient.f[j] * force.f[j];
      if (j < end_) free(column(j)) += gradient.y[j] * force.y[j] * exponent_of(j);
    }
    return free;
  }

  [[nodiscard]] PiecewiseLinearForce moved_by(const PiecewiseLinearForce& force, const Eigen::VectorXd& step) const {
    Eigen::VectorXd knots = Eigen::VectorXd::Zero(static_cast<Index>(n_) - 1);
    for (std::size_t j = 1; j < end_; ++j) knots(static_cast<Index>(j) - 1) = step(column(j)) * exponent_of(j);
    return moved(force, {knots.data(), n_ - 1}, {step.data(), n_});
  }

 private:
  [[nodiscard]] Index column(std::size_t j) const { return static_cast<Index>(n_) + (j == 1 ? 0 : 1); }
  [[nodiscard]] double exponent_of(std::size_t j) const {
    return j == 1 ? 1 : static_cast<double>(end_ - j) / static_cast<double>(end_ - 2);
  }

  std::size_t n_, end_;
};

/// Errors of contact duration and max compression at the given energies, and their derivatives with respect to the
/// free parameters. A fit of the duration alone would spoil the compression of the softest impacts for very little
/// gain.
struct Linearised {
  Eigen::VectorXd errors;
  Eigen::MatrixXd jacobian;

  Linearised(const PiecewiseLinearForce& force, const GradedParameters& parameters, const FitTarget& target,
             const std::vector<double>& log_energies) {
    constexpr double kWeight = 0.3;
    const Index points = std::ssize(log_energies);
    errors.resize(2 * points);
    jacobian.resize(2 * points, parameters.count());
    PiecewiseLinearForce gradient;
    for (Index i = 0; i < points; ++i) {
      const double energy = std::exp(log_energies[static_cast<std::size_t>(i)]);
      const double duration = target.half_duration(energy), compression = target.compression(energy) / kWeight;
      errors(i) = half_duration(force, energy, &gradient) / duration - 1;
      jacobian.row(i) = parameters.chain_rule(force, gradient) / duration;
      errors(points + i) = turning_point(force, energy, &gradient) / compression - kWeight;
      jacobian.row(points + i) = parameters.chain_rule(force, gradient) / compression;
    }
  }
};

}  // namespace

double force_between(const FitTarget& target, double before, double y, double after) {
  const double left = y - before, right = after - y, middle = target.force(y);
  const double bend =
      2 * ((target.force(after) - middle) / right - (middle - target.force(before)) / left) / (left + right);
  return std::max(middle - bend * left * right / 12, middle / 2);
}

PiecewiseLinearForce make_monotone(PiecewiseLinearForce force) {
  constexpr double kMin = 1e-3;  // exponent; even many knots on a plateau then rise by a negligible amount
  for (std::size_t j = force.segments(); j-- > 1;)
    force.f[j] = std::min(force.f[j], force.f[j + 1] * std::pow(force.y[j] / force.y[j + 1], kMin));
  return force;
}

PiecewiseLinearForce match_slowest_impact(PiecewiseLinearForce force, const FitTarget& target) {
  const double spring = force.y[1] * std::pow(std::numbers::pi / 2 / target.half_duration(target.min_energy), 2);
  if (force.segments() == 1 || spring < force.f[2]) force.f[1] = spring;
  return force;
}

PiecewiseLinearForce insert_first_point(PiecewiseLinearForce force, const PiecewiseLinearForce& coarse) {
  force.y.insert(force.y.begin() + 1, std::min(coarse.y[1], 0.95 * force.y[1]));
  force.f.insert(force.f.begin() + 1, std::min(coarse.f[1], 0.9 * force.f[1]));
  return force;
}

PiecewiseLinearForce moved(PiecewiseLinearForce force, std::span<const double> y, std::span<const double> f) {
  for (std::size_t j = 0; j < y.size(); ++j) force.y[j + 1] *= std::exp(y[j]);
  for (std::size_t j = 0; j < f.size(); ++j) force.f[j + 1] *= std::exp(f[j]);
  return force;
}

PiecewiseLinearForce least_squares(PiecewiseLinearForce force, std::size_t end, const FitTarget& target,
                                   const std::vector<double>& log_energies, StopCriterion stop) {
  const GradedParameters parameters(force.segments(), end);
  Linearised at(force, parameters, target, log_energies);
  constexpr double kMaxStep = 10;  // largest change of a logarithm
  double damping = 1e-3;
  for (int i = 0; i < stop.max_steps && damping < 1e9; ++i) {
    Eigen::MatrixXd normal = at.jacobian.transpose() * at.jacobian;
    normal.diagonal() *= 1 + damping;
    const Eigen::VectorXd step = normal.ldlt().solve(-(at.jacobian.transpose() * at.errors));
    const PiecewiseLinearForce tried = parameters.moved_by(force, step);
    damping *= 10;
    if (!step.allFinite() || step.lpNorm<Eigen::Infinity>() > kMaxStep || !tried.rises()) continue;
    Linearised there(tried, parameters, target, log_energies);
    const double before = at.errors.squaredNorm(), after = there.errors.squaredNorm();
    if (after < before) {
      force = tried;
      at = std::move(there);
      damping /= 100;
      if (after > (1 - stop.min_gain) * before) break;
    }
    if (step.lpNorm<Eigen::Infinity>() < 1e-10) break;
  }
  return force;
}

}  // namespace contactspline
