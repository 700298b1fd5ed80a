// SPDX-License-Identifier: MIT
// Gauss's rule on equal parts of an interval.
#pragma once

#include <vector>

namespace contactspline {

struct QuadratureRule {
  std::vector<double> points, weights;
};

/// Gauss's rule of ten points on equal parts of 0 to `length`, for an integrand whose phase changes by `phase` [rad]
/// from one end to the other: by 4 pi at the utmost over each part, with an error of 1e-8.
[[nodiscard]] QuadratureRule gauss_rule(double length, double phase);

}  // namespace contactspline
