// SPDX-License-Identifier: MIT
#include "generator/resonator/quadrature.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace contactspline {

QuadratureRule gauss_rule(double length, double phase) {
  using Gauss = boost::math::quadrature::gauss<double, 10>;
  const int parts = static_cast<int>(std::ceil(phase / (4 * std::numbers::pi))) + 1;
  const double half = length / parts / 2;
  QuadratureRule rule;
  for (int part = 0; part < parts; ++part)
    for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i)
      for (const int sign : {-1, 1}) {
        rule.points.push_back(half * (2 * part + 1 + sign * Gauss::abscissa()[i]));
        rule.weights.push_back(half * Gauss::weights()[i]);
      }
  return rule;
}

}  // namespace contactspline
