// SPDX-License-Identifier: MIT
// What the command line asks of the operating system: system_posix.cpp and system_windows.cpp.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

/// The words of the command line in UTF-8, on Windows in ASCII: with other letters it ends the program. Prepares the
/// standard streams: bytes pass through them as they are.
[[nodiscard]] std::vector<std::string> begin_program(int argc, char** argv);

/// Does somebody read this stream on a screen?
[[nodiscard]] bool is_terminal(std::FILE* stream);

/// While one lives, what ends the program from outside, such as Ctrl-C, waits.
class EndWaits {
 public:
  EndWaits();
  EndWaits(const EndWaits&) = delete;
  EndWaits& operator=(const EndWaits&) = delete;
  ~EndWaits();

 private:
  struct Before;
  std::unique_ptr<Before> before_;
};

/// The folder of a file; "." where the path names none.
[[nodiscard]] inline std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

/// A file under a free name in the folder of its target, to be written and then renamed. Its descriptor; -1 and errno
/// if there is none.
[[nodiscard]] int create_temporary(const std::filesystem::path& target, std::filesystem::path& name);

/// Writes all bytes; false and errno if that fails.
[[nodiscard]] bool write_bytes(int descriptor, std::string_view bytes);

/// Brings to the disk what was written, with the permissions of the file that it will replace, or of a new one. False
/// and errno if that fails.
[[nodiscard]] bool bring_to_disk(int descriptor, const std::filesystem::path& replaced);

/// Keeps an old file under a free name, too, to put it back from; empty where the file system cannot.
[[nodiscard]] std::filesystem::path back_up(const std::filesystem::path& file);

/// False and errno if the system has not taken what was written.
bool close_file(int descriptor);

}  // namespace contactspline
