// SPDX-License-Identifier: MIT
// The ending of a file name, which chooses its format.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

namespace contactspline {

/// The ending with its point, in lower case; empty if there is none.
[[nodiscard]] inline std::string file_ending(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace contactspline
