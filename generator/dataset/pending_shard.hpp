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
#include <utility>

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

/// A file that says that its owner alone writes beside it. HDF5 may lock the files that it writes itself, and on some
/// file systems a second lock of the same process stands against the first: so that this one holds a file of its own.
class WriterLock {
 public:
  WriterLock(std::filesystem::path name, const std::filesystem::path& shard) : name_(std::move(name)) {
    do {
      if (descriptor_ >= 0) ::close(descriptor_);
      descriptor_ = ::open(name_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
      if (descriptor_ < 0) fail_to_write(shard);
      if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) continue;
      const int error = errno;
      ::close(descriptor_);
      errno = error;
      if (error != EWOULDBLOCK) fail_to_write(shard);
      refuse(shard.string(), "file", "is being written by another process", "another folder, or to wait for it");
    } while (!still_has_its_name());
  }
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;
  ~WriterLock() {
    ::unlink(name_.c_str());
    ::close(descriptor_);
  }

 private:
  // Another process may have removed the file before it was locked.
  [[nodiscard]] bool still_has_its_name() const {
    struct stat open = {}, named = {};
    return ::fstat(descriptor_, &open) == 0 && ::lstat(name_.c_str(), &named) == 0 && open.st_ino == named.st_ino &&
           open.st_dev == named.st_dev;
  }

  std::filesystem::path name_;
  int descriptor_ = -1;
};

/// A file under a temporary name, which one process at a time writes. The name begins as that of all temporary files
/// of the program, so that none of somebody else has it; what a killed process left there is removed, and no link is
/// followed.
class PendingShard {
 public:
  explicit PendingShard(const std::filesystem::path& path)
      : path_(path), pending_(beside(path, ".part")), lock_(beside(path, ".lock"), path) {
    ::unlink(pending_.c_str());
    descriptor_ = ::open(pending_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail_to_write(path_);
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
  static std::filesystem::path beside(const std::filesystem::path& path, const char* ending) {
    return path.parent_path() / (".contactspline-" + path.filename().string() + ending);
  }

  std::filesystem::path path_, pending_;
  WriterLock lock_;  // outlives the temporary name
  int descriptor_ = -1;
  bool is_renamed_ = false;
};

}  // namespace contactspline
