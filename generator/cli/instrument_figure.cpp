// SPDX-License-Identifier: MIT
// The figure of an instrument: its diagram, drawn by gnuplot.
#include <fmt/format.h>

#include <string>
#include <string_view>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"
#include "generator/instrument/diagram.hpp"

namespace contactspline {
namespace {

constexpr DiagramSize kPage{1058, 707};  // of kWholePage in an SVG

std::string_view style_of(DiagramPart part) {
  switch (part) {
    case DiagramPart::kContact:
      return "lc rgb '#d55e00' lw 1.6 dt 1";
    case DiagramPart::kSpring:
      return "lc rgb '#0072b2' lw 2.4 dt 2";
    case DiagramPart::kLink:
      return "lc rgb '#009e73' lw 2.4 dt 1";
    case DiagramPart::kSupport:
      return "lc rgb '#888888' lw 5";
    case DiagramPart::kTable:
      return "lc rgb '#b8b8b8' lw 8";
    default:
      return "lc rgb '#555555' lw 3";
  }
}

std::string_view colour_of(DiagramPart part) {
  switch (part) {
    case DiagramPart::kContact:
      return "#d55e00";
    case DiagramPart::kSpring:
      return "#0072b2";
    case DiagramPart::kLink:
      return "#009e73";
    case DiagramPart::kPlace:
      return "#666666";
    default:
      return "#222222";
  }
}

std::string label(DiagramPoint at, std::string_view text, std::string_view alignment, std::string_view colour,
                  std::string_view style) {
  return fmt::format("set label '{}' at {:.4f},{:.4f} {} noenhanced front textcolor rgb '{}' font ',12' {}\n", text,
                     at.x, at.y, alignment, colour, style);
}

std::string script_of(const Diagram& diagram) {
  std::string script = fmt::format(
      "unset border\nunset tics\nunset grid\nunset key\nset style textbox opaque noborder margins "
      "0.2,0.2\nset xrange [0:1]\nset yrange [{}:{}]\n",
      diagram.bottom, diagram.top);
  for (const auto& [from, to, part] : diagram.lines)
    script += fmt::format("set arrow from {:.4f},{:.4f} to {:.4f},{:.4f} nohead {}\n", from.x, from.y, to.x, to.y,
                          style_of(part));
  for (const auto& [at, is_mass] : diagram.dots)
    script += label(at, "", "left", "#222222",
                    is_mass ? "point pt 5 ps 2.2 lc rgb '#555555'" : "point pt 7 ps 0.7 lc rgb '#222222'");
  for (const auto& [at, text, part] : diagram.labels)
    script += part == DiagramPart::kBody ? label(at, text, "left", colour_of(part), "")
                                         : label(at, text, "center", colour_of(part), "boxed");
  return script + "plot NaN\nunset multiplot\n";
}

}  // namespace

std::string figure_of(const InstrumentModel& model, FigureFormat format) {
  return draw(heading(kWholePage) + script_of(diagram_of(model, kPage)), title_of(model), FigureKind::kInstrument,
              format);
}

}  // namespace contactspline
