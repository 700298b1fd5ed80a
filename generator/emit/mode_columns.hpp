// SPDX-License-Identifier: MIT
// Modes as columns of numbers, and these as rules of Faust.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "generator/support/number_literal.hpp"

namespace contactspline {

/// A key of the templates, and the member of a mode for it.
template <typename Row>
struct ModeColumn {
  std::string_view key;
  double (*member)(const Row&);
};

/// The column of all modes, in the digits on which sin() and sqrt() of all machines agree.
template <typename Row>
[[nodiscard]] std::vector<double> numbers_of(const ModeColumn<Row>& column, const std::vector<Row>& modes) {
  std::vector<double> numbers;
  for (const Row& mode : modes) numbers.push_back(rounded_to(column.member(mode), 13));
  return numbers;
}

/// A rule of Faust for each row: name(i) = the values of row i in the columns. The Faust compiler looks up
/// pattern-matching rules much faster than list entries, and few rules faster than many.
[[nodiscard]] std::string faust_rules(std::string_view name, std::initializer_list<std::vector<double>> columns);

}  // namespace contactspline
