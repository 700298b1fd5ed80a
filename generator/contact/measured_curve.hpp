// SPDX-License-Identifier: MIT
// A measured force-compression curve: strict reading, smoothing, and comparison with a power law.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "generator/contact/contact_law.hpp"

namespace contactspline {

struct CurveSample {
  double compression_m, force_n;
};

/// A curve as measured, for figures and reports.
struct Measurement {
  std::string file;  ///< as named in the material
  std::vector<CurveSample> samples;
};

/// Shape of the smoothed force: never falling (monotone), or with a slope that never falls either (hardening).
enum class CurveShape { kMonotone, kHardening };

/// Reads a CSV file: a header `compression_UNIT,force_UNIT` (m, mm, um; n, mn, kn), then one sample per line with
/// rising compression, numbers with a decimal point; lines that begin with # are comments. Throws BadInput with
/// `file` and the line for wrong syntax, NaN, negative or falling compressions, forces that are negative or fall by
/// more than noise, fewer than 8 or more than 10000 samples, and values so large or small that the unit must be
/// wrong.
[[nodiscard]] std::vector<CurveSample> parse_curve(std::string_view text, std::string_view file);

/// Least-squares fit in force. The slope is linear between at most 24 knots, with about as many samples in each
/// piece. It is >= 0 (monotone), or >= 0 and never falls (hardening). Non-negative least squares after Lawson and
/// Hanson (1974). Computed in 113 bits and rounded once.
[[nodiscard]] ForceCurve smooth_curve(const std::vector<CurveSample>& samples, CurveShape shape);

/// The power law with the smallest sum of squared force errors, exponent 0.1 to 10.
[[nodiscard]] PowerLaw nearest_power_law(const std::vector<CurveSample>& samples);

/// Root mean square of the differences between samples and curve, relative to the largest force.
[[nodiscard]] double relative_scatter(const std::vector<CurveSample>& samples, const ForceCurve& curve);

}  // namespace contactspline
