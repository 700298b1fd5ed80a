// SPDX-License-Identifier: MIT
// A file that is written under a temporary name and then renamed.
#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "generator/support/error.hpp"

namespace contactspline {

/// Throws BadInput that names the file.
[[noreturn]] inline void fail_to_write(const std::filesystem::path& path, std::string_view what) {
  refuse(path.string(), "file", what, "a folder with enough room that can be written to");
}

/// The same with what errno says.
[[noreturn]] inline void fail_to_write(const std::filesystem::path& path) {
  fail_to_write(path, errno == 0 ? "cannot be written" : fmt::format("cannot be written: {}", std::strerror(errno)));
}

/// A file under a temporary name, locked against other processes.
class PendingShard {
 public:
  explicit PendingShard(const std::filesystem::path& path) : path_(path), pending_(path.string() + ".part") {
    do {
      if (descriptor_ >= 0) ::close(descriptor_);
      descriptor_ = ::open(pending_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (descriptor_ < 0) fail_to_write(path_);
      if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        ::close(descriptor_);
        refuse(path_.string(), "file", "is being written by another process", "another folder, or to wait for it");
      }
    } while (!still_has_its_name());
  }
  PendingShard(const PendingShard&) = delete;
  PendingShard& operator=(const PendingShard&) = delete;
  ~PendingShard() {
    if (!is_renamed_) ::unlink(pending_.c_str());
    ::close(descriptor_);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::filesystem::path& pending() const { return pending_; }

  /// Takes room on the disk. HDF5 would not survive a disk that fills while it writes. To be called after HDF5 has
  /// created its file, which gives back all room.
  void reserve(std::size_t bytes) const {
    if (::fallocate(descriptor_, 0, 0, static_cast<off_t>(bytes)) != 0 && errno != EOPNOTSUPP && errno != ENOSYS)
      fail_to_write(path_);
  }

  /// Lets the system bring to the disk what is written meanwhile: less is left for rename_into_place().
  void begin_to_store() const { ::sync_file_range(descriptor_, 0, 0, SYNC_FILE_RANGE_WRITE); }

  void rename_into_place(std::size_t bytes) {
    if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0 || ::fsync(descriptor_) != 0 ||
        ::rename(pending_.c_str(), path_.c_str()) != 0)
      fail_to_write(path_);
    is_renamed_ = true;
  }

 private:
  // Another process may have renamed or removed the file before it was locked.
  [[nodiscard]] bool still_has_its_name() const {
    struct stat open = {}, named = {};
    return ::fstat(descriptor_, &open) == 0 && ::stat(pending_.c_str(), &named) == 0 && open.st_ino == named.st_ino &&
           open.st_dev == named.st_dev;
  }

  std::filesystem::path path_, pending_;
  int descriptor_ = -1;
  bool is_renamed_ = false;
};

}  // namespace contactspline
