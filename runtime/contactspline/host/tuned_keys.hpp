// SPDX-License-Identifier: MIT
// Keys that a table tunes, for hosts that play keys without MIDI.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "contactspline/data/timed_event.hpp"
#include "contactspline/host/any_instrument.hpp"
#include "contactspline/midi/key_tuning.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// What MIDI must know of an instrument. Notes that begin farther than an octave from their key play another one.
template <std::floating_point T>
[[nodiscard]] MidiSettings midi_settings(const AnyInstrument<T>& instrument) {
  MidiSettings settings;
  while (settings.first_key < 127 && !instrument.has_key(settings.first_key)) ++settings.first_key;
  while (settings.last_key > settings.first_key && !instrument.has_key(settings.last_key)) --settings.last_key;
  if (instrument.bends_keys()) settings.max_cents = 1200;
  return settings;
}

/// Turns events of keys into those of the keys of an instrument that play them, and tunes these. Nothing allocates.
class TunedKeys {
 public:
  /// From the next notes on.
  void tune(const MidiSettings& settings) {
    settings_ = settings;
    is_tuned_ = true;
  }

  /// sink: called with each TimedEvent that the instrument has to play.
  template <typename Sink>
  void take(TimedEvent event, Sink&& sink) {
    if (!is_tuned_ || !is_of_key(event.action) || event.number >= kMidiKeys) return sink(event);
    Key& key = keys_[event.number];
    if (event.action == Action::kNoteOn && !begin(key, event.number)) return;
    if (event.action == Action::kNoteOff && !end(key)) return;
    if (event.action == Action::kNoteOn)
      sink(
          TimedEvent{event.sample, Action::kBendKey, number_of(key, event.number), key.tuned.cents + key.bend_cents});
    if (event.action == Action::kBendKey) {
      key.bend_cents = event.value;
      event.value += key.tuned.cents;
    }
    event.number = number_of(key, event.number);
    sink(event);
  }

  /// Lets all keys go, as if the instrument had been brought to rest.
  void drop_notes() {
    for (Key& key : keys_) key.is_held = false;
  }

 private:
  struct Key {
    TunedKey tuned{-1, 0};  // -1: not played yet
    double bend_cents = 0;
    bool is_held = false;
  };

  static bool is_of_key(Action action) {
    return action == Action::kNoteOn || action == Action::kNoteOff || action == Action::kBendKey ||
           action == Action::kDampKey || action == Action::kPlaceKey || action == Action::kMoveKey ||
           action == Action::kLevelKey || action == Action::kPanKey;
  }
  static std::size_t number_of(const Key& key, std::size_t otherwise) {
    return key.tuned.key < 0 ? otherwise : static_cast<std::size_t>(key.tuned.key);
  }

  // Does the key sound?
  bool begin(Key& key, std::size_t number) {
    const double cents = settings_.key_cents[number];
    if (!is_number(cents)) return false;
    key.tuned = tuned_key(static_cast<int>(number), cents, 0, settings_);
    return key.is_held = true;
  }
  // Does no other key hold what it plays?
  bool end(Key& key) {
    key.is_held = false;
    return std::ranges::none_of(keys_,
                                [&](const Key& other) { return other.is_held && other.tuned.key == key.tuned.key; });
  }

  MidiSettings settings_;
  bool is_tuned_ = false;
  std::array<Key, kMidiKeys> keys_{};
};

}  // namespace contactspline
