// SPDX-License-Identifier: MIT
// The figure of families of knots: the errors of several splines of one material.
#include <fmt/format.h>

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "generator/cli/error_panel.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"

namespace contactspline {
namespace {

/// The errors of one design over speed [m/s] and over compression [mm]; the largest are those of the table.
struct FamilyErrors {
  ErrorCurve duration, compression, force;
};

std::string curve_name(const Design& family) {
  const SplineDesign& spline = family.material.spline;
  return fmt::format("{}, {} segments",
                     spline.minimise == ErrorOf::spectrum ? name_of(spline.minimise) : name_of(spline.knots),
                     family.spline.segments.size());
}

FamilyErrors errors_of(const Design& design, std::size_t number) {
  constexpr int kSpeeds = 1500;
  const Material& material = design.material;
  const Impact& impact = *material.impact;
  const auto table = segment_table(design.spline);
  const double largest = material.contact.force(material.spline.max_compression_m);
  const ErrorCurve none{
      curve_name(design), fmt::format("lw 1.6 lc rgb '{}'", kColours[number % kColours.size()]), {}, {}};
  FamilyErrors errors{none, none, none};
  errors.duration.largest = design.quality.impact->contact_duration;
  errors.compression.largest = design.quality.impact->max_compression;
  errors.force.largest = design.quality.force.worst;
  const auto add = [](ErrorCurve& curve, double at, double error) {
    curve.at.push_back(at);
    curve.error.push_back(error);
  };
  for (int i = 0; i <= kSpeeds; ++i) {
    const double t = static_cast<double>(i) / kSpeeds;
    const double speed = impact.min_speed_m_per_s * std::pow(impact.max_speed_m_per_s / impact.min_speed_m_per_s, t);
    const SplineImpact found = impact_on_spline(design.spline, impact.mass_kg, speed);
    const double y = max_compression(material.contact, impact.mass_kg, speed);
    add(errors.duration, speed,
        found.contact_duration_s / contact_duration(material.contact, impact.mass_kg, speed) - 1);
    add(errors.compression, speed, found.max_compression_m / y - 1);
    add(errors.force, 1e3 * y, (force<double>(std::span(table), y) - material.contact.force(y)) / largest);
  }
  return errors;
}

}  // namespace

std::string figure_of(std::span<const Design> families, FigureFormat format) {
  std::vector<ErrorCurve> duration, compression, force;
  for (std::size_t i = 0; i < families.size(); ++i) {
    const FamilyErrors errors = errors_of(families[i], i);
    duration.push_back(envelope_of(errors.duration));
    compression.push_back(envelope_of(errors.compression));
    force.push_back(envelope_of(errors.force));
  }
  return draw(heading(kThreePanelsWithKey) +
                  error_panel("duration", "impact speed [m/s]", "contact duration error [%]", duration) +
                  error_panel("compression", "impact speed [m/s]", "max compression error [%]", compression) +
                  error_panel("force", "compression [mm]", "force error [% of largest]", force) + "unset multiplot",
              fmt::format("{}: families of knots", title_of(families.front().material)), FigureKind::kKnots, format);
}

}  // namespace contactspline
