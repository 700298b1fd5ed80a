// SPDX-License-Identifier: MIT
// What forms store when a body stretches.
#pragma once

#include <cstddef>
#include <vector>

#include "contactspline/data/stretch_form.hpp"

namespace contactspline::testing {

/// Energy of forms at displacements of the modes [J]: the sum of stiffness/4 (q' B q + b q_u)^2.
inline double energy_of(const std::vector<StretchForm>& forms, const std::vector<double>& q) {
  double energy = 0;
  for (const auto& [stiffness, squares, products, linear] : forms) {
    double stretch = linear.factor_per_m * q[linear.mode];
    for (std::size_t i = 0; i < q.size(); ++i) stretch += squares[i] * q[i] * q[i];
    for (const auto& [first, second, factor] : products) stretch += 2 * factor * q[first] * q[second];
    energy += stiffness / 4 * stretch * stretch;
  }
  return energy;
}

}  // namespace contactspline::testing
