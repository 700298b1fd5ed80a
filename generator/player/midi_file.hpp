// SPDX-License-Identifier: MIT
// The chunks of a standard MIDI file: a list of messages with their times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

/// A message of a file.
struct MidiFileMessage {
  double time_s;
  std::vector<std::uint8_t> bytes;  ///< with their status; of a channel, or system-exclusive
};

struct MidiFile {
  std::string title;                      ///< of the first track, printable; empty where it has none
  std::vector<MidiFileMessage> messages;  ///< by rising time, at one time in the order of the tracks
  double end_s = 0;                       ///< of the last track
  std::vector<std::string> remarks;       ///< what was not read as it stands, with track and byte
};

/// Reads a file of format 0, 1 or 2, also within a RIFF file. Skips chunks of other kinds, as the standard asks. A
/// damaged event is left out with a remark. The tracks of format 2 follow each other. `file` stands in messages only.
/// Throws BadInput where there is no track.
[[nodiscard]] MidiFile read_midi_file(std::string_view bytes, std::string_view file);

/// Refuses a MIDI file in one line.
[[noreturn]] void refuse_midi(std::string_view file, std::string_view wrong);

}  // namespace contactspline
