// SPDX-License-Identifier: MIT
// The figures of impacts: duration, force and restitution over the impact speed, and errors over speed or over the
// sample rate.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "generator/cli/error_panel.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"

namespace contactspline {
namespace {

constexpr auto kSixPanels = "3,2 margins 0.085,0.68,0.085,0.93 spacing 0.105,0.13 columnsfirst";
constexpr std::array kLineColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"};
constexpr std::array kPoints = {6, 4, 8, 12};  // circle, square, triangle, diamond

/// A quantity of an impact at a speed, in the unit of its axis.
struct Quantity {
  std::string name, axis;
  std::function<double(const BarrierImpact&, double speed)> of;
};

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = {
      {"duration", "contact duration [ms]",
       [](const BarrierImpact& impact, double) { return 1e3 * impact.contact_duration_s; }},
      {"force", "largest force [N]", [](const BarrierImpact& impact, double) { return impact.max_force_n; }},
      {"restitution", "restitution [1]",
       [](const BarrierImpact& impact, double speed) { return impact.exit_speed_m_per_s / speed; }}};
  return all;
}

const char* colour_of(std::size_t number) {
  return kLineColours[number % kLineColours.size()];
}

// Solid for the first colours, then dashed.
std::string line_style(std::size_t number) {
  return fmt::format("lw 1.6 lc rgb '{}' dt {}", colour_of(number), 1 + number / kLineColours.size() % 4);
}

Data values_of(const std::string& name, const ImpactSweep& sweep, std::size_t model, const Quantity& quantity) {
  Data data(name);
  for (const auto& [speed, impacts] : sweep.points) data.add({speed, quantity.of(impacts[model], speed)});
  return data;
}

// A wide pale line is exact, a narrow one the spline, points are simulated. The colour tells materials apart, or the
// models of a single material as in the panels of its errors.
std::string value_style(std::size_t sweep, std::size_t model, bool is_single) {
  if (model == 0) return is_single ? "lines lt 1" : fmt::format("lines lw 6 lc rgb '#a0{}'", colour_of(sweep) + 1);
  if (model == 1) return "lines " + line_style(is_single ? 0 : sweep);
  return fmt::format("points pt {} ps 0.6 lc rgb '{}'", kPoints[(model - 2) % kPoints.size()],
                     colour_of(is_single ? model - 1 : sweep));
}

// The materials by their colours, then in grey what the lines and points of all of them mean.
std::vector<KeyEntry> key_of(std::span<const ImpactSweep> sweeps) {
  std::vector<KeyEntry> key;
  for (std::size_t s = 0; s < sweeps.size(); ++s) key.push_back({sweeps[s].material, line_style(s)});
  key.push_back({"exact", "lw 6 lc rgb '#b8b8b8'"});
  key.push_back({"spline", "lw 1.6 lc rgb '#444444'"});
  const ImpactSweep& sweep = sweeps.front();
  for (std::size_t model = 2; model < sweep.models.size(); ++model)
    key.push_back({sweep.models[model],
                   fmt::format("pt {} ps 0.8 lc rgb '#444444'", kPoints[(model - 2) % kPoints.size()]), true});
  return key;
}

std::string value_panel(std::span<const ImpactSweep> sweeps, const Quantity& quantity) {
  std::string data;
  std::vector<std::string> plots;
  Interval speeds, values;
  const bool is_single = sweeps.size() == 1;
  for (std::size_t s = 0; s < sweeps.size(); ++s)
    for (std::size_t m = 0; m < sweeps[s].models.size(); ++m) {
      const Data line = values_of(fmt::format("{}_{}_{}", quantity.name, s, m), sweeps[s], m, quantity);
      data += line.text();
      speeds.include(line.range(1));
      values.include(line.range(2));
      plots.push_back(fmt::format("${} every {} using 1:2 with {} title '{}'", line.name(),
                                  m < 2 ? 1 : 1 + sweeps[s].points.size() / 20, value_style(s, m, is_single),
                                  is_single && m == 0 ? "exact" : ""));
    }
  const bool is_restitution = quantity.name == "restitution";
  return data + logarithmic_axis('x', speeds, "impact speed [m/s]") +
         (is_restitution ? "unset logscale y\n" + linear_axis('y', {0, std::max(1.0, values.high)}, quantity.axis)
                         : logarithmic_axis('y', between_tics(values), quantity.axis)) +
         fmt::format("plot {}\n{}", fmt::join(plots, ", "), kNoKey);
}

/// An error of an impact relative to the exact one, and the label of its axis.
struct ErrorOfImpact {
  const char* name;
  const char* axis;
  double BarrierImpact::*member;
};
constexpr ErrorOfImpact kErrors[] = {
    {"duration_error", "contact duration error [%]", &BarrierImpact::contact_duration_s},
    {"compression_error", "max compression error [%]", &BarrierImpact::max_compression_m},
    {"force_error", "max force error [%]", &BarrierImpact::max_force_n}};

double error_of(const ImpactPoint& point, std::size_t model, double BarrierImpact::*member) {
  return point.impacts[model].*member / (point.impacts.front().*member) - 1;
}

std::string speed_panel(const ImpactSweep& sweep, const ErrorOfImpact& error) {
  std::vector<ErrorCurve> curves;
  for (std::size_t model = 1; model < sweep.models.size(); ++model) {
    ErrorCurve curve{sweep.models[model], line_style(model - 1), {}, {}};
    for (const ImpactPoint& point : sweep.points) {
      curve.at.push_back(point.speed_m_per_s);
      curve.error.push_back(error_of(point, model, error.member));
    }
    curves.push_back(envelope_of(curve));
  }
  return error_panel(error.name, "impact speed [m/s]", error.axis, curves);
}

// The models of a sweep that are simulated, by rising sample rate.
std::vector<std::size_t> by_rate(const ImpactSweep& sweep) {
  std::vector<std::size_t> models;
  for (std::size_t model = 0; model < sweep.models.size(); ++model)
    if (sweep.sample_rates_hz[model] > 0) models.push_back(model);
  std::ranges::sort(models, {}, [&](std::size_t model) { return sweep.sample_rates_hz[model]; });
  return models;
}

// A line for each material and speed, and a pale one for the error of its spline alone.
std::string rate_panel(std::span<const ImpactSweep> sweeps, const ErrorOfImpact& error) {
  std::vector<ErrorCurve> curves;
  std::size_t number = 0;
  for (const ImpactSweep& sweep : sweeps)
    for (const ImpactPoint& point : sweep.points) {
      const std::string name = fmt::format("{}, {:.3g} m/s", sweep.material, point.speed_m_per_s);
      ErrorCurve simulated{name, line_style(number), {}, {}};
      ErrorCurve spline{"", fmt::format("lw 3 lc rgb '#a0{}'", colour_of(number++) + 1), {}, {}};
      for (const std::size_t model : by_rate(sweep)) {
        simulated.at.push_back(sweep.sample_rates_hz[model] / 1000);
        simulated.error.push_back(error_of(point, model, error.member));
        spline.at.push_back(simulated.at.back());
        spline.error.push_back(error_of(point, 1, error.member));
      }
      curves.push_back(simulated);
      curves.push_back(spline);
    }
  return error_panel(error.name, "sample rate [kHz]; pale: the spline alone", error.axis, curves);
}

Data data_of(const std::string& name, std::span<const double> times, std::span<const double> values,
             std::span<const double> more = {}) {
  Data data(name);
  for (std::size_t i = 0; i < times.size(); ++i) data.add({1e3 * times[i], values[i] + (more.empty() ? 0 : more[i])});
  return data;
}

// A curve of each course over time; dashed after it those that are drawn too.
std::string time_panel(const std::string& label, const std::vector<Data>& curves,
                       const std::vector<std::string>& styles) {
  Interval time, value;
  std::string text;
  std::vector<std::string> plots;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    text += curves[i].text();
    time.include(curves[i].range(1));
    value.include(curves[i].range(2));
    plots.push_back(fmt::format("${} using 1:2 with lines {}", curves[i].name(), styles[i]));
  }
  value.include(0);
  return text + linear_axis('x', time, "time since the touch [ms]") + linear_axis('y', value, label) +
         fmt::format("plot {}\n", fmt::join(plots, ", "));
}

}  // namespace

std::string figure_over_time(std::span<const ImpactCourse> courses, const std::string& title, FigureFormat format) {
  const auto style = [&](std::size_t number, int dash) {
    return courses[number].is_exact ? fmt::format("lw 6 lc rgb '#b8b8b8' dt {}", dash)
                                    : fmt::format("lw 1.6 lc rgb '{}' dt {}", colour_of(number), dash);
  };
  std::vector<Data> forces, speeds, energies;
  std::vector<std::string> styles, energy_styles;
  std::vector<KeyEntry> key;
  for (std::size_t i = 0; i < courses.size(); ++i) {
    const ImpactCourse& course = courses[i];
    forces.push_back(data_of(fmt::format("force_{}", i), course.time_s, course.force_n));
    speeds.push_back(data_of(fmt::format("speed_{}", i), course.time_s, course.speed_m_per_s));
    energies.push_back(data_of(fmt::format("kinetic_{}", i), course.time_s, course.kinetic_j));
    styles.push_back(style(i, 1));
    energy_styles.push_back(style(i, 1));
    key.push_back({course.name, style(i, 1)});
    if (course.stored_j.empty()) continue;
    energies.push_back(data_of(fmt::format("total_{}", i), course.time_s, course.kinetic_j, course.stored_j));
    energy_styles.push_back(style(i, 2));
  }
  key.push_back({"energy of the mass", "lw 1.6 lc rgb '#444444' dt 1"});
  // In SVG gnuplot draws a line with the dashes of the one before it if both have one colour.
  if (energies.size() > courses.size()) key.push_back({"and of the contact", "lw 1.6 lc rgb '#454545' dt 2"});
  return draw(heading(kThreePanelsWithKey) + "unset key\n" + key_beside("", key) +
                  time_panel("contact force [N]", forces, styles) + kNoKey +
                  time_panel("speed into the barrier [m/s]", speeds, styles) +
                  time_panel("energy [J]", energies, energy_styles) + "unset multiplot",
              title, FigureKind::kImpacts, format);
}

std::string figure_over_speed(std::span<const ImpactSweep> sweeps, const std::string& title, FigureFormat format) {
  const bool has_errors = sweeps.size() == 1;
  std::string script = heading(has_errors ? kSixPanels : kThreePanelsWithKey);
  script += has_errors ? "set key inside bottom left samplen 1.5 font ',12'\n" : key_beside("", key_of(sweeps));
  for (const Quantity& quantity : quantities()) script += value_panel(sweeps, quantity);
  if (has_errors)
    for (const ErrorOfImpact& error : kErrors) script += speed_panel(sweeps.front(), error);
  return draw(script + "unset multiplot", title, FigureKind::kImpacts, format);
}

std::string figure_over_rate(std::span<const ImpactSweep> sweeps, const std::string& title, FigureFormat format) {
  std::string script = heading(kThreePanelsWithKey);
  for (const ErrorOfImpact& error : kErrors) script += rate_panel(sweeps, error);
  return draw(script + "unset multiplot", title, FigureKind::kImpacts, format);
}

}  // namespace contactspline
