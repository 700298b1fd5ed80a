// SPDX-License-Identifier: MIT
// The errors of a spline against its contact law, from closed forms for both.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "generator/material/material.hpp"
#include "generator/spline/contact_spline.hpp"

namespace contactspline {

/// Errors over [0, max_compression_m], relative to the exact value at max_compression_m. With compensation the range
/// is the design range of the spline.
struct CurveError {
  double worst;
  double rms;
};

/// Worst relative errors over the range of impact speeds, of the exact motion on the spline. With compensation, of
/// the simulated motion.
struct ImpactError {
  double contact_duration;
  double max_compression;
};

struct Quality {
  CurveError force;
  CurveError energy;
  std::optional<ImpactError> impact;  ///< present if the material has a range of impacts
};

/// The impact of a mass on a spline, in closed form: within each segment the motion is sinusoidal.
struct SplineImpact {
  double max_compression_m;
  double contact_duration_s;
};

/// The impact of a mass (> 0) on a rigid barrier with this spline, at a speed (> 0). Half the duration is the sum
/// over the segments of 2/w atan(w dy/(v0 + v1)), w^2 = 2 c/m, where v0 and v1 are the speeds at the ends of a
/// segment.
[[nodiscard]] SplineImpact impact_on_spline(const Spline& spline, double mass_kg, double speed_m_per_s);

/// The larger magnitude of the two; infinite if `error` is not finite.
[[nodiscard]] double worse(double worst, double error);

/// Speeds from the slowest impact to the fastest. Between two speeds with turning points at neighbouring knots the
/// error is smooth and has one or two peaks. So there are at least `min_steps` speeds between them, and about `total`
/// in all. With 32 and 2048 the worst error is found to within 0.3 %.
[[nodiscard]] std::vector<double> speeds_by_segment(std::span<const Segment<double>> segments, const Impact& impact,
                                                    int min_steps, int total);

/// Measures a spline against its material. The curves have 64 points per segment. The speeds are in geometric
/// progression for uniform knots given by number: 16 per segment, at least 512, fewer only if they take too long.
/// Otherwise there are at least 32 between any two speeds with turning points at a knot (12 if impacts are simulated,
/// and then a search from the worst ones). Speeds lie closer together around a turning point where a layer begins to
/// act.
[[nodiscard]] Quality measure_quality(const Spline& spline, const Material& material);

/// A lower bound of the error of the contact duration that measure_quality() finds, from an eighth of its speeds; 0
/// with compensation. Mostly within 10 % of it.
[[nodiscard]] double min_duration_error(const Spline& spline, const Material& material);

}  // namespace contactspline
