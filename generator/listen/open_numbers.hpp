// SPDX-License-Identifier: MIT
// Numbers of a JSON file that are left open: {"fit": [min, max]} in their place, with a "start" if you like.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "generator/support/json_reader.hpp"

namespace contactspline {

struct OpenNumber {
  std::string key;                 ///< its full path in the file
  Range bounds;                    ///< min < max
  double start;                    ///< between them
  std::size_t begin = 0, end = 0;  ///< of what stands in its place in the text

  /// The number at a part of the way between the bounds, 0 to 1: by ratios if both are above 0. And back.
  [[nodiscard]] double at(double part) const;
  [[nodiscard]] double part_of(double number) const;
};

/// Reads {"fit": [min, max], "start": number}, without a start the middle of the way. `key`: its path. Throws
/// BadInput.
[[nodiscard]] OpenNumber read_open_number(const JsonObject& open, const std::string& key);

/// The open numbers of a text of JSON, by their places. `file` stands in messages. Throws BadInput, also where the
/// text is no JSON.
[[nodiscard]] std::vector<OpenNumber> open_numbers(std::string_view text, const std::string& file);

/// The text with numbers in the places of its open ones, in their order.
[[nodiscard]] std::string filled(std::string_view text, std::span<const OpenNumber> open,
                                 std::span<const double> numbers);

}  // namespace contactspline
