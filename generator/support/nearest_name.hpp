// SPDX-License-Identifier: MIT
// What a user may have meant by a name that is not there.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace contactspline {

/// How many characters must be added, left out or replaced to make one text of the other (V. Levenshtein, 1966).
[[nodiscard]] inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);  // of the first i characters of a to the first j of b
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// The names with the one first that differs least from `wrong`, if by no more than half of its characters; the
/// others keep their order.
[[nodiscard]] inline std::vector<std::string> nearest_first(std::vector<std::string> names, std::string_view wrong) {
  if (wrong.size() > 64) return names;  // no name is as long
  const auto distance = [&](std::string_view name) { return edit_distance(name, wrong); };
  const auto nearest = std::ranges::min_element(names, {}, distance);
  if (nearest != names.end() && 2 * distance(*nearest) <= wrong.size())
    std::rotate(names.begin(), nearest, nearest + 1);
  return names;
}

}  // namespace contactspline
