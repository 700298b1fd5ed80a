// SPDX-License-Identifier: MIT
// Notes of a standard MIDI file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

struct MidiNote {
  double time_s;
  double hold_s;  ///< until the key is let go, or the pedal that holds it
  int key;        ///< 0 to 127, 60 is middle C
  int velocity;   ///< 1 to 127
};

struct MidiSong {
  std::string title;            ///< of the first track, printable; empty where it has none
  std::vector<MidiNote> notes;  ///< by rising time
};

/// Title and notes of a MIDI file of format 0 or 1: of every channel but the tenth, which is for drums; tempo,
/// sustain pedal (controller 64 from 64 on) and restruck keys are followed, all else is left out. `file` stands in
/// messages only. Throws BadInput.
[[nodiscard]] MidiSong parse_midi(std::string_view bytes, std::string_view file);

}  // namespace contactspline
