// SPDX-License-Identifier: MIT
// What speaks against a recorded note, or against its fit.
#pragma once

#include <string>
#include <vector>

#include "generator/listen/instrument_fit.hpp"

namespace contactspline {

/// Takes the mean of the samples away. Throws BadInput if they are silent or saturated, or if something sounds before
/// the note: between it and the loudest 10 ms the level falls 30 dB below those.
void require_one_sound(RecordedSound& recording, const std::string& file);

/// Throws BadInput where the strongest partial of a fitted note, or the lowest of those up to 12 dB below it,
/// recorded or rendered, has none of the other beside it within 80 cents.
void require_pitch(const RecordedInstrument& recorded, const std::vector<FittedNote>& notes);

/// A line for each recording that the instrument does not explain: differences of level beyond noise, partials that
/// it has not, no silence before the note that tells the noise.
[[nodiscard]] std::vector<std::string> doubts_of(const RecordedInstrument& recorded,
                                                 const std::vector<FittedNote>& notes);

}  // namespace contactspline
