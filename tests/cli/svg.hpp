// SPDX-License-Identifier: MIT
// A figure read back: well-formed or an error.
#pragma once

#include <expat.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "sandbox.hpp"

namespace contactspline::testing {

struct Svg {
  std::size_t bytes = 0;
  std::size_t curves = 0;            ///< groups that gnuplot calls gnuplot_plot_...
  std::string text;                  ///< all of it
  std::vector<std::string> numbers;  ///< attributes that hold coordinates
};

namespace detail {

inline void take_element(void* user, const XML_Char* name, const XML_Char** attributes) {
  auto& svg = *static_cast<Svg*>(user);
  for (; *attributes != nullptr; attributes += 2) {
    const std::string key = attributes[0], value = attributes[1];
    svg.curves += std::string(name) == "g" && key == "id" && value.starts_with("gnuplot_plot");
    if (key == "d" || key == "points" || key == "transform" || key == "viewBox") svg.numbers.push_back(value);
  }
}

inline void take_text(void* user, const XML_Char* text, int length) {
  static_cast<Svg*>(user)->text.append(text, static_cast<std::size_t>(length));
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

/// A figure a browser can draw: well-formed, of so many curves, no larger than 2 MB, every coordinate a number.
inline void expect_drawn(const fs::path& path, std::size_t curves) {
  const Svg svg = read_svg(path);
  EXPECT_EQ(svg.curves, curves) << path;
  EXPECT_LT(svg.bytes, 2'000'000u) << path;
  EXPECT_FALSE(svg.numbers.empty());
  for (std::string numbers : svg.numbers) {
    std::ranges::transform(numbers, numbers.begin(), [](unsigned char c) { return std::tolower(c); });
    EXPECT_EQ(numbers.find("nan"), std::string::npos) << path << ": " << numbers;
    EXPECT_EQ(numbers.find("inf"), std::string::npos) << path << ": " << numbers;
  }
}

}  // namespace contactspline::testing
