// SPDX-License-Identifier: MIT
// A recorded note beside what an instrument makes of it, before and after a fit.
#pragma once

#include "generator/listen/note_impression.hpp"

namespace contactspline {

/// How far a recording is from what is rendered.
struct NoteDistance {
  double level_db;  ///< mean of the absolute differences of level
  double noise_db;  ///< what noise alone leaves of them
  double cents;     ///< median of those of the partials; 0 where the recording has none
};

struct FittedNote {
  NoteDistance before, after;
  NoteImpression recorded, started, found;  ///< the rendered ones with their gain
};

}  // namespace contactspline
