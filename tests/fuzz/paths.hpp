// SPDX-License-Identifier: MIT
// What the program does with the bytes of an input file: its reader alone, and the whole path behind it to emitted
// text and sound. Large designs are made smaller: they are slow, not different.
#pragma once

#include <span>
#include <string_view>

namespace contactspline::testing {

/// Takes the bytes of a file. Throws BadInput if they are refused, std::logic_error if what follows from them is
/// wrong.
using TakeBytes = void (*)(std::string_view bytes);

struct Path {
  std::string_view name;  ///< also of its folder in corpus/
  std::string_view file;  ///< begins each message about the bytes
  TakeBytes read, play;   ///< the reader alone; reader, design, emission and a short block of sound
};

/// Material, curve, friction, resonator, keyboard, score, instrument and MIDI file.
[[nodiscard]] std::span<const Path> paths();

/// The path of that name. Throws std::out_of_range.
[[nodiscard]] const Path& path_of(std::string_view name);

/// Empty if a refusal is one readable line about `file`, else what is wrong with it.
[[nodiscard]] std::string_view fault_of_message(std::string_view message, std::string_view file);

}  // namespace contactspline::testing
