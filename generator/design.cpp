// SPDX-License-Identifier: MIT
#include "generator/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "generator/compensation.hpp"
#include "generator/energy_table.hpp"
#include "generator/error.hpp"
#include "generator/literal.hpp"
#include "generator/quality.hpp"

namespace contactspline {
namespace {

// As many digits as matter: a fit ends within 1e-8 of the same place on every machine, whatever its exp() and atan(),
// so that six digits are the same everywhere but for rare luck. Many segments need more, where the last ones may
// differ. So does a law with breaks, just beyond which the duration is off like the root of the energy.
int digits_of(const Material& material) {
  constexpr int kFew = 32;
  const SplineDesign& design = material.spline;
  if (!material.contact.breaks().empty()) return 10;
  return design.segments <= kFew ? 6 : design.segments <= kMostFittedSegments ? 8 : 12;
}

ForceLine line_for(const SplineDesign& design, const FitTarget& target) {
  if (design.knots == Knots::graded) return graded_line(design.segments, target);
  return design.minimise == ErrorOf::force ? least_force_error_line(design.segments, target)
                                           : optimal_line(design.segments, target);
}

ForceLine fitted_line(const Material& material) {
  if (!material.compensation) return line_for(material.spline, fit_target(material));
  const auto [target, end] = compensated_target(material);
  ForceLine line = line_for(material.spline, target);
  const double range = material.spline.max_compression_m;
  const double series = material.compensation->compliance_m_per_n * material.contact.force(range) / range;
  for (std::size_t j = 0; j < line.y.size(); ++j) {
    line.f[j] /= end;
    line.y[j] = end * line.y[j] + series * line.f[j];
  }
  return line;
}

// More digits where fewer would make two points one.
ForceLine rounded_line(const ForceLine& line, int digits) {
  ForceLine rounded = line;
  for (auto* values : {&rounded.y, &rounded.f})
    for (double& value : *values) value = rounded_to(value, digits);
  return rounded.rises() || digits >= 16 ? rounded : rounded_line(line, digits + 2);
}

Spline spline_of(const Material& material, std::string_view file) {
  if (material.spline.knots == Knots::uniform) return uniform_spline(material, file);
  const ForceLine line = fitted_line(material);
  if (!line.rises())
    throw BadInput(fmt::format(
        "{}: spline.knots: {} {} segments find no forces that rise from the touch on, as where a curve begins "
        "without force; allowed: a law that pushes from 0 on, or uniform knots",
        file, material.spline.segments, name_of(material.spline.knots)));
  return line_spline(rounded_line(line, digits_of(material)), material, file);
}

double error_of(const Spline& spline, const Material& material) {
  const Quality quality = measure_quality(spline, material);
  return material.spline.minimise == ErrorOf::force ? quality.force.worst : quality.impact->contact_duration;
}

// Doubles the segments until the tolerance is kept, then halves the interval: one segment fewer does not keep it.
// Errors need not fall with each segment, so a few numbers below are tried too.
Spline spline_within_tolerance(Material& material, std::string_view file) {
  SplineDesign& design = material.spline;
  constexpr int kMostSearched = 1024;
  constexpr double kMissed = 1.003;  // peaks of the error between the measured speeds
  const int most = design.knots == Knots::optimal ? kMostFittedSegments : kMostSearched;
  double error = 0;
  const auto within = [&](int segments) -> std::optional<Spline> {
    design.segments = segments;
    Spline spline = spline_of(material, file);
    error = error_of(spline, material);
    return error * kMissed <= design.tolerance ? std::optional(std::move(spline)) : std::nullopt;
  };
  int fails = 0, keeps = 1;
  std::optional<Spline> found;
  while (!(found = within(keeps))) {
    if (keeps == most)
      throw BadInput(fmt::format("{}: spline.tolerance: {} is not kept by {} {} segments; allowed: at least {:.4g}",
                                 file, design.tolerance, most, name_of(design.knots), error * 1.01));
    fails = std::exchange(keeps, std::min(2 * keeps, most));
  }
  while (keeps - fails > 1) {
    const int middle = (fails + keeps) / 2;
    if (auto fewer = within(middle)) {
      found = std::move(fewer);
      keeps = middle;
    } else {
      fails = middle;
    }
  }
  constexpr int kCheap = 64;  // uniform knots: all numbers below are tried
  const int looked = design.knots == Knots::optimal                     ? 2
                     : design.knots == Knots::uniform && keeps < kCheap ? keeps
                                                                        : std::clamp(keeps / 8, 3, 16);
  for (int fewer = keeps - 2; fewer > 0 && fewer >= keeps - 1 - looked; --fewer)
    if (auto better = within(fewer)) {
      found = std::move(better);
      keeps = fewer;
    }
  design.segments = keeps;
  return *std::move(found);
}

}  // namespace

std::function<double(double)> continued(std::function<double(double)> force) {
  constexpr double kStep = 1e-4;
  const double exponent = (1 - force(1 - kStep)) / kStep;
  return [=, force = std::move(force)](double y) { return y <= 1 ? force(y) : std::pow(y, exponent); };
}

FitTarget fit_target(const Material& material) {
  const Potential& contact = material.contact;
  const Impact& impact = *material.impact;
  const double range = material.spline.max_compression_m, largest = contact.force(range);
  const double energy = range * largest, second = std::sqrt(impact.mass_kg * range / largest);
  const double slowest = std::min(impact.min_speed_m_per_s, impact.max_speed_m_per_s / 2);
  const auto energy_of = [&](double speed) { return impact.mass_kg * speed * speed / 2 / energy; };
  const auto speed_of = [=, mass = impact.mass_kg](double stored) { return std::sqrt(2 * stored * energy / mass); };
  FitTarget target{
      [=](double y) { return contact.force(y * range) / largest; },
      [=, mass = impact.mass_kg](double stored) { return contact.max_compression(mass, speed_of(stored)) / range; },
      [=, mass = impact.mass_kg](double stored) {
        return contact.contact_duration(mass, speed_of(stored)) / (2 * second);
      },
      contact.max_compression(impact.mass_kg, slowest) / range,
      energy_of(slowest),
      energy_of(impact.max_speed_m_per_s)};
  if (contact.power_law() != nullptr) return target;
  target.force = continued(std::move(target.force));
  const bool layers = std::holds_alternative<PowerSum>(contact.law());
  for (const double y : contact.breaks())
    if (y < range) target.breaks.push_back({y / range, contact.energy(y) / energy, layers});
  return tabulated(std::move(target));
}

Spline design_spline(Material& material, std::string_view file) {
  return material.spline.tolerance > 0 ? spline_within_tolerance(material, file) : spline_of(material, file);
}

}  // namespace contactspline
