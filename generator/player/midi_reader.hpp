// SPDX-License-Identifier: MIT
// Notes of a standard MIDI file.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/midi/midi_interpreter.hpp"
#include "generator/player/midi_file.hpp"
#include "generator/support/error.hpp"

namespace contactspline {

struct MidiNote {
  double time_s;
  double hold_s;                     ///< until the key is let go, or the sustain pedal that holds it
  double key_hold_s;                 ///< until the key is let go
  int key;                           ///< 0 to 127, 60 is middle C
  double velocity;                   ///< above 0 to 1
  int channel;                       ///< 0 to 15
  double cents = 0;                  ///< of its own, beside the bend of its channel
  double release = 0;                ///< velocity with which the key is let go, 0 to 1
  std::size_t begins = 0, ends = 0;  ///< numbers of both among what the file plays
};

/// The pitch wheel or the tuning of a channel goes to another place.
struct MidiBend {
  double time_s;
  int channel;  ///< 0 to 15
  double cents;
  bool in_note;  ///< does a note of the channel sound?
};

/// A pedal goes to another place.
struct MidiPedal {
  double time_s;
  int controller;   ///< of kMidiPedals
  double position;  ///< 0 up to 1 down, of the channel that presses it farthest
};

/// A controller that is no pedal, or the pressure (kPressureController), goes to another place.
struct MidiMove {
  double time_s;
  int channel;  ///< 0 to 15
  int controller;
  double part;            ///< 0 to 1
  bool is_first = false;  ///< back to its first value
};

/// A channel changes its program.
struct MidiProgram {
  double time_s;
  std::set<int> channels;  ///< 0 to 15: its own, and the members of an MPE zone whose first one it is
  int program;             ///< 0 to 127
};

struct MidiSong {
  std::string title;                       ///< of the first track, printable; empty where it has none
  std::vector<MidiNote> notes;             ///< by rising time
  std::vector<MidiBend> bends;             ///< by rising time
  std::vector<MidiPedal> pedals;           ///< by rising time
  std::vector<MidiMove> moves = {};        ///< by rising time
  std::vector<MidiProgram> programs = {};  ///< by rising time
  std::vector<double> silences_s = {};     ///< when all that sounds stops
  std::vector<std::string> remarks = {};   ///< what of the file was not read as it stands
  std::size_t unchosen = 0;                ///< notes of other channels
  std::size_t unmapped = 0;                ///< notes on keys that do not sound
  std::size_t far_bends = 0;               ///< of sounding notes, beyond what strings follow
};

/// What is played of a MIDI file.
struct PlayedMidi {
  MidiFile file;             ///< messages of the chosen channels; those behind its end let go what nobody has let go
  std::size_t notes = 0;     ///< of these channels
  std::size_t unchosen = 0;  ///< notes of other channels
};

/// Nothing of a MIDI file is played: the notes are on other channels or keys.
struct NothingPlayed : BadInput {
  using BadInput::BadInput;
};

/// A channel of a file that has notes.
struct MidiUse {
  std::size_t notes = 0;
  int program = 0;  ///< of its first note, 0 to 127
};

/// The channels (1 to 16) of a file that have notes.
[[nodiscard]] std::map<int, MidiUse> midi_uses(std::span<const MidiFileMessage> messages);

/// The messages of the channels (1 to 16), or if none is given of all but the tenth, which is for drums unless an MPE
/// zone holds it. `file` stands in messages only. Throws BadInput, also where no note is played.
[[nodiscard]] PlayedMidi read_played_midi(std::string_view bytes, std::string_view file,
                                          std::span<const int> channels = {});

/// Title and notes of what read_played_midi() reads. What the messages mean says MidiInterpreter. Throws BadInput.
[[nodiscard]] MidiSong parse_midi(std::string_view bytes, std::string_view file, std::span<const int> channels = {},
                                  const MidiSettings& settings = {});

}  // namespace contactspline
