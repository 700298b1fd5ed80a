// SPDX-License-Identifier: MIT
// Bytes of MIDI and the messages in them.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace contactspline {

/// A message of a channel. Programs and the pressure of a channel have no second data byte: 0.
struct MidiMessage {
  int status;         ///< without the channel, 0x80 to 0xe0
  int first, second;  ///< 0 to 127
  int channel = 0;    ///< 0 to 15
};

/// Data bytes after a status of a channel, 0x80 to 0xef: 2, or 1 of programs and the pressure of a channel.
[[nodiscard]] constexpr std::size_t midi_data_bytes(int status) {
  return (status & 0xe0) == 0xc0 ? 1 : 2;
}

/// A whole message of a channel in three bytes; nothing for damaged messages and those of other lengths.
[[nodiscard]] constexpr std::optional<MidiMessage> midi_message(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != 3 || bytes[0] < 0x80 || bytes[0] >= 0xf0 || (bytes[1] | bytes[2]) >= 0x80) return {};
  return MidiMessage{bytes[0] & 0xf0, bytes[1], bytes[2], bytes[0] & 0xf};
}

/// Finds messages in a stream of bytes, which may be cut anywhere. Knows running status; messages of one byte may
/// stand within others. Data bytes without a status and messages that another status cuts off are left out. Does not
/// allocate.
class MidiParser {
 public:
  /// The bytes of the longest system-exclusive message that is read, a bulk tuning, without its first and last.
  static constexpr std::size_t kMaxExclusive = 512;

  /// Takes a byte. message: called with a MidiMessage; exclusive: with the bytes of a system-exclusive message
  /// between its first and last; reset: where the system is reset.
  template <typename Message, typename Exclusive, typename Reset>
  void take(std::uint8_t byte, Message&& message, Exclusive&& exclusive, Reset&& reset) {
    if (byte >= 0xf8) {
      if (byte == 0xff) reset();
    } else if (byte >= 0x80) {
      if (byte == 0xf7 && status_ == 0xf0 && length_ <= kMaxExclusive)
        exclusive(std::span<const std::uint8_t>(exclusive_).first(length_));
      status_ = byte;  // a message of the system ends running status
      length_ = 0;
    } else if (status_ == 0xf0) {
      if (length_ < kMaxExclusive) exclusive_[length_] = byte;
      length_ += length_ <= kMaxExclusive;
    } else if (status_ >= 0x80 && status_ < 0xf0) {
      data_[length_++] = byte;
      if (length_ < midi_data_bytes(status_)) return;
      length_ = 0;
      message(MidiMessage{status_ & 0xf0, data_[0], midi_data_bytes(status_) == 2 ? data_[1] : 0, status_ & 0xf});
    }
  }

 private:
  int status_ = 0;  // 0: none yet
  std::array<std::uint8_t, 2> data_{};
  std::size_t length_ = 0;  // of the data so far
  std::array<std::uint8_t, kMaxExclusive> exclusive_{};
};

}  // namespace contactspline
