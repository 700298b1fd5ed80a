// SPDX-License-Identifier: MIT
#include "generator/resonator/undercut_bar.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "generator/resonator/quadrature.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

constexpr int kDigits = 9;

Bar with_ends(Bar bar, BarEnd end) {
  bar.ends = {end, end};
  return bar;
}

// Gauss's rule on both ends and on the arch: at their borders the slope of the thickness jumps.
QuadratureRule rule_of(const Bar& bar, const Undercut& undercut, double wavenumber_per_m) {
  const double end = (bar.length_m - undercut.length_m) / 2;
  QuadratureRule all;
  for (const auto& [from, length] :
       {std::pair(0.0, end), std::pair(end, undercut.length_m), std::pair(end + undercut.length_m, end)}) {
    if (!(length > 0)) continue;
    // A product of two shapes has twice the phase; twice that makes the error that of rounding.
    const QuadratureRule rule = gauss_rule(length, 4 * wavenumber_per_m * length);
    for (const double point : rule.points) all.points.push_back(from + point);
    all.weights.insert(all.weights.end(), rule.weights.begin(), rule.weights.end());
  }
  return all;
}

}  // namespace

double UndercutBar::thickness_ratio_at(double x_m) const {
  const double s = 2 * (x_m - bar_.length_m / 2) / undercut_.length_m;
  return std::abs(s) < 1 ? 1 - (1 - undercut_.thickness_ratio) * (1 - s * s) : 1;
}

// A mode of frequency w has the moment M = EI u'' and M'' = w^2 mu u, so w^2 is the quotient of the integrals of
// M''^2/mu and of M^2/EI over all moments that are 0 with their slopes at the free ends. These are sums of the shapes
// of a clamped bar, whose second derivatives are those of a free one.
void UndercutBar::compute() const {
  const Bar clamped = with_ends(bar_, BarEnd::kClamped), free = with_ends(bar_, BarEnd::kFree);
  const double mass_per_m = bar_.mass_kg / bar_.length_m;
  for (std::size_t i = 1; i <= kFunctions; ++i)
    wavenumbers_.push_back(wavenumber_times_length(bar_, static_cast<int>(i)) / bar_.length_m);
  const auto count = static_cast<Eigen::Index>(kFunctions);
  const QuadratureRule rule = rule_of(bar_, undercut_, wavenumbers_.back());
  const auto points = static_cast<Eigen::Index>(rule.points.size());
  Eigen::MatrixXd curved(points, count), moved(points, count);  // M''/sqrt(mu) and M/sqrt(EI)
  for (Eigen::Index p = 0; p < points; ++p) {
    const double x = rule.points[static_cast<std::size_t>(p)], ratio = thickness_ratio_at(x);
    const double root = std::sqrt(rule.weights[static_cast<std::size_t>(p)] / ratio);
    for (Eigen::Index i = 0; i < count; ++i) {
      const int number = static_cast<int>(i) + 1;
      const double beta = wavenumbers_[static_cast<std::size_t>(i)];
      curved(p, i) = root * contactspline::shape_at(free, number, beta, x) / std::sqrt(mass_per_m);
      moved(p, i) = root / ratio * contactspline::shape_at(clamped, number, beta, x) /
                    (beta * beta * std::sqrt(bar_.bending_stiffness_n_m2));
    }
  }
  const Eigen::MatrixXd mass = curved.transpose() * curved;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(moved.transpose() * moved, mass);
  if (solver.info() != Eigen::Success) throw std::runtime_error("the modes of an undercut bar were not found");
  for (std::size_t m = 0; m < kModes; ++m) {
    const Eigen::Index column = count - 1 - static_cast<Eigen::Index>(m);
    const double square = 1 / solver.eigenvalues()[column];
    Eigen::VectorXd weights = solver.eigenvectors().col(column);
    weights *=
        square * mass_per_m / weights.sum();  // the shape is 1 at the first end, where those of the free bar are
    const double mode_mass = weights.dot(mass * weights) / (square * square);
    const double beta = std::pow(square * mass_per_m / bar_.bending_stiffness_n_m2, 0.25);
    modes_.push_back(
        {rounded_to(std::sqrt(square), kDigits), rounded_to(beta, kDigits), rounded_to(mode_mass, kDigits)});
    for (double& weight : weights) weight /= square * mass_per_m;
    weights_.emplace_back(weights.begin(), weights.end());
  }
}

const std::vector<UndampedMode>& UndercutBar::modes() const {
  std::call_once(once_, [this] { compute(); });
  return modes_;
}

double UndercutBar::shape_at(std::size_t mode, double x_m) const {
  static_cast<void>(modes());
  const Bar free = with_ends(bar_, BarEnd::kFree);
  double shape = 0;
  for (std::size_t i = 0; i < kFunctions; ++i)
    shape += weights_[mode][i] * contactspline::shape_at(free, static_cast<int>(i) + 1, wavenumbers_[i], x_m);
  return rounded_to(shape / thickness_ratio_at(x_m), kDigits);
}

}  // namespace contactspline
