// SPDX-License-Identifier: MIT
// Figures drawn by gnuplot, as the bytes of a file. The functions that draw throw BadInput if gnuplot is missing or
// fails.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "generator/instrument/instrument.hpp"
#include "generator/player/mass_barrier_player.hpp"
#include "generator/player/score_player.hpp"
#include "generator/spline/design.hpp"

namespace contactspline {

enum class FigureFormat { kSvg, kPng, kPdf };

/// The format that the ending of a name chooses: .svg, .png or .pdf. Throws BadInput for any other.
[[nodiscard]] FigureFormat figure_format(const std::string& file);

[[nodiscard]] bool has_gnuplot();

/// Potential and force of a design, exact and as a spline with its knots, and the errors of the spline.
[[nodiscard]] std::string figure_of(const Design& design, FigureFormat format);

/// Errors of contact duration, max compression and force of several designs of one material, which must have an
/// impact.
[[nodiscard]] std::string figure_of(std::span<const Design> families, FigureFormat format);

/// Bodies, places and connections of an instrument.
[[nodiscard]] std::string figure_of(const InstrumentModel& model, FigureFormat format);

/// Errors of one model of an impact, as fractions, one for each speed.
struct ImpactErrors {
  std::string model;
  std::vector<double> contact_duration = {}, max_compression = {}, max_force = {};
};

/// Magnitudes of the errors of several models over the impact speed [m/s].
[[nodiscard]] std::string figure_of(std::span<const double> speeds, std::span<const ImpactErrors> models,
                                    const std::string& title, FigureFormat format);

/// Height and contact force of a simulated motion over time, and the force of the first contact sample by sample.
[[nodiscard]] std::string figure_of(const MassBarrierMotion& motion, const std::string& title, FigureFormat format);

/// Waveform, contact force and spectrogram of a played score. `signal` names the signal with its unit, for the axis.
[[nodiscard]] std::string figure_of(const Performance& performance, const std::string& title,
                                    const std::string& signal, FigureFormat format);

}  // namespace contactspline
