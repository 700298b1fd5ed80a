// SPDX-License-Identifier: MIT
// What speaks against a recorded note, or against its fit.
#pragma once

#include <string>
#include <vector>

#include "generator/listen/fitted_note.hpp"
#include "generator/listen/recorded_instrument.hpp"

namespace contactspline {

/// Throws BadInput where the strongest partial of a fitted note, or the lowest of those up to 12 dB below it,
/// recorded or rendered, has none of the other beside it within 80 cents.
void require_pitch(const RecordedInstrument& recorded, const std::vector<FittedNote>& notes);

/// A line for each recording that the instrument does not explain: differences of level beyond noise, partials that
/// it has not, no silence before the note that tells the noise.
[[nodiscard]] std::vector<std::string> doubts_of(const RecordedInstrument& recorded,
                                                 const std::vector<FittedNote>& notes);

}  // namespace contactspline
