// SPDX-License-Identifier: MIT
// What MIDI remembers of a channel, and of the tuning of keys.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "contactspline/midi/key_tuning.hpp"
#include "contactspline/midi/midi_meaning.hpp"

namespace contactspline {

/// Cents of a number of 14 bits about its middle, so many at its ends.
[[nodiscard]] constexpr double midi_cents(int number, double range_cents) {
  return range_cents * (number - 0x2000) / 0x2000;
}

/// The state of a channel: wheel, registered parameters and what waits for a next message.
struct MidiChannel {
  static constexpr int kNone = 0x3fff;  ///< no registered parameter

  int wheel = 0x2000;
  int bend_range = 2 << 7, fine = 0x2000, coarse = 64 << 7, modulation_range = 64;  ///< 14 bits each
  int chosen = kNone;
  bool is_registered = false;  ///< is `chosen` a registered parameter?
  int velocity_low = 0;
  std::array<int, kMidiPedals.size()> pedals{};     ///< their values
  double told_cents = 0;                            ///< the bend that was told last
  double pressure = kUnsent, brightness = kUnsent;  ///< 0 to 1, as sent last

  static constexpr double kUnsent = std::numeric_limits<double>::quiet_NaN();

  /// The bend by the wheel and the tuning of the channel.
  [[nodiscard]] double cents() const {
    const double range = 100 * (bend_range >> 7) + (bend_range & 127);
    return midi_cents(wheel, range) + midi_cents(fine, 100) + 100 * ((coarse >> 7) - 64);
  }

  /// The registered parameter that data entry is for, or null.
  [[nodiscard]] const MidiRow<MidiTuning>* parameter() const {
    return is_registered ? midi_row(kMidiRegistered, chosen) : nullptr;
  }

  [[nodiscard]] int* value_of(MidiTuning parameter) {
    switch (parameter) {
      case MidiTuning::kBendRange:
        return &bend_range;
      case MidiTuning::kFine:
        return &fine;
      case MidiTuning::kCoarse:
        return &coarse;
      case MidiTuning::kModulationRange:
        return &modulation_range;
      case MidiTuning::kZone:
        break;
    }
    return nullptr;
  }

  /// Moves a parameter by one step: its low byte, of the bend range a cent; the coarse tuning by a semitone.
  void step(MidiTuning parameter, int by) {
    int* const value = value_of(parameter);
    if (value == nullptr) return;
    if (parameter != MidiTuning::kBendRange) {
      *value = std::clamp(*value + by * (parameter == MidiTuning::kCoarse ? 128 : 1), 0, 0x3fff);
      return;
    }
    const int cents = std::clamp(100 * (*value >> 7) + (*value & 127) + by, 0, 12799);
    *value = cents / 100 << 7 | cents % 100;
  }
};

/// How far the keys are tuned from equal temperament.
class MidiKeyTuning {
 public:
  MidiKeyTuning() = default;
  explicit MidiKeyTuning(const KeyCents& keys) : keys_(keys) {}

  void tune(std::size_t key, double cents) { keys_[key] = cents; }
  /// Of a key, beside that of all keys; not a number if it does not sound.
  [[nodiscard]] double cents(int key) const { return keys_[static_cast<std::size_t>(key)]; }
  [[nodiscard]] double master() const { return midi_cents(fine_, 100) + 100 * (coarse_ - 64); }
  void tune(const KeyCents& keys) { keys_ = keys; }

  /// Takes a universal message, without its first and last byte; others and damaged ones do nothing.
  void take(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < 5 || (bytes[0] != kRealTime && bytes[0] != kNonRealTime)) return;
    const bool is_real_time = bytes[0] == kRealTime;
    const auto data = bytes.subspan(4);
    if (bytes[2] == 4 && is_real_time && data.size() == 2) {
      if (bytes[3] == 3) fine_ = data[0] | data[1] << 7;
      if (bytes[3] == 4) coarse_ = data[1];
    } else if (bytes[2] == 8) {
      const std::size_t bank = bytes[3] == 7 || bytes[3] == 4 ? 1 : 0;
      if ((bytes[3] == 2 && is_real_time) || bytes[3] == 7) take_notes(data.subspan(bank));
      if ((bytes[3] == 1 || bytes[3] == 4) && !is_real_time) take_bulk(data.subspan(bank));
    }
  }

 private:
  static constexpr std::uint8_t kRealTime = 0x7f, kNonRealTime = 0x7e;

  // Program, number of changes, and for each the key and its pitch.
  void take_notes(std::span<const std::uint8_t> data) {
    if (data.size() < 2) return;
    for (std::size_t n = 0; n < data[1] && 2 + 4 * (n + 1) <= data.size(); ++n)
      tune(data[2 + 4 * n], data.subspan(3 + 4 * n).first(3));
  }

  // Program, name of 16 bytes, and the pitches of all keys. The sum behind them is not asked for: programs differ.
  void take_bulk(std::span<const std::uint8_t> data) {
    constexpr std::size_t kHead = 17;
    if (data.size() < kHead + 3 * kMidiKeys) return;
    for (std::size_t key = 0; key < kMidiKeys; ++key) tune(key, data.subspan(kHead + 3 * key).first(3));
  }

  // A pitch: a key and 14 bits of a semitone above it; all bits: no change.
  void tune(std::size_t key, std::span<const std::uint8_t> pitch) {
    if (pitch[0] == 127 && pitch[1] == 127 && pitch[2] == 127) return;
    keys_[key] = 100.0 * (pitch[0] - static_cast<int>(key)) + 100.0 * (pitch[1] << 7 | pitch[2]) / 0x4000;
  }

  int fine_ = 0x2000, coarse_ = 64;
  KeyCents keys_{};
};

}  // namespace contactspline
