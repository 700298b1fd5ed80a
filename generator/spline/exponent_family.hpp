// SPDX-License-Identifier: MIT
// A family of splines over a range of exponents, on common knots. It makes the exponent a live control.
#pragma once

#include <optional>
#include <vector>

#include "contactspline/step/contact.hpp"
#include "generator/material/material.hpp"
#include "generator/spline/spline_error.hpp"

namespace contactspline {

/// Splines of the power laws F = F_max (y/y_max)^a for exponents a from `min` to `max` in equal steps. All have the
/// material's force at its max_compression_m. A linear blend of two neighbours, (1 - t) and t, is again C1 and
/// convex.
struct ExponentFamily {
  std::vector<double> knots_m;                        ///< left ends of the segments, common to all members
  std::vector<std::vector<Segment<double>>> members;  ///< one for each exponent; one entry per segment
  double max_compression_m;                           ///< largest compression of the fastest impact at any exponent
};

/// The family of a material, which must have a live_exponent, with the given number of segments. The knots are in
/// geometric progression from half the compression of the slowest impact at the smallest exponent to the largest
/// compression of the fastest impact at any exponent, at least max_compression_m. The forces lie h^2 F''/12 below the
/// law, so that the mean force between two knots is that of the law. Numbers are rounded to the digits that all
/// machines agree on.
[[nodiscard]] ExponentFamily exponent_family(const Material& material, int segments);

/// The power law that the family approximates at an exponent.
[[nodiscard]] PowerLaw law_of_family(const Material& material, double exponent);

/// The segments of the family at an exponent within its range, blended as in the runtime.
[[nodiscard]] std::vector<Segment<double>> blended(const ExponentFamily& family, const LiveExponents& range,
                                                   double exponent);

/// Worst errors over the speeds of the material's impacts and over the exponents of its family, with three exponents
/// between any two members. Nothing if the material has no impact. It must have a live_exponent.
[[nodiscard]] std::optional<ImpactError> measure_family(const ExponentFamily& family, const Material& material);

}  // namespace contactspline
