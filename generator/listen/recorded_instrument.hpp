// SPDX-License-Identifier: MIT
// Fit files of whole instruments (docs/how-to/fit.md): an instrument with open numbers, and recordings of its notes.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/fit/recorded_note.hpp"
#include "generator/listen/open_numbers.hpp"
#include "generator/material/contact_reader.hpp"

namespace contactspline {

/// A recorded note, and what plays it.
struct RecordedNote {
  std::string file;
  int key;                                   ///< of MIDI
  double velocity;                           ///< above 0 to 1
  std::optional<std::size_t> open_velocity;  ///< in its place: one of the open numbers
  bool is_kept;                              ///< not fitted: it shows how well the fit foretells
  RecordedSound recording;
};

struct RecordedInstrument {
  std::string fit_file;            ///< the file that was read
  std::string fit_text;            ///< what it says
  std::string text, file;          ///< of the instrument or keyboard file
  bool is_keyboard = false;        ///< is it one? Then each recorded key is played alone
  bool has_contacts = false;       ///< or friction: steps that err with the sample rate
  std::vector<std::string> files;  ///< all that were read, relative to the fit file
  std::size_t open_in_text = 0;    ///< so many of the open numbers stand in the text; the others are velocities
  std::vector<OpenNumber> open;
  std::vector<RecordedNote> notes;
  std::string output;            ///< its name; empty: the first
  double seconds = 1;            ///< of each note that are compared, from its onset on
  bool has_common_gain = false;  ///< else each recording has a gain of its own
};

/// Does the text have the keys of such a fit file?
[[nodiscard]] bool is_recorded_instrument(std::string_view text, std::string_view file);

/// Reads a fit file, its instrument and its recordings. `file` stands in messages; `read` reads what it names. Throws
/// BadInput, also if a recording is silent, saturated or too short.
[[nodiscard]] RecordedInstrument parse_recorded_instrument(std::string_view text, const std::string& file,
                                                           const ReadFile& read);

}  // namespace contactspline
