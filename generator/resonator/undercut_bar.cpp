// SPDX-License-Identifier: MIT
#include "generator/resonator/undercut_bar.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "generator/resonator/quadrature.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

constexpr int kDigits = 9;

Bar with_free_ends(Bar bar) {
  bar.ends = {BarEnd::kFree, BarEnd::kFree};
  return bar;
}

// Gauss's rule on the first half of the bar, on its end and on the arch: at their border the slope of the thickness
// jumps. The other half is alike.
QuadratureRule rule_of(const Bar& bar, const Undercut& undercut, double wavenumber_per_m) {
  const double end = (bar.length_m - undercut.length_m) / 2;
  QuadratureRule all;
  for (const auto& [from, length] : {std::pair(0.0, end), std::pair(end, undercut.length_m / 2)}) {
    if (!(length > 0)) continue;
    // A product of two shapes has twice the phase; twice that makes the error that of rounding.
    const QuadratureRule rule = gauss_rule(length, 4 * wavenumber_per_m * length);
    for (const double point : rule.points) all.points.push_back(from + point);
    for (const double weight : rule.weights) all.weights.push_back(2 * weight);
  }
  return all;
}

}  // namespace

double UndercutBar::thickness_ratio_at(double x_m) const {
  const double s = 2 * (x_m - bar_.length_m / 2) / undercut_.length_m;
  return std::abs(s) < 1 ? 1 - (1 - undercut_.thickness_ratio) * (1 - s * s) : 1;
}

// Modes are even or odd about the middle.
void UndercutBar::compute() const {
  for (std::size_t i = 1; i <= kFunctions; ++i)
    wavenumbers_.push_back(wavenumber_times_length(bar_, static_cast<int>(i)) / bar_.length_m);
  std::vector<WeighedMode> all = modes_of_parity(0);
  for (WeighedMode& mode : modes_of_parity(1)) all.push_back(std::move(mode));
  std::ranges::sort(all, {}, [](const WeighedMode& m) { return m.mode.angular_frequency_rad_per_s; });
  for (WeighedMode& mode : std::span(all).first(kModes)) {
    modes_.push_back(mode.mode);
    weights_.push_back(std::move(mode.weights));
  }
}

// A mode of frequency w has the moment M = EI u'' and M'' = w^2 mu u, so w^2 is the quotient of the integrals of
// M''^2/mu and of M^2/EI over all moments that are 0 with their slopes at the free ends. These are sums of the shapes
// of a clamped bar, whose second derivatives are those of a free one.
std::vector<UndercutBar::WeighedMode> UndercutBar::modes_of_parity(std::size_t parity) const {
  const Bar free = with_free_ends(bar_);
  const double mass_per_m = bar_.mass_kg / bar_.length_m;
  const auto count = static_cast<Eigen::Index>(kFunctions / 2);
  const QuadratureRule rule = rule_of(bar_, undercut_, wavenumbers_.back());
  const auto points = static_cast<Eigen::Index>(rule.points.size());
  Eigen::MatrixXd curved(points, count), moved(points, count);  // M''/sqrt(mu) and M/sqrt(EI)
  for (Eigen::Index p = 0; p < points; ++p) {
    const double x = rule.points[static_cast<std::size_t>(p)], ratio = thickness_ratio_at(x);
    const double root = std::sqrt(rule.weights[static_cast<std::size_t>(p)] / ratio);
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::size_t function = 2 * static_cast<std::size_t>(i) + parity;
      const int number = static_cast<int>(function) + 1;
      const double beta = wavenumbers_[function];
      // The waves of both shapes are opposite, what decays from the ends is the same.
      const double of_free = contactspline::shape_at(free, number, beta, x), sign = parity == 0 ? 1 : -1;
      const double decaying = std::exp(-beta * x) + sign * std::exp(-beta * (bar_.length_m - x));
      const double of_clamped = decaying / (1 + sign * std::exp(-beta * bar_.length_m)) - of_free;
      curved(p, i) = root * of_free / std::sqrt(mass_per_m);
      moved(p, i) = root / ratio * of_clamped / (beta * beta * std::sqrt(bar_.bending_stiffness_n_m2));
    }
  }
  const Eigen::MatrixXd mass = curved.transpose() * curved;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(moved.transpose() * moved, mass);
  if (solver.info() != Eigen::Success) throw std::runtime_error("the modes of an undercut bar were not found");
  std::vector<WeighedMode> modes;
  for (Eigen::Index column = count - 1; column >= count - Eigen::Index{kModes}; --column) {
    const double square = 1 / solver.eigenvalues()[column];
    Eigen::VectorXd weights = solver.eigenvectors().col(column);
    weights *=
        square * mass_per_m / weights.sum();  // the shape is 1 at the first end, where those of the free bar are
    const double mode_mass = weights.dot(mass * weights) / (square * square);
    const double beta = std::pow(square * mass_per_m / bar_.bending_stiffness_n_m2, 0.25);
    modes.push_back(
        {{rounded_to(std::sqrt(square), kDigits), rounded_to(beta, kDigits), rounded_to(mode_mass, kDigits)},
         std::vector<double>(kFunctions)});
    for (Eigen::Index i = 0; i < count; ++i)
      modes.back().weights[2 * static_cast<std::size_t>(i) + parity] = weights[i] / (square * mass_per_m);
  }
  return modes;
}

const std::vector<UndampedMode>& UndercutBar::modes() const {
  std::call_once(once_, [this] { compute(); });
  return modes_;
}

double UndercutBar::shape_at(std::size_t mode, double x_m) const {
  static_cast<void>(modes());
  const Bar free = with_free_ends(bar_);
  double shape = 0;
  for (std::size_t i = 0; i < kFunctions; ++i)
    shape += weights_[mode][i] * contactspline::shape_at(free, static_cast<int>(i) + 1, wavenumbers_[i], x_m);
  return rounded_to(shape / thickness_ratio_at(x_m), kDigits);
}

}  // namespace contactspline
