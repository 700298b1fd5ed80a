// SPDX-License-Identifier: MIT
// Output files: whole or not at all, and untouched where nothing changed.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

struct OutputFile {
  std::filesystem::path path;
  std::string bytes;
};

/// Whole content of a regular file. Throws BadInput, naming it, where it cannot be read or is larger than 1 MiB.
[[nodiscard]] std::string read_input(const std::filesystem::path& path);

/// Throws BadInput where an output is also an input or another output: one would silently replace the other.
void require_distinct(std::span<const std::filesystem::path> outputs, std::span<const std::filesystem::path> inputs);

/// Does the file hold just these bytes?
[[nodiscard]] bool is_current(const OutputFile& file);

/// Writes every file that is not current, creating folders: all contents are on disk under temporary names before the
/// first one is renamed into place, so an old file stays whole whatever happens. Returns what was written. Throws
/// BadInput where a file cannot be written; no temporary file is left then.
std::vector<std::filesystem::path> write_files(std::span<const OutputFile> files);

/// Writes to standard output; throws BadInput where that fails.
void write_stdout(std::string_view text);

}  // namespace contactspline
