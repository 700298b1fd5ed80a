// SPDX-License-Identifier: MIT
// Reading input files.
#pragma once

#include <filesystem>
#include <string>

namespace contactspline {

/// The content of a regular file. Throws BadInput, with the path in its message, if the file cannot be read or is
/// larger than 1 MiB.
[[nodiscard]] std::string read_input(const std::filesystem::path& path);

}  // namespace contactspline
