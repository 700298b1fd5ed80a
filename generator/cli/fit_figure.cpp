// SPDX-License-Identifier: MIT
// The figure of a fit: data with the model, and their residuals.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
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

// The data and, where they are few, each file with the model in its colour; else the model.
std::string title_of(const std::vector<std::string>& files, std::size_t source) {
  constexpr std::size_t kMost = 6;
  if (files.size() == 1) return "model";
  if (files.size() <= kMost) return fmt::format("model, {}", files[source]);
  return source == 0 ? "model, a colour for each file" : "";
}

// The key goes to the half of the panel where the curves are lower.
std::string key_of(const std::vector<Data>& sources, Interval at) {
  double left = 0, right = 0;
  for (const Data& source : sources)
    for (const std::vector<double>& row : source.rows()) {
      double& highest = row[0] < (at.low + at.high) / 2 ? left : right;
      highest = std::max(highest, row[2]);
    }
  return fmt::format("set key top {} opaque noenhanced font ',12'\n", left < right ? "left" : "right");
}

/// How gnuplot draws the model of a source and its residuals.
struct SourceStyle {
  std::string model, residuals;
};

// Solid lines and discs for the first colours, then dashed lines and other points.
SourceStyle style_of(const PanelOfFit& panel, std::size_t source) {
  constexpr std::array kPoints = {7, 5, 9, 13};
  constexpr std::size_t kUsed = kColours.size() - 1;
  const std::string colour = fmt::format("lc rgb '{}'", kColours[1 + source % kUsed]);
  const bool is_smooth = std::string_view(panel.quantity) != "force over compression";  // it has two branches
  return {is_smooth ? fmt::format("lines lw 1.6 dt {} {}", 1 + source / kUsed % 4, colour)
                    : "points pt 7 ps 0.2 lw 1 " + colour,
          fmt::format("points pt {} ps 0.3 lw 1 {}", kPoints[source / kUsed % kPoints.size()], colour)};
}

std::string panels_of(const PanelOfFit& panel, const std::vector<Data>& sources,
                      const std::vector<std::string>& files) {
  std::string script;
  Interval at, value, residual;
  std::vector<std::string> values, residuals;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    script += sources[i].text();
    at.include(sources[i].range(1));
    value.include(sources[i].range(2));
    value.include(sources[i].range(3));
    residual.include(sources[i].range(4));
    const SourceStyle style = style_of(panel, i);
    const std::string& name = sources[i].name();
    const std::string title = title_of(files, i);
    values.push_back(fmt::format("${} using 1:2 with points pt 7 ps 0.25 lw 1 lc rgb '#888888' {}", name,
                                 i == 0 ? "title 'data'" : "notitle"));
    values.push_back(fmt::format("${} using 1:3 with {} {}", name, style.model,
                                 title.empty() ? "notitle" : "title " + in_quotes(title)));
    residuals.push_back(fmt::format("${} using 1:4 with {} notitle", name, style.residuals));
  }
  residual.include(0);
  script += linear_axis('x', at, panel.at) + linear_axis('y', value, panel.value);
  script += key_of(sources, at) + fmt::format("plot {}\n", fmt::join(values, ", "));
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
    std::vector<std::string> files;
    for (const FitQuality& quality : fit.qualities) {
      if (quality.quantity != panel.quantity) continue;
      sources.push_back(rows_of(panel, quality, sources.size()));
      files.push_back(quality.file);
    }
    if (sources.empty()) continue;
    ++rows;
    panels += panels_of(panel, sources, files);
  }
  const std::string layout = fmt::format("{},2 margins 0.085,0.985,0.085,0.93 spacing 0.1,0.13", rows);
  return draw(heading(layout) + panels + "unset multiplot", title, FigureKind::kFit, format);
}

}  // namespace contactspline
