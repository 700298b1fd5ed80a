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

/// The target of a material that keeps its impacts: its table of durations is computed once.
class TargetOf {
 public:
  const FitTarget& operator()(const Material& material) {
    if (!target_) target_ = fit_target(material);
    return *target_;
  }

 private:
  std::optional<FitTarget> target_;
};

// The fitted force, relative to max_compression_m and the force there.
PiecewiseLinearForce fitted_force(const Material& material, TargetOf& target_of) {
  if (!material.compensation) return fit(material.spline, target_of(material));
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

Spline spline_of(const Material& material, std::string_view file, TargetOf& target_of) {
  if (material.spline.knots == Knots::uniform) return uniform_spline(material, file);
  const PiecewiseLinearForce force = fitted_force(material, target_of);
  if (!force.rises())
    refuse(file, "spline.knots",
           fmt::format("no rising force was found for {} {} segments (a curve may begin with zero force)",
                       material.spline.segments, name_of(material.spline.knots)),
           "a law with a positive force from 0 on, or uniform knots");
  return spline_through(rounded_force(force, rounding_digits(material)), material, file);
}

/// The error that the tolerance of a material bounds; a lower bound of it where that is above the tolerance already.
struct ToleratedError {
  double value;
  bool is_lower_bound;
};

// A bound in decibels holds for splines whose contact duration is within 1 %: the spectrum of a soft impact has
// little to compare.
ToleratedError error_of(const Spline& spline, const Material& material) {
  constexpr double kMaxDurationError = 0.01, kNever = std::numeric_limits<double>::infinity();
  const SplineDesign& design = material.spline;
  if (design.minimise == ErrorOf::force) return {measure_quality(spline, material).force.worst, false};
  const bool of_spectrum = design.minimise == ErrorOf::spectrum;
  const double min_error = min_duration_error(spline, material);
  if (!(min_error <= (of_spectrum ? kMaxDurationError : design.tolerance)))
    return {of_spectrum ? kNever : min_error, true};
  const double duration = measure_quality(spline, material).impact->contact_duration;
  if (!of_spectrum) return {duration, false};
  return {duration <= kMaxDurationError ? measure_spectrum(spline, material)->worst_db : kNever, false};
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
    Spline spline = spline_of(material_, file_, target_of_);
    error_ = error_of(spline, material_);
    if (!(error_.value * kMargin <= material_.spline.tolerance)) return false;
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
           fmt::format("at least {:.4g}", error_.value * (error_.is_lower_bound ? 1.5 : 1.01)));
  }

  Material& material_;
  std::string_view file_;
  int max_;
  int missed_ = 0, met_ = 0;  // numbers of segments that miss and meet the tolerance
  ToleratedError error_ = {};
  TargetOf target_of_;
  std::optional<Spline> best_;
};

}  // namespace

Spline design_spline(Material& material, std::string_view file) {
  if (material.spline.minimise == ErrorOf::spectrum) require_spectrum(material, file);
  if (material.compensation) require_compensable(material, file);
  if (material.spline.tolerance > 0) return ToleranceSearch(material, file).smallest();
  TargetOf target_of;
  return spline_of(material, file, target_of);
}

Design design_material(Material material, std::string_view file) {
  const Spline spline = design_spline(material, file);
  return {material, spline, measure_quality(spline, material), measure_spectrum(spline, material)};
}

Design design_material(std::string_view text, std::string_view file, const ReadFile& read) {
  return design_material(parse_material(text, file, read), file);
}

}  // namespace contactspline
