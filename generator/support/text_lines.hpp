// SPDX-License-Identifier: MIT
// Text files that are read line by line.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>

#include "generator/support/error.hpp"

namespace contactspline {

/// The file name and the number of the current line, for messages.
struct LineOfFile {
  std::string_view file;
  std::size_t line = 0;

  [[noreturn]] void fail(std::string_view wrong, std::string_view allowed) const {
    refuse(file, fmt::format("line {}", line), wrong, allowed);
  }
};

/// The text without the characters of `blanks` at both ends.
[[nodiscard]] inline std::string_view trimmed(std::string_view text, std::string_view blanks) {
  const auto begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// The next line that is more than `blanks` and does not begin with a character of `comments`, as it stands; nothing
/// at the end of the file.
[[nodiscard]] inline std::optional<std::string_view> next_line(std::string_view& rest, LineOfFile& place,
                                                               std::string_view blanks, std::string_view comments) {
  while (!rest.empty()) {
    const auto end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++place.line;
    const std::string_view words = trimmed(line, blanks);
    if (!words.empty() && comments.find(words.front()) == std::string_view::npos) return line;
  }
  return std::nullopt;
}

}  // namespace contactspline
