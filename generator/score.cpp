// SPDX-License-Identifier: MIT
#include "generator/score.hpp"

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

#include "generator/embedded.hpp"
#include "generator/error.hpp"
#include "generator/keyboard.hpp"
#include "generator/midi.hpp"
#include "generator/spline.hpp"

namespace contactspline {
namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();
constexpr double kForEver = std::numeric_limits<double>::infinity();

constexpr Range kTime{0, 3600};
constexpr Range kDuration{1e-3, 3600};
constexpr Range kSpeed{1e-3, 100};
constexpr Range kMass{1e-6, 100};
constexpr Range kPlace{0, 100};
constexpr Range kDecay{0, 1e5};
constexpr Range kPan{-1, 1};
constexpr Range kRatio{1e-6, 1e6};
constexpr Range kLoss{0, 1e3};
constexpr Range kHeight{-0.1, 0.1};
constexpr Range kForce{-1e3, 1e3};
constexpr Range kStiffness{0, 1e9};
constexpr Range kResistance{0, 1e6};
constexpr Range kVibrato{0, 0.1};
constexpr Range kVibratoRate{0, 100};
constexpr Range kCents{-1200, 1200};

constexpr double kDamper = 60;          // 1/s: 60 dB in 0.12 s
constexpr double kPluckRise = 0.004;    // s
constexpr double kRing = 1;             // s, after the last note of a MIDI file
constexpr double kFeltLoss = 0.1;       // s/m, of a keyboard's hammers
constexpr double kKeyboardWidth = 0.6;  // pan of its ends
constexpr int kMostModes = 4096;
constexpr std::size_t kMaxVoices = 128;
constexpr std::size_t kMaxEvents = 65536;

constexpr std::array kHammerControls = {
    ControlName{"hammer_mass_kg", kMass, kUnset}, ControlName{"stiffness_ratio", kRatio, 1},
    ControlName{"loss_s_per_m", kLoss, 0}, ControlName{"damping_per_s", kDecay, 0},
    ControlName{"strike_m", kPlace, kUnset}};

constexpr std::array kSlideControls = {ControlName{"place_m", kPlace, kUnset},
                                       ControlName{"slide_mass_kg", kMass, kUnset},
                                       ControlName{"hand_force_n", kForce, 0},
                                       ControlName{"hand_stiffness_n_per_m", kStiffness, 0},
                                       ControlName{"hand_resistance_n_s_per_m", kResistance, 0},
                                       ControlName{"rest_resistance_n_s_per_m", kResistance, 0},
                                       ControlName{"pluck_force_n", kForce, 0},
                                       ControlName{"stiffness_ratio", kRatio, 1},
                                       ControlName{"loss_s_per_m", kLoss, 0},
                                       ControlName{"vibrato_m", kVibrato, 0},
                                       ControlName{"vibrato_hz", kVibratoRate, 0}};

constexpr std::array kFretControls = {
    ControlName{"place_m", kPlace, kUnset},    ControlName{"gap_m", kHeight, kUnset},
    ControlName{"pluck_force_n", kForce, 0},   ControlName{"damping_per_s", kDecay, 0},
    ControlName{"stiffness_ratio", kRatio, 1}, ControlName{"loss_s_per_m", kLoss, 0}};

/// What tells one instrument's scores from another's.
struct Rules {
  std::string_view name;
  std::span<const ControlName> controls;
  const char* note;                     ///< the key of an event that plays
  std::size_t pluck_force;              ///< the control that a pluck moves
  std::vector<std::string> voice_keys;  ///< beside name, resonator, material, tuning_cents, pan
};

const Rules& rules_of(Instrument instrument) {
  static const std::array rules = {
      Rules{"hammer-string", kHammerControls, "speed_m_per_s", 0, {"hammer_mass_kg", "damper_per_s"}},
      Rules{"slide-string",
            kSlideControls,
            "pluck_n",
            SlideStringControl::kPluckForce,
            {"pluck_m", "pickup_m", "height_m"}},
      Rules{"fret-string", kFretControls, "pluck_n", FretStringControl::kPluckForce, {"pluck_m", "pickup_m"}}};
  return rules[static_cast<std::size_t>(instrument)];
}

bool has_hammer(Instrument instrument) {
  return instrument == Instrument::kHammerString;
}

Instrument read_instrument(const JsonObject& score) {
  constexpr std::array kAll = {Instrument::kHammerString, Instrument::kSlideString, Instrument::kFretString};
  std::vector<std::string_view> names;
  for (const Instrument instrument : kAll) names.push_back(name_of(instrument));
  const std::string allowed = fmt::format("{}", fmt::join(names, ", "));
  const std::string name = score.text("instrument", allowed);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) score.fail("instrument", fmt::format("'{}' is unknown", shown(name)), allowed);
  return kAll[static_cast<std::size_t>(found - names.begin())];
}

// Whether it is a file's path rather than the name of something that ships.
bool is_path(std::string_view name) {
  return name.ends_with(".json") || name.find('/') != name.npos;
}

struct NamedText {
  std::string text, file;
};

/// The text of what a key names: a file, or something that ships.
NamedText read_named(const JsonObject& object, const char* key, std::span<const EmbeddedText> shipped,
                     const ReadFile& read) {
  std::vector<std::string_view> names;
  for (const auto& text : shipped)
    if (text.file_name.ends_with(".json")) names.push_back(text.file_name.substr(0, text.file_name.size() - 5));
  const std::string allowed = fmt::format("a .json file, {}", fmt::join(names, ", "));
  const std::string name = object.text(key, allowed);
  if (is_path(name)) return {read(name), name};
  const auto found = std::ranges::find(shipped, name + ".json", &EmbeddedText::file_name);
  if (found == shipped.end()) object.fail(object.key(key), fmt::format("'{}' does not ship", shown(name)), allowed);
  return {std::string(found->content), name + ".json"};
}

// What a material names lies beside it, wherever the score is.
ReadFile reader_from(const std::string& material_file, const ReadFile& read) {
  if (!is_path(material_file)) return shipped_file;
  return [folder = std::filesystem::path(material_file).parent_path(), &read](const std::string& path) {
    return read((folder / path).string());
  };
}

double number_or(const JsonObject& object, const char* name, Range range, double otherwise) {
  return object.has(name) ? object.number(name, range) : otherwise;
}

void tune(const JsonObject& json, Resonator& resonator) {
  if (!json.has("tuning_cents")) return;
  auto* string = std::get_if<StiffString>(&resonator.body);
  if (string == nullptr) json.fail(json.key("tuning_cents"), "is not for this resonator", "beside strings");
  for (double& cents : string->detuning_cents) cents += json.number("tuning_cents", kCents);
}

void complete_hammer(const JsonObject& json, const Material& material, Voice& voice) {
  using Control = HammerStringControl;
  if (!json.has("hammer_mass_kg") && !material.impact)
    json.fail(json.key("hammer_mass_kg"), "missing, and the material has no impact", "a number");
  voice.initial[Control::kHammerMass] =
      json.has("hammer_mass_kg") ? json.number("hammer_mass_kg", kMass) : material.impact->mass_kg;
  voice.initial[Control::kPlace] = voice.resonator.strike.position_m;
  voice.damper_per_s = number_or(json, "damper_per_s", kDecay, kDamper);
}

void complete_plucked(const JsonObject& json, Voice& voice) {
  const auto* string = std::get_if<StiffString>(&voice.resonator.body);
  if (string == nullptr || string->detuning_cents.size() != 1)
    json.fail(json.key("resonator"), "is not a single string", "a resonator of one string");
  voice.pluck_m = json.number("pluck_m", {0, string->length_m});
  voice.resonator.pickup.position_m = json.number("pickup_m", {0, string->length_m});
}

Voice read_voice(const JsonObject& json, Instrument instrument, const ReadFile& read) {
  constexpr auto kNameAllowed = "1 to 64 characters";
  Voice voice;
  voice.name = json.text("name", kNameAllowed);
  if (voice.name.empty() || voice.name.size() > 64)
    json.fail(json.key("name"), fmt::format("has {} characters", voice.name.size()), kNameAllowed);
  const NamedText resonator = read_named(json, "resonator", embedded_resonators(), read);
  voice.resonator = parse_resonator(resonator.text, resonator.file);
  tune(json, voice.resonator);
  const NamedText felt = read_named(json, "material", embedded_texts(), read);
  const Material material = parse_material(felt.text, felt.file, reader_from(felt.file, read));
  voice.contact = segment_table(uniform_spline(material, felt.file));
  for (const ControlName& control : controls_of(instrument))
    voice.initial.push_back(control.name == std::string_view("loss_s_per_m") ? material.loss_s_per_m
                                                                             : control.initial);
  voice.pan = number_or(json, "pan", kPan, 0);
  if (has_hammer(instrument))
    complete_hammer(json, material, voice);
  else
    complete_plucked(json, voice);
  if (instrument == Instrument::kSlideString) voice.height_m = json.number("height_m", kHeight);
  return voice;
}

std::vector<Voice> read_voices(const JsonObject& score, Instrument instrument, const ReadFile& read) {
  std::vector<std::string> keys = {"name", "resonator", "material", "tuning_cents", "pan"};
  for (const std::string& key : rules_of(instrument).voice_keys) keys.push_back(key);
  std::vector<Voice> voices;
  std::set<std::string> names;
  for (const JsonObject& json : score.objects("voices", keys, kMaxVoices)) {
    voices.push_back(read_voice(json, instrument, read));
    if (!names.insert(voices.back().name).second)
      json.fail(json.key("name"), fmt::format("'{}' is the name of two voices", shown(voices.back().name)), "once");
  }
  return voices;
}

// A key of a keyboard as a voice, panned as the player hears it.
Voice voice_of(const Keyboard& keyboard, int key) {
  const KeyboardNote note = note_of(keyboard, key);
  const int span = keyboard.last_key - keyboard.first_key;
  const double from_middle = span == 0 ? 0 : 2.0 * (key - keyboard.first_key) / span - 1;
  Voice voice;
  voice.name = fmt::format("{}", key);
  voice.resonator = {keyboard.name, "", note.string, {note.strike_position_m}, {note.strike_position_m}, kMostModes};
  voice.contact = segment_table(uniform_spline(note.felt, keyboard.name));
  voice.initial = {note.hammer_mass_kg, 1, kFeltLoss, 0, note.strike_position_m};
  voice.damper_per_s = key <= keyboard.last_damped_key ? kDamper : 0;
  voice.strings = note.strings;
  voice.pan = kKeyboardWidth * from_middle;
  return voice;
}

// Every key that is played.
std::vector<Voice> read_keys(const JsonObject& score, const std::vector<JsonObject>& events, const ReadFile& read) {
  const NamedText named = read_named(score, "keyboard", embedded_keyboards(), read);
  const Keyboard keyboard = parse_keyboard(named.text, named.file);
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

/// The voices that an event is for: the one it names, or all.
std::span<Voice> voices_of(const JsonObject& event, std::vector<Voice>& voices) {
  if (event.has("key"))
    return {std::ranges::find(voices, fmt::format("{}", event.integer("key", 0, 127)), &Voice::name), 1};
  if (!event.has("voice")) return voices;
  std::vector<std::string_view> names;
  for (const Voice& voice : voices) names.push_back(voice.name);
  const std::string allowed = shown(fmt::format("{}", fmt::join(names, ", ")), 240);
  const std::string name = event.text("voice", allowed);
  const auto found = std::ranges::find(voices, name, &Voice::name);
  if (found == voices.end()) event.fail(event.key("voice"), fmt::format("'{}' is no voice", shown(name)), allowed);
  return {found, 1};
}

// Largest place along a resonator; none on a table of modes.
std::optional<double> reach_of(const Resonator& resonator) {
  if (const auto* string = std::get_if<StiffString>(&resonator.body)) return string->length_m;
  if (const auto* bar = std::get_if<FreeBar>(&resonator.body)) return bar->length_m;
  if (const auto* membrane = std::get_if<Membrane>(&resonator.body)) return membrane->radius_m;
  return {};
}

// A place must lie on the resonator.
void check_place(const JsonObject& event, const ControlName& control, const Voice& voice, double place_m) {
  if (control.name != std::string_view("place_m") && control.name != std::string_view("strike_m")) return;
  const auto reach = reach_of(voice.resonator);
  if (!reach) event.fail(event.key(control.name), "has no meaning on a table of modes", "no such key");
  if (place_m > *reach)
    event.fail(event.key(control.name), fmt::format("{} is beyond {}", place_m, voice.resonator.name),
               fmt::format("a number from 0 to {}", *reach));
}

// Sets the controls that an event names; false where it names none.
bool read_glides(const JsonObject& event, Instrument instrument, double time, std::span<Voice> voices) {
  const auto controls = controls_of(instrument);
  const double over = number_or(event, "over_s", kTime, 0);
  bool any = false;
  for (std::size_t i = 0; i < controls.size(); ++i) {
    if (!event.has(controls[i].name)) continue;
    any = true;
    const double to = event.number(controls[i].name, controls[i].range);
    for (Voice& voice : voices) {
      check_place(event, controls[i], voice, to);
      if (time == 0 && over == 0) voice.initial[i] = to;
      voice.glides.push_back({time, over, i, to});
    }
  }
  if (event.has("over_s") && !any) event.fail(event.key("over_s"), "glides to nothing", "beside a control");
  return any;
}

// A throw of the hammer; or a pluck: the force rises, and lets go at once.
bool read_note(const JsonObject& event, Instrument instrument, double time, std::span<Voice> voices) {
  const Rules& rules = rules_of(instrument);
  if (event.has("hold_s") && !event.has(rules.note))
    event.fail(event.key("hold_s"), "holds nothing", fmt::format("beside {}", rules.note));
  if (!event.has(rules.note)) return false;
  for (Voice& voice : voices) {
    if (has_hammer(instrument)) {
      voice.strikes.push_back({time, event.number(rules.note, kSpeed), number_or(event, "hold_s", kTime, kForEver)});
    } else {
      voice.glides.push_back({time, kPluckRise, rules.pluck_force, event.number(rules.note, kForce)});
      voice.glides.push_back({time + kPluckRise, 0, rules.pluck_force, 0});
    }
  }
  return true;
}

void read_event(const JsonObject& event, const Score& score, std::vector<Voice>& voices) {
  const double time = event.number("time_s", {0, score.duration_s});
  const auto concerned = voices_of(event, voices);
  const bool glides = read_glides(event, score.instrument, time, concerned);
  const bool plays = read_note(event, score.instrument, time, concerned);
  if (!glides && !plays)
    event.fail(event.key("time_s"), "nothing happens",
               fmt::format("beside {} or a control", rules_of(score.instrument).note));
}

std::vector<std::string> event_keys(Instrument instrument, bool has_keys) {
  std::vector<std::string> keys = {"time_s", has_keys ? "key" : "voice", rules_of(instrument).note};
  if (has_hammer(instrument)) keys.emplace_back("hold_s");
  keys.emplace_back("over_s");
  for (const ControlName& control : controls_of(instrument)) keys.emplace_back(control.name);
  return keys;
}

void require_initial(const JsonObject& score, Instrument instrument, const std::vector<Voice>& voices) {
  const auto controls = controls_of(instrument);
  for (const Voice& voice : voices)
    for (std::size_t i = 0; i < controls.size(); ++i)
      if (std::isnan(voice.initial[i]))
        score.fail("events", fmt::format("{} of {} is not set", controls[i].name, shown(voice.name)),
                   "an event at time_s 0 that sets it at once");
}

}  // namespace

std::string_view name_of(Instrument instrument) {
  return rules_of(instrument).name;
}

std::span<const ControlName> controls_of(Instrument instrument) {
  return rules_of(instrument).controls;
}

Score parse_score(std::string_view text, std::string_view file, const ReadFile& read) {
  const auto json = parse_json(text, file, "score");
  const JsonObject score(json, file, "score",
                         {"instrument", "description", "duration_s", "keyboard", "voices", "events"});
  Score result{read_instrument(score), read_description(score), score.number("duration_s", kDuration), {}};
  const bool has_keys = score.has("keyboard");
  if (has_keys && (score.has("voices") || !has_hammer(result.instrument)))
    score.fail("keyboard", "has no place here", "in a score for hammer-string, instead of voices");
  const auto events = score.objects("events", event_keys(result.instrument, has_keys), kMaxEvents);
  result.voices = has_keys ? read_keys(score, events, read) : read_voices(score, result.instrument, read);
  for (const JsonObject& event : events) read_event(event, result, result.voices);
  require_initial(score, result.instrument, result.voices);
  for (Voice& voice : result.voices) {
    std::ranges::stable_sort(voice.glides, {}, &Glide::time_s);
    std::ranges::stable_sort(voice.strikes, {}, &Strike::time_s);
  }
  return result;
}

Score parse_midi_score(std::string_view bytes, std::string_view file) {
  const auto [title, notes] = parse_midi(bytes, file);
  const auto piano = std::ranges::find(embedded_keyboards(), "piano.json", &EmbeddedText::file_name);
  const Keyboard keyboard = parse_keyboard(piano->content, piano->file_name);
  std::map<int, Voice> voices;
  double end = 0;
  for (const MidiNote& note : notes) {
    if (note.key < keyboard.first_key || note.key > keyboard.last_key)
      throw BadInput(fmt::format("{}: MIDI: key {} at {:.3f} s is not on the piano; allowed: {} to {}", file,
                                 note.key, note.time_s, keyboard.first_key, keyboard.last_key));
    if (!voices.contains(note.key)) voices[note.key] = voice_of(keyboard, note.key);
    const double speed = 0.2 * std::pow(30.0, note.velocity / 127.0);
    voices[note.key].strikes.push_back({note.time_s, speed, note.hold_s});
    end = std::max(end, note.time_s + note.hold_s);
  }
  if (!(end + kRing <= kDuration.most))
    throw BadInput(
        fmt::format("{}: MIDI: it lasts {:.4g} s; allowed: at most {} s", file, end, kDuration.most - kRing));
  Score score{Instrument::kHammerString, title, end + kRing, {}};
  for (auto& [key, voice] : voices) score.voices.push_back(std::move(voice));
  return score;
}

}  // namespace contactspline
