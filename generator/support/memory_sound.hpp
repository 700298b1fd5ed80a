// SPDX-License-Identifier: MIT
// A sound file in memory, for libsndfile to read or write.
#pragma once

#include <algorithm>
#include <cstring>
#include <sndfile.hh>
#include <string>

namespace contactspline {

/// The bytes of a sound file and the place in them.
struct MemorySound {
  std::string bytes;
  sf_count_t position = 0;

  /// What libsndfile calls, with the address of a MemorySound.
  [[nodiscard]] static SF_VIRTUAL_IO calls() { return {length, seek, read, write, tell}; }

 private:
  static MemorySound& of(void* user) { return *static_cast<MemorySound*>(user); }

  static sf_count_t length(void* user) { return static_cast<sf_count_t>(of(user).bytes.size()); }

  static sf_count_t seek(sf_count_t offset, int whence, void* user) {
    const sf_count_t from = whence == SEEK_CUR ? of(user).position : whence == SEEK_END ? length(user) : 0;
    return of(user).position = std::max<sf_count_t>(0, from + offset);
  }

  static sf_count_t read(void* target, sf_count_t count, void* user) {
    const sf_count_t taken = std::clamp<sf_count_t>(length(user) - tell(user), 0, count);
    if (taken > 0) std::memcpy(target, of(user).bytes.data() + tell(user), static_cast<std::size_t>(taken));
    of(user).position += taken;
    return taken;
  }

  static sf_count_t write(const void* source, sf_count_t count, void* user) {
    const sf_count_t end = std::max(length(user), tell(user) + count);
    of(user).bytes.resize(static_cast<std::size_t>(end));
    std::memcpy(of(user).bytes.data() + tell(user), source, static_cast<std::size_t>(count));
    of(user).position += count;
    return count;
  }

  static sf_count_t tell(void* user) { return of(user).position; }
};

}  // namespace contactspline
