// SPDX-License-Identifier: MIT
// How the audio thread tells a window which keys are held, and how far they are bent. Without a lock.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "contactspline/midi/key_tuning.hpp"

namespace contactspline {

/// The keys of MIDI. One thread writes, others read.
class HeldKeys {
 public:
  HeldKeys() { write(none()); }

  [[nodiscard]] static KeyCents none() {
    KeyCents none;
    none.fill(std::numeric_limits<double>::quiet_NaN());
    return none;
  }

  /// Of keys that are not held: not a number.
  void write(const KeyCents& cents) {
    for (std::size_t key = 0; key < kMidiKeys; ++key)
      cents_[key].store(static_cast<float>(cents[key]), std::memory_order_relaxed);
  }
  /// Of a key of MIDI, above its pitch in equal temperament, if it is held.
  [[nodiscard]] std::optional<double> cents(int key) const {
    const float cents = cents_[static_cast<std::size_t>(key)].load(std::memory_order_relaxed);
    return std::isnan(cents) ? std::nullopt : std::optional<double>(static_cast<double>(cents));
  }

 private:
  std::array<std::atomic<float>, kMidiKeys> cents_;
};

}  // namespace contactspline
