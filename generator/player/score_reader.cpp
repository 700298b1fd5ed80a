// SPDX-License-Identifier: MIT
#include "generator/player/score_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "generator/instrument/instrument_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/player/instrument_score_reader.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/player/score_keys.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr double kForEver = std::numeric_limits<double>::infinity();

constexpr auto kKeyControls = std::span(HammerStringParameter::kList).first(HammerStringParameter::kOfKeys);
constexpr const Parameter& kBlow = HammerStringParameter::kList[HammerStringParameter::kSpeed];
constexpr Shipped kPlayers[] = {Shipped::kInstruments, Shipped::kKeyboards};

constexpr int kNoBends = -1;            // instead of a channel
constexpr double kKeyboardWidth = 0.6;  // pan of its ends

Damper damper_of(const Keyboard& keyboard, int key) {
  return {key <= keyboard.last_damped_key ? keyboard.damper_per_s : 0, keyboard.damper_time_s};
}

// A key of a keyboard as a voice, panned as from the bench of the piano.
Voice voice_of(const Keyboard& keyboard, int key) {
  KeyboardNote note = note_of(keyboard, key);
  const int span = keyboard.last_key - keyboard.first_key;
  const double from_middle = span == 0 ? 0 : 2.0 * (key - keyboard.first_key) / span - 1;
  Voice voice;
  voice.name = fmt::format("{}", key);
  voice.resonator = {keyboard.name, "", note.string, {note.strike_position_m}, {note.strike_position_m}, kMaxModes};
  voice.contact = segment_table(design_spline(note.felt, keyboard.name));
  using Control = HammerStringParameter;
  for (const Parameter& parameter : Control::kList) voice.initial.push_back(parameter.initial);
  voice.initial[Control::kHammerMass] = note.hammer_mass_kg;
  voice.initial[Control::kLoss] = keyboard.felt_loss_s_per_m;
  voice.initial[Control::kPlace] = note.strike_position_m;
  voice.damper = damper_of(keyboard, key);
  voice.strings = note.strings;
  voice.pan = kKeyboardWidth * from_middle;
  voice.key = static_cast<std::size_t>(key - keyboard.first_key);
  return voice;
}

// All keys of a keyboard, which end at its body.
void add_body(const Keyboard& keyboard, const NamedText& file, const ReadFile& read, Score& score) {
  KeyboardResonators resonators = resonators_of(keyboard, file, read);
  score.body = std::move(resonators.body);
  score.knock = std::move(resonators.knock);
  score.bridge_places = std::move(resonators.bridge_places);
  score.ears = std::move(resonators.ears);
  if (!score.body) return;
  score.una_corda_stiffness_ratio = keyboard.body->una_corda_stiffness_ratio;
  score.listening = keyboard.body->listening;
  for (int key = keyboard.first_key; key <= keyboard.last_key; ++key) {
    const KeyboardNote note = note_of(keyboard, key);
    score.keys.push_back({.strings = strings_on_body(note, *keyboard.body),
                          .strike_position_m = note.strike_position_m,
                          .felt = {},
                          .hammer_mass_kg = note.hammer_mass_kg,
                          .damper = damper_of(keyboard, key),
                          .bridge_ratio = note.bridge_ratio,
                          .output_ratio = note.output_ratio,
                          .horizontal = horizontal_motion(note, *keyboard.body),
                          .bridge_place = note.bridge_place,
                          .longitudinal = longitudinal_motion(note, *keyboard.body, key)});
  }
}

// What of a MIDI file is not played as it is written.
std::string left_out_line(std::string_view file, const Keyboard& keyboard, const MidiSong& song, std::size_t drums,
                          std::size_t notes) {
  std::vector<std::string> parts;
  if (drums > 0) parts.push_back(left_out_drums(drums));
  if (notes > 0)
    parts.push_back(
        fmt::format("left out: notes beyond the keys {} to {} ({})", keyboard.first_key, keyboard.last_key, notes));
  std::ranges::copy(left_out_parts(song), std::back_inserter(parts));
  if (parts.empty()) return {};
  return fmt::format("{}: MIDI: {}", file, fmt::join(parts, "; "));
}

// How the wheel of a channel bends its strings. Of several bends at one time the last one counts.
SharedGlides bends_of(std::span<const MidiBend> bends, int channel) {
  std::vector<Glide> glides;
  for (const MidiBend& bend : bends) {
    if (bend.channel != channel) continue;
    if (!glides.empty() && glides.back().time_s == bend.time_s) glides.pop_back();
    glides.push_back(glide_of(bend, HammerStringParameter::kBend));
  }
  return std::make_shared<const std::vector<Glide>>(std::move(glides));
}

// Without the body the sustain pedal holds notes, from halfway on, and that is all.
void add_pedals(std::span<const MidiPedal> pedals, Score& score) {
  for (const auto& [time_s, controller, position] : pedals) {
    const auto pedal = std::ranges::find(KeyboardParameter::kList, controller, &Parameter::controller);
    const auto parameter = static_cast<std::size_t>(pedal - KeyboardParameter::kList.begin());
    score.pedals.push_back({time_s, 0, parameter, position});
    if (parameter != KeyboardParameter::kSustain || (position > 0 && position < 1))
      score.left_out_at_rest = "half pedal, sostenuto and soft pedal";
  }
}

// When the pedals that are down at the end of the last note are up again: they may hold it.
double end_of_pedals(std::span<const MidiPedal> pedals, double end_s) {
  bool sustains = false, holds = false;
  for (const MidiPedal& pedal : pedals) {
    if (pedal.time_s > end_s && !sustains && !holds) break;
    if (pedal.controller == kSostenutoPedal) holds = pedal.position > 0;
    if (pedal.controller == kSustainPedal) sustains = pedal.position > 0;
    end_s = std::max(end_s, pedal.time_s);
  }
  return end_s;
}

MidiSettings settings_of(const Keyboard& keyboard, const Tuning& tuning) {
  const MidiSettings settings{
      .first_key = keyboard.first_key, .last_key = keyboard.last_key, .max_cents = kTuningCents.max};
  return tuning.is_given() ? tuned(settings, key_cents(tuning, keyboard.concert_pitch_hz)) : settings;
}

// The key of an event as a voice: its strings, and what tunes them.
Voice read_key(const JsonObject& event, int key, const Keyboard& keyboard, const MidiSettings& settings) {
  require_tuned(event, key, settings.key_cents);
  const auto [played, cents] = tuned_key(key, settings.key_cents[static_cast<std::size_t>(key)], 0, settings);
  if (played < keyboard.first_key || played > keyboard.last_key)
    event.fail(event.key("key"), fmt::format("{} has a pitch beyond the keyboard", key),
               fmt::format("pitches of the keys {} to {}", keyboard.first_key, keyboard.last_key));
  Voice voice = voice_of(keyboard, played);
  voice.name = fmt::format("{}", key);
  voice.bend_cents = cents;
  return voice;
}

// Every key that is played. A tuning may give pitches of the keyboard to any key of MIDI.
std::vector<Voice> read_keys(const JsonObject& score, const Keyboard& keyboard, const std::vector<JsonObject>& events,
                             const Tuning& tuning) {
  const MidiSettings settings = settings_of(keyboard, tuning);
  const int first = tuning.is_given() ? 0 : keyboard.first_key, last = tuning.is_given() ? 127 : keyboard.last_key;
  std::map<int, Voice> keys;
  for (const JsonObject& event : events)
    if (event.has("key"))
      if (const int key = event.integer("key", first, last); !keys.contains(key))
        keys.emplace(key, read_key(event, key, keyboard, settings));
  if (keys.empty()) score.fail("events", "play no key", fmt::format("key, an integer from {} to {}", first, last));
  std::vector<Voice> voices;
  for (auto& [key, voice] : keys) voices.push_back(std::move(voice));
  return voices;
}

// The voices that an event is for: of the key or the voice that it names, or all.
std::span<Voice> concerned_voices(const JsonObject& event, std::vector<Voice>& voices) {
  if (!event.has("key")) return voices_of(event, voices);
  return {std::ranges::find(voices, fmt::format("{}", event.integer("key", 0, 127)), &Voice::name), 1};
}

// A place must lie on the string.
void check_place(const JsonObject& event, const Parameter& control, const Voice& voice, double place_m) {
  if (const double extent = extent_of(voice.resonator.body); place_m > extent)
    event.fail(event.key(control.name), fmt::format("{} is beyond {}", place_m, voice.resonator.name),
               fmt::format("a number from 0 to {}", extent));
}

// Sets the controls that an event names; false where it names none.
bool read_glides(const JsonObject& event, double time, std::span<Voice> voices) {
  const double over = number_or(event, "over_s", kEventTime_s, 0);
  bool any = false;
  for (std::size_t i = 0; i < kKeyControls.size(); ++i) {
    const Parameter& parameter = kKeyControls[i];
    if (!event.has(parameter.name)) continue;
    any = true;
    const double to = event.number(parameter.name, {parameter.allowed.min, parameter.allowed.max});
    for (Voice& voice : voices) {
      if (i == HammerStringParameter::kPlace) check_place(event, parameter, voice, to);
      if (time == 0 && over == 0) voice.initial[i] = to;
      voice.glides.push_back({time, over, i, to});
    }
  }
  return any;
}

// Moves the pedals that an event names; false where it names none.
bool read_pedals(const JsonObject& event, double time, Score& score) {
  bool any = false;
  for (std::size_t i = 0; i < KeyboardParameter::kParameters; ++i) {
    const Parameter& pedal = KeyboardParameter::kList[i];
    if (!is_pedal(i) || score.keys.empty() || !event.has(pedal.name)) continue;
    any = true;
    if (event.has("key")) event.fail(event.key(pedal.name), "is for all keys", "without key");
    score.pedals.push_back({time, number_or(event, "over_s", kEventTime_s, 0), i,
                            event.number(pedal.name, {pedal.allowed.min, pedal.allowed.max})});
  }
  return any;
}

// A blow of the hammer, or a key that is pressed without one.
bool read_note(const JsonObject& event, double time, std::span<Voice> voices) {
  const bool presses = event.has("hold_s") && event.has("key");
  if (event.has("hold_s") && !event.has(kBlow.name) && !presses)
    event.fail(event.key("hold_s"), "holds nothing", fmt::format("beside {} or key", kBlow.name));
  if (!event.has(kBlow.name) && !presses) return false;
  for (Voice& voice : voices)
    voice.strikes.push_back({time, number_or(event, kBlow.name, {kBlow.allowed.min, kBlow.allowed.max}, 0),
                             number_or(event, "hold_s", kEventTime_s, kForEver)});
  return true;
}

void read_event(const JsonObject& event, Score& score) {
  const double time = event.number("time_s", {0, score.duration_s});
  const auto concerned = concerned_voices(event, score.voices);
  const bool glides = read_glides(event, time, concerned);
  const bool moves = read_pedals(event, time, score);
  const bool plays = read_note(event, time, concerned);
  if (event.has("over_s") && !glides && !moves)
    event.fail(event.key("over_s"), "glides to nothing", "beside a control");
  if (!glides && !moves && !plays)
    event.fail(event.key("time_s"), "nothing happens", fmt::format("beside {} or a control", kBlow.name));
}

std::vector<std::string> event_keys(const Keyboard& keyboard) {
  std::vector<std::string> keys = {"time_s", "key", kBlow.name, "hold_s", "over_s"};
  for (const Parameter& control : kKeyControls) keys.emplace_back(control.name);
  for (std::size_t i = 0; keyboard.body && i < KeyboardParameter::kParameters; ++i)
    if (is_pedal(i)) keys.emplace_back(KeyboardParameter::kList[i].name);
  return keys;
}

// Is it a score of 0.1.0 that names a kind, "hammer-string", beside the `keyboard` that plays? Of others of then,
// whose voices were made of resonator and material, says what plays such voices now.
bool names_old_keyboard(const JsonObject& score) {
  constexpr std::pair<std::string_view, std::string_view> kOld[] = {
      {"hammer-string", "piano"}, {"slide-string", "lap_steel"}, {"fret-string", "fret_guitar"}};
  const std::string name = score.has_text("instrument") ? score.text("instrument", "") : "";
  if (score.has("keyboard") && name == kOld[0].first) return true;
  for (const auto& [old, now] : kOld)
    if (name == old)
      score.fail(
          "instrument", fmt::format("'{}' is no instrument", old),
          fmt::format("the name of an instrument or a keyboard, such as \"{}\", or a file of one with the parts of "
                      "the voices",
                      now));
  if (score.has("keyboard"))
    score.fail("keyboard", "is no key beside an instrument", "the keyboard as the instrument, such as \"piano\"");
  return false;
}

JsonObject parse_score_object(std::string_view text, std::string_view file) {
  std::vector<std::string> allowed = {"instrument", "description", "duration_s", "level_db", "oversample",
                                      "tuning",     "keymap",      "a4_hz",      "voices",   "events"};
  if (text.find("-string\"") != text.npos || text.find("\"keyboard\"") != text.npos)  // others are not old
    if (const auto keys = json_keys(text, file, "score"); !keys.empty())
      if (names_old_keyboard(parse_json(text, file, "score", keys))) allowed.emplace_back("keyboard");
  return parse_json(text, file, "score", allowed);
}

// What plays: an instrument or a keyboard, of an old score the keyboard.
NamedText read_player(const JsonObject& score, const ReadFile& read) {
  if (score.has("keyboard")) return read_named(score, "keyboard", Shipped::kKeyboards, read);
  return read_named(score, "instrument", kPlayers, read);
}

// Voices that the same key plays have strings of their own.
void give_strings(std::vector<Voice>& voices, std::vector<KeyParts>& on_body) {
  std::set<std::size_t> keys;
  for (Voice& voice : voices) {
    if (keys.insert(voice.key).second || on_body.empty()) continue;
    on_body.push_back(on_body[voice.key]);
    voice.key = on_body.size() - 1;
  }
}

// A voice with strings of its own, which bend as their channel does.
void name_bent(Voice& voice, int channel, double cents) {
  if (channel != kNoBends) voice.name += fmt::format("_channel_{}", channel + 1);
  if (cents != 0) voice.name += fmt::format("_{:+.6g}_cents", cents);
  voice.bend_cents = cents;
}

bool is_on(const Keyboard& keyboard, const MidiNote& note) {
  return note.key >= keyboard.first_key && note.key <= keyboard.last_key;
}

// How long the notes on a keyboard last, with the pedals that hold them, and ring.
double duration_of(const MidiSong& song, const Keyboard& keyboard, std::string_view file) {
  const auto on_keyboard = [&](const MidiNote& note) { return is_on(keyboard, note); };
  if (std::ranges::none_of(song.notes, on_keyboard))
    throw NothingPlayed(fmt::format("{}: MIDI: no note is on the {}; allowed: keys {} to {}", file, keyboard.name,
                                    keyboard.first_key, keyboard.last_key));
  double end = 0;
  for (const MidiNote& note : song.notes)
    if (is_on(keyboard, note)) end = std::max(end, note.time_s + note.hold_s);
  return midi_duration_s(file, end_of_pedals(song.pedals, end));
}

Score parse_keyboard_score(const JsonObject& score, std::string_view file, const NamedText& named,
                           const ReadFile& read, const Tuning& tuning) {
  const Keyboard keyboard = parse_keyboard(named.text, named.file);
  if (score.has("voices")) score.fail("voices", "has no place here", "no such key: the keys are the voices");
  const auto events = score.objects("events", event_keys(keyboard), kMaxEvents);
  Score result{std::string(file), read_description(score), score.number("duration_s", kScoreDuration_s),
               read_keys(score, keyboard, events, tuning)};
  result.level_db = read_level(score);
  result.oversampling = read_oversampling(score);
  add_body(keyboard, named, read, result);
  give_strings(result.voices, result.keys);
  for (const JsonObject& event : events) read_event(event, result);
  sort_by_time(result.voices);
  std::ranges::stable_sort(result.pedals, {}, &Glide::time_s);
  if (!result.pedals.empty()) result.left_out_at_rest = "pedals";
  return result;
}

}  // namespace

NamedText shipped_piano() {
  const EmbeddedFile& piano = *find_embedded(Shipped::kKeyboards, "piano.json");
  return {std::string(piano.content), std::string(piano.name), true, false, Shipped::kKeyboards};
}

Score score_of_all_keys(const Keyboard& keyboard, const NamedText& named, const ReadFile& read) {
  Score score{named.file, keyboard.description, 1, {}};
  for (int key = keyboard.first_key; key <= keyboard.last_key; ++key) score.voices.push_back(voice_of(keyboard, key));
  add_body(keyboard, named, read, score);
  return score;
}

ScoreHeading score_heading(std::string_view text, std::string_view file) {
  const JsonObject score = parse_score_object(text, file);
  return {score.text("instrument", "a name"), read_description(score), score.number("duration_s", kScoreDuration_s)};
}

ScoreHeading midi_score_heading(std::string_view bytes, std::string_view file) {
  const NamedText piano = shipped_piano();
  const Keyboard keyboard = parse_keyboard(piano.text, piano.file);
  const MidiSong song = parse_midi(bytes, file, {}, settings_of(keyboard, {}));
  return {keyboard.name, song.title, duration_of(song, keyboard, file)};
}

Score parse_score(std::string_view text, std::string_view file, const ReadFile& read, const InstrumentModel* played,
                  const Tuning& given) {
  const JsonObject score = parse_score_object(text, file);
  const Tuning tuning = given.is_given() ? given : read_tuning(score, read);
  if (played != nullptr) {
    if (const std::string name = score.text("instrument", played->name); name != played->name)
      score.fail("instrument", fmt::format("'{}' is not what --instrument names", shown(name)), played->name);
    return parse_score_on(score, file, *played, tuning);
  }
  const NamedText named = read_player(score, read);
  if (named.kind == Shipped::kKeyboards) return parse_keyboard_score(score, file, named, read, tuning);
  return parse_score_on(score, file, parse_instrument(named.text, named.file, reader_beside(named, read)), tuning);
}

Score parse_midi_score(std::string_view bytes, std::string_view file, std::span<const int> channels,
                       const NamedText& played, const ReadFile& read, const Tuning& tuning) {
  const Keyboard keyboard = parse_keyboard(played.text, played.file);
  const MidiSong song = parse_midi(bytes, file, channels, settings_of(keyboard, tuning));
  Score score{std::string(file), {}, duration_of(song, keyboard, file), {}};
  std::map<int, SharedGlides> bends;  // of the channels that have some
  for (const MidiBend& bend : song.bends)
    if (!bends.contains(bend.channel)) bends.emplace(bend.channel, bends_of(song.bends, bend.channel));
  // By key, channel and tuning; channels without bends share their strings.
  std::map<std::tuple<int, int, double>, Voice> voices;
  std::size_t beyond = 0;
  for (const MidiNote& note : song.notes) {
    if (!is_on(keyboard, note)) {
      ++beyond;
      continue;
    }
    const int channel = bends.contains(note.channel) ? note.channel : kNoBends;
    Voice& voice = voices[{note.key, channel, note.cents}];
    if (voice.name.empty()) {
      voice = voice_of(keyboard, note.key);
      name_bent(voice, channel, note.cents);
      if (bends.contains(note.channel)) voice.bends = bends.at(note.channel);
    }
    voice.strikes.push_back(
        {note.time_s, strike_speed(keyboard, note.velocity), note.hold_s, 0, note.key_hold_s, note.release});
  }
  score.left_out = left_out_line(file, keyboard, song, channels.empty() ? song.unchosen : 0, beyond);
  score.silences_s = song.silences_s;
  score.ring_s = kMidiRing_s;
  add_body(keyboard, played, read, score);
  for (auto& [key, voice] : voices) score.voices.push_back(std::move(voice));
  give_strings(score.voices, score.keys);
  add_pedals(song.pedals, score);
  return score;
}

}  // namespace contactspline
