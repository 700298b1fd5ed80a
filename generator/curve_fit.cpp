// SPDX-License-Identifier: MIT
#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <limits>

#include "generator/curve.hpp"
#include "generator/quad.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kMostPieces = 24;
constexpr std::size_t kSamplesPerPiece = 3;

using Matrix = Eigen::Matrix<Quad, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Quad, Eigen::Dynamic, 1>;
using Indices = std::vector<Eigen::Index>;

// Knots at 0, at the last sample and between, so that each piece holds about as many samples.
std::vector<double> knots_for(const std::vector<CurveSample>& samples) {
  const std::size_t pieces = std::clamp<std::size_t>(samples.size() / kSamplesPerPiece, 2, kMostPieces);
  std::vector<double> knots{0};
  for (std::size_t i = 1; i < pieces; ++i) knots.push_back(samples[i * samples.size() / pieces].compression_m);
  knots.push_back(samples.back().compression_m);
  return knots;
}

// Integral up to y of the hat on knot `i`: what a unit of slope there adds to the force at y. In units of the range.
Quad hat_integral(const std::vector<Quad>& knots, std::size_t i, const Quad& y) {
  const auto half = [&](const Quad& foot, const Quad& top) {  // from the foot of a flank towards its top
    const Quad width = top - foot;
    const Quad way = std::clamp<Quad>((y - foot) / width, 0, 1);
    return Quad(abs(width) * way * way / 2);
  };
  Quad sum = 0;
  if (i > 0) sum += half(knots[i - 1], knots[i]);
  if (i + 1 < knots.size() && y > knots[i]) {
    const Quad whole = (knots[i + 1] - knots[i]) / 2;
    sum += whole - half(knots[i + 1], knots[i]);
  }
  return sum;
}

/// Normal equations of the least squares: gram x = moment.
struct NormalEquations {
  Matrix gram;
  Vector moment;
};

// Unknowns are the slopes at the knots, or (hardening) by how much the slope grows at each.
NormalEquations normal_equations(const std::vector<CurveSample>& samples, const std::vector<double>& knots_m,
                                 CurveShape shape) {
  const Quad range = knots_m.back();
  std::vector<Quad> knots;
  for (const double knot : knots_m) knots.push_back(knot / range);
  const auto size = static_cast<Eigen::Index>(knots.size());
  NormalEquations equations{Matrix::Zero(size, size), Vector::Zero(size)};
  Vector row(size);
  for (const CurveSample& sample : samples) {
    const Quad y = sample.compression_m / range;
    for (Eigen::Index i = 0; i < size; ++i) row(i) = hat_integral(knots, static_cast<std::size_t>(i), y);
    if (shape == CurveShape::kHardening)
      for (Eigen::Index i = size - 1; i > 0; --i) row(i - 1) += row(i);
    for (Eigen::Index i = 0; i < size; ++i)
      if (row(i) != 0)
        for (Eigen::Index j = 0; j <= i; ++j) equations.gram(i, j) += row(i) * row(j);
    equations.moment += row * Quad(sample.force_n);
  }
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = i + 1; j < size; ++j) equations.gram(i, j) = equations.gram(j, i);
  return equations;
}

// The solution with all unknowns but `free` at 0.
Vector solve_on(const NormalEquations& equations, const Indices& free) {
  const auto size = static_cast<Eigen::Index>(free.size());
  Matrix gram(size, size);
  Vector moment(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    moment(i) = equations.moment(free[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < size; ++j)
      gram(i, j) = equations.gram(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]);
  }
  const Vector part = gram.ldlt().solve(moment);
  Vector whole = Vector::Zero(equations.moment.size());
  for (Eigen::Index i = 0; i < size; ++i) whole(free[static_cast<std::size_t>(i)]) = part(i);
  return whole;
}

// Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23: frees the unknown that gains most, and while
// that makes another one negative goes only so far as it is 0, and fixes that one there.
Vector non_negative_solution(const NormalEquations& equations) {
  const Eigen::Index size = equations.moment.size();
  const Quad tolerance = std::numeric_limits<double>::epsilon() * equations.moment.cwiseAbs().maxCoeff() * 1e-6;
  Vector x = Vector::Zero(size);
  Indices free;
  for (Eigen::Index round = 0; round < 10 * size; ++round) {
    const Vector gain = equations.moment - equations.gram * x;
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < size; ++i)
      if (std::ranges::find(free, i) == free.end() && gain(i) > tolerance && (best < 0 || gain(i) > gain(best)))
        best = i;
    if (best < 0) break;
    free.push_back(best);
    for (Vector z = solve_on(equations, free);; z = solve_on(equations, free)) {
      Quad part = 1;
      for (const auto i : free)
        if (z(i) <= 0) part = std::min<Quad>(part, x(i) / (x(i) - z(i)));
      x += part * (z - x);
      if (part == 1) break;
      const Quad nothing = Quad(1e-25) * x.cwiseAbs().maxCoeff();
      std::erase_if(free, [&](Eigen::Index i) { return z(i) <= 0 && x(i) <= nothing; });
      for (Eigen::Index i = 0; i < size; ++i)
        if (std::ranges::find(free, i) == free.end()) x(i) = 0;
    }
  }
  return x;
}

}  // namespace

ForceCurve smooth_curve(const std::vector<CurveSample>& samples, CurveShape shape) {
  std::vector<double> knots = knots_for(samples);
  Vector slopes = non_negative_solution(normal_equations(samples, knots, shape)) / Quad(knots.back());
  if (shape == CurveShape::kHardening)
    for (Eigen::Index i = 1; i < slopes.size(); ++i) slopes(i) += slopes(i - 1);
  std::vector<double> rounded;
  for (const Quad& slope : slopes) rounded.push_back(slope.convert_to<double>());
  return {std::move(knots), std::move(rounded)};
}

PowerLaw nearest_power_law(const std::vector<CurveSample>& samples) {
  const double range = samples.back().compression_m;
  double stiffness = 0;  // in units of the range
  const auto residual = [&](double exponent) {
    double shape_force = 0, shape_shape = 0, force_force = 0;
    for (const auto& [y, f] : samples) {
      const double shape = std::pow(y / range, exponent);
      shape_force += shape * f;
      shape_shape += shape * shape;
      force_force += f * f;
    }
    stiffness = shape_force / shape_shape;
    return force_force - stiffness * shape_force;
  };
  const double exponent = boost::math::tools::brent_find_minima(residual, 0.1, 10.0, 40).first;
  residual(exponent);
  return {stiffness / std::pow(range, exponent), exponent};
}

double relative_scatter(const std::vector<CurveSample>& samples, const ForceCurve& curve) {
  double squares = 0, largest = 0;
  for (const auto& [y, f] : samples) {
    squares += (f - curve.force(y)) * (f - curve.force(y));
    largest = std::max(largest, f);
  }
  return std::sqrt(squares / static_cast<double>(samples.size())) / largest;
}

}  // namespace contactspline
