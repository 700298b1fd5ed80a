// SPDX-License-Identifier: MIT
// What a host says of single notes within a block. The framework knows bytes of MIDI of a channel only: the sides of
// CLAP and VST3 put the rest, and with it all notes, into this list, in the order of their times.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "contactspline/midi/midi_interpreter.hpp"

namespace contactspline {

struct HostNote {
  enum class Kind : unsigned char {
    kMidi,      ///< bytes
    kBegin,     ///< name, value: velocity, 0 to 1; cents above its key
    kEnd,       ///< name, value: release velocity, 0 to 1
    kEndFirst,  ///< the same of the first note of that name that is held
    kExpress,   ///< name, expression, value as MidiInterpreter has it
    kSet,       ///< name, parameter, value as the host shows it
    kModulate   ///< name, or none for all; parameter, value: how far it is moved, as the host shows it
  };
  Kind kind;
  std::uint32_t frame;  ///< in the block [samples]
  NoteName name = {};
  double value = 0, cents = 0;
  NoteExpression expression = {};
  std::uint32_t parameter = 0;               ///< as the host counts them
  std::span<const std::uint8_t> bytes = {};  ///< the host's
};

/// Does a name stand for all notes?
[[nodiscard]] constexpr bool is_of_all(const NoteName& name) {
  return name.id < 0 && name.channel < 0 && name.key < 0;
}

/// The list of a block.
class HostNotes {
 public:
  [[nodiscard]] bool is_full() const { return count_ == notes_.size(); }
  /// Where it is not full.
  void push(const HostNote& note) { notes_[count_++] = note; }
  [[nodiscard]] std::span<const HostNote> all() const { return std::span(notes_).first(count_); }
  void clear() { count_ = 0; }

 private:
  std::array<HostNote, 1024> notes_;
  std::size_t count_ = 0;
};

/// How far a host has moved a parameter of a key: by setting it, and by modulating it. In the instrument's unit.
struct NoteMove {
  double set = 0, modulated = 0;
};

}  // namespace contactspline
