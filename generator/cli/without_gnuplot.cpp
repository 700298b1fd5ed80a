// SPDX-License-Identifier: MIT
// What gnuplot.cpp does, on a system for which it is not written.
#include "generator/cli/gnuplot.hpp"
#include "generator/support/error.hpp"

namespace contactspline {

std::string draw(const std::string& /*script*/, const std::string& /*title*/, FigureKind /*kind*/,
                 FigureFormat /*format*/) {
  throw BadInput("figure: this program does not draw on Windows; allowed: no --figure, or --no-figure");
}

bool has_gnuplot() {
  return false;
}

}  // namespace contactspline
