// SPDX-License-Identifier: MIT
// A figure read back: well-formed or an error.
#pragma once

#include <expat.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sandbox.hpp"
#include "support/expressions.hpp"

namespace contactspline::testing {

struct Svg {
  std::size_t bytes = 0;
  std::size_t curves = 0;            ///< groups that gnuplot calls gnuplot_plot_...
  std::string text;                  ///< all of it
  std::vector<std::string> labels;   ///< each text on its own
  std::vector<std::string> numbers;  ///< attributes that hold coordinates
  std::string element;               ///< the last one that began
};

namespace detail {

inline void take_element(void* user, const XML_Char* name, const XML_Char** attributes) {
  auto& svg = *static_cast<Svg*>(user);
  svg.element = name;
  if (svg.element == "text") svg.labels.emplace_back();
  for (; *attributes != nullptr; attributes += 2) {
    const std::string key = attributes[0], value = attributes[1];
    svg.curves += svg.element == "g" && key == "id" && value.starts_with("gnuplot_plot");
    if (key == "d" || key == "points" || key == "transform" || key == "viewBox") svg.numbers.push_back(value);
  }
}

inline void take_text(void* user, const XML_Char* text, int length) {
  auto& svg = *static_cast<Svg*>(user);
  const std::string_view part(text, static_cast<std::size_t>(length));
  svg.text += part;
  const bool is_label = svg.element == "text" || svg.element == "tspan";
  if (is_label && part.find_first_not_of(" \n\t") != part.npos) svg.labels.back() += part;
}

}  // namespace detail

/// Throws where the file is not well-formed XML, or not UTF-8.
inline Svg read_svg(const fs::path& path) {
  const std::string bytes = read_file(path);
  Svg svg;
  svg.bytes = bytes.size();
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate("UTF-8"),
                                                                            XML_ParserFree);
  XML_SetUserData(parser.get(), &svg);
  XML_SetElementHandler(parser.get(), detail::take_element, nullptr);
  XML_SetCharacterDataHandler(parser.get(), detail::take_text);
  if (XML_Parse(parser.get(), bytes.data(), static_cast<int>(bytes.size()), XML_TRUE) != XML_STATUS_OK)
    throw std::runtime_error(path.string() + ": " + XML_ErrorString(XML_GetErrorCode(parser.get())));
  return svg;
}

/// No upright label, which is turned by 90 degrees around its baseline, reaches beyond the left edge.
inline void expect_labels_whole(const fs::path& path) {
  constexpr double kAscent = 11;  // ascent of a font of 14
  const char* upright = R"(translate\(([-\d.]+),[-\d.]+\) rotate\(270\))";
  std::size_t labels = 0;
  for (const std::string& numbers : read_svg(path).numbers)
    if (const auto found = whole_match(numbers, upright)) {
      EXPECT_GE(std::stod((*found)[1]), kAscent) << path;
      ++labels;
    }
  EXPECT_GT(labels, 0u) << path;
}

/// A figure a browser can draw: well-formed, of so many curves, no larger than 2 MB, every coordinate a
/// number, every label whole.
inline void expect_drawn(const fs::path& path, std::size_t curves) {
  const Svg svg = read_svg(path);
  EXPECT_EQ(svg.curves, curves) << path;
  EXPECT_LT(svg.bytes, 2'000'000u) << path;
  EXPECT_FALSE(svg.numbers.empty());
  expect_labels_whole(path);
  for (std::string numbers : svg.numbers) {
    std::ranges::transform(numbers, numbers.begin(), [](unsigned char c) { return std::tolower(c); });
    EXPECT_EQ(numbers.find("nan"), std::string::npos) << path << ": " << numbers;
    EXPECT_EQ(numbers.find("inf"), std::string::npos) << path << ": " << numbers;
  }
}

/// Left and right borders of the panels, without repetition: one pair for each column of aligned panels.
inline std::set<std::pair<std::string, std::string>> columns_of(const fs::path& path) {
  // Left and bottom, as gnuplot draws them.
  const char* border = R"(M([\d.]+),([\d.]+) L\1,[\d.]+ L([\d.]+),[\d.]+ M\3,\2 M\1,\2\s*)";
  std::set<std::pair<std::string, std::string>> columns;
  for (const std::string& numbers : read_svg(path).numbers)
    if (const auto found = whole_match(numbers, border)) columns.emplace((*found)[1], (*found)[3]);
  return columns;
}

/// A curve of a figure in the units of its axes, which are linear. Without labels at the tics of x there is no x.
struct DrawnCurve {
  std::vector<double> x, y;
};

namespace detail {

/// From the screen to the numbers at the tics.
class TicScale {
 public:
  void add(double pixel, double value) { tics_.emplace_back(pixel, value); }
  [[nodiscard]] bool is_known() const { return tics_.size() > 1; }
  [[nodiscard]] double at(double pixel) const {
    const auto [from, low] = tics_.front();
    const auto [to, high] = tics_.back();
    return low + (high - low) * (pixel - from) / (to - from);
  }

 private:
  std::vector<std::pair<double, double>> tics_;
};

// The points of the paths in a part of a figure, path by path, and where each path ends.
inline std::vector<std::pair<std::vector<std::pair<double, double>>, std::size_t>> paths_in(const std::string& svg) {
  std::vector<std::pair<std::vector<std::pair<double, double>>, std::size_t>> paths;
  for (std::size_t at = svg.find(" d='"); at != svg.npos; at = svg.find(" d='", at + 1)) {
    const std::size_t end = svg.find('\'', at + 4);
    auto& [points, path_end] = paths.emplace_back();
    path_end = end;
    for (std::size_t from = svg.find_first_of("ML", at + 4); from < end; from = svg.find_first_of("ML", from + 1)) {
      std::size_t length = 0;
      const double x = std::stod(svg.substr(from + 1, 20), &length);
      points.emplace_back(x, std::stod(svg.substr(from + 2 + length, 20)));
    }
  }
  return paths;
}

// A tic is a line of two points that a number follows.
inline void read_tics(const std::string& svg, TicScale& x, TicScale& y) {
  for (const auto& [points, end] : paths_in(svg)) {
    const std::string after = svg.substr(end, svg.find("d='", end) - end);
    const auto found = first_match(after, R"(^'/>\s*<g transform[^>]*>\s*<text>((<tspan[^>]*>)?)(-?[\d.]+)<)");
    if (points.size() < 2 || !found) continue;
    const bool is_y = points[0].second == points[1].second;
    (is_y ? y : x).add(is_y ? points[0].second : points[0].first, std::stod((*found)[3]));
  }
}

}  // namespace detail

/// The curves of a figure without keys of gnuplot, each with the axes of its panel.
inline std::vector<DrawnCurve> drawn_curves(const fs::path& path) {
  const std::string svg = read_file(path);
  std::vector<DrawnCurve> curves;
  detail::TicScale x, y;
  for (std::size_t at = 0;;) {
    const std::size_t begin = svg.find("id=\"gnuplot_plot", at);
    if (begin == svg.npos) return curves;
    detail::TicScale next_x, next_y;
    detail::read_tics(svg.substr(at, begin - at), next_x, next_y);
    if (next_y.is_known()) x = next_x, y = next_y;
    at = svg.find("\n\t</g>", begin);
    DrawnCurve& curve = curves.emplace_back();
    for (const auto& [points, end] : detail::paths_in(svg.substr(begin, at - begin)))
      for (const auto& [point_x, point_y] : points) {
        if (x.is_known()) curve.x.push_back(x.at(point_x));
        curve.y.push_back(y.at(point_y));
      }
  }
}

}  // namespace contactspline::testing
