// SPDX-License-Identifier: MIT
// A family of splines over a range of exponents on common knots, so that the exponent can be a live control.
#pragma once

#include <vector>

#include "contactspline/contact.hpp"
#include "generator/material.hpp"

namespace contactspline {

/// Splines of the power laws F = F_max (y/y_max)^a for exponents a from `least` to `most` in equal steps: all have
/// the material's force at its max_compression_m. A blend of two neighbours, (1 - t) of the one and t of the other,
/// is C1 and convex again.
struct ExponentFamily {
  std::vector<double> knots_m;                        ///< left ends of the segments, common to all members
  std::vector<std::vector<Segment<double>>> members;  ///< one for each exponent, one entry per segment
  double max_compression_m;                           ///< of the fastest impact at any of the exponents
};

/// The family of a material that has a live_exponent, of so many segments. Knots in geometric progression from half
/// the compression of the slowest impact at the least exponent to the largest compression of the fastest at any (at
/// least the material's own); the forces there lie below the law by h^2 F''/12, so that between them the mean force
/// is the law's. Numbers have as many digits as every machine agrees in.
[[nodiscard]] ExponentFamily exponent_family(const Material& material, int segments);

/// The power law that a family stands for at an exponent.
[[nodiscard]] PowerLaw law_of_family(const Material& material, double exponent);

/// The family's segments at an exponent of its range, as the runtime blends them.
[[nodiscard]] std::vector<Segment<double>> blended(const ExponentFamily& family, const LiveExponents& range,
                                                   double exponent);

}  // namespace contactspline
