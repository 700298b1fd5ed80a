// SPDX-License-Identifier: MIT
// Residuals of measurements against the model of an impact, in any real type: dual numbers give their derivatives.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "generator/fit/impact_model.hpp"
#include "generator/fit/low_pass.hpp"
#include "generator/fit/measurements.hpp"
#include "generator/fit/models.hpp"
#include "generator/fit/pulse_window.hpp"

namespace contactspline {

/// What is unknown of each pulse: its begin in parts of its duration, ln of its speed, and the sensor's offset and
/// its drift over the contact in parts of its largest force.
enum PulseUnknown { kBegin, kLogSpeed, kOffset, kSlope, kPulseUnknowns };

/// What is unknown of each blow on a resonator: ln of its speed, and ln of its gain over the common one.
enum BlowUnknown { kBlowSpeed, kBlowGain, kBlowUnknowns };

/// Settings that all residuals share.
struct FitScales {
  double mass_kg, reference_m;
  bool is_robust = true;                                              ///< large residuals count less
  double max_frequency_hz = std::numeric_limits<double>::infinity();  ///< of the levels that count
};

/// The standard deviation of one source's noise, in the unit of its residuals.
using Noise = std::shared_ptr<double>;

/// p: a pointer to each unknown, those of FitParameter first.
template <typename Real>
ViscoelasticLaw<Real> law_of(const Real* const* p, double reference_m) {
  using std::exp;
  return {*p[kLogForce],           *p[kExponent], *p[kHuntCrossley],       *p[kWeight],
          Real(exp(*p[kLogTime])), reference_m,   Real(exp(*p[kLogCore])), *p[kDepth]};
}

/// A residual in parts of the noise, in the norm 2 c^2 (sqrt(1 + r^2/c^2) - 1): r^2 for small ones, then linear.
inline constexpr double kRobust = 3;
template <typename Real>
Real scaled(const Real& difference, double noise, const FitScales& scales) {
  if (!scales.is_robust) return difference / noise;
  const double value = impact_model::number(difference), r = value / noise;
  const double root = std::sqrt(1 + r * r / (kRobust * kRobust)), factor = std::sqrt(2 / (1 + root));
  const double slope = factor * (1 - (root - 1) / (2 * root));
  return r * factor + slope / noise * (difference - value);
}

/// Force of a pulse, in parts of its largest one.
struct PulseResidual {
  const Pulse& pulse;
  PulseMeasures measures;
  const FitScales& scales;
  Noise noise;
  DenseTimes dense = {};  ///< of a low-pass; none: without one
  int fitted_order = 0;   ///< of a low-pass that is fitted

  template <typename Real>
  bool operator()(const Real* const* parameters, Real* residuals) const {
    const Real* const* unknown = parameters + kLawParameters;
    using std::exp;
    return compare(parameters, unknown, residuals, [&](std::span<const double> times, std::span<Real> forces) {
      return pulse_force(law_of(parameters, scales.reference_m), scales.mass_kg, Real(exp(*unknown[kLogSpeed])),
                         begin_s(unknown), times, forces);
    });
  }

  template <typename Real>
  [[nodiscard]] Real begin_s(const Real* const* unknown) const {
    return measures.begin_s + *unknown[kBegin] * (measures.end_s - measures.begin_s);
  }

  /// The residuals of modelled forces: play(times, forces) computes these, or returns false.
  template <typename Real, typename Play>
  bool compare(const Real* const* parameters, const Real* const* unknown, Real* residuals, Play play) const {
    const std::span<Real> forces(residuals, pulse.time_s.size());
    if (dense.time_s.empty()) {
      if (!play(std::span<const double>(pulse.time_s), forces)) return false;
    } else {
      std::vector<Real> passed(dense.time_s.size());
      if (!play(std::span<const double>(dense.time_s), std::span<Real>(passed))) return false;
      pass(parameters, std::span<Real>(passed));
      for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = passed[i * dense.stride];
    }
    const double middle = (measures.begin_s + measures.end_s) / 2, duration = measures.end_s - measures.begin_s;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const double drift = (pulse.time_s[i] - middle) / duration;
      forces[i] = scaled(
          Real((forces[i] - pulse.force_n[i]) / measures.max_force_n + *unknown[kOffset] + *unknown[kSlope] * drift),
          *noise, scales);
    }
    return true;
  }

 private:
  // The low-pass that is known, or else the one that is fitted.
  template <typename Real>
  void pass(const Real* const* parameters, std::span<Real> forces) const {
    using std::exp;
    const bool is_known = pulse.low_pass_hz.has_value();
    const Real hz = is_known ? Real(*pulse.low_pass_hz) : Real(exp(*parameters[kLogLowPass]));
    pass_low(std::span<const double>(dense.time_s), forces, Real(hz * (2 * std::numbers::pi)),
             is_known ? pulse.low_pass_order : fitted_order);
  }
};

/// The same of a hammer that strikes a resonator.
struct StruckPulseResidual {
  PulseResidual pulse;
  std::span<const StruckMode> modes;

  template <typename Real>
  bool operator()(const Real* const* parameters, Real* residuals) const {
    using std::exp;
    const Real* const* unknown = parameters + kFitParameters;
    return pulse.compare(parameters, unknown, residuals, [&](std::span<const double> times, std::span<Real> forces) {
      strike_model::Strike<Real> strike(law_of(parameters, pulse.scales.reference_m),
                                        Real(exp(*parameters[kLogMass])), Real(exp(*unknown[kLogSpeed])), modes);
      return strike.play_pulse(pulse.begin_s(unknown), times, forces);
    });
  }
};

/// One quantity of a row of a table: its ratio to the measured one, less 1.
struct RowResidual {
  double speed_m_per_s;
  std::vector<std::pair<int, double>> measured;  ///< 0: duration, 1: largest force, 2: restitution; and its value
  const FitScales& scales;
  std::vector<Noise> noise;

  template <typename Real>
  bool operator()(const Real* const* parameters, Real* residuals) const {
    const auto impact = measure_impact(law_of(parameters, scales.reference_m), scales.mass_kg, speed_m_per_s);
    if (!impact) return false;
    const Real values[3] = {impact->duration_s, impact->max_force_n, impact->restitution};
    for (std::size_t i = 0; i < measured.size(); ++i)
      residuals[i] = scaled(Real(values[measured[i].first] / measured[i].second - 1.0), *noise[i], scales);
    return true;
  }
};

/// Force over compression, in parts of the largest one. A slow press leaves the memory no time to be heard of.
struct CurveResidual {
  const MeasuredForce& curve;
  double max_force_n;
  const FitScales& scales;
  Noise noise;

  template <typename Real>
  bool operator()(const Real* const* parameters, Real* residuals) const {
    using std::exp;
    const auto law = law_of(parameters, scales.reference_m);
    const Real stiffness = exp(law.log_force);
    for (std::size_t i = 0; i < curve.samples.size(); ++i) {
      const auto& [y, force, speed] = curve.samples[i];
      const Real modelled =
          stiffness * impact_model::shape(law, Real(y)) * (1.0 - law.weight + law.loss_s_per_m * speed);
      residuals[i] = scaled(Real((modelled - force) / max_force_n), *noise, scales);
    }
    return true;
  }
};

/// Levels of partials, in nepers: differences of ln of their amplitudes.
struct BlowResidual {
  const StruckResonator& struck;
  const Blow& blow;
  const FitScales& scales;
  Noise noise;

  template <typename Real>
  bool operator()(const Real* const* parameters, Real* residuals) const {
    using std::exp;
    const Real* const* unknown = parameters + kFitParameters;
    strike_model::Strike<Real> strike(law_of(parameters, scales.reference_m), Real(exp(*parameters[kLogMass])),
                                      Real(exp(*unknown[kBlowSpeed])), struck.modes);
    if (!strike.play()) return false;
    for (std::size_t i = 0; i < blow.levels.size(); ++i) {
      const auto& [mode, level_db] = blow.levels[i];
      residuals[i] = Real(0.0);
      if (struck.modes[mode].frequency_hz() > scales.max_frequency_hz) continue;
      const Real level = strike.log_amplitude(mode) + std::log(struck.output_per_m[mode]) + *parameters[kLogGain] +
                         *unknown[kBlowGain];
      residuals[i] = scaled(Real(level - level_db / kDecibelsPerNeper), *noise, scales);
    }
    return true;
  }
};

}  // namespace contactspline
