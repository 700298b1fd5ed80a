// SPDX-License-Identifier: MIT
// The pitches of the keys of MIDI, and which key of an instrument plays them.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace contactspline {

inline constexpr std::size_t kMidiKeys = 128;

/// Cents of each key above equal temperament. Not a number: the key does not sound.
using KeyCents = std::array<double, kMidiKeys>;

/// What an instrument is, as far as MIDI must know it.
struct MidiSettings {
  int first_key = 0, last_key = 127;
  /// A note that is tuned farther than that when it begins plays another key, the nearest to its pitch.
  double max_cents = std::numeric_limits<double>::infinity();
  /// The same without the bend of its channel.
  double max_own_cents = std::numeric_limits<double>::infinity();
  /// Until messages tune the keys otherwise.
  KeyCents key_cents{};
  /// Of the wheels at first, and after a reset: semitones and cents, as MIDI has them.
  int bend_range = 2 << 7;
};

/// A key of an instrument, and how far a note on it is tuned [cents].
struct TunedKey {
  int key;
  double cents;
};

/// What plays a note of a key, tuned by its own cents, that begins with a bend of its channel; cents: without that.
[[nodiscard]] inline TunedKey tuned_key(int key, double own_cents, double bend_cents, const MidiSettings& settings) {
  const double cents = own_cents + bend_cents;
  if (!(std::abs(cents) > settings.max_cents) && !(std::abs(own_cents) > settings.max_own_cents))
    return {key, own_cents};
  const int nearest =
      std::clamp(key + static_cast<int>(std::lround(cents / 100)), settings.first_key, settings.last_key);
  return {nearest, own_cents + 100.0 * (key - nearest)};
}

/// Settings of an instrument whose keys are tuned by a table. Strings far from the pitch that they are made for sound
/// so, and have another inharmonicity: a key that is tuned by more than a tone is played by the strings nearest to
/// it.
[[nodiscard]] inline MidiSettings tuned(MidiSettings settings, const KeyCents& key_cents) {
  constexpr double kTone = 200;
  settings.key_cents = key_cents;
  settings.max_own_cents = (std::min)(settings.max_cents, kTone);
  return settings;
}

}  // namespace contactspline
