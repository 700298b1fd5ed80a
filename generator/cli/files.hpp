// SPDX-License-Identifier: MIT
// Writing output files. A file is written completely or not at all, and only if it changes.
// No file of somebody else is replaced: every file that the program writes bears its mark.
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

/// The mark of this program and its version. Every file that it writes has it in its first or last 64 KiB, for
/// instance as a comment; emitted JSON has it as "written_by".
[[nodiscard]] std::string_view mark();

/// True if the first or the last 64 KiB of a regular file contain this text.
[[nodiscard]] bool bears(const std::filesystem::path& path, std::string_view text);

/// The first 64 KiB of a regular file; empty if it does not exist or cannot be read.
[[nodiscard]] std::string beginning_of(const std::filesystem::path& path);

/// Throws BadInput if an output is also an input or another output, because one would silently replace the other.
void require_distinct(std::span<const std::filesystem::path> outputs, std::span<const std::filesystem::path> inputs);

/// Throws BadInput if a file of this name exists, is not empty and is not the program's own, unless `force`.
void require_own(const std::filesystem::path& output, bool (*is_own)(const std::filesystem::path&), bool force);

/// Throws as require_distinct() does, and as require_own() does for an output without the mark of this program.
void require_writable(std::span<const std::filesystem::path> outputs, std::span<const std::filesystem::path> inputs,
                      bool force);

/// Makes the folders of these files: where an option names a folder, not a file. Throws BadInput.
void create_folders_of(std::span<const std::filesystem::path> outputs);

/// Throws BadInput if one of these files cannot be created, or its folder does not exist: before a long computation
/// whose result goes there.
void require_creatable(std::span<const std::filesystem::path> outputs);

/// True if the file exists with exactly these bytes.
[[nodiscard]] bool is_current(const OutputFile& file);

/// Writes all files that are not current, into folders that exist. All contents are on disk under temporary names
/// before the first one is renamed into place, so an old file is never damaged. Returns the paths of the written
/// files. Throws BadInput if a file cannot be written; then it puts all old files back and removes all temporary
/// files. SIGINT, SIGTERM and SIGHUP wait until it ends.
std::vector<std::filesystem::path> write_files(std::span<const OutputFile> files);

/// Writes to standard output. Throws BadInput if that fails.
void write_stdout(std::string_view text);

/// Writes to standard error what is wrong, in one line that a terminal can show.
void print_error(std::string message);

}  // namespace contactspline
