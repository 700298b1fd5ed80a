// SPDX-License-Identifier: MIT
// The figure of a spline: potential and force beside the contact law, and their errors.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"
#include "generator/spline/exponent_family.hpp"

namespace contactspline {
namespace {

constexpr int kPointsPerSegment = 24;
constexpr int kMaxCurvePoints = 4096;
constexpr std::size_t kMaxKnots = 1024;

constexpr auto kCurvesOverCompression =
    "$curve using 1:{0} with lines lt 1 title law, '' using 1:{1} with lines lt 2 title 'spline', "
    "$knots using 1:{2} with points lt 4 title 'knots'";
constexpr auto kErrorOverCompression = "plot $curve using 1:{} with lines lt 3, $knots using 1:{} with points lt 4\n";

// The segments whose knots are drawn: all, or every second and so on of very many.
std::vector<Segment<double>> drawn_segments(const Design& design) {
  const auto& segments = design.spline.segments;
  std::vector<Segment<double>> drawn;
  for (std::size_t j = 0; j < segments.size(); j += 1 + (segments.size() - 1) / kMaxKnots)
    drawn.push_back(segments[j]);
  return drawn;
}

// Compressions [m] from 0 to the end of the range, close together, and the knots, where the curves have kinks.
std::vector<double> compressions_of(const Design& design) {
  const double range = design.material.spline.max_compression_m;
  const int points = std::min(kMaxCurvePoints, kPointsPerSegment * design.material.spline.segments);
  std::vector<double> compressions;
  for (int i = 0; i <= points; ++i) compressions.push_back(range * i / points);
  for (const auto& segment : drawn_segments(design))
    if (segment.knot <= range) compressions.push_back(segment.knot);
  std::ranges::sort(compressions);
  return compressions;
}

// Columns: compression [mm]; potential [mJ], exact and of the spline; force [N] likewise; errors of both in percent.
Data curve_data(const Design& design) {
  const ContactLaw& contact = design.material.contact;
  const auto table = segment_table(design.spline);
  const std::span view(table);
  const double range = design.material.spline.max_compression_m;
  const double top_energy = contact.energy(range), top_force = contact.force(range);
  Data data("curve");
  for (const double y : compressions_of(design)) {
    const double v = potential<double>(view, y), f = force<double>(view, y);
    const double exact_v = contact.energy(y), exact_f = contact.force(y);
    data.add({1e3 * y, 1e3 * exact_v, 1e3 * v, exact_f, f, 100 * (v - exact_v) / top_energy,
              100 * (f - exact_f) / top_force});
  }
  return data;
}

// Columns: compression [mm], potential [mJ], force [N], errors of both in percent.
Data knot_data(const Design& design) {
  const Material& material = design.material;
  const double range = material.spline.max_compression_m;
  Data data("knots");
  for (const auto& s : drawn_segments(design))
    data.add({1e3 * s.knot, 1e3 * s.energy, s.force,
              100 * (s.energy - material.contact.energy(s.knot)) / material.contact.energy(range),
              100 * (s.force - material.contact.force(s.knot)) / material.contact.force(range)});
  return data;
}

// The measured samples within the range of the spline.
Data measured_data(const Material& material) {
  Data data("measured");
  for (const auto& [y, f, speed] : material.measured->samples)
    if (y <= material.spline.max_compression_m) data.add({1e3 * y, f});
  return data;
}

// The force with the fitted loss at the speeds of the measured impact: in, to the turning point and out. The line
// breaks where samples lie beyond the range of the spline.
Data branches_data(const Material& material) {
  std::vector<CurveSample> samples = material.measured->samples;
  std::ranges::stable_sort(samples, {}, [](const CurveSample& sample) {
    return sample.speed_m_per_s < 0 ? 1 / sample.compression_m : -1 / sample.compression_m;
  });
  Data data("branches");
  for (const auto& [y, f, speed] : samples)
    data.add(y <= material.spline.max_compression_m
                 ? std::vector{1e3 * y, material.contact.force(y) * (1 + material.loss_s_per_m * speed)}
                 : std::vector<double>{});
  return data;
}

// The forces of the members of a live exponent's family, within the range of the spline.
Data members_data(const Design& design) {
  constexpr int kPoints = 200;
  const double range = design.material.spline.max_compression_m;
  Data data("members");
  for (const auto& member :
       exponent_family(design.material, static_cast<int>(design.spline.segments.size())).members) {
    for (int i = 0; i <= kPoints; ++i) {
      const double y = range * i / kPoints;
      data.add({1e3 * y, force<double>(std::span(member), y)});
    }
    data.add({});  // ends the line
  }
  return data;
}

std::string_view law_of(const Material& material) {
  const std::string_view name = name_of_law(material);
  return name == "sum"        ? "sum of power laws"
         : name == "series"   ? "power laws in series"
         : name == "measured" ? "smoothed curve"
                              : name;
}

/// The data and the curves of the panel of the force, from the back to the front.
struct ForcePanel {
  std::string data;
  std::vector<std::string> curves;
  Interval force;

  void add(const Data& points, std::string_view style, const std::string& title) {
    if (points.range(1).is_empty()) return;
    data += points.text();
    force.include(points.range(2));
    curves.push_back(fmt::format("${} using 1:2 with {} title {}", points.name(), style, in_quotes(title)));
  }
};

ForcePanel force_panel(const Design& design, const Data& curve) {
  const Material& material = design.material;
  ForcePanel panel{{}, {}, curve.range(4)};
  if (const auto& live = material.live_exponent)
    panel.add(members_data(design), "lines lt 6", fmt::format("exponents {:g} to {:g}", live->min, live->max));
  panel.curves.push_back(fmt::format(kCurvesOverCompression, 4, 5, 3));
  if (!material.measured) return panel;
  panel.add(measured_data(material), "points lt 5", "measured");
  if (material.measured->impact_speed_m_per_s)
    panel.add(branches_data(material), "lines lw 1.6 lc rgb '#009e73'",
              fmt::format("with loss {:.2g} s/m", material.loss_s_per_m));
  return panel;
}

std::string error_panel(std::string_view what, Interval range, int column, const Data& knots, int knot_column) {
  range.include(knots.range(static_cast<std::size_t>(knot_column)));
  return linear_axis('y', range, fmt::format("{} error [% of largest]", what)) +
         fmt::format(kErrorOverCompression, column, knot_column);
}

}  // namespace

std::string figure_of(const Design& design, FigureFormat format) {
  const Data curve = curve_data(design), knots = knot_data(design);
  const ForcePanel force = force_panel(design, curve);
  const std::string script =
      curve.text() + knots.text() + force.data + heading(kFourPanels) +
      fmt::format("law = '{}'\n", law_of(design.material)) + linear_axis('x', curve.range(1), "compression [mm]") +
      linear_axis('y', curve.range(2), "contact potential [mJ]") + "plot " +
      fmt::format(kCurvesOverCompression, 2, 3, 2) + "\n" + linear_axis('y', force.force, "contact force [N]") +
      fmt::format("plot {}\nunset key\n", fmt::join(force.curves, ", ")) +
      error_panel("potential", curve.range(6), 6, knots, 4) + error_panel("force", curve.range(7), 7, knots, 5) +
      "unset multiplot";
  return draw(script, fmt::format("{}: {} segments", title_of(design.material), design.spline.segments.size()),
              FigureKind::kSpline, format);
}

}  // namespace contactspline
