// SPDX-License-Identifier: MIT
#include "generator/listen/note_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "generator/support/error.hpp"

namespace contactspline {
namespace {

using Partials = std::vector<Partial>;  // by falling level

// The partials up to so much below the strongest.
Partials strong(Partials partials, double depth_db) {
  std::erase_if(partials,
                [&](const Partial& partial) { return partial.level_db < partials.front().level_db - depth_db; });
  return partials;
}

bool has_beside(const Partials& partials, double frequency_hz, double cents) {
  return std::ranges::any_of(partials, [&](const Partial& partial) {
    return std::abs(1200 * std::log2(partial.frequency_hz / frequency_hz)) < cents;
  });
}

double lowest_hz(const Partials& partials) {
  return std::ranges::min(partials, {}, &Partial::frequency_hz).frequency_hz;
}

// The first partial up to 20 dB below the strongest that the rendered note has not.
std::optional<Partial> strange_partial(const FittedNote& note) {
  constexpr double kDepth_db = 20, kFar_cents = 60;
  for (const Partial& partial : strong(note.recorded.partials, kDepth_db))
    if (!has_beside(note.found.partials, partial.frequency_hz, kFar_cents)) return partial;
  return std::nullopt;
}

}  // namespace

void require_pitch(const RecordedInstrument& recorded, const std::vector<FittedNote>& notes) {
  constexpr double kFarthest_cents = 80, kDepth_db = 12;
  for (std::size_t n = 0; n < notes.size(); ++n) {
    const Partials &theirs = notes[n].recorded.partials, &ours = notes[n].found.partials;
    if (recorded.notes[n].is_kept || theirs.empty() || ours.empty()) continue;
    const double found_hz = lowest_hz(strong(theirs, kDepth_db)), expected_hz = lowest_hz(strong(ours, kDepth_db));
    if (has_beside(ours, theirs.front().frequency_hz, kFarthest_cents) &&
        has_beside(ours, found_hz, kFarthest_cents) && has_beside(theirs, expected_hz, kFarthest_cents))
      continue;
    refuse(recorded.notes[n].file, "samples",
           fmt::format("the strong partials begin at {:.5g} Hz, those of key {} within the bounds at {:.5g} Hz",
                       found_hz, recorded.notes[n].key, expected_hz),
           "a recording of this key, or wider bounds");
  }
}

std::vector<std::string> doubts_of(const RecordedInstrument& recorded, const std::vector<FittedNote>& notes) {
  constexpr double kLeft_db = 0.5, kOfNoise = 5;
  std::vector<std::string> doubts;
  for (std::size_t n = 0; n < notes.size(); ++n) {
    const std::string file = shown(recorded.notes[n].file);
    const NoteDistance& left = notes[n].after;
    if (left.level_db > std::max(kLeft_db, kOfNoise * left.noise_db))
      doubts.push_back(
          fmt::format("{}: the instrument does not explain it: {:.1f} dB are left, by noise alone {:.1f}", file,
                      left.level_db, left.noise_db));
    if (const auto strange = strange_partial(notes[n]))
      doubts.push_back(fmt::format("{}: the instrument has no partial near {:.5g} Hz: another note, hum?", file,
                                   strange->frequency_hz));
    if (notes[n].recorded.noise_frames == 0)
      doubts.push_back(fmt::format("{}: its noise is not known: 0.1 s before the note would tell", file));
  }
  return doubts;
}

}  // namespace contactspline
