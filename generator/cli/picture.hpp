// SPDX-License-Identifier: MIT
// Pictures as SVG, drawn by gnuplot.
#pragma once

#include <string>

#include "generator/emit.hpp"
#include "generator/render.hpp"

namespace contactspline {

/// Potential and force of a design, exact and as a spline with its knots, and their errors.
[[nodiscard]] std::string picture_of(const Design& design);

/// Displacement and force of a rendered motion over time, and the first contact sample by sample.
[[nodiscard]] std::string picture_of(const MassBarrierMotion& motion, const std::string& title);

}  // namespace contactspline
