// SPDX-License-Identifier: MIT
// Pictures as SVG, drawn by gnuplot.
#pragma once

#include <span>
#include <string>

#include "generator/emit.hpp"
#include "generator/play.hpp"
#include "generator/render.hpp"

namespace contactspline {

/// Potential and force of a design, exact and as a spline with its knots, and their errors.
[[nodiscard]] std::string picture_of(const Design& design);

/// Errors of contact duration, max compression and force of several designs of one material, which has impacts.
[[nodiscard]] std::string picture_of(std::span<const Design> families);

/// Displacement and force of a rendered motion over time, and the first contact sample by sample.
[[nodiscard]] std::string picture_of(const MassBarrierMotion& motion, const std::string& title);

/// Waveform, contact force and spectrogram of a played score. `signal`: what is heard, with its unit.
[[nodiscard]] std::string picture_of(const Performance& performance, const std::string& title,
                                     const std::string& signal);

}  // namespace contactspline
