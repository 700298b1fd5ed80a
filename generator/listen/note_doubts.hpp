// SPDX-License-Identifier: MIT
// What speaks against a recorded note, or against its fit.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "generator/listen/fitted_note.hpp"
#include "generator/listen/note_renderer.hpp"
#include "generator/listen/recorded_instrument.hpp"

namespace contactspline {

/// Throws BadInput where the strongest partial of a fitted note, or the lowest of those up to 12 dB below it,
/// recorded or rendered, has none of the other beside it within 80 cents.
void require_pitch(const RecordedInstrument& recorded, const std::vector<FittedNote>& notes);

/// The same before a search, with the pitches that open numbers may reach: at_bounds has the notes at the start, and
/// behind them those with each number at its lower and its upper bound. notes: those of the instrument that these
/// are.
void require_pitch_in_reach(const RecordedInstrument& recorded, std::span<const std::size_t> notes,
                            std::span<const NoteImpression> impressions, std::span<const RenderedNotes> at_bounds);

/// Does what the instrument plays differ from the recording by little more than noise, with its strong partials?
[[nodiscard]] bool is_explained(const FittedNote& note);

/// A line for each recording that the instrument does not explain: differences of level beyond noise, partials that
/// it has not, no silence before the note that tells the noise.
[[nodiscard]] std::vector<std::string> doubts_of(const RecordedInstrument& recorded,
                                                 const std::vector<FittedNote>& notes);

}  // namespace contactspline
