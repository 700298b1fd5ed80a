// SPDX-License-Identifier: MIT
// Keys that scores of all instruments have in common, for the two score readers.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/step/controls.hpp"
#include "contactspline/step/half_band.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/player/score.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

inline constexpr Range kEventTime_s{0, 3600};
inline constexpr Range kScoreDuration_s{1e-3, 3600};
inline constexpr Range kVoicePan{-1, 1};
inline constexpr double kMidiRing_s = 1;         ///< after the last note of a MIDI file
inline constexpr double kMidiBendTime_s = 0.01;  ///< in which a sounding string follows the pitch wheel
inline constexpr std::size_t kMaxVoices = 128;
inline constexpr std::size_t kMaxEvents = 65536;

/// A number of an object, or `otherwise` if the object does not have it. Throws BadInput.
[[nodiscard]] inline double number_or(const JsonObject& object, const char* name, Range range, double otherwise) {
  return object.has(name) ? object.number(name, range) : otherwise;
}

/// The name of a voice, which is added to `names` and must not be in it. Throws BadInput.
[[nodiscard]] inline std::string read_voice_name(const JsonObject& json, std::set<std::string>& names) {
  constexpr auto kAllowed = "1 to 64 characters";
  std::string name = json.text("name", kAllowed);
  if (const std::size_t characters = count_characters(name); characters == 0 || characters > 64)
    json.fail(json.key("name"), fmt::format("has {} characters", characters), kAllowed);
  if (!names.insert(name).second)
    json.fail(json.key("name"), fmt::format("'{}' is the name of two voices", shown(name)), "once");
  return name;
}

/// The voices that an event is for: the one it names, or all. Throws BadInput.
[[nodiscard]] inline std::span<Voice> voices_of(const JsonObject& event, std::vector<Voice>& voices) {
  if (!event.has("voice")) return voices;
  std::vector<std::string_view> names;
  for (const Voice& voice : voices) names.push_back(voice.name);
  const std::string allowed = shown(fmt::format("{}", fmt::join(names, ", ")), 240);
  const std::string name = event.text("voice", allowed);
  const auto found = std::ranges::find(voices, name, &Voice::name);
  if (found == voices.end()) event.fail(event.key("voice"), fmt::format("'{}' is no voice", shown(name)), allowed);
  return {found, 1};
}

/// A turn of the pitch wheel as a glide of a parameter, beside the own tuning of a note.
[[nodiscard]] inline Glide glide_of(const MidiBend& bend, std::size_t parameter, double own_cents = 0) {
  return {bend.time_s, bend.in_note ? kMidiBendTime_s : 0, parameter, bend.cents + own_cents};
}

/// The parts of the one line that says what of a MIDI file is not played as it is written.
[[nodiscard]] inline std::vector<std::string> left_out_parts(const MidiSong& song) {
  std::vector<std::string> parts = song.remarks;
  if (song.unmapped > 0)
    parts.push_back(fmt::format("left out: notes on keys that the key map leaves out ({})", song.unmapped));
  if (song.far_bends > 0)
    parts.push_back(fmt::format("played as 48 semitones: bends by more than that ({})", song.far_bends));
  return parts;
}

/// Duration of a MIDI file whose last note ends at `end_s`, with the time that it rings [s]. Throws BadInput.
[[nodiscard]] inline double midi_duration_s(std::string_view file, double end_s) {
  if (!(end_s + kMidiRing_s <= kScoreDuration_s.max))
    throw BadInput(fmt::format("{}: MIDI: it lasts {:.4g} s; allowed: at most {} s", file, end_s,
                               kScoreDuration_s.max - kMidiRing_s));
  return end_s + kMidiRing_s;
}

/// The level of the peak that a score asks for, or nothing. Throws BadInput.
[[nodiscard]] inline std::optional<double> read_level(const JsonObject& score) {
  if (!score.has("level_db")) return std::nullopt;
  return score.number("level_db", kLevel_db);
}

/// At how many times the rate a score asks its models to run. Throws BadInput.
[[nodiscard]] inline int read_oversampling(const JsonObject& score) {
  if (!score.has("oversample")) return 1;
  const int factor = score.integer("oversample", 1, 8);
  if (std::ranges::find(kOversamplings, factor) == std::end(kOversamplings))
    score.fail("oversample", fmt::format("{} is no such factor", factor), "1, 2, 4, 8");
  return factor;
}

/// What is said of notes on the tenth channel that no keys play.
[[nodiscard]] inline std::string left_out_drums(std::size_t notes) {
  return fmt::format("left out: drums, the notes of channel 10 ({}), which --channel 10 plays as keys", notes);
}

/// Throws BadInput if the key of an event does not sound.
inline void require_tuned(const JsonObject& event, int key, const KeyCents& cents) {
  if (!is_number(cents[static_cast<std::size_t>(key)]))
    event.fail(event.key("key"), fmt::format("the key map leaves out key {}", key), "keys that it gives a degree");
}

/// Throws NothingTuned: a tuning is given for a score without keys that have a pitch.
[[noreturn]] inline void refuse_tuning(std::string_view file) {
  throw NothingTuned(
      fmt::format("{}: tuning: the score has no keys that could be tuned; allowed: for MIDI files, "
                  "keyboards, and instruments with a tuned_key",
                  file));
}

/// Sorts what happens to each voice by rising time.
inline void sort_by_time(std::vector<Voice>& voices) {
  for (Voice& voice : voices) {
    std::ranges::stable_sort(voice.glides, {}, &Glide::time_s);
    std::ranges::stable_sort(voice.strikes, {}, &Strike::time_s);
    std::ranges::stable_sort(voice.notes, {}, &Note::time_s);
  }
}

}  // namespace contactspline
