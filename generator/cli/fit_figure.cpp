// SPDX-License-Identifier: MIT
// The figure of a fit: data with the model, and their residuals.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"
#include "generator/fit/fit_panels.hpp"

namespace contactspline {
namespace {

bool is_of_levels(const PanelOfFit& panel) {
  return std::string_view(panel.quantity) == kLevels;
}

// Rows of place, measured, modelled and residual in percent or dB, by rising place.
Data rows_of(const PanelOfFit& panel, const FitQuality& quality, std::size_t number) {
  Data data(fmt::format("fit_{}_{}", &panel - kFitPanels, number));
  // 100 cancels the percent: residuals of levels stay in dB.
  const double largest = is_of_levels(panel) ? 100 : std::ranges::max(quality.measured);
  std::vector<std::size_t> order(quality.at.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return quality.at[i]; });
  for (const std::size_t i : order) {
    const double scale = panel.is_relative ? quality.measured[i] : largest;
    data.add({panel.at_scale * (quality.at[i] - (panel.from_begin ? quality.at.front() : 0)),
              panel.value_scale * quality.measured[i], panel.value_scale * quality.modelled[i],
              100 * (quality.measured[i] - quality.modelled[i]) / scale});
  }
  return data;
}

std::string panels_of(const PanelOfFit& panel, const std::vector<Data>& sources) {
  std::string script;
  Interval at, value, residual;
  std::vector<std::string> values, residuals;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    script += sources[i].text();
    at.include(sources[i].range(1));
    value.include(sources[i].range(2));
    value.include(sources[i].range(3));
    residual.include(sources[i].range(4));
    const char* colour = kColours[1 + i % (kColours.size() - 1)];
    const bool is_smooth = std::string_view(panel.quantity) != "force over compression";  // it has two branches
    values.push_back(
        fmt::format("${} using 1:2 with points pt 7 ps 0.25 lw 1 lc rgb '#888888' notitle", sources[i].name()));
    values.push_back(fmt::format("${} using 1:3 with {} lc rgb '{}' notitle", sources[i].name(),
                                 is_smooth ? "lines lw 1.6" : "points pt 7 ps 0.2 lw 1", colour));
    residuals.push_back(
        fmt::format("${} using 1:4 with points pt 7 ps 0.3 lw 1 lc rgb '{}' notitle", sources[i].name(), colour));
  }
  residual.include(0);
  script += linear_axis('x', at, panel.at) + linear_axis('y', value, panel.value);
  script += fmt::format("plot {}\n", fmt::join(values, ", "));
  script += linear_axis('y', residual,
                        is_of_levels(panel) ? "residual [dB]"
                        : panel.is_relative ? "residual [%]"
                                            : "residual, of the largest force [%]");
  return script + fmt::format("plot {}\n", fmt::join(residuals, ", "));
}

}  // namespace

std::string figure_of(const Fit& fit, const std::string& title, FigureFormat format) {
  std::string panels;
  int rows = 0;
  for (const PanelOfFit& panel : kFitPanels) {
    std::vector<Data> sources;
    for (const FitQuality& quality : fit.qualities)
      if (quality.quantity == panel.quantity) sources.push_back(rows_of(panel, quality, sources.size()));
    if (sources.empty()) continue;
    ++rows;
    panels += panels_of(panel, sources);
  }
  const std::string layout = fmt::format("{},2 margins 0.085,0.985,0.085,0.93 spacing 0.1,0.13", rows);
  return draw(heading(layout) + panels + "unset multiplot", title, FigureKind::kFit, format);
}

}  // namespace contactspline
