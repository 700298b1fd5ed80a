// SPDX-License-Identifier: MIT
// Notes of a standard MIDI file.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

struct MidiNote {
  double time_s;
  double hold_s;      ///< until the key is let go, or the sustain pedal that holds it
  double key_hold_s;  ///< until the key is let go
  int key;            ///< 0 to 127, 60 is middle C
  int velocity;       ///< 1 to 127
  int channel;        ///< 0 to 15
};

/// The pitch wheel of a channel goes to another place.
struct MidiBend {
  double time_s;
  int channel;  ///< 0 to 15
  double cents;
  bool in_note;  ///< does a note of the channel sound?
};

/// A pedal goes to another place.
struct MidiPedal {
  enum : int { kSustain = 64, kSostenuto = 66, kSoft = 67 };  ///< controllers

  double time_s;
  int controller;
  double position;  ///< 0 up to 1 down, of the channel that presses it farthest
};

struct MidiSong {
  std::string title;              ///< of the first track, printable; empty where it has none
  std::vector<MidiNote> notes;    ///< by rising time
  std::vector<MidiBend> bends;    ///< by rising time
  std::vector<MidiPedal> pedals;  ///< by rising time
  std::size_t unchosen = 0;       ///< notes of other channels
};

/// Title and notes of a MIDI file of format 0 or 1: of the channels (1 to 16), or if none is given of all but the
/// tenth, which is for drums. Follows tempo, pedals (the sustain pedal holds notes from 64 on), restruck keys and the
/// pitch wheel (2 semitones, or the range that the file sets). `file` stands in messages only. Throws BadInput.
[[nodiscard]] MidiSong parse_midi(std::string_view bytes, std::string_view file, std::span<const int> channels = {});

}  // namespace contactspline
