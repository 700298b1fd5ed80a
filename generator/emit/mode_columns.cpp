// SPDX-License-Identifier: MIT
#include "generator/emit/mode_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace contactspline {

std::string faust_rules(std::string_view name, std::initializer_list<std::vector<double>> columns) {
  std::string rules;
  for (std::size_t i = 0; i < columns.begin()->size(); ++i) {
    std::vector<std::string> values;
    for (const std::vector<double>& column : columns) values.push_back(literal(column[i]));
    rules += fmt::format("{}({}) = {};\n", name, i, fmt::join(values, ", "));
  }
  return rules;
}

}  // namespace contactspline
