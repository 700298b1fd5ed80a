// SPDX-License-Identifier: MIT
// The fit of an instrument's open numbers to recordings of its notes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "generator/listen/fitted_note.hpp"
#include "generator/listen/recorded_instrument.hpp"
#include "generator/listen/search_steps.hpp"

namespace contactspline {

/// A number that was found, with its 95 % interval.
struct FoundNumber {
  double value, low, high;
  bool is_at_bound = false;
  bool is_told = true;  ///< do the recordings tell it? Else the interval is all that is allowed
};

struct InstrumentFit {
  std::vector<FoundNumber> numbers;  ///< of each open one
  std::vector<FittedNote> notes;     ///< of each recording
  std::vector<std::string> doubts;   ///< lines that say what the instrument does not explain
  bool is_explained = true;          ///< are the fitted notes? Else the intervals may lack the true numbers
};

/// Searches the open numbers by least squares from several starts (docs/how-to/fit.md). `tell` hears what is done
/// now, and what an interrupted fit found is taken from the disk. Throws BadInput where the instrument cannot be made
/// or played at the start, where an open number changes nothing, and as require_pitch() does, before the search where
/// it can tell.
[[nodiscard]] InstrumentFit fit_instrument(const RecordedInstrument& recorded, const ReadFile& read,
                                           const std::function<void(const std::string&)>& tell,
                                           const StepsOnDisk& disk);

}  // namespace contactspline
