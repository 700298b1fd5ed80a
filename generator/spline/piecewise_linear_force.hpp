// SPDX-License-Identifier: MIT
// A continuous piecewise-linear contact force, which is the slope of a C1 quadratic spline, and the impact of a unit
// mass on it. All numbers are dimensionless: multiples of a unit of compression, of force and of mass.
#pragma once

#include <cstddef>
#include <vector>

namespace contactspline {

/// Force through the points (y[j], f[j]), j = 0..N, both rising from (0, 0). The last piece extends to infinity.
struct PiecewiseLinearForce {
  std::vector<double> y, f;

  [[nodiscard]] std::size_t segments() const { return y.size() - 1; }
  [[nodiscard]] bool rises() const;                    ///< y strictly rising, f never falling: a convex potential
  [[nodiscard]] std::vector<double> energies() const;  ///< the stored energy at each point
};

/// Half the contact duration of a unit mass with kinetic `energy` (> 0). If `gradient` is given, its y and f are
/// filled with the derivatives of the result with respect to y and f of the force.
[[nodiscard]] double half_duration(const PiecewiseLinearForce& force, double energy,
                                   PiecewiseLinearForce* gradient = nullptr);

/// Largest compression of that mass; `gradient` as above.
[[nodiscard]] double turning_point(const PiecewiseLinearForce& force, double energy,
                                   PiecewiseLinearForce* gradient = nullptr);

}  // namespace contactspline
