// SPDX-License-Identifier: MIT
// What the program prints, as tests read it.
#pragma once

#include <fmt/format.h>

#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {

inline std::string material(int segments, const std::string& description = "a probe") {
  return fmt::format(R"({{"name": "probe", "description": "{}",
    "contact": {{"stiffness_n_per_m_alpha": 1e9, "exponent": 1.5}},
    "impact": {{"mass_kg": 0.01, "max_speed_m_per_s": 2, "min_speed_m_per_s": 0.1}},
    "spline": {{"knots": "uniform", "segments": {}}}}})",
                     description, segments);
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The first number after each place where `label` stands in a line.
inline double number_after(const std::string& text, const std::string& label) {
  const auto at = text.find(label);
  if (at == std::string::npos) throw std::runtime_error("no " + label + " in\n" + text);
  return std::stod(text.substr(at + label.size()));
}

inline std::string printed(const Sandbox& box, const Words& arguments) {
  return succeed({.arguments = arguments, .folder = box.path()});
}

}  // namespace contactspline::testing
