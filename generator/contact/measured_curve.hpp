// SPDX-License-Identifier: MIT
// A measured force-compression curve: strict reading, smoothing, and comparison with a power law.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/contact/contact_law.hpp"

namespace contactspline {

/// Samples of a slow measurement have speed 0. Those of an impact have the speed of the compression: positive on the
/// way in (loading), negative on the way out (unloading).
struct CurveSample {
  double compression_m, force_n;
  double speed_m_per_s = 0;
};

/// A curve as measured, for figures and reports.
struct Measurement {
  std::string file;  ///< as named in the material
  std::vector<CurveSample> samples;
  std::optional<double> impact_speed_m_per_s =
      {};  ///< speed of the impact that was measured; the loss is fitted to it
};

/// Shape of the smoothed force: never falling (monotone), or with a slope that never falls either (hardening).
enum class CurveShape { kMonotone, kHardening };

/// Reads a CSV file: a header `compression_UNIT,force_UNIT` (m, mm, um; n, mn, kn), then one sample per line with
/// rising compression, numbers with a decimal point; lines that begin with # are comments. Throws BadInput with
/// `file` and the line for wrong syntax, NaN, negative or falling compressions, forces that are negative or fall by
/// more than noise, fewer than 8 or more than 10000 samples, and values so large or small that the unit must be
/// wrong.
/// With an impact speed [m/s], a loading branch with rising compression and an unloading branch with falling
/// compression follow one another. The speed of a mass that arrives at the impact speed v and turns at the largest
/// compression is v sqrt(1 - W(y)/W(ymax)), W(y) the work of the force up to y; on the way out it follows from the
/// work that is given back. It is also an error if the force
/// has more than one peak, or if more work is given back than was taken up. Samples are returned
/// by rising compression.
[[nodiscard]] std::vector<CurveSample> parse_curve(std::string_view text, std::string_view file,
                                                   std::optional<double> impact_speed_m_per_s = {});

/// The checks of parse_curve() on samples that were read otherwise, from these lines of a file; returns them by
/// rising compression, with their speeds.
[[nodiscard]] std::vector<CurveSample> checked_curve(std::vector<CurveSample> samples,
                                                     const std::vector<std::size_t>& lines, std::string_view file,
                                                     std::optional<double> impact_speed_m_per_s);

/// Least-squares fit in force, F(y) (1 + loss v) for samples with a speed v. The slope is linear between at most 24
/// knots, with about as many samples in each piece. It is >= 0 (monotone), or >= 0 and never falls (hardening).
/// Non-negative least squares after Lawson and Hanson (1974). Computed in 113 bits and rounded once.
[[nodiscard]] ForceCurve smooth_curve(const std::vector<CurveSample>& samples, CurveShape shape,
                                      double loss_s_per_m = 0);

/// The loss [s/m] between 0 and `max_loss` > 0 for which smooth_curve leaves the smallest sum of squared errors; it
/// may be `max_loss` itself. 1 + max_loss v must be positive for every sample.
[[nodiscard]] double fitted_loss(const std::vector<CurveSample>& samples, CurveShape shape, double max_loss_s_per_m);

/// The power law with the smallest sum of squared force errors at a given loss, exponent 0.1 to 10.
[[nodiscard]] PowerLaw nearest_power_law(const std::vector<CurveSample>& samples, double loss_s_per_m = 0);

/// Root mean square of the differences between the samples and curve (1 + loss v), relative to the largest force.
[[nodiscard]] double relative_scatter(const std::vector<CurveSample>& samples, const ForceCurve& curve,
                                      double loss_s_per_m = 0);

}  // namespace contactspline
