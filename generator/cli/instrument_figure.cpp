// SPDX-License-Identifier: MIT
// The figure of an instrument: its diagram, drawn by gnuplot.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"
#include "generator/instrument/diagram.hpp"

namespace contactspline {
namespace {

constexpr DiagramSize kPage{1058, 707};  // of kWholePage in an SVG

/// How gnuplot draws the lines of a part and the colour of its labels; empty where it has none.
struct Look {
  DiagramPart part;
  std::string_view line, label;
};
constexpr Look kLooks[] = {{DiagramPart::kContact, "lc rgb '#d55e00' lw 1.6 dt 1", "#d55e00"},
                           {DiagramPart::kSpring, "lc rgb '#0072b2' lw 2.4 dt 2", "#0072b2"},
                           {DiagramPart::kLink, "lc rgb '#009e73' lw 2.4 dt 1", "#009e73"},
                           {DiagramPart::kFriction, "lc rgb '#aa4499' lw 2.4 dt 3", "#aa4499"},
                           {DiagramPart::kSupport, "lc rgb '#888888' lw 5", ""},
                           {DiagramPart::kBody, "lc rgb '#555555' lw 3", "#222222"},
                           {DiagramPart::kTable, "lc rgb '#b8b8b8' lw 8", ""},
                           {DiagramPart::kPlace, "", "#666666"}};

const Look& look_of(DiagramPart part) {
  return *std::ranges::find(kLooks, part, &Look::part);
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
                          look_of(part).line);
  for (const auto& [at, is_mass] : diagram.dots)
    script += label(at, "", "left", "#222222",
                    is_mass ? "point pt 5 ps 2.2 lc rgb '#555555'" : "point pt 7 ps 0.7 lc rgb '#222222'");
  for (const auto& [at, text, part] : diagram.labels)
    script += part == DiagramPart::kBody ? label(at, text, "left", look_of(part).label, "")
                                         : label(at, text, "center", look_of(part).label, "boxed");
  return script + "plot NaN\nunset multiplot\n";
}

}  // namespace

std::string figure_of(const InstrumentModel& model, FigureFormat format) {
  return draw(heading(kWholePage) + script_of(diagram_of(model, kPage)), title_of(model), FigureKind::kInstrument,
              format);
}

}  // namespace contactspline
