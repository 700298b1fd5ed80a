// SPDX-License-Identifier: MIT
// gnuplot: a script and a title become the bytes of an SVG, a PNG or a PDF that bears the mark of this program.
#pragma once

#include <string>

#include "generator/cli/figure_file.hpp"

namespace contactspline {

/// Stands in a script where the title of the figure goes.
inline constexpr auto kTitle = "TITLE-OF-THE-FIGURE";

[[nodiscard]] bool has_gnuplot();

/// Runs gnuplot with the common style. Throws BadInput if gnuplot is missing or fails.
[[nodiscard]] std::string draw(const std::string& script, const std::string& title, FigureKind kind,
                               FigureFormat format);

}  // namespace contactspline
