// SPDX-License-Identifier: MIT
// A continuous piecewise-linear contact force, which is the slope of a C1 quadratic spline, and how long it holds a
// unit mass. In pure numbers: compression, force and mass are parts of some unit each.
#pragma once

#include <cstddef>
#include <vector>

namespace contactspline {

/// Force through the points (y[j], f[j]), j = 0..N, from (0, 0) on, both rising; the last piece extends to infinity.
struct ForceLine {
  std::vector<double> y, f;

  [[nodiscard]] std::size_t segments() const { return y.size() - 1; }
  [[nodiscard]] bool rises() const;                    ///< y strictly, f nowhere falling: a convex potential
  [[nodiscard]] std::vector<double> energies() const;  ///< stored at the points
};

/// Half the contact duration of a unit mass of kinetic `energy` (> 0): the way in. Where `slopes` is given its y and
/// f are filled with the derivatives by those of the line.
[[nodiscard]] double half_duration(const ForceLine& line, double energy, ForceLine* slopes = nullptr);

/// Where that mass turns: the largest compression. With its derivatives likewise.
[[nodiscard]] double turning_point(const ForceLine& line, double energy, ForceLine* slopes = nullptr);

}  // namespace contactspline
