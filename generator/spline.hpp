// SPDX-License-Identifier: MIT
// Quadratic spline of a contact potential. Numbers in brackets are the equations of the companion derivation
// (DAFx-24).
#pragma once

#include <vector>

#include "contactspline/contact.hpp"
#include "generator/force_line.hpp"
#include "generator/material.hpp"

namespace contactspline {

/// Coefficients of the segments V_j = a_j y^2 + b_j y + c_j, j = 1..N, one entry per segment.
struct Coefficients {
  std::vector<double> a, b, c;
};

/// C1 piecewise-quadratic, one-sided, convex approximation of a contact potential.
struct Spline {
  std::vector<Segment<double>> segments;  ///< N local segments in SI units, each about its own left knot
  double length_scale_m;                  ///< Delta_y of uniform knots, else the largest compression
  double energy_scale_j;    ///< V(y) = energy_scale Vn(y / length_scale); of a power law and uniform knots: k
                            ///< Delta_y^(a + 1)
  Coefficients regular;     ///< (8): in powers of y itself, SI; cancels in single precision
  Coefficients normalised;  ///< (5): a-bar, b-bar, c-bar over energy_scale, free of units
  std::vector<double> normalised_knots;  ///< over length_scale
  double end_m = 0;  ///< up to where it was designed: max_compression_m, but for what compensation bends
};

/// The spline of a material by the derivation: sampling (9), one-sidedness (10)(11), continuity (12)(13)(15),
/// smoothness (14), the bidiagonal system (21)(22), quadratic terms (18), regular form (8). Computed in 113 bits and
/// rounded once, so the digits are the same on every machine. Throws BadInput, naming `file`, where it is not convex
/// or leaves the range of double.
[[nodiscard]] Spline uniform_spline(const Material& material, std::string_view file);

/// The spline whose force runs through the points of `line`, which are parts of max_compression_m and of the force
/// there. Computed in 113 bits and rounded once. Throws BadInput where it leaves the range of double.
[[nodiscard]] Spline line_spline(const ForceLine& line, const Material& material, std::string_view file);

/// Table for the contact step: "out of contact" followed by the segments.
[[nodiscard]] std::vector<Segment<double>> segment_table(const Spline& spline);

}  // namespace contactspline
