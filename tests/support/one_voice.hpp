// SPDX-License-Identifier: MIT
// The notes of a score on a single voice of an instrument file.
#pragma once

#include "contactspline/instrument/played_by_events.hpp"
#include "generator/player/voice_tracks.hpp"

namespace contactspline::testing {

/// Plays a note, or its end, on an instrument, which it tunes while it sounds. Returns whether the instrument has the
/// key. Instrument: NetworkInstrument or SeenNetwork.
template <typename Instrument>
bool play_note(Instrument& instrument, const NoteTrack::Change& change) {
  const Note& note = *change.strike;
  for (const KeyRange& range : instrument.keyed().ranges) {
    if (note.key < range.first || note.key > range.last) continue;
    const Event& event = instrument.events()[range.event];
    if (change.is_end) {
      event.kind == EventKind::kBow ? play_event(instrument, event, 0) : instrument.release(event.number);
      return true;
    }
    if (range.tuned_key >= 0) instrument.tune(100.0 * (note.key - range.tuned_key), range.string);
    play_event(instrument, event, note.velocity * instrument.value(event.parameter));
    return true;
  }
  return false;
}

}  // namespace contactspline::testing
