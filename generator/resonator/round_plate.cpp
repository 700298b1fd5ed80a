// SPDX-License-Identifier: MIT
#include "generator/resonator/round_plate.hpp"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/bessel_prime.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "generator/resonator/form_terms.hpp"
#include "generator/resonator/quadrature.hpp"

namespace contactspline {
namespace {

using std::numbers::pi;

// J_m or I_m and its slope at x.
struct Bessel {
  double value, slope;
};
Bessel oscillating(int order, double x) {
  return {boost::math::cyl_bessel_j(order, x), boost::math::cyl_bessel_j_prime(order, x)};
}
Bessel growing(int order, double x) {
  return {boost::math::cyl_bessel_i(order, x), boost::math::cyl_bessel_i_prime(order, x)};
}

// What the two conditions at a rim at the distance x = beta R ask to be zero, for J_m (sign -1) or I_m (sign 1): the
// displacement and the slope, or the bending moment and the shear force.
struct RimConditions {
  double first, second;
};
RimConditions at_rim(PlateRim rim, double poisson, int order, double x, Bessel f, double sign) {
  if (rim == PlateRim::kClamped) return {f.value, f.slope};
  const double m2 = double(order) * order, slope = x * f.slope, rest = 1 - poisson;
  return {sign * x * x * f.value - rest * (slope - m2 * f.value),
          sign * x * x * slope - rest * m2 * (slope - f.value)};
}

// Zero at beta R of a mode. Divided by I_m, which grows beyond all numbers.
double characteristic(PlateRim rim, double poisson, int order, double x) {
  const RimConditions j = at_rim(rim, poisson, order, x, oscillating(order, x), -1);
  const Bessel grown = growing(order, x);
  const RimConditions i = at_rim(rim, poisson, order, x, {1, grown.slope / grown.value}, 1);
  return j.first * i.second - j.second * i.first;
}

// Root i = 1, 2, ... of the characteristic equation. Roots of an order lie about pi apart, the lowest above m, or
// above 2.9 for m = 0 and 1. Each is found once.
double root_of(PlateRim rim, double poisson, int order, int i) {
  thread_local std::map<std::tuple<PlateRim, double, int>, std::vector<double>> found;
  std::vector<double>& roots = found[{rim, poisson, order}];
  constexpr double kStep = 1;
  const auto f = [&](double x) { return characteristic(rim, poisson, order, x); };
  while (roots.size() < static_cast<std::size_t>(i)) {
    double left = roots.empty() ? std::max(1.5, 0.9 * order) : roots.back() + 1;
    double at_left = f(left), right = left + kStep, at_right = f(right);
    while ((at_left < 0) == (at_right < 0)) {
      left = right, at_left = at_right;
      right += kStep, at_right = f(right);
    }
    std::uintmax_t steps = 100;
    const auto [low, high] = boost::math::tools::toms748_solve(f, left, right, at_left, at_right,
                                                               boost::math::tools::eps_tolerance<double>(52), steps);
    roots.push_back((low + high) / 2);
  }
  return roots[static_cast<std::size_t>(i) - 1];
}

// J_m(x r) + c I_m(x r) with x = beta R, r from 0 to 1 at the rim.
class RadialShape {
 public:
  RadialShape(PlateRim rim, double poisson, int order, double root) : order_(order), root_(root) {
    const RimConditions j = at_rim(rim, poisson, order, root, oscillating(order, root), -1);
    const Bessel grown = growing(order, root);
    at_rim_ = grown.value;
    const RimConditions i = at_rim(rim, poisson, order, root, {1, grown.slope / grown.value}, 1);
    share_ = -j.first / i.first;
  }

  struct Derivatives {
    double value, first, second;
  };
  [[nodiscard]] double operator()(double r) const {
    return boost::math::cyl_bessel_j(order_, root_ * r) +
           share_ * (boost::math::cyl_bessel_i(order_, root_ * r) / at_rim_);
  }
  // By r, r > 0. Bessel's equations give the second ones.
  [[nodiscard]] Derivatives derivatives(double r) const {
    const double x = root_ * r, square = double(order_) * order_ / (x * x);
    const Bessel j = oscillating(order_, x);
    Bessel i = growing(order_, x);
    i = {share_ * (i.value / at_rim_), share_ * (i.slope / at_rim_)};
    const double slope = j.slope + i.slope;
    return {j.value + i.value, root_ * slope,
            root_ * root_ * (-slope / x - (1 - square) * j.value + (1 + square) * i.value)};
  }
  // Integral of the squared shape times cos^2 over the disc of radius 1.
  [[nodiscard]] double square() const {
    const QuadratureRule rule = gauss_rule(1, 2 * root_);
    double sum = 0;
    for (std::size_t p = 0; p < rule.points.size(); ++p)
      sum += rule.weights[p] * rule.points[p] * std::pow((*this)(rule.points[p]), 2);
    return sum * (order_ == 0 ? 2 * pi : pi);
  }

 private:
  int order_;
  double root_, at_rim_ = 0, share_ = 0;  // share: c I_m(x)
};

// cos(n pi/2).
double quarter_turns(int n) {
  constexpr std::array<double, 4> kCosines = {1, 0, -1, 0};
  return kCosines[static_cast<std::size_t>(n + 4) % 4];
}

// The integral of cos(a angle - i pi/2) cos(b angle - j pi/2) around a circle; b >= 0.
double around(int a, int i, int b, int j) {
  if (std::abs(a) != b) return 0;
  if (a == 0) return 2 * pi * quarter_turns(i) * quarter_turns(j);
  return pi * quarter_turns(a > 0 ? i - j : i + j);
}

// What L() needs of a shape at the points of a rule, times cos(order angle - quarters pi/2).
struct Sampled {
  Sampled(const RadialShape& shape, int m, const QuadratureRule& rule) : order(m) {
    for (const double r : rule.points) {
      const auto [value, first, second] = shape.derivatives(r);
      values.push_back(value);
      seconds.push_back(second);
      turns.push_back((first - double(m) * m * value / r) / r);  // (f_r + f_angle,angle/r)/r of cos
      twists.push_back(m * (first - value / r) / r);             // m (f/r)_r
    }
  }
  int order, quarters = 0;  // 0: cos, 1: sin
  std::vector<double> values, seconds, turns, twists;
};

struct Root {
  int order;
  double root;
  bool is_sine = false;
};

// The lowest `count`, by rising root. The lowest root of an order rises from order 2 on.
std::vector<Root> lowest_roots(PlateRim rim, double poisson, std::size_t count) {
  const double end = root_above(count);
  std::vector<Root> roots;
  for (int order = 0; order < 2 || root_of(rim, poisson, order, 1) < end; ++order)
    for (int i = 1; root_of(rim, poisson, order, i) < end; ++i)
      roots.push_back({order, root_of(rim, poisson, order, i)});
  std::ranges::sort(roots, {}, &Root::root);
  roots.resize(count);
  return roots;
}

// The same with sines beside the cosines of order 1 and more, without half a pair at the end.
std::vector<Root> lowest_of_both(PlateRim rim, double poisson, std::size_t count) {
  std::vector<Root> roots;
  for (const Root& root : lowest_roots(rim, poisson, count)) {
    roots.push_back(root);
    if (root.order > 0) roots.push_back({root.order, root.root, true});
    if (roots.size() > count) {
      roots.resize(roots.size() - (root.order > 0 ? 2 : 1));
      break;
    }
  }
  return roots;
}

std::vector<Root> airy_functions(const RoundPlate& plate, std::size_t count) {
  return plate.has_both_symmetries ? lowest_of_both(PlateRim::kClamped, 0, count)
                                   : lowest_roots(PlateRim::kClamped, 0, count);
}

// Modes at the points of a rule; a sine has the numbers of its cosine.
std::vector<Sampled> sampled(const RoundPlate& plate, std::span<const RoundPlateMode> modes,
                             const QuadratureRule& rule) {
  std::map<std::pair<int, double>, std::size_t> found;
  std::vector<Sampled> shapes;
  shapes.reserve(modes.size());
  for (const auto& [order, wavenumber, is_sine] : modes) {
    const auto [like, is_new] = found.try_emplace({order, wavenumber}, shapes.size());
    if (is_new)
      shapes.emplace_back(RadialShape(plate.rim, plate.poisson_ratio, order, wavenumber * plate.radius_m), order,
                          rule);
    else
      shapes.emplace_back(shapes[like->second]);
    shapes.back().quarters = is_sine;
  }
  return shapes;
}

// The integral of P L(f, g) over the disc of radius 1.
double coupling(const Sampled& airy, const Sampled& f, const Sampled& g, const QuadratureRule& rule) {
  const double sum = around(f.order + g.order, f.quarters + g.quarters, airy.order, airy.quarters);
  const double difference = around(f.order - g.order, f.quarters - g.quarters, airy.order, airy.quarters);
  if (sum == 0 && difference == 0) return 0;
  const double of_cos = (difference + sum) / 2, of_sin = (difference - sum) / 2;
  double integral = 0;
  for (std::size_t p = 0; p < rule.points.size(); ++p)
    integral +=
        rule.weights[p] * rule.points[p] * airy.values[p] *
        (of_cos * (f.seconds[p] * g.turns[p] + g.seconds[p] * f.turns[p]) - 2 * of_sin * f.twists[p] * g.twists[p]);
  return integral;
}

}  // namespace

double root_above(std::size_t modes) {
  return 4 + 3.2 * std::sqrt(static_cast<double>(modes));
}

double frequency_at(const RoundPlate& plate, double root) {
  const double beta = root / plate.radius_m, rest = 1 - plate.poisson_ratio * plate.poisson_ratio;
  return beta * beta * plate.thickness_m * std::sqrt(plate.youngs_modulus_pa / (12 * rest * plate.density_kg_m3));
}

UndampedMode undamped_mode(const RoundPlate& plate, int order, int i) {
  const double root = root_of(plate.rim, plate.poisson_ratio, order, i), beta = root / plate.radius_m;
  const double mass_per_area = plate.density_kg_m3 * plate.thickness_m;
  return {frequency_at(plate, root), beta,
          mass_per_area * plate.radius_m * plate.radius_m *
              RadialShape(plate.rim, plate.poisson_ratio, order, root).square()};
}

double radial_shape(const RoundPlate& plate, int order, double wavenumber_per_m, double radius_m) {
  return RadialShape(plate.rim, plate.poisson_ratio, order,
                     wavenumber_per_m * plate.radius_m)(radius_m / plate.radius_m);
}

std::vector<StretchForm> stretch_forms(const RoundPlate& plate, std::span<const RoundPlateMode> modes,
                                       std::size_t count) {
  const std::vector<Root> airy = airy_functions(plate, count);
  double highest = 0;
  for (const RoundPlateMode& mode : modes) highest = std::max(highest, mode.wavenumber_per_m * plate.radius_m);
  const QuadratureRule rule = gauss_rule(1, 2 * highest + airy.back().root);
  const std::vector<Sampled> shapes = sampled(plate, modes, rule);
  const double square_m2 = plate.radius_m * plate.radius_m;
  // The integrals of P L(f, g) over the plate are those over the disc of radius 1 by R^2/R^4.
  constexpr int kDigits = 11;
  std::vector<StretchForm> forms;
  for (const auto& [order, root, is_sine] : airy) {
    const RadialShape shape(PlateRim::kClamped, 0, order, root);
    Sampled function(shape, order, rule);
    function.quarters = is_sine;
    StretchForm& form = forms.emplace_back(StretchForm{
        plate.youngs_modulus_pa * plate.thickness_m * square_m2 / (2 * std::pow(root, 4) * shape.square()), {}});
    for (std::size_t p = 0; p < shapes.size(); ++p) {
      form.squares_per_m2.push_back(coupling(function, shapes[p], shapes[p], rule) / square_m2);
      for (std::size_t q = 0; q < p; ++q)
        if (const double product = coupling(function, shapes[p], shapes[q], rule); product != 0)
          form.products.push_back({q, p, product / square_m2});
    }
    round_terms(form, kDigits);
  }
  return forms;
}

std::size_t form_count(const RoundPlate& plate, std::size_t count) {
  return airy_functions(plate, count).size();
}

double kept_of_stretching(const RoundPlate& plate, std::size_t modes, std::size_t count) {
  std::vector<RoundPlateMode> lowest;
  for (const Root& root : lowest_roots(plate.rim, plate.poisson_ratio, modes))
    lowest.push_back({root.order, root.root / plate.radius_m});
  // Sines do nothing where a mode with a cosine moves alone.
  RoundPlate with_cosines = plate;
  with_cosines.has_both_symmetries = false;
  constexpr std::size_t kAll = 400;
  const auto cosines = std::ranges::count(airy_functions(plate, count), false, &Root::is_sine);
  return least_share(stretch_forms(with_cosines, lowest, kAll), static_cast<std::size_t>(cosines));
}

}  // namespace contactspline
