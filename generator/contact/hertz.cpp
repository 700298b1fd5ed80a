// SPDX-License-Identifier: MIT
#include "generator/contact/hertz.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/tools/roots.hpp>
#include <cstdint>
#include <utility>

#include "generator/support/quad.hpp"

namespace contactspline {
namespace {

using Shape = ElasticBody::Shape;

Quad compliance(const ElasticBody& body) {
  const Quad nu = body.poisson_ratio;
  return (1 - nu * nu) / body.youngs_modulus_pa;
}

// Relative curvatures along two perpendicular axes. If `one` is a cylinder, the first axis is its own; crossed
// cylinders have their axes along both.
std::pair<Quad, Quad> curvatures(const ElasticBody& one, const ElasticBody& other) {
  const auto curvature = [](const ElasticBody& body) {
    return body.shape == Shape::kPlane ? Quad(0) : 1 / Quad(body.radius_m);
  };
  const Quad along_one = one.shape == Shape::kCylinder ? Quad(0) : curvature(one);
  const bool both = one.shape == Shape::kCylinder && other.shape == Shape::kCylinder;
  const Quad across_other = other.shape == Shape::kCylinder ? Quad(0) : curvature(other);
  if (both) return {curvature(other), curvature(one)};
  return {along_one + across_other, curvature(one) + curvature(other)};
}

// sqrt((K - E)/(A K e^2)) / K of the contact ellipse for the half curvatures A < B.
Quad ellipse_factor(const Quad& a_half, const Quad& b_half) {
  struct Integrals {
    Quad k, e;
    explicit Integrals(const Quad& eccentricity)
        : k(boost::math::ellint_1(eccentricity)), e(boost::math::ellint_2(eccentricity)) {}
  };
  // Solves for the logarithm of the ratio b/a of the axes, from nearly 1:1 down to about 1:1e6.
  const auto eccentricity = [](const Quad& ratio) { return Quad(sqrt(1 - ratio * ratio)); };
  const auto balance = [&](const Quad& log_ratio) {
    const Quad ratio = exp(log_ratio);
    const Integrals f(eccentricity(ratio));
    return Quad((f.e / (ratio * ratio) - f.k) / (f.k - f.e) - b_half / a_half);
  };
  std::uintmax_t steps = 300;
  const auto [low, high] = boost::math::tools::toms748_solve(balance, Quad(-14), Quad(-1e-9),
                                                             boost::math::tools::eps_tolerance<Quad>(80), steps);
  const Quad e = eccentricity(exp((low + high) / 2));
  const Integrals f(e);
  return sqrt((f.k - f.e) / (a_half * f.k * e * e)) / f.k;
}

}  // namespace

bool touch_at_a_point(const ElasticBody& one, const ElasticBody& other) {
  const auto is_flat = [](const ElasticBody& body) { return body.shape == Shape::kPlane; };
  const auto is_round = [](const ElasticBody& body) { return body.shape == Shape::kSphere; };
  return is_round(one) || is_round(other) || !(is_flat(one) || is_flat(other));
}

PowerLaw hertz_law(const ElasticBody& one, const ElasticBody& other) {
  const Quad modulus = 1 / (compliance(one) + compliance(other));
  auto [min, max] = curvatures(one, other);
  if (min > max) std::swap(min, max);
  // Below a ratio of 1 + 1e-8 the solver would fail; a circle with the geometric mean differs by less than 1e-17.
  const Quad stiffness =
      max <= min * (1 + Quad(1e-8))
          ? Quad(4 * modulus / 3 / sqrt(sqrt(Quad(min * max))))
          : Quad(2 * boost::math::constants::pi<Quad>() / 3 * modulus * ellipse_factor(min / 2, max / 2));
  return {stiffness.convert_to<double>(), 1.5};
}

}  // namespace contactspline
