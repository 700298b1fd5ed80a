// SPDX-License-Identifier: MIT
// parse_midi() of a program that was built without PortSMF.
#include "generator/player/midi_reader.hpp"
#include "generator/support/error.hpp"

namespace contactspline {

MidiSong parse_midi(std::string_view /*bytes*/, std::string_view file, std::span<const int> /*channels*/) {
  refuse(std::string(file), "score", "this program was built without PortSMF and reads no MIDI", "a score (.json)");
}

}  // namespace contactspline
