// SPDX-License-Identifier: MIT
// Score files: JSON and MIDI (docs/reference/scores.md).
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "generator/material/contact_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/player/score.hpp"
#include "generator/player/tuning.hpp"

namespace contactspline {

/// Parses the text of a score: JSON with comments (docs/reference/scores.md). `file` stands in messages only; `read`
/// gives the files it names. played: an instrument that the score must name, in place of a file; null: none. given: a
/// tuning in place of the score's, if it is given. Throws BadInput.
[[nodiscard]] Score parse_score(std::string_view text, std::string_view file, const ReadFile& read,
                                const InstrumentModel* played = nullptr, const Tuning& given = {});

/// A voice for each key of a keyboard, and its body, without events; designs all felts, which takes some seconds.
/// named: its file; `read` reads what it names. Throws BadInput.
[[nodiscard]] Score score_of_all_keys(const Keyboard& keyboard, const NamedText& named, const ReadFile& read);

/// What a score says of itself, for a list.
struct ScoreHeading {
  std::string instrument;   ///< its name, or its file; of a score that ships
  std::string description;  ///< one line, may be empty
  double duration_s;
};

/// The heading of such a score. Reads no event, and designs no contact. Throws BadInput.
[[nodiscard]] ScoreHeading score_heading(std::string_view text, std::string_view file);

/// The heading of a MIDI file as parse_midi_score() plays it. Throws BadInput.
[[nodiscard]] ScoreHeading midi_score_heading(std::string_view bytes, std::string_view file);

/// The keyboard that plays MIDI files, unless another one is asked for.
[[nodiscard]] NamedText shipped_piano();

/// The notes of a MIDI file, of these channels as in parse_midi(), on a keyboard, with 1 s to ring after the last
/// one. `read` reads what the keyboard names. The keyboard's velocity law turns velocity/127 into the hammer's speed.
/// A bent note is played on a string of its own, with the tension of its pitch; then the piano has no body, which all
/// these strings would load. Notes beyond the keyboard are left out. Throws BadInput.
[[nodiscard]] Score parse_midi_score(std::string_view bytes, std::string_view file,
                                     std::span<const int> channels = {}, const NamedText& played = shipped_piano(),
                                     const ReadFile& read = shipped_file, const Tuning& tuning = {});

}  // namespace contactspline
