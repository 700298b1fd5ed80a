// SPDX-License-Identifier: MIT
// Tunings: Scala's files of scales (.scl) and key maps (.kbm), and the pitch of A4 (docs/how-to/tuning.md).
#pragma once

#include <optional>
#include <string>

#include "contactspline/midi/key_tuning.hpp"
#include "generator/material/contact_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// A text, and the file that messages name.
struct TuningText {
  std::string text, file;
};

/// What tunes the keys.
struct Tuning {
  std::optional<TuningText> scale = {};   ///< .scl; none: twelve equal tones in an octave
  std::optional<TuningText> keymap = {};  ///< .kbm; none: the scale goes up from key 60, which keeps its pitch
  std::optional<double> a4_hz = {};       ///< pitch of key 69, in place of the one that the key map states

  [[nodiscard]] bool is_given() const { return scale || keymap || a4_hz; }
};

inline constexpr Range kA4_hz{220, 880};
inline constexpr double kUsualA4_hz = 440;

/// A tuning is given, and nothing that is played has a pitch.
struct NothingTuned : BadInput {
  using BadInput::BadInput;
};

/// Cents of all keys above those of an instrument of equal temperament with such an A4 [Hz]. A key that the key map
/// leaves out has no number; those outside of its range have 0. Throws BadInput, with file and line.
[[nodiscard]] KeyCents key_cents(const Tuning& tuning, double own_a4_hz = kUsualA4_hz);

/// The keys `tuning`, `keymap` and `a4_hz` of a score. `read` gives the files that they name. Throws BadInput.
[[nodiscard]] Tuning read_tuning(const JsonObject& score, const ReadFile& read);

}  // namespace contactspline
