// SPDX-License-Identifier: MIT
#include "generator/player/score_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "generator/material/named_file.hpp"
#include "generator/player/instrument_score_reader.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/player/score_keys.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/spline/designed_materials.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr double kForEver = std::numeric_limits<double>::infinity();

constexpr Range kSpeed{1e-3, 100};
constexpr Range kMass{1e-6, 100};
constexpr Range kDecay{0, 1e5};
constexpr Range kHeight{-0.1, 0.1};
constexpr Range kForce{-1e3, 1e3};

constexpr double kRing = 1;             // s, after the last note of a MIDI file
constexpr double kBendTime_s = 0.01;    // in which a sounding string follows the pitch wheel
constexpr int kNoBends = -1;            // instead of a channel
constexpr double kKeyboardWidth = 0.6;  // pan of its ends

bool has_hammer(Instrument instrument) {
  return instrument == Instrument::kHammerString;
}

// The instrument of the runtime that a score names, or kFile.
Instrument read_instrument(const JsonObject& score) {
  constexpr std::array kAll = {Instrument::kHammerString, Instrument::kSlideString, Instrument::kFretString};
  std::vector<std::string_view> names;
  for (const Instrument instrument : kAll) names.push_back(name_of(instrument));
  const std::string allowed = fmt::format("{}, a .json file, {}", fmt::join(names, ", "),
                                          fmt::join(shipped_names(Shipped::kInstruments), ", "));
  const std::string name = score.text("instrument", allowed);
  if (is_path(name) || find_embedded(Shipped::kInstruments, name + ".json") != nullptr) return Instrument::kFile;
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) score.fail("instrument", fmt::format("'{}' is unknown", shown(name)), allowed);
  return kAll[static_cast<std::size_t>(found - names.begin())];
}

// Changes the pitch of a string by `tuning_cents`, -1200 to 1200. No other resonator may have the key.
void tune(const JsonObject& json, Resonator& resonator) {
  if (!json.has("tuning_cents")) return;
  auto* string = std::get_if<StiffString>(&resonator.body);
  if (string == nullptr) json.fail(json.key("tuning_cents"), "is not for this resonator", "beside strings");
  for (double& cents : string->detuning_cents) cents += json.number("tuning_cents", kTuningCents);
}

void complete_hammer(const JsonObject& json, const Material& material, Voice& voice) {
  using Control = HammerStringControl;
  if (!json.has("hammer_mass_kg") && !material.impact)
    json.fail(json.key("hammer_mass_kg"), "missing, and the material has no impact", "a number");
  voice.initial[Control::kHammerMass] =
      json.has("hammer_mass_kg") ? json.number("hammer_mass_kg", kMass) : material.impact->mass_kg;
  voice.initial[Control::kPlace] = voice.resonator.strike.position_m;
  voice.damper.damping_per_s = number_or(json, "damper_per_s", kDecay, Damper().damping_per_s);
}

void complete_plucked(const JsonObject& json, Voice& voice) {
  const auto* string = std::get_if<StiffString>(&voice.resonator.body);
  if (string == nullptr || string->detuning_cents.size() != 1)
    json.fail(json.key("resonator"), "is not a single string", "a resonator of one string");
  voice.pluck_m = json.number("pluck_m", {0, string->length_m});
  voice.resonator.pickup.position_m = json.number("pickup_m", {0, string->length_m});
}

Voice read_voice(const JsonObject& json, Instrument instrument, const ReadFile& read, DesignedMaterials& materials,
                 std::set<std::string>& names) {
  Voice voice;
  voice.name = read_voice_name(json, names);
  const NamedText resonator = read_named(json, "resonator", Shipped::kResonators, read);
  voice.resonator = parse_resonator(resonator.text, resonator.file);
  tune(json, voice.resonator);
  const auto& [material, table] = materials.of(json);
  voice.contact = table;
  for (const ControlName& control : rules_of(instrument).controls)
    voice.initial.push_back(control.name == std::string_view("loss_s_per_m") ? material.loss_s_per_m
                                                                             : control.initial);
  voice.pan = number_or(json, "pan", kVoicePan, 0);
  if (has_hammer(instrument))
    complete_hammer(json, material, voice);
  else
    complete_plucked(json, voice);
  if (instrument == Instrument::kSlideString) voice.height_m = json.number("height_m", kHeight);
  return voice;
}

std::vector<Voice> read_voices(const JsonObject& score, Instrument instrument, const ReadFile& read) {
  std::vector<std::string> keys = {"name", "resonator", "material", "tuning_cents", "pan"};
  for (const char* key : rules_of(instrument).voice_keys) keys.emplace_back(key);
  DesignedMaterials materials(read);
  std::vector<Voice> voices;
  std::set<std::string> names;
  for (const JsonObject& json : score.objects("voices", keys, kMaxVoices))
    voices.push_back(read_voice(json, instrument, read, materials, names));
  return voices;
}

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
  voice.initial = {note.hammer_mass_kg, 1, keyboard.felt_loss_s_per_m, 0, note.strike_position_m, 0};
  voice.damper = damper_of(keyboard, key);
  voice.strings = note.strings;
  voice.pan = kKeyboardWidth * from_middle;
  voice.key = static_cast<std::size_t>(key - keyboard.first_key);
  return voice;
}

// All keys of a keyboard, which end at its body.
void add_body(const Keyboard& keyboard, const NamedText& file, const ReadFile& read, Score& score) {
  score.body = body_of(keyboard, file, read);
  if (!score.body) return;
  score.una_corda_stiffness_ratio = keyboard.body->una_corda_stiffness_ratio;
  for (int key = keyboard.first_key; key <= keyboard.last_key; ++key) {
    const KeyboardNote note = note_of(keyboard, key);
    score.keys.push_back({strings_on_body(note, *keyboard.body),
                          note.strike_position_m,
                          {},
                          {.hammer_mass_kg = note.hammer_mass_kg},
                          damper_of(keyboard, key)});
  }
}

// What of a MIDI file is not played as it is written.
std::string left_out_line(std::string_view file, const Keyboard& keyboard, std::size_t notes, std::size_t far_bends) {
  std::vector<std::string> parts;
  if (notes > 0)
    parts.push_back(
        fmt::format("left out: notes beyond the keys {} to {} ({})", keyboard.first_key, keyboard.last_key, notes));
  if (far_bends > 0)
    parts.push_back(fmt::format("played as an octave: bends by more than an octave ({})", far_bends));
  if (parts.empty()) return {};
  return fmt::format("{}: MIDI: {}", file, fmt::join(parts, "; "));
}

// Bends the string of a voice as the wheel of its channel.
void add_bends(std::span<const MidiBend> bends, int channel, Voice& voice) {
  for (const MidiBend& bend : bends) {
    if (bend.channel != channel) continue;
    const double cents = std::clamp(bend.cents, kTuningCents.min, kTuningCents.max);
    voice.glides.push_back({bend.time_s, bend.in_note ? kBendTime_s : 0, HammerStringControl::kBend, cents});
  }
}

// Without the body the sustain pedal holds notes, from halfway on, and that is all.
void add_pedals(std::span<const MidiPedal> pedals, Score& score) {
  for (const auto& [time_s, controller, position] : pedals) {
    const std::size_t pedal = controller == MidiPedal::kSostenuto ? PedalControl::kSostenuto
                              : controller == MidiPedal::kSoft    ? PedalControl::kUnaCorda
                                                                  : PedalControl::kSustain;
    score.pedals.push_back({time_s, 0, pedal, position});
    if (pedal != PedalControl::kSustain || (position > 0 && position < 1))
      score.left_out_at_rest = "half pedal, sostenuto and soft pedal";
  }
}

// When the pedals that are down at the end of the last note are up again: they may hold it.
double end_of_pedals(std::span<const MidiPedal> pedals, double end_s) {
  bool sustains = false, holds = false;
  for (const MidiPedal& pedal : pedals) {
    if (pedal.time_s > end_s && !sustains && !holds) break;
    if (pedal.controller == MidiPedal::kSostenuto) holds = pedal.position > 0;
    if (pedal.controller == MidiPedal::kSustain) sustains = pedal.position > 0;
    end_s = std::max(end_s, pedal.time_s);
  }
  return end_s;
}

// Every key that is played.
std::vector<Voice> read_keys(const JsonObject& score, const Keyboard& keyboard,
                             const std::vector<JsonObject>& events) {
  std::set<int> keys;
  for (const JsonObject& event : events)
    if (event.has("key")) keys.insert(event.integer("key", keyboard.first_key, keyboard.last_key));
  if (keys.empty())
    score.fail("events", "play no key",
               fmt::format("key, an integer from {} to {}", keyboard.first_key, keyboard.last_key));
  std::vector<Voice> voices;
  for (const int key : keys) voices.push_back(voice_of(keyboard, key));
  return voices;
}

// The voices that an event is for: of the key or the voice that it names, or all.
std::span<Voice> concerned_voices(const JsonObject& event, std::vector<Voice>& voices) {
  if (!event.has("key")) return voices_of(event, voices);
  return {std::ranges::find(voices, fmt::format("{}", event.integer("key", 0, 127)), &Voice::name), 1};
}

// A place must lie on the resonator.
void check_place(const JsonObject& event, const ControlName& control, const Voice& voice, double place_m) {
  if (control.name != std::string_view("place_m") && control.name != std::string_view("strike_m")) return;
  const double extent = extent_of(voice.resonator.body);
  if (extent == 0) event.fail(event.key(control.name), "has no meaning on a table of modes", "no such key");
  if (place_m > extent)
    event.fail(event.key(control.name), fmt::format("{} is beyond {}", place_m, voice.resonator.name),
               fmt::format("a number from 0 to {}", extent));
}

// Only a string has a tension.
void check_bend(const JsonObject& event, const ControlName& control, const Voice& voice) {
  if (control.name == std::string_view("bend_cents") && !std::holds_alternative<StiffString>(voice.resonator.body))
    event.fail(event.key(control.name), fmt::format("{} is no string", voice.resonator.name), "for strings");
}

// Sets the controls that an event names; false where it names none.
bool read_glides(const JsonObject& event, Instrument instrument, double time, std::span<Voice> voices) {
  const auto controls = rules_of(instrument).controls;
  const double over = number_or(event, "over_s", kEventTime_s, 0);
  bool any = false;
  for (std::size_t i = 0; i < controls.size(); ++i) {
    if (!event.has(controls[i].name)) continue;
    any = true;
    const double to = event.number(controls[i].name, controls[i].range);
    for (Voice& voice : voices) {
      check_place(event, controls[i], voice, to);
      check_bend(event, controls[i], voice);
      if (time == 0 && over == 0) voice.initial[i] = to;
      voice.glides.push_back({time, over, i, to});
    }
  }
  return any;
}

// Moves the pedals that an event names; false where it names none.
bool read_pedals(const JsonObject& event, double time, Score& score) {
  bool any = false;
  for (std::size_t i = 0; i < pedal_controls().size(); ++i) {
    const auto& [name, range, up] = pedal_controls()[i];
    if (!event.has(name)) continue;
    any = true;
    if (event.has("key")) event.fail(event.key(name), "is for all keys", "without key");
    score.pedals.push_back({time, number_or(event, "over_s", kEventTime_s, 0), i, event.number(name, range)});
  }
  return any;
}

// A throw of the hammer; or a pluck: the force rises, and lets go at once.
bool read_note(const JsonObject& event, Instrument instrument, double time, std::span<Voice> voices) {
  const InstrumentRules& rules = rules_of(instrument);
  const bool presses = event.has("hold_s") && event.has("key");  // without a blow
  if (event.has("hold_s") && !event.has(rules.note) && !presses)
    event.fail(event.key("hold_s"), "holds nothing",
               fmt::format("beside {}{}", rules.note, has_hammer(instrument) ? " or key" : ""));
  if (!event.has(rules.note) && !presses) return false;
  for (Voice& voice : voices) {
    if (has_hammer(instrument)) {
      voice.strikes.push_back(
          {time, number_or(event, rules.note, kSpeed, 0), number_or(event, "hold_s", kEventTime_s, kForEver)});
    } else {
      voice.glides.push_back({time, kPluckRise_s, rules.pluck_force, event.number(rules.note, kForce)});
      voice.glides.push_back({time + kPluckRise_s, 0, rules.pluck_force, 0});
    }
  }
  return true;
}

void read_event(const JsonObject& event, Score& score) {
  const double time = event.number("time_s", {0, score.duration_s});
  const auto concerned = concerned_voices(event, score.voices);
  const bool glides = read_glides(event, score.instrument, time, concerned);
  const bool moves = read_pedals(event, time, score);
  const bool plays = read_note(event, score.instrument, time, concerned);
  if (event.has("over_s") && !glides && !moves)
    event.fail(event.key("over_s"), "glides to nothing", "beside a control");
  if (!glides && !moves && !plays)
    event.fail(event.key("time_s"), "nothing happens",
               fmt::format("beside {} or a control", rules_of(score.instrument).note));
}

std::vector<std::string> event_keys(Instrument instrument, bool has_keys) {
  std::vector<std::string> keys = {"time_s", has_keys ? "key" : "voice", rules_of(instrument).note};
  if (has_hammer(instrument)) keys.emplace_back("hold_s");
  keys.emplace_back("over_s");
  for (const ControlName& control : rules_of(instrument).controls) keys.emplace_back(control.name);
  if (has_keys)
    for (const ControlName& pedal : pedal_controls()) keys.emplace_back(pedal.name);
  return keys;
}

void require_initial(const JsonObject& score, Instrument instrument, const std::vector<Voice>& voices) {
  const auto controls = rules_of(instrument).controls;
  for (const Voice& voice : voices)
    for (std::size_t i = 0; i < controls.size(); ++i)
      if (std::isnan(voice.initial[i]))
        score.fail("events", fmt::format("{} of {} is not set", controls[i].name, shown(voice.name)),
                   "an event at time_s 0 that sets it at once");
}

}  // namespace

Score parse_score(std::string_view text, std::string_view file, const ReadFile& read) {
  const JsonObject score = parse_json(
      text, file, "score", {"instrument", "description", "duration_s", "keyboard", "body", "voices", "events"});
  const Instrument instrument = read_instrument(score);
  if (score.has("body") && instrument != Instrument::kSlideString && instrument != Instrument::kFretString)
    score.fail("body", "has no place here", "in a score for slide-string or fret-string");
  if (instrument == Instrument::kFile) return parse_instrument_score(score, file, read);
  Score result{
      std::string(file), instrument, read_description(score), score.number("duration_s", kScoreDuration_s), {}};
  const bool has_keys = score.has("keyboard");
  if (has_keys && (score.has("voices") || !has_hammer(result.instrument)))
    score.fail("keyboard", "has no place here", "in a score for hammer-string, instead of voices");
  const auto events = score.objects("events", event_keys(result.instrument, has_keys), kMaxEvents);
  if (has_keys) {
    const NamedText named = read_named(score, "keyboard", Shipped::kKeyboards, read);
    const Keyboard keyboard = parse_keyboard(named.text, named.file);
    result.voices = read_keys(score, keyboard, events);
    add_body(keyboard, named, read, result);
  } else {
    result.voices = read_voices(score, result.instrument, read);
  }
  if (score.has("body")) {
    const NamedText named = read_named(score, "body", Shipped::kResonators, read);
    result.body = parse_resonator(named.text, named.file);
  }
  for (const JsonObject& event : events) read_event(event, result);
  require_initial(score, result.instrument, result.voices);
  sort_by_time(result.voices);
  std::ranges::stable_sort(result.pedals, {}, &Glide::time_s);
  if (!result.pedals.empty()) result.left_out_at_rest = "pedals";
  return result;
}

Score parse_midi_score(std::string_view bytes, std::string_view file, std::span<const int> channels) {
  const auto [title, notes, bends, pedals] = parse_midi(bytes, file, channels);
  const EmbeddedFile* piano = find_embedded(Shipped::kKeyboards, "piano.json");
  const Keyboard keyboard = parse_keyboard(piano->content, piano->name);
  std::set<int> bending_channels;
  for (const MidiBend& bend : bends) bending_channels.insert(bend.channel);
  std::map<std::pair<int, int>, Voice> voices;  // by key and channel; channels without bends share their strings
  double end = 0;
  std::size_t beyond = 0;
  for (const MidiNote& note : notes) {
    if (note.key < keyboard.first_key || note.key > keyboard.last_key) {
      ++beyond;
      continue;
    }
    const int channel = bending_channels.contains(note.channel) ? note.channel : kNoBends;
    Voice& voice = voices[{note.key, channel}];
    if (voice.name.empty()) {
      voice = voice_of(keyboard, note.key);
      if (channel != kNoBends) voice.name += fmt::format("_channel_{}", channel + 1);
      add_bends(bends, channel, voice);
    }
    voice.strikes.push_back(
        {note.time_s, strike_speed(keyboard, note.velocity / 127.0), note.hold_s, 0, note.key_hold_s});
    end = std::max(end, note.time_s + note.hold_s);
  }
  end = end_of_pedals(pedals, end);
  if (voices.empty())
    throw BadInput(fmt::format("{}: MIDI: no note is on the piano; allowed: keys {} to {}", file, keyboard.first_key,
                               keyboard.last_key));
  if (!(end + kRing <= kScoreDuration_s.max))
    throw BadInput(
        fmt::format("{}: MIDI: it lasts {:.4g} s; allowed: at most {} s", file, end, kScoreDuration_s.max - kRing));
  const auto is_far = [](const MidiBend& bend) { return std::abs(bend.cents) > kTuningCents.max; };
  const auto far_bends = static_cast<std::size_t>(std::ranges::count_if(bends, is_far));
  Score score{std::string(file), Instrument::kHammerString, title, end + kRing, {}};
  score.left_out = left_out_line(file, keyboard, beyond, far_bends);
  add_body(keyboard, {{}, std::string(piano->name), true}, shipped_file, score);
  std::set<std::size_t> keys;
  for (auto& [key, voice] : voices) {
    if (!keys.insert(voice.key).second) {  // another channel has bent strings there
      score.keys.push_back(score.keys[voice.key]);
      voice.key = score.keys.size() - 1;
    }
    score.voices.push_back(std::move(voice));
  }
  add_pedals(pedals, score);
  return score;
}

}  // namespace contactspline
