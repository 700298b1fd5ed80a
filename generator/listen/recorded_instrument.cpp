// SPDX-License-Identifier: MIT
#include "generator/listen/recorded_instrument.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/json_syntax.hpp"

namespace contactspline {
namespace {

constexpr auto kInstrumentKey = "instrument";
const std::vector<std::string> kKeysOfFit{kInstrumentKey, "recordings", "output", "seconds", "gain"};
constexpr std::size_t kMaxRecordings = 64, kMaxOpen = 64;
constexpr double kMinRate_hz = 8000;
constexpr Range kVelocity{0.01, 1}, kAnyVelocity{0.1, 1}, kSeconds{0.1, 10};

bool read_is_kept(const JsonObject& entry) {
  if (!entry.has("kept")) return false;
  const std::string value = entry.json("kept");
  if (value != "true" && value != "false") entry.fail(entry.key("kept"), "is not true or false", "true or false");
  return value == "true";
}

// Stated, between bounds, or unknown.
void read_velocity(const JsonObject& entry, RecordedNote& note, std::vector<OpenNumber>& open) {
  const std::string key = entry.key("velocity");
  const bool is_open = entry.has_object("velocity");
  if (entry.has("velocity") && !is_open) {
    note.velocity = entry.number("velocity", kVelocity);
    return;
  }
  if (note.is_kept)
    entry.fail(key, "is not stated, but the recording is kept", "a number from 0.01 to 1, such as 0.7");
  OpenNumber velocity{key, kAnyVelocity, 0.5};
  if (is_open) velocity = read_open_number(entry.object("velocity", {"fit", "start"}), key);
  if (velocity.bounds.min < kVelocity.min || velocity.bounds.max > kVelocity.max)
    entry.fail(key, "leaves its range", "bounds from 0.01 to 1");
  note.open_velocity = open.size();
  open.push_back(velocity);
}

void read_recordings(const JsonObject& fit, const std::vector<JsonObject>& entries, const ReadFile& read,
                     RecordedInstrument& recorded) {
  for (const JsonObject& entry : entries) {
    const std::string path = entry.text("file", "a sound file of one or two channels, relative to the fit file");
    RecordedNote note{path, entry.integer("key", 0, 127), 0, {}, read_is_kept(entry), {}};
    read_velocity(entry, note, recorded.open);
    note.recording = read_recording(read_for_key(fit.file(), entry.key("file"), path, read), path, 2);
    if (const double rate_hz = note.recording.sample_rate_hz; rate_hz < kMinRate_hz)
      refuse(path, "sample_rate_hz", fmt::format("is {:g}", rate_hz), fmt::format("{:g} or more", kMinRate_hz));
    require_one_sound(note.recording, path);
    recorded.files.push_back(path);
    recorded.notes.push_back(std::move(note));
  }
  if (std::ranges::all_of(recorded.notes, &RecordedNote::is_kept))
    fit.fail("recordings", "all are kept", "one or more that are not");
  const auto is_stated = [](const RecordedNote& note) { return !note.is_kept && !note.open_velocity; };
  if (std::ranges::none_of(recorded.notes, is_stated))
    fit.fail("recordings", "no fitted one states its velocity, for which gain and contact may stand as well",
             "one or more that do, such as \"velocity\": 0.5");
}

}  // namespace

bool is_recorded_instrument(std::string_view text, std::string_view file) {
  if (is_something_else(text)) return false;
  const std::vector<std::string> keys = json_keys(text, file, "fit");
  return std::ranges::count(keys, kInstrumentKey) + std::ranges::count(keys, "recordings") > 0;
}

RecordedInstrument parse_recorded_instrument(std::string_view text, const std::string& file, const ReadFile& read) {
  const JsonObject fit = parse_json(text, file, "fit", kKeysOfFit);
  const std::vector<JsonObject> entries =
      fit.objects("recordings", {"file", "key", "velocity", "kept"}, kMaxRecordings);
  RecordedInstrument recorded;
  recorded.fit_file = file;
  recorded.fit_text = text;
  recorded.file = fit.text(kInstrumentKey, "an instrument or keyboard file (.json), relative to the fit file");
  recorded.text = read_for_key(file, kInstrumentKey, recorded.file, read);
  recorded.files.push_back(recorded.file);
  recorded.is_keyboard = kind_of_file(recorded.text, recorded.file, "instrument") == Shipped::kKeyboards;
  recorded.open = open_numbers(recorded.text, recorded.file);
  recorded.open_in_text = recorded.open.size();
  const std::vector<std::string> keys = json_keys(recorded.text, recorded.file, "instrument");
  recorded.has_contacts =
      recorded.is_keyboard || std::ranges::count(keys, "contacts") + std::ranges::count(keys, "frictions") > 0;
  if (recorded.open.empty() || recorded.open.size() > kMaxOpen)
    refuse(recorded.file, "instrument", fmt::format("has {} open numbers", recorded.open.size()),
           fmt::format("1 to {}, such as {{\"fit\": [1, 2]}} in place of a number", kMaxOpen));
  if (fit.has("seconds")) recorded.seconds = fit.number("seconds", kSeconds);
  if (fit.has("output")) recorded.output = fit.text("output", "the name of an output");
  if (fit.has("gain")) {
    const std::string gain = fit.text("gain", "each, common");
    if (gain != "each" && gain != "common")
      fit.fail("gain", fmt::format("'{}' is unknown", shown(gain)), "each, common");
    recorded.has_common_gain = gain == "common";
  }
  read_recordings(fit, entries, read, recorded);
  return recorded;
}

}  // namespace contactspline
