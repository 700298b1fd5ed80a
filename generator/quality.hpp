// SPDX-License-Identifier: MIT
// How well a spline stands for its potential, by closed forms on both sides.
#pragma once

#include <optional>

#include "generator/live_exponent.hpp"
#include "generator/material.hpp"
#include "generator/spline.hpp"

namespace contactspline {

/// Errors over [0, max_compression_m] (where compensated, as far as the spline is designed), relative to the exact
/// value at max_compression_m.
struct CurveError {
  double worst;
  double rms;
};

/// Worst relative errors over the range of impact speed: of the spline's own motion, or where its material asks for
/// compensation of the simulated one.
struct ImpactError {
  double contact_duration;
  double max_compression;
};

struct Quality {
  CurveError force;
  CurveError energy;
  std::optional<ImpactError> impact;  ///< present where the material gives a range of impacts
};

/// Motion of a mass thrown at the spline: both closed forms, for in each segment it is sinusoidal.
struct SplineImpact {
  double max_compression_m;
  double contact_duration_s;
};

/// Max compression [m] and contact duration [s] of a mass (> 0) hitting a rigid barrier through the spline at a speed
/// (> 0): sum over the segments of 2/w atan(w dy/(v0 + v1)), w^2 = 2 c/m, v the speeds at the ends.
[[nodiscard]] SplineImpact impact_on_spline(const Spline& spline, double mass_kg, double speed_m_per_s);

/// Measures a spline against its material: 64 points a segment for the curves; speeds in geometric progression,
/// sixteen a segment and at least 512 while that stays cheap, for uniform knots given by number; else 32 or more
/// between any two speeds that turn at a knot (12 where impacts are simulated, then climbing from the worst). Closer
/// and closer to a speed that turns where a layer begins to act.
[[nodiscard]] Quality measure_quality(const Spline& spline, const Material& material);

/// Worst errors over the speeds of the material's impacts and the exponents of its family, three of them between any
/// two members; nothing where it has no impact. It must have a live_exponent.
[[nodiscard]] std::optional<ImpactError> measure_family(const ExponentFamily& family, const Material& material);

}  // namespace contactspline
