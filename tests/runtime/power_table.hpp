// SPDX-License-Identifier: MIT
// Segment tables of power laws for tests of the runtime, without the generator.
#pragma once

#include <cmath>
#include <vector>

#include "contactspline/step/contact.hpp"

namespace contactspline::testing {

using Table = std::vector<Segment<double>>;

// Quadratic pieces whose forces at the knots are those of k y^a; beyond the last knot the last piece goes on.
template <typename T = double>
std::vector<Segment<T>> power_table(double k, double a, double max_compression, int segments = 24) {
  std::vector<Segment<T>> table(1, {0, 0, 0, 0});
  double energy = 0;
  for (int j = 0; j < segments; ++j) {
    const double from = max_compression * std::pow(double(j) / segments, 2);
    const double to = max_compression * std::pow(double(j + 1) / segments, 2);
    const double f0 = k * std::pow(from, a), f1 = k * std::pow(to, a);
    table.push_back({static_cast<T>(from), static_cast<T>(energy), static_cast<T>(f0),
                     static_cast<T>((f1 - f0) / (to - from) / 2)});
    energy += (f0 + f1) / 2 * (to - from);
  }
  return table;
}

}  // namespace contactspline::testing
