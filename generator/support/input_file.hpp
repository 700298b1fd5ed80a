// SPDX-License-Identifier: MIT
// Reading input files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace contactspline {

/// The content of a regular file. Throws BadInput, with the path in its message, if the file cannot be read or is
/// larger than 1 MiB.
[[nodiscard]] std::string read_input(const std::filesystem::path& path);

/// The same up to so many MiB.
[[nodiscard]] std::string read_large_input(const std::filesystem::path& path, int max_mib);

/// What messages call standard input. No file that an argument or a key can name is called so.
inline constexpr std::string_view kStandardInput = "standard input";

/// All of standard input, which is read once and kept. Throws BadInput if it cannot be read or is larger than 1 MiB.
[[nodiscard]] const std::string& read_standard_input();

}  // namespace contactspline
