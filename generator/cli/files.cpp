// SPDX-License-Identifier: MIT
#include "generator/cli/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "generator/cli/system.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock = 1 << 16;
constexpr std::size_t kMarkedBytes = 1 << 16;  // at the beginning and at the end of a file

// The mark of any version, in text and in emitted JSON.
constexpr std::array<std::string_view, 2> kMarks = {"Written by contactspline ", "\"written_by\": \"contactspline "};

[[noreturn]] void fail(const fs::path& path, std::string_view what) {
  throw BadInput(fmt::format("{}: file: {}", path.string(), what));
}

[[noreturn]] void fail_with_errno(const fs::path& path) {
  fail(path, fmt::format("cannot be written: {}", std::strerror(errno)));
}

/// A file under a temporary name in the folder of its target. The destructor removes it unless it was renamed, and
/// puts the old file back unless keep() was called.
class PendingFile {
 public:
  explicit PendingFile(const fs::path& target) : target_(target), descriptor_(create_temporary(target, name_)) {
    if (descriptor_ < 0) fail_with_errno(target_);
  }
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile() {
    if (descriptor_ >= 0) close_file(descriptor_);
    if (!name_.empty()) remove(name_);
    if (is_renamed_) put_back();
    if (!backup_.empty()) remove(backup_);
  }

  void write(std::string_view bytes) {
    if (!write_bytes(descriptor_, bytes) || !bring_to_disk(descriptor_, target_)) fail_with_errno(target_);
    if (!close_file(std::exchange(descriptor_, -1))) fail_with_errno(target_);
  }

  /// Keeps the old file, to put it back from.
  void back_up() {
    std::error_code error;
    had_old_file_ = fs::exists(target_, error);
    if (had_old_file_) backup_ = contactspline::back_up(target_);
  }

  void rename_into_place() {
    std::error_code error;
    fs::rename(name_, target_, error);
    if (error) fail(target_, fmt::format("cannot be written: {}", error.message()));
    name_.clear();
    is_renamed_ = true;
  }

  /// The new file stays.
  void keep() { is_renamed_ = false; }

 private:
  static void remove(const fs::path& file) {
    std::error_code error;
    fs::remove(file, error);
  }

  void put_back() {
    std::error_code error;
    if (!backup_.empty()) {
      fs::rename(backup_, target_, error);
      if (!error) backup_.clear();
    }
    if (!had_old_file_) remove(target_);
  }

  fs::path target_;
  fs::path name_;    ///< temporary; empty after the renaming
  fs::path backup_;  ///< of the old file; empty without one
  int descriptor_ = -1;
  bool had_old_file_ = false, is_renamed_ = false;
};

// A folder that does not exist is a mistake in the name of the file, most likely.
void require_folder_of(const fs::path& path) {
  std::error_code error;
  const fs::path folder = folder_of(path);
  if (!fs::is_directory(folder, error))
    fail(path,
         fmt::format("its folder {0} does not exist; allowed: a folder that exists, for instance after mkdir -p {0}",
                     folder.string()));
}

// The file to write. A symbolic link stays and its target is written; anything but a regular file is refused.
fs::path real_target(const fs::path& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (error == std::errc::filename_too_long) fail(path, fmt::format("cannot be written: {}", error.message()));
  if (fs::exists(status) && !fs::is_regular_file(status)) fail(path, "is not a regular file");
  if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
  fs::path target = fs::canonical(path, error);
  if (error) fail(path, "is a broken link");
  return target;
}

std::string read_part(std::ifstream& stream) {
  std::string part(kMarkedBytes, '\0');
  stream.read(part.data(), static_cast<std::streamsize>(part.size()));
  part.resize(static_cast<std::size_t>(stream.gcount()));
  return part;
}

std::string end_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const auto size = stream.tellg();
  stream.seekg(std::max<std::streamoff>(0, size - static_cast<std::streamoff>(kMarkedBytes)));
  return read_part(stream);
}

bool bears_mark(const fs::path& path) {
  return std::ranges::any_of(kMarks, [&](std::string_view mark) { return bears(path, mark); });
}

// The same path for every spelling of it, also if the file does not exist.
fs::path normal_form(const fs::path& path) {
  std::error_code error;
  const fs::path normal = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : normal;
}

}  // namespace

void require_distinct(std::span<const fs::path> outputs, std::span<const fs::path> inputs) {
  std::set<fs::path> taken;
  for (const fs::path& input : inputs) taken.insert(normal_form(input));
  for (const fs::path& output : outputs)
    if (!taken.insert(normal_form(output)).second)
      fail(output, "is already an input or another output; allowed: another folder or file name");
}

std::string_view mark() {
  return "Written by contactspline " CONTACTSPLINE_VERSION;
}

std::string beginning_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};  // opening a pipe would wait for its writer
  std::ifstream stream(path, std::ios::binary);
  return read_part(stream);
}

bool bears(const fs::path& path, std::string_view text) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;  // opening a pipe would wait for its writer
  return beginning_of(path).find(text) != std::string::npos || end_of(path).find(text) != std::string::npos;
}

// Another program may write the same file meanwhile: one that exists is whole.
void require_own(const fs::path& output, bool (*is_own)(const fs::path&), bool force) {
  std::error_code error;
  if (force || !fs::is_regular_file(output, error) || fs::file_size(output, error) == 0 || is_own(output)) return;
  fail(output, "exists, and this program did not write it; allowed: another name, or --force to replace it");
}

void require_writable(std::span<const fs::path> outputs, std::span<const fs::path> inputs, bool force) {
  require_distinct(outputs, inputs);
  for (const fs::path& output : outputs) require_own(output, bears_mark, force);
}

void create_folders_of(std::span<const fs::path> outputs) {
  for (const fs::path& output : outputs) {
    std::error_code error;
    fs::create_directories(folder_of(output), error);
    if (error) fail(output, fmt::format("its folder cannot be created: {}", error.message()));
  }
}

void require_creatable(std::span<const fs::path> outputs) {
  const EndWaits until_removed;
  for (const fs::path& output : outputs) {
    require_folder_of(output);
    const PendingFile removed_at_once(real_target(output));
  }
}

bool is_current(const OutputFile& file) {
  std::error_code error;
  if (!fs::is_regular_file(file.path, error)) return false;  // opening a pipe would wait for its writer
  if (fs::file_size(file.path, error) != file.bytes.size()) return false;
  std::ifstream stream(file.path, std::ios::binary);
  std::string_view rest = file.bytes;
  for (std::array<char, kBlock> block; !rest.empty(); rest.remove_prefix(std::min(kBlock, rest.size()))) {
    const std::size_t size = std::min(kBlock, rest.size());
    if (!stream.read(block.data(), static_cast<std::streamsize>(size))) return false;
    if (rest.substr(0, size) != std::string_view(block.data(), size)) return false;
  }
  return true;
}

std::vector<fs::path> write_files(std::span<const OutputFile> files) {
  const EndWaits until_renamed;
  std::vector<std::unique_ptr<PendingFile>> pending;
  std::vector<fs::path> written;
  for (const OutputFile& file : files) {
    if (is_current(file)) continue;
    require_folder_of(file.path);
    pending.push_back(std::make_unique<PendingFile>(real_target(file.path)));
    pending.back()->write(file.bytes);
    written.push_back(file.path);
  }
  if (pending.size() > 1)
    for (const auto& file : pending) file->back_up();
  for (const auto& file : pending) file->rename_into_place();
  for (const auto& file : pending) file->keep();
  return written;
}

void write_stdout(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw BadInput(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
}

void print_error(std::string message) {
  std::ranges::replace_if(
      message, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  std::fputs(("contactspline: " + message + "\n").c_str(), stderr);  // fmt::print would throw where nobody listens
}

}  // namespace contactspline
