// SPDX-License-Identifier: MIT
#include "generator/listen/note_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

double cents_between(double from_hz, double to_hz) {
  return 1200 * std::log2(to_hz / from_hz);
}

bool has_beside(const Partials& partials, double frequency_hz, double cents) {
  return std::ranges::any_of(partials, [&](const Partial& partial) {
    return std::abs(cents_between(frequency_hz, partial.frequency_hz)) < cents;
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

bool has_more_than_noise(const NoteDistance& left) {
  constexpr double kLeft_db = 0.5, kOfNoise = 5;
  return left.level_db > std::max(kLeft_db, kOfNoise * left.noise_db);
}

// A harmonic of the mains, 50 or 60 Hz, of the lower ones?
bool may_be_hum(double frequency_hz) {
  constexpr double kHighest_hz = 700, kNear_hz = 1;
  return frequency_hz < kHighest_hz && std::ranges::any_of(std::array{50, 60}, [&](int mains_hz) {
           return std::abs(std::remainder(frequency_hz, mains_hz)) < kNear_hz;
         });
}

// Where the strong partials of a note begin.
double pitch_of(const Partials& partials) {
  constexpr double kDepth_db = 12;
  return lowest_hz(strong(partials, kDepth_db));
}

// How far open numbers may move a rendered note.
struct PitchReach {
  double low_cents = 0, high_cents = 0;
};

// From the start, by each number to the one of its bounds that leads there; nothing where one plays no note.
std::optional<PitchReach> reach_of(std::span<const RenderedNotes> at_bounds, std::size_t note) {
  const auto is_played = [&](const RenderedNotes& notes) { return notes && !(*notes)[note].partials.empty(); };
  if (!std::ranges::all_of(at_bounds, is_played)) return std::nullopt;
  const auto pitch = [&](std::size_t i) { return pitch_of((*at_bounds[i])[note].partials); };
  PitchReach reach;
  for (std::size_t i = 1; i + 1 < at_bounds.size(); i += 2) {
    const double one = cents_between(pitch(0), pitch(i)), other = cents_between(pitch(0), pitch(i + 1));
    reach.low_cents += std::min({one, other, 0.0});
    reach.high_cents += std::max({one, other, 0.0});
  }
  return reach;
}

// How far the strong partial nearest to the pitch of a key is from it, where that is nearer to another key: at most
// two semitones, beyond which the instrument may have no such pitch.
std::optional<double> cents_from_key(const Partials& partials, int key) {
  constexpr double kDepth_db = 20, kOtherKey_cents = 50, kFarthest_cents = 250;
  const double key_hz = 440 * std::exp2((key - 69) / 12.0);
  double nearest = kFarthest_cents;
  for (const Partial& partial : strong(partials, kDepth_db))
    if (const double cents = cents_between(key_hz, partial.frequency_hz); std::abs(cents) < std::abs(nearest))
      nearest = cents;
  if (std::abs(nearest) <= kOtherKey_cents || std::abs(nearest) >= kFarthest_cents) return std::nullopt;
  return nearest;
}

void require_pitch(const RecordedNote& note, const Partials& theirs, const Partials& ours, PitchReach reach) {
  constexpr double kFarthest_cents = 80;
  if (note.is_kept || theirs.empty() || ours.empty()) return;
  const double middle_cents = (reach.low_cents + reach.high_cents) / 2, moved = std::exp2(middle_cents / 1200);
  const double farthest_cents = kFarthest_cents + (reach.high_cents - reach.low_cents) / 2;
  const double found_hz = pitch_of(theirs), expected_hz = pitch_of(ours);
  if (has_beside(ours, theirs.front().frequency_hz / moved, farthest_cents) &&
      has_beside(ours, found_hz / moved, farthest_cents) && has_beside(theirs, expected_hz * moved, farthest_cents))
    return;
  const double low_hz = expected_hz * std::exp2(reach.low_cents / 1200);
  const double high_hz = expected_hz * std::exp2(reach.high_cents / 1200);
  refuse(note.file, "samples",
         fmt::format("the strong partials begin at {:.5g} Hz{}, those of key {} within the bounds at {:.5g}{} Hz",
                     found_hz, may_be_hum(found_hz) ? " (hum?)" : "", note.key, low_hz,
                     high_hz > 1.001 * low_hz ? fmt::format(" to {:.5g}", high_hz) : ""),
         "a recording of this key alone, or wider bounds");
}

}  // namespace

void require_pitch(const RecordedInstrument& recorded, const std::vector<FittedNote>& notes) {
  for (std::size_t n = 0; n < notes.size(); ++n)
    require_pitch(recorded.notes[n], notes[n].recorded.partials, notes[n].found.partials, {});
}

void require_pitch_in_reach(const RecordedInstrument& recorded, std::span<const std::size_t> notes,
                            std::span<const NoteImpression> impressions, std::span<const RenderedNotes> at_bounds) {
  for (std::size_t i = 0; i < notes.size(); ++i)
    if (const auto reach = reach_of(at_bounds, i))
      require_pitch(recorded.notes[notes[i]], impressions[i].partials, (*at_bounds[0])[i].partials, *reach);
}

bool is_explained(const FittedNote& note) {
  return !has_more_than_noise(note.after) && !strange_partial(note);
}

std::vector<std::string> doubts_of(const RecordedInstrument& recorded, const std::vector<FittedNote>& notes) {
  std::vector<std::string> doubts;
  for (std::size_t n = 0; n < notes.size(); ++n) {
    const std::string file = shown(recorded.notes[n].file);
    const NoteDistance& left = notes[n].after;
    if (has_more_than_noise(left))
      doubts.push_back(
          fmt::format("{}: the instrument does not explain it: {:.1f} dB are left, by noise alone {:.1f}", file,
                      left.level_db, left.noise_db));
    if (const auto strange = strange_partial(notes[n]))
      doubts.push_back(fmt::format("{}: the instrument has no partial near {:.5g} Hz: another note, hum?", file,
                                   strange->frequency_hz));
    if (const auto cents = cents_from_key(notes[n].recorded.partials, recorded.notes[n].key))
      doubts.push_back(fmt::format("{}: sounds {:+.0f} cents from its key, {}", file, *cents, recorded.notes[n].key));
    if (notes[n].recorded.noise_frames == 0)
      doubts.push_back(fmt::format("{}: its noise is not known: 0.1 s before the note would tell", file));
  }
  return doubts;
}

}  // namespace contactspline
