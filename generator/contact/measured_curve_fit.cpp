// SPDX-License-Identifier: MIT
#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <limits>

#include "generator/contact/measured_curve.hpp"
#include "generator/support/quad.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kMaxPieces = 24;
constexpr std::size_t kSamplesPerPiece = 3;

using Matrix = Eigen::Matrix<Quad, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Quad, Eigen::Dynamic, 1>;
using Indices = std::vector<Eigen::Index>;

// Knots at 0, at the last sample, and between them so that all pieces hold about the same number of samples.
std::vector<double> knots_for(const std::vector<CurveSample>& samples) {
  const std::size_t pieces = std::clamp<std::size_t>(samples.size() / kSamplesPerPiece, 2, kMaxPieces);
  std::vector<double> knots{0};
  for (std::size_t i = 1; i < pieces; ++i)  // two branches may have samples at the same compression
    if (const double y = samples[i * samples.size() / pieces].compression_m; y > knots.back()) knots.push_back(y);
  knots.push_back(samples.back().compression_m);
  return knots;
}

// Integral up to y of the hat function on knot `i`: the force at y for a unit slope at that knot. In units of the
// range.
Quad hat_integral(const std::vector<Quad>& knots, std::size_t i, const Quad& y) {
  const auto half = [&](const Quad& foot, const Quad& top) {  // integral over one flank, from its foot up to y
    const Quad width = top - foot;
    const Quad fraction = std::clamp<Quad>((y - foot) / width, 0, 1);
    return Quad(abs(width) * fraction * fraction / 2);
  };
  Quad sum = 0;
  if (i > 0) sum += half(knots[i - 1], knots[i]);
  if (i + 1 < knots.size() && y > knots[i]) {
    const Quad whole = (knots[i + 1] - knots[i]) / 2;
    sum += whole - half(knots[i + 1], knots[i]);
  }
  return sum;
}

/// Normal equations of a least-squares problem: gram x = moment. The sum of squares at x is `squares` - 2 x moment +
/// x gram x.
struct NormalEquations {
  Matrix gram;
  Vector moment;
  Quad squares = 0;
};

// The unknowns are the slopes at the knots (monotone) or the increases of the slope at the knots (hardening).
NormalEquations normal_equations(const std::vector<CurveSample>& samples, const std::vector<double>& knots_m,
                                 CurveShape shape, double loss) {
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
    row *= 1 + Quad(loss) * sample.speed_m_per_s;
    for (Eigen::Index i = 0; i < size; ++i)
      if (row(i) != 0)
        for (Eigen::Index j = 0; j <= i; ++j) equations.gram(i, j) += row(i) * row(j);
    equations.moment += row * Quad(sample.force_n);
    equations.squares += Quad(sample.force_n) * sample.force_n;
  }
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = i + 1; j < size; ++j) equations.gram(i, j) = equations.gram(j, i);
  return equations;
}

// The solution with all unknowns outside `free` held at 0.
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

bool is_among(const Indices& indices, Eigen::Index i) {
  return std::ranges::find(indices, i) != indices.end();
}

// The unknown outside `free` with the largest gradient above the tolerance, or -1.
Eigen::Index steepest(const Vector& gradient, const Indices& free, const Quad& tolerance) {
  Eigen::Index best = -1;
  for (Eigen::Index i = 0; i < gradient.size(); ++i)
    if (!is_among(free, i) && gradient(i) > tolerance && (best < 0 || gradient(i) > gradient(best))) best = i;
  return best;
}

// Moves x towards the solution on `free`. If an unknown would become negative, the step ends where the first one is
// 0; that one leaves `free`, and the next solution is tried.
void solve_within_bounds(Vector& x, Indices& free, const NormalEquations& equations) {
  for (Vector z = solve_on(equations, free);; z = solve_on(equations, free)) {
    Quad fraction = 1;
    for (const auto i : free)
      if (z(i) <= 0) fraction = std::min<Quad>(fraction, x(i) / (x(i) - z(i)));
    x += fraction * (z - x);
    if (fraction == 1) return;
    const Quad negligible = Quad(1e-25) * x.cwiseAbs().maxCoeff();
    std::erase_if(free, [&](Eigen::Index i) { return z(i) <= 0 && x(i) <= negligible; });
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (!is_among(free, i)) x(i) = 0;
  }
}

// Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23.
Vector non_negative_solution(const NormalEquations& equations) {
  const Eigen::Index size = equations.moment.size();
  const Quad tolerance = std::numeric_limits<double>::epsilon() * equations.moment.cwiseAbs().maxCoeff() * 1e-6;
  Vector x = Vector::Zero(size);
  Indices free;
  for (Eigen::Index round = 0; round < 10 * size; ++round) {
    const Eigen::Index entering = steepest(equations.moment - equations.gram * x, free, tolerance);
    if (entering < 0) break;
    free.push_back(entering);
    solve_within_bounds(x, free, equations);
  }
  return x;
}

}  // namespace

ForceCurve smooth_curve(const std::vector<CurveSample>& samples, CurveShape shape, double loss_s_per_m) {
  std::vector<double> knots = knots_for(samples);
  Vector slopes = non_negative_solution(normal_equations(samples, knots, shape, loss_s_per_m)) / Quad(knots.back());
  if (shape == CurveShape::kHardening)
    for (Eigen::Index i = 1; i < slopes.size(); ++i) slopes(i) += slopes(i - 1);
  std::vector<double> rounded;
  for (const Quad& slope : slopes) rounded.push_back(slope.convert_to<double>());
  return {std::move(knots), std::move(rounded)};
}

double fitted_loss(const std::vector<CurveSample>& samples, CurveShape shape, double max_loss_s_per_m) {
  const std::vector<double> knots = knots_for(samples);
  const auto equations_at = [&](double loss) { return normal_equations(samples, knots, shape, loss); };
  const auto squares_at = [&](const NormalEquations& equations) {
    const Vector x = non_negative_solution(equations);
    const Quad fit = x.dot(equations.gram * x) - 2 * x.dot(equations.moment);
    return Quad(equations.squares + fit).convert_to<double>();
  };
  // Gram matrix and moment are a quadratic and a linear function of the loss: the samples are summed up three times
  // only.
  const double half = max_loss_s_per_m / 2;
  const NormalEquations none = equations_at(0), middle = equations_at(half), whole = equations_at(2 * half);
  const auto squares_with = [&](double loss) {
    const Quad t = Quad(loss) / half;
    return squares_at({(t - 1) * (t - 2) / 2 * none.gram + t * (2 - t) * middle.gram + t * (t - 1) / 2 * whole.gram,
                       (1 - t) * none.moment + t * middle.moment, none.squares});
  };
  constexpr int kGrid = 32;
  int best = 0;
  double min = squares_with(0);
  for (int i = 1; i <= kGrid; ++i)
    if (const double squares = squares_with(max_loss_s_per_m * i / kGrid); squares < min) {
      min = squares;
      best = i;
    }
  const auto loss_at = [&](int i) { return max_loss_s_per_m * std::clamp(i, 0, kGrid) / kGrid; };
  constexpr int kBits = 30;  // a minimum is known to half the digits of its function, and that has 53
  return boost::math::tools::brent_find_minima(squares_with, loss_at(best - 1), loss_at(best + 1), kBits).first;
}

PowerLaw nearest_power_law(const std::vector<CurveSample>& samples, double loss_s_per_m) {
  const double range = samples.back().compression_m;
  double stiffness = 0;  // in units of the range
  const auto residual = [&](double exponent) {
    double shape_force = 0, shape_shape = 0, force_force = 0;
    for (const auto& [y, f, speed] : samples) {
      const double shape = std::pow(y / range, exponent) * (1 + loss_s_per_m * speed);
      shape_force += shape * f;
      shape_shape += shape * shape;
      force_force += f * f;
    }
    stiffness = shape_force / shape_shape;
    return force_force - stiffness * shape_force;
  };
  const double exponent = boost::math::tools::brent_find_minima(residual, 0.1, 10.0, 40).first;
  residual(exponent);  // sets the stiffness for this exponent
  return {stiffness / std::pow(range, exponent), exponent};
}

double relative_scatter(const std::vector<CurveSample>& samples, const ForceCurve& curve, double loss_s_per_m) {
  double squares = 0, largest = 0;
  for (const auto& [y, f, speed] : samples) {
    const double error = f - curve.force(y) * (1 + loss_s_per_m * speed);
    squares += error * error;
    largest = std::max(largest, f);
  }
  return std::sqrt(squares / static_cast<double>(samples.size())) / largest;
}

}  // namespace contactspline
