// SPDX-License-Identifier: MIT
// What a user may have meant by a name that is not there.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

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

/// The names that differ least from `wrong`, if by no more than half of its characters, in their order.
[[nodiscard]] inline std::vector<std::string> nearest_names(const std::vector<std::string>& names,
                                                            std::string_view wrong) {
  std::vector<std::string> nearest;
  if (wrong.size() > 64) return nearest;  // no name is as long
  std::size_t least = wrong.size() / 2;
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(name, wrong);
    if (distance < least) nearest.clear();
    if (distance <= least) nearest.push_back(name);
    least = std::min(least, distance);
  }
  return nearest;
}

/// A question for the end of a message: "; did you mean felt_c2 or felt_c4?"; nothing where no name is near.
[[nodiscard]] inline std::string did_you_mean(const std::vector<std::string>& names, std::string_view wrong) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> nearest = nearest_names(names, wrong);
  if (nearest.empty()) return {};
  nearest.resize(std::min(nearest.size(), kMost));
  return fmt::format("; did you mean {}?", fmt::join(nearest, " or "));
}

/// Names for a message, the nearest one first: all if they are few, else three and the command that prints the
/// others; with did_you_mean().
[[nodiscard]] inline std::string names_in_short(std::vector<std::string> names, std::string_view wrong,
                                                std::string_view command) {
  constexpr std::size_t kFew = 5, kSome = 3;
  const std::string question = did_you_mean(names, wrong);
  if (const auto nearest = nearest_names(names, wrong); !nearest.empty()) {
    const auto first = std::ranges::find(names, nearest.front());
    std::rotate(names.begin(), first, first + 1);
  }
  if (names.size() <= kFew) return fmt::format("{}{}", fmt::join(names, ", "), question);
  names.resize(kSome);
  return fmt::format("{}, or another name of `{}`{}", fmt::join(names, ", "), command, question);
}

}  // namespace contactspline
