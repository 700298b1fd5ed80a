// SPDX-License-Identifier: MIT
// A measured force-compression curve: read strictly, smoothed in shape, judged against a power law.
#pragma once

#include <string_view>
#include <vector>

#include "generator/potential.hpp"

namespace contactspline {

struct CurveSample {
  double compression_m, force_n;
};

/// What the smoothed force may do: rise (monotone), or rise ever more steeply (hardening).
enum class CurveShape { kMonotone, kHardening };

/// Reads a CSV file: a header `compression_UNIT,force_UNIT` (m, mm, um; n, mn, kn), then a sample a line with rising
/// compression, numbers with a decimal point; lines that begin with # are comments. Throws BadInput, naming `file`
/// and the line: syntax, NaN, negative or falling compression, forces that pull or fall by more than noise, fewer
/// than 8 or more than 20000 samples, sizes that speak of a wrong unit.
[[nodiscard]] std::vector<CurveSample> parse_curve(std::string_view text, std::string_view file);

/// Least squares in force: the slope runs straight between at most 24 knots, which share the samples evenly, and is
/// >= 0 (monotone) or never falls (hardening); non-negative least squares after Lawson and Hanson (1974). Computed in
/// 113 bits and rounded once.
[[nodiscard]] ForceCurve smooth_curve(const std::vector<CurveSample>& samples, CurveShape shape);

/// The power law nearest to the samples, by least squares in force.
[[nodiscard]] PowerLaw nearest_power_law(const std::vector<CurveSample>& samples);

/// Root mean square of what the samples depart from the curve, of the largest force.
[[nodiscard]] double relative_scatter(const std::vector<CurveSample>& samples, const ForceCurve& curve);

}  // namespace contactspline
