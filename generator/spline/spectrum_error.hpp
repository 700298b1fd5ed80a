// SPDX-License-Identifier: MIT
// The error of the spectrum of the contact force of impacts (docs/how-it-works/knots.md).
#pragma once

#include <optional>
#include <vector>

#include "generator/material/material.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/fit_target.hpp"
#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// Spectra are compared up to this frequency, about the highest audible partial of an instrument.
constexpr double kMaxSpectrumFrequency_hz = 15000;
/// Spectra are compared down to this level, relative to 0 Hz.
constexpr double kMinSpectrumLevel_db = -60;

/// Errors of spectra in decibels, over impacts from the slowest to the fastest and over frequencies. A spectrum has
/// zeros, so the error is 20 log10(1 + |difference|/envelope); the envelope of the exact spectrum at a frequency is
/// its largest magnitude at this frequency or a higher one.
struct SpectrumError {
  double mean_db, worst_db;
};

/// A table with a larger worst error is poor for sound: partials of a blow are then off by 1 dB on average and 20 dB
/// at worst, where half of it leaves 0.3 and 6 dB (docs/how-it-works/knots.md).
constexpr double kPoorSpectrumError_db = 10;

/// The exact spectra of the impacts of a target at `speeds` (> 1) speeds in geometric progression, at four
/// frequencies between any two zeros, up to the 36th zero at most. They are those of a spline with so many graded
/// segments: the own error of 512 is at most 0.02 dB for a power law and 0.07 dB for a law with a stiff stop.
class ExactSpectra {
 public:
  ExactSpectra(const FitTarget& target, int speeds, int segments = 512);

  /// The error of a force in the units of the target, which must be increasing. Absent if is_empty().
  [[nodiscard]] std::optional<SpectrumError> error_of(const PiecewiseLinearForce& force) const;

  /// Does nothing of the spectra lie within the limits of frequency? The lowest frequency compared has a period of
  /// four contact durations, so this is true if all contacts last less than 1/60 ms.
  [[nodiscard]] bool is_empty() const;

  /// The root mean square of |difference|/envelope.
  [[nodiscard]] double rms_error_of(const PiecewiseLinearForce& force) const;

 private:
  struct Impact {
    double energy, step;  // angular frequencies are multiples of the step
    std::vector<double> spectrum, envelope;
  };

  /// The part of the spectrum of an impact that is compared: up to the frequency `highest`, down to the lowest level,
  /// or to the last zero that is compared.
  static Impact compared_part(const PiecewiseLinearForce& exact, double energy, double step, double highest);
  [[nodiscard]] std::vector<double> differences(const PiecewiseLinearForce& force) const;

  std::vector<Impact> impacts_;
};

/// Can the spectra of the impacts of a material be compared? The contacts of very hard and light bodies are too
/// short.
[[nodiscard]] bool has_spectrum(const Material& material);

/// The error of the spectrum of a spline over the impacts of its material. Absent if the material has no impact, if
/// nothing of its spectra lies within the limits, or if it has compensation, because the spline then differs from the
/// law on purpose.
[[nodiscard]] std::optional<SpectrumError> measure_spectrum(const Spline& spline, const Material& material);

}  // namespace contactspline
