// SPDX-License-Identifier: MIT
// Figures drawn by gnuplot, as the bytes of a file. The functions that draw throw BadInput if gnuplot is missing or
// fails.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "generator/cli/figure_file.hpp"
#include "generator/contact/barrier_impact.hpp"
#include "generator/fit/fit.hpp"
#include "generator/instrument/instrument.hpp"
#include "generator/listen/instrument_fit.hpp"
#include "generator/material/friction_reader.hpp"
#include "generator/player/score_player.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/spline/design.hpp"

namespace contactspline {

/// Potential and force of a design, exact and as a spline with its knots, and the errors of the spline.
[[nodiscard]] std::string figure_of(const Design& design, FigureFormat format);

/// Errors of contact duration, max compression and force of several designs of one material, which must have an
/// impact.
[[nodiscard]] std::string figure_of(std::span<const Design> families, FigureFormat format);

/// Force of surfaces that rub over their way at several temperatures, and their coefficient over the speed.
[[nodiscard]] std::string figure_of(const RubbingSurfaces& surfaces, FigureFormat format);

/// Decay and shapes of the modes of a resonator below a frequency over their frequencies. There must be one.
[[nodiscard]] std::string figure_of(const Resonator& resonator, double max_frequency_hz, FigureFormat format);

/// Bodies, places and connections of an instrument.
[[nodiscard]] std::string figure_of(const InstrumentModel& model, FigureFormat format);

/// Impacts of one material at one speed, by several models.
struct ImpactPoint {
  double speed_m_per_s;
  std::vector<BarrierImpact> impacts;  ///< one for each model
};

/// Impacts of one material on a rigid barrier by several models: the exact motion, that of the spline, simulations.
struct ImpactSweep {
  std::string material;
  std::vector<std::string> models;      ///< their names; the first is exact, the second the spline
  std::vector<double> sample_rates_hz;  ///< of the models; 0 for the first two
  std::vector<ImpactPoint> points;      ///< by rising speed
};

/// Contact duration, largest force and restitution over the impact speed; for one material also the envelopes of the
/// errors of duration, compression and force. All sweeps have the same speeds and models.
[[nodiscard]] std::string figure_over_speed(std::span<const ImpactSweep> sweeps, const std::string& title,
                                            FigureFormat format);

/// Errors of contact duration, compression and force over the sample rate, one curve for each material and speed.
[[nodiscard]] std::string figure_over_rate(std::span<const ImpactSweep> sweeps, const std::string& title,
                                           FigureFormat format);

/// One motion of an impact, from touch to separation or sample by sample.
struct ImpactCourse {
  std::string name;
  bool is_exact;
  std::vector<double> time_s, force_n, speed_m_per_s;
  std::vector<double> kinetic_j;  ///< of the mass
  std::vector<double> stored_j;   ///< in the contact; empty where a memory hides it
};

/// Force, speed and energy of impacts over time.
[[nodiscard]] std::string figure_over_time(std::span<const ImpactCourse> courses, const std::string& title,
                                           FigureFormat format);

/// Data and model of a fit, over time, speed or compression, with their residuals beside them.
[[nodiscard]] std::string figure_of(const Fit& fit, const std::string& title, FigureFormat format);

/// Levels of the first six recorded notes and of what was rendered before and after a fit, by frequency and over
/// time.
[[nodiscard]] std::string figure_of(const InstrumentFit& fit, const RecordedInstrument& recorded,
                                    FigureFormat format);

/// A bouncing mass, sample by sample.
struct MassBarrierMotion {
  double sample_rate_hz;
  std::vector<double> displacement_m;  ///< after each sample, into the barrier
  std::vector<double> force_n;         ///< over each sample
};

/// Height and contact force of a simulated motion over time, and the force of the first contact sample by sample.
/// Without any contact the height alone.
[[nodiscard]] std::string figure_of(const MassBarrierMotion& motion, const std::string& title, FigureFormat format);

/// The words in the figure of a played score: its title and the labels of two axes, with their units.
struct PerformanceText {
  std::string title, signal, force;
};

/// Waveform, contact force and spectrogram of a played score, in stereo of the mean of both channels. Without any
/// contact there is no panel of the force.
[[nodiscard]] std::string figure_of(const Performance& performance, const PerformanceText& text, FigureFormat format);

}  // namespace contactspline
