// SPDX-License-Identifier: MIT
#include "generator/score.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "generator/embedded.hpp"
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
constexpr double kDamper = 40;        // per second: falls by 60 dB in a sixth of a second
constexpr double kPluckRise = 0.004;  // s
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
  std::vector<std::string> voice_keys;
  std::vector<std::string> event_keys;  ///< beside the controls
};

const Rules& rules_of(Instrument instrument) {
  static const std::array rules = {Rules{"hammer-string",
                                         kHammerControls,
                                         {"name", "resonator", "material", "hammer_mass_kg", "damper_per_s", "pan"},
                                         {"time_s", "over_s", "voice", "speed_m_per_s", "hold_s"}},
                                   Rules{"slide-string",
                                         kSlideControls,
                                         {"name", "resonator", "material", "pluck_m", "pickup_m", "height_m", "pan"},
                                         {"time_s", "over_s", "voice", "pluck_n"}},
                                   Rules{"fret-string",
                                         kFretControls,
                                         {"name", "resonator", "material", "pluck_m", "pickup_m", "pan"},
                                         {"time_s", "over_s", "voice", "pluck_n"}}};
  return rules[static_cast<std::size_t>(instrument)];
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

/// The text of a resonator or material that a key names, and the file to name in messages.
std::pair<std::string, std::string> read_named(const JsonObject& voice, const char* key,
                                               std::span<const EmbeddedText> shipped, const ReadFile& read) {
  std::vector<std::string_view> names;
  for (const auto& text : shipped)
    if (text.file_name.ends_with(".json")) names.push_back(text.file_name.substr(0, text.file_name.size() - 5));
  const std::string allowed = fmt::format("a .json file, {}", fmt::join(names, ", "));
  const std::string name = voice.text(key, allowed);
  if (is_path(name)) return {read(name), name};
  const auto found = std::ranges::find(shipped, name + ".json", &EmbeddedText::file_name);
  if (found == shipped.end()) voice.fail(voice.key(key), fmt::format("'{}' does not ship", shown(name)), allowed);
  return {std::string(found->content), name + ".json"};
}

double number_or(const JsonObject& object, const char* name, Range range, double otherwise) {
  return object.has(name) ? object.number(name, range) : otherwise;
}

// Largest place along a resonator.
std::optional<double> reach_of(const Resonator& resonator) {
  if (const auto* string = std::get_if<StiffString>(&resonator.body)) return string->length_m;
  if (const auto* bar = std::get_if<FreeBar>(&resonator.body)) return bar->length_m;
  if (const auto* membrane = std::get_if<Membrane>(&resonator.body)) return membrane->radius_m;
  return {};
}

void complete_hammer(const JsonObject& json, const Material& material, Voice& voice) {
  using Control = HammerStringControl;
  if (!json.has("hammer_mass_kg") && !material.impact)
    json.fail(json.key("hammer_mass_kg"), "missing, and the material has no impact", "a number");
  voice.initial[Control::kHammerMass] = json.has("hammer_mass_kg")
                                            ? json.number("hammer_mass_kg", kMass)
                                            : std::clamp(material.impact->mass_kg, kMass.least, kMass.most);
  voice.initial[Control::kPlace] = voice.resonator.strike.position_m;
  voice.damper_per_s = number_or(json, "damper_per_s", kDecay, kDamper);
}

void complete_plucked(const JsonObject& json, Voice& voice) {
  const auto* string = std::get_if<StiffString>(&voice.resonator.body);
  if (string == nullptr || string->detuning_cents.size() != 1)
    json.fail(json.key("resonator"), "is not a single string", "a resonator with one string");
  voice.pluck_m = json.number("pluck_m", {0, string->length_m});
  voice.resonator.pickup.position_m = json.number("pickup_m", {0, string->length_m});
}

Voice read_voice(const JsonObject& json, Instrument instrument, const ReadFile& read) {
  constexpr auto kNameAllowed = "1 to 64 characters";
  Voice voice;
  voice.name = json.text("name", kNameAllowed);
  if (voice.name.empty() || voice.name.size() > 64)
    json.fail(json.key("name"), fmt::format("has {} characters", voice.name.size()), kNameAllowed);
  const auto [resonator_text, resonator_file] = read_named(json, "resonator", embedded_resonators(), read);
  voice.resonator = parse_resonator(resonator_text, resonator_file);
  const auto [material_text, material_file] = read_named(json, "material", embedded_texts(), read);
  const Material material = parse_material(material_text, material_file);
  voice.contact = segment_table(uniform_spline(material, material_file));
  for (const ControlName& control : controls_of(instrument)) voice.initial.push_back(control.initial);
  voice.pan = number_or(json, "pan", kPan, 0);
  if (instrument == Instrument::kHammerString)
    complete_hammer(json, material, voice);
  else
    complete_plucked(json, voice);
  if (instrument == Instrument::kSlideString) voice.height_m = json.number("height_m", kHeight);
  return voice;
}

std::vector<Voice> read_voices(const JsonObject& score, Instrument instrument, const ReadFile& read) {
  std::vector<Voice> voices;
  std::set<std::string> names;
  for (const JsonObject& json : score.objects("voices", rules_of(instrument).voice_keys, kMaxVoices)) {
    voices.push_back(read_voice(json, instrument, read));
    if (!names.insert(voices.back().name).second)
      json.fail(json.key("name"), fmt::format("'{}' is the name of two voices", shown(voices.back().name)), "once");
  }
  return voices;
}

/// The voices that an event is for: the one it names, or all.
std::span<Voice> voices_of(const JsonObject& event, std::vector<Voice>& voices) {
  if (!event.has("voice")) return voices;
  std::vector<std::string_view> names;
  for (const Voice& voice : voices) names.push_back(voice.name);
  const std::string allowed = shown(fmt::format("{}", fmt::join(names, ", ")), 240);
  const std::string name = event.text("voice", allowed);
  const auto found = std::ranges::find(voices, name, &Voice::name);
  if (found == voices.end()) event.fail(event.key("voice"), fmt::format("'{}' is no voice", shown(name)), allowed);
  return {found, 1};
}

// A place must lie on the resonator.
void check_place(const JsonObject& event, const ControlName& control, const Voice& voice, double place) {
  if (control.range.most != kPlace.most) return;
  const auto reach = reach_of(voice.resonator);
  if (!reach) event.fail(event.key(control.name), "has no meaning on a table of modes", "no such key");
  if (place > *reach)
    event.fail(event.key(control.name), fmt::format("{} is beyond {}", place, voice.resonator.name),
               fmt::format("a number from 0 to {}", *reach));
}

// What an event can do.
std::vector<std::string_view> deeds_of(Instrument instrument) {
  std::vector<std::string_view> deeds = {instrument == Instrument::kHammerString ? "speed_m_per_s" : "pluck_n"};
  for (const ControlName& control : controls_of(instrument)) deeds.emplace_back(control.name);
  return deeds;
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
  return any;
}

bool read_strike(const JsonObject& event, double time, std::span<Voice> voices) {
  if (!event.has("speed_m_per_s")) return false;
  const Strike strike{time, event.number("speed_m_per_s", kSpeed), number_or(event, "hold_s", kTime, kForEver)};
  for (Voice& voice : voices) voice.strikes.push_back(strike);
  return true;
}

// A pluck: the force rises, and lets go at once.
bool read_pluck(const JsonObject& event, Instrument instrument, double time, std::span<Voice> voices) {
  if (!event.has("pluck_n")) return false;
  const double force = event.number("pluck_n", kForce);
  const std::size_t control =
      instrument == Instrument::kSlideString ? +SlideStringControl::kPluckForce : +FretStringControl::kPluckForce;
  for (Voice& voice : voices)
    voice.glides.insert(voice.glides.end(), {{time, kPluckRise, control, force}, {time + kPluckRise, 0, control, 0}});
  return true;
}

void read_event(const JsonObject& event, const Score& score, std::vector<Voice>& voices) {
  const double time = event.number("time_s", {0, score.duration_s});
  const auto concerned = voices_of(event, voices);
  const bool glides = read_glides(event, score.instrument, time, concerned);
  const bool strikes = read_strike(event, time, concerned);
  const bool plucks = read_pluck(event, score.instrument, time, concerned);
  if (event.has("over_s") && !glides) event.fail(event.key("over_s"), "glides to nothing", "beside a control");
  if (event.has("hold_s") && !strikes) event.fail(event.key("hold_s"), "holds nothing", "beside speed_m_per_s");
  if (!glides && !strikes && !plucks)
    event.fail(event.key("time_s"), "nothing happens",
               fmt::format("beside {}", fmt::join(deeds_of(score.instrument), ", ")));
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
  const JsonObject score(json, file, "score", {"instrument", "description", "duration_s", "voices", "events"});
  Score result{read_instrument(score), read_description(score), score.number("duration_s", kDuration), {}};
  result.voices = read_voices(score, result.instrument, read);
  std::vector<std::string> keys = rules_of(result.instrument).event_keys;
  for (const ControlName& control : controls_of(result.instrument)) keys.emplace_back(control.name);
  for (const JsonObject& event : score.objects("events", keys, kMaxEvents)) read_event(event, result, result.voices);
  require_initial(score, result.instrument, result.voices);
  for (Voice& voice : result.voices) {
    std::ranges::stable_sort(voice.glides, {}, &Glide::time_s);
    std::ranges::stable_sort(voice.strikes, {}, &Strike::time_s);
  }
  return result;
}

}  // namespace contactspline
