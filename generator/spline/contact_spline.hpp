// SPDX-License-Identifier: MIT
// The quadratic spline of a contact potential. Numbers in brackets are the equations of the companion derivation
// (DAFx-24).
#pragma once

#include <vector>

#include "contactspline/step/contact.hpp"
#include "generator/contact/barrier_impact.hpp"
#include "generator/material/material.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// Coefficients of the segments V_j = a_j y^2 + b_j y + c_j, j = 1..N; one entry per segment.
struct Coefficients {
  std::vector<double> a, b, c;
};

/// A C1 piecewise-quadratic, one-sided, convex approximation of a contact potential.
struct Spline {
  std::vector<Segment<double>> segments;  ///< N segments in SI units, each in powers of y minus its left knot
  double length_scale_m;                  ///< uniform knots: Delta_y; other knots: the largest compression
  double energy_scale_j;    ///< V(y) = energy_scale Vn(y / length_scale); for a power law with uniform knots it is k
                            ///< Delta_y^(a + 1)
  Coefficients regular;     ///< (8): in powers of y itself, SI units; inaccurate in single precision (cancellation)
  Coefficients normalised;  ///< (5): a-bar, b-bar, c-bar divided by energy_scale, dimensionless
  std::vector<double> normalised_knots;  ///< knots divided by length_scale
  double end_m = 0;  ///< end of the design range: max_compression_m, or its image under the compensation
};

/// The spline of a material on uniform knots, as in the derivation: sampling (9), one-sidedness (10)(11), continuity
/// (12)(13)(15), smoothness (14), the bidiagonal system (21)(22), quadratic terms (18), regular form (8). Computed in
/// 113 bits and rounded once, so the digits are the same on every machine. Throws BadInput, with `file` in its
/// message, if the spline is not convex or leaves the range of double.
[[nodiscard]] Spline uniform_spline(const Material& material, std::string_view file);

/// The spline whose slope is `force`, given relative to max_compression_m and to the law's force there. Computed in
/// 113 bits and rounded once. Throws BadInput, with `file` in its message, if it leaves the range of double.
[[nodiscard]] Spline spline_through(const PiecewiseLinearForce& force, const Material& material,
                                    std::string_view file);

/// The table for the contact step: a segment for "out of contact", then the segments of the spline.
[[nodiscard]] std::vector<Segment<double>> segment_table(const Spline& spline);

/// The spline as a LawView, which holds a copy of the table.
[[nodiscard]] LawView law_view(const Spline& spline);

}  // namespace contactspline
