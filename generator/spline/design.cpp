// SPDX-License-Identifier: MIT
#include "generator/spline/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "generator/spline/compensation.hpp"
#include "generator/spline/fit_target.hpp"
#include "generator/spline/graded_knots.hpp"
#include "generator/spline/minimax_force.hpp"
#include "generator/spline/minimax_knots.hpp"
#include "generator/spline/spectrum_error.hpp"
#include "generator/spline/spectrum_knots.hpp"
#include "generator/support/error.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

// Digits to which the fitted points are rounded. On every machine a fit ends within 1e-8 of the same points, although
// exp() and atan() differ, so six digits agree except in rare cases. Many segments need more digits, of which the
// last may differ between machines. A law with breaks needs more digits too: just above a break the error of the
// duration grows like the square root of an error of the energy.
int rounding_digits(const Material& material) {
  constexpr int kMaxCoarse = 32;
  const SplineDesign& design = material.spline;
  if (!material.contact.breaks().empty()) return 10;
  return design.segments <= kMaxCoarse ? 6 : design.segments <= kMaxFittedSegments ? 8 : 12;
}

// The spectra of very short contacts say nothing about a spline.
void require_spectrum(const Material& material, std::string_view file) {
  if (has_spectrum(material)) return;
  refuse(file, "spline.minimise",
         fmt::format("the contacts are so short that nothing of their spectrum can be compared below {:g} Hz",
                     kMaxSpectrumFrequency_hz),
         "contact_duration");
}

PiecewiseLinearForce fit(const SplineDesign& design, const FitTarget& target) {
  if (design.knots == Knots::graded) return graded_knots(design.segments, target);
  if (design.minimise == ErrorOf::spectrum) return spectrum_knots(design.segments, target);
  return design.minimise == ErrorOf::force ? minimax_force(design.segments, target)
                                           : minimax_knots(design.segments, target);
}

// The fitted force, relative to max_compression_m and the force there.
PiecewiseLinearForce fitted_force(const Material& material) {
  if (!material.compensation) return fit(material.spline, fit_target(material));
  const auto [target, end] = compensated_target(material);
  PiecewiseLinearForce force = fit(material.spline, target);
  for (double& f : force.f) f /= end;
  for (double& y : force.y) y *= end;
  return force;
}

// Rounds all points; uses more digits if two points would become equal.
PiecewiseLinearForce rounded_force(const PiecewiseLinearForce& force, int digits) {
  PiecewiseLinearForce rounded = force;
  for (auto* values : {&rounded.y, &rounded.f})
    for (double& value : *values) value = rounded_to(value, digits);
  return rounded.rises() || digits >= 16 ? rounded : rounded_force(force, digits + 2);
}

Spline spline_of(const Material& material, std::string_view file) {
  if (material.spline.knots == Knots::uniform) return uniform_spline(material, file);
  const PiecewiseLinearForce force = fitted_force(material);
  if (!force.rises())
    refuse(file, "spline.knots",
           fmt::format("no rising force was found for {} {} segments (a curve may begin with zero force)",
                       material.spline.segments, name_of(material.spline.knots)),
           "a law with a positive force from 0 on, or uniform knots");
  return spline_through(rounded_force(force, rounding_digits(material)), material, file);
}

// The error that the tolerance of a material bounds. A bound in decibels holds for splines whose contact duration is
// within 1 %: the spectrum of a soft impact has little to compare.
double error_of(const Spline& spline, const Material& material) {
  constexpr double kMaxDurationError = 0.01;
  const Quality quality = measure_quality(spline, material);
  if (material.spline.minimise == ErrorOf::spectrum)
    return quality.impact->contact_duration <= kMaxDurationError ? measure_spectrum(spline, material)->worst_db
                                                                 : std::numeric_limits<double>::infinity();
  return material.spline.minimise == ErrorOf::force ? quality.force.worst : quality.impact->contact_duration;
}

/// The search for the smallest number of segments whose error is within the material's tolerance.
class ToleranceSearch {
 public:
  ToleranceSearch(Material& material, std::string_view file)
      : material_(material),
        file_(file),
        max_(material.spline.knots == Knots::optimal ? kMaxFittedSegments : kMaxSearched) {}

  /// Leaves the number in the material. Throws BadInput if the largest number does not meet the tolerance.
  Spline smallest() {
    double_until_met();
    bisect();
    try_smaller();
    material_.spline.segments = met_;
    return *std::move(best_);
  }

 private:
  static constexpr int kMaxSearched = 1024;

  // Designs a spline with that many segments, and keeps it if it meets the tolerance.
  bool meets_tolerance(int segments) {
    constexpr double kMargin = 1.003;  // for peaks of the error between the measured speeds
    material_.spline.segments = segments;
    Spline spline = spline_of(material_, file_);
    error_ = error_of(spline, material_);
    if (!(error_ * kMargin <= material_.spline.tolerance)) return false;
    best_ = std::move(spline);
    met_ = segments;
    return true;
  }

  void double_until_met() {
    for (int segments = 1; !meets_tolerance(segments); segments = std::min(2 * segments, max_)) {
      if (segments == max_) refuse_tolerance();
      missed_ = segments;
    }
  }

  void bisect() {
    while (met_ - missed_ > 1) {
      const int middle = (missed_ + met_) / 2;
      if (!meets_tolerance(middle)) missed_ = middle;
    }
  }

  // The error does not fall with every segment, so a smaller number may meet the tolerance even if missed_ does not.
  // For uniform knots, whose splines are cheap, all smaller numbers are tried; not for series, whose force is a root
  // that each integral seeks at every point.
  void try_smaller() {
    const int tries = max_tries();
    for (int fewer = met_ - 2; fewer > 0 && fewer >= met_ - 1 - tries; --fewer)
      meets_tolerance(fewer);  // updates met_
  }
  [[nodiscard]] int max_tries() const {
    constexpr int kMaxTriedFully = 64;
    const SplineDesign& design = material_.spline;
    const bool is_cheap = !std::holds_alternative<PowerSeries>(material_.contact.law());
    if (design.knots == Knots::uniform && is_cheap && met_ < kMaxTriedFully) return met_;
    if (design.knots == Knots::optimal && design.minimise != ErrorOf::spectrum) return 2;
    return std::clamp(met_ / 8, 3, 16);
  }

  [[noreturn]] void refuse_tolerance() const {
    refuse(file_, material_.spline.minimise == ErrorOf::spectrum ? "spline.tolerance_db" : "spline.tolerance",
           fmt::format("{} is not met by {} {} segments", material_.spline.tolerance, max_,
                       name_of(material_.spline.knots)),
           fmt::format("at least {:.4g}", error_ * 1.01));
  }

  Material& material_;
  std::string_view file_;
  int max_;
  int missed_ = 0, met_ = 0;  // numbers of segments that miss and meet the tolerance
  double error_ = 0;
  std::optional<Spline> best_;
};

}  // namespace

Spline design_spline(Material& material, std::string_view file) {
  if (material.spline.minimise == ErrorOf::spectrum) require_spectrum(material, file);
  if (material.compensation) require_compensable(material, file);
  return material.spline.tolerance > 0 ? ToleranceSearch(material, file).smallest() : spline_of(material, file);
}

Design design_material(Material material, std::string_view file) {
  const Spline spline = design_spline(material, file);
  return {material, spline, measure_quality(spline, material), measure_spectrum(spline, material)};
}

Design design_material(std::string_view text, std::string_view file, const ReadFile& read) {
  return design_material(parse_material(text, file, read), file);
}

}  // namespace contactspline
