// SPDX-License-Identifier: MIT
// Bytes of MIDI as nobody should send them: noise, and between it messages of MPE and of tunings with any numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <span>

#include "support/random.hpp"

namespace contactspline::testing {

/// How many bytes a test draws: 10 million if CONTACTSPLINE_FULL_TESTS is set.
inline std::size_t hostile_bytes(std::size_t few) {
  return std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr ? 10'000'000 : few;
}

class HostileMidi {
 public:
  explicit HostileMidi(std::uint64_t seed) : random_(seed) {}

  /// The next bytes, at most 512; they stay until the next call.
  std::span<const std::uint8_t> next() {
    size_ = 0;
    switch (random_.below(12)) {
      case 0:
        return registered(6, random_.below(2) == 0 ? 0 : 15);  // an MPE zone
      case 1:
        return registered(static_cast<int>(random_.below(8)), channel());
      case 2:
      case 3:
      case 4:
        return add({0xe0 | channel(), end(), end()});
      case 5:
      case 6:
      case 7:
        return add({0x80 | static_cast<int>(random_.below(2)) << 4 | channel(), key(), data()});
      case 8:
        return tuning();
      case 9:  // pressure, controllers, programs
        return add({(0xa0 + 16 * static_cast<int>(random_.below(4))) | channel(), data(), data()});
      default:
        for (std::size_t n = random_.below(5); n > 0; --n) add({static_cast<int>(random_.below(256))});
        return taken();
    }
  }

 private:
  int data() { return static_cast<int>(random_.below(128)); }
  int end() { return random_.below(3) == 0 ? data() : random_.below(2) == 0 ? 0 : 127; }
  int channel() { return static_cast<int>(random_.below(16)); }
  int key() { return 36 + static_cast<int>(random_.below(60)); }

  std::span<const std::uint8_t> taken() const { return std::span(bytes_).first(size_); }
  std::span<const std::uint8_t> add(std::initializer_list<int> bytes) {
    for (const int byte : bytes) bytes_[size_++] = static_cast<std::uint8_t>(byte);
    return taken();
  }

  std::span<const std::uint8_t> registered(int number, int channel) {
    add({0xb0 | channel, 101, 0, 0xb0 | channel, 100, number, 0xb0 | channel, 6, data()});
    return random_.below(2) == 0 ? taken() : add({0xb0 | channel, 38, data()});
  }

  // Single notes, all keys or the master, right or cut off.
  std::span<const std::uint8_t> tuning() {
    const auto kind = random_.below(8);
    const std::size_t begin = size_;
    if (kind == 0) {
      add({0xf0, 0x7e, 0x7f, 8, 1, 0});
      for (int n = 0; n < 16; ++n) add({'a'});
      for (int k = 0; k < 128; ++k) add({data(), data(), data()});
      add({data()});
    } else if (kind < 6) {
      add({0xf0, 0x7f, 0x7f, 8, 2, 0, 3});
      for (int n = 0; n < 3; ++n) add({key(), data(), data(), data()});
    } else {
      add({0xf0, 0x7f, 0x7f, 4, kind == 6 ? 3 : 4, data(), data()});
    }
    if (random_.below(8) == 0) size_ = begin + random_.below(size_ - begin);
    return add({0xf7});
  }

  Random random_;
  std::array<std::uint8_t, 512> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace contactspline::testing
