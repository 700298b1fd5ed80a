// SPDX-License-Identifier: MIT
#include "generator/listen/note_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "generator/fit/recorded_note.hpp"
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

// The mean squares of 10 ms each.
std::vector<double> powers_of(const RecordedSound& recording) {
  const auto length = static_cast<std::size_t>(0.01 * recording.sample_rate_hz);
  std::vector<double> powers;
  for (std::size_t begin = 0; begin + length <= recording.samples.size(); begin += length) {
    const auto part = std::span(recording.samples).subspan(begin, length);
    powers.push_back(std::inner_product(part.begin(), part.end(), part.begin(), 0.0) / static_cast<double>(length));
  }
  return powers;
}

// The first partial up to 20 dB below the strongest that the rendered note has not.
std::optional<Partial> strange_partial(const FittedNote& note) {
  constexpr double kDepth_db = 20, kFar_cents = 60;
  for (const Partial& partial : strong(note.recorded.partials, kDepth_db))
    if (!has_beside(note.found.partials, partial.frequency_hz, kFar_cents)) return partial;
  return std::nullopt;
}

}  // namespace

void require_one_sound(RecordedSound& recording, const std::string& file) {
  constexpr double kPause = 1e-3, kRounding = 1e-9;
  require_sounding(recording, file);
  std::vector<double>& samples = recording.samples;
  const double offset = std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
  for (double& sample : samples) sample -= offset;
  if (std::ranges::all_of(samples, [&](double sample) { return std::abs(sample) <= kRounding * std::abs(offset); }))
    refuse(file, "samples", "the recording is silent", "a struck note");
  const std::vector<double> powers = powers_of(recording);
  if (powers.empty()) return;
  const auto loudest = std::ranges::max_element(powers);
  const double onset_s = onset_of(samples, recording.sample_rate_hz);
  const auto begin =
      powers.begin() +
      std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(std::max(0.0, 100 * onset_s)), loudest - powers.begin());
  if (std::any_of(begin, loudest, [&](double power) { return power < kPause * *loudest; }))
    refuse(file, "samples",
           fmt::format("something sounds {:.2g} s before the note", 0.01 * static_cast<double>(loudest - begin)),
           "one note, without what is before it");
}

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
  constexpr double kLeft_db = 2, kOfNoise = 2;
  std::vector<std::string> doubts;
  for (std::size_t n = 0; n < notes.size(); ++n) {
    const std::string file = shown(recorded.notes[n].file);
    const NoteDistance& left = notes[n].after;
    if (left.level_db > kLeft_db + kOfNoise * left.noise_db)
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
