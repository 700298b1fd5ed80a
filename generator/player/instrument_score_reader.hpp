// SPDX-License-Identifier: MIT
// Scores of instruments that a file describes (docs/reference/scores.md).
#pragma once

#include <span>
#include <string_view>

#include "generator/player/score.hpp"
#include "generator/player/tuning.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// Reads a score that an instrument of a file plays. `file` stands in messages only. Throws BadInput.
[[nodiscard]] Score parse_score_on(const JsonObject& score, std::string_view file, const InstrumentModel& model,
                                   const Tuning& tuning);

/// The notes of a MIDI file, of these channels as in parse_midi(), on an instrument, with 1 s to ring after the last
/// one. Without keys of its own it has those of hosts. Without channels, keys of its own that tune nothing play the
/// tenth, which is for drums. A channel with a pitch wheel has an instrument of its own. Throws BadInput.
[[nodiscard]] Score parse_midi_on_instrument(std::string_view bytes, std::string_view file,
                                             std::span<const int> channels, const InstrumentModel& given,
                                             const Tuning& tuning = {});

}  // namespace contactspline
