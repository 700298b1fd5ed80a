// SPDX-License-Identifier: MIT
// The figure of two surfaces that rub: force over the way at several temperatures, coefficient over the speed.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"

namespace contactspline {
namespace {

constexpr auto kTwoPanelsWithKey = "2,1 margins 0.115,0.68,0.09,0.93 spacing 0,0.15";
constexpr std::array kNormalForces_n = {0.1, 0.3, 1.0, 3.0, 10.0};
constexpr Interval kSpeeds_m_per_s{0.001, 10};

// A curve of a panel, which it names.
struct Curve {
  Data data;
  std::string meaning;
};

std::string panel(const std::vector<Curve>& curves, const std::string& axes, const std::string& title) {
  std::string data, plot;
  std::vector<KeyEntry> key;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string style = fmt::format("lc rgb '{}' lw 2", kColours[i % kColours.size()]);
    data += curves[i].data.text();
    plot += fmt::format("{} ${} using 1:2 with lines {}", i == 0 ? "plot" : ",", curves[i].data.name(), style);
    key.push_back({curves[i].meaning, style});
  }
  return data + axes + key_beside(title, key) + plot + "\n";
}

std::string over_the_way(const RubbingSurfaces& surfaces) {
  const auto& [bristles, heat] = surfaces.friction;
  const double end_m = 1.5 * heat.cold_coefficient / bristles.stiffness_per_m;
  std::vector<Curve> curves;
  for (const double part : {0.0, 0.5, 1.0, 2.0, 4.0}) {
    const double temperature_k = part * heat.softening_k, coefficient = coefficient_at(surfaces, temperature_k);
    Data data(fmt::format("way_{}", curves.size()));
    for (const double x : {0.0, coefficient / bristles.stiffness_per_m, end_m})
      data.add({1e6 * x, std::min(bristles.stiffness_per_m * x, coefficient)});
    curves.push_back({std::move(data), fmt::format("{:g} K", temperature_k)});
    if (!surfaces.warms()) break;
  }
  return panel(curves,
               linear_axis('x', {0, 1e6 * end_m}, "way along each other [um]") +
                   linear_axis('y', {0, heat.cold_coefficient}, "force over normal force [1]"),
               "above ambient");
}

std::string over_the_speed(const RubbingSurfaces& surfaces) {
  constexpr int kSteps = 120;
  std::vector<Curve> curves;
  for (const double force_n : kNormalForces_n) {
    Data data(fmt::format("speed_{}", curves.size()));
    for (int i = 0; i <= kSteps; ++i) {
      const double speed =
          kSpeeds_m_per_s.low * std::pow(kSpeeds_m_per_s.high / kSpeeds_m_per_s.low, double(i) / kSteps);
      data.add({speed, steady_sliding(surfaces, speed, force_n).coefficient});
    }
    curves.push_back({std::move(data), fmt::format("{:g} N", force_n)});
    if (!surfaces.warms()) break;
  }
  if (!surfaces.warms()) curves.front().meaning = "any force";
  return panel(curves,
               logarithmic_axis('x', kSpeeds_m_per_s, "speed of slip that goes on [m/s]") +
                   linear_axis('y', {0, surfaces.friction.heat.cold_coefficient}, "coefficient [1]"),
               "normal force");
}

}  // namespace

std::string figure_of(const RubbingSurfaces& surfaces, FigureFormat format) {
  return draw(heading(kTwoPanelsWithKey) + "unset key\n" + over_the_way(surfaces) + over_the_speed(surfaces) +
                  "unset multiplot",
              title_of(surfaces), FigureKind::kFriction, format);
}

}  // namespace contactspline
