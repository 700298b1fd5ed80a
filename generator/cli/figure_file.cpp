// SPDX-License-Identifier: MIT
#include "generator/cli/figure_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "generator/cli/file_ending.hpp"
#include "generator/cli/files.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

// In the order of FigureKind.
constexpr std::array<std::string_view, 8> kKinds = {
    "figure of a spline",      "figure of knots",   "figure of impacts", "figure of a resonator",
    "figure of an instrument", "figure of a sound", "figure of a fit",   "figure of friction"};

std::string_view name_of(FigureKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

}  // namespace

FigureFormat figure_format(const std::string& file) {
  constexpr std::array<std::string_view, 3> kEndings = {".svg", ".png", ".pdf"};  // in the order of FigureFormat
  const auto found = std::ranges::find(kEndings, file_ending(file));
  if (found == kEndings.end())
    refuse(file, "figure", "its ending names no format that can be drawn", ".svg, .png, .pdf");
  return static_cast<FigureFormat>(found - kEndings.begin());
}

std::string mark_of(FigureKind kind) {
  return fmt::format("{}, {}", mark(), name_of(kind));
}

void require_kind(const std::string& file, FigureKind kind, bool force) {
  for (const std::string_view other : kKinds)
    if (!force && other != name_of(kind) && bears(file, fmt::format(", {}", other)))
      throw BadInput(
          fmt::format("{}: file: is a {} and would become a {}; allowed: another name, or --force to "
                      "replace it",
                      file, other, name_of(kind)));
}

void write_figure(const std::string& file, FigureKind kind, std::span<const std::filesystem::path> inputs, bool force,
                  const std::function<std::string(FigureFormat)>& draw) {
  require_writable({{file}}, inputs, force);
  require_kind(file, kind, force);
  write_files({{OutputFile{file, draw(figure_format(file))}}});
}

}  // namespace contactspline
