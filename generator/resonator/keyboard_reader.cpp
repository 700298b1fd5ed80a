// SPDX-License-Identifier: MIT
#include "generator/resonator/keyboard_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <tuple>

#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/ranges.hpp"

namespace contactspline {
namespace {

constexpr int kHighestKey = 127;
constexpr int kMaxSegments = 256;
constexpr Range kLength{1e-3, 100};
constexpr Range kBending{1e-12, 1e6};
constexpr Range kConstantLoss{1e-6, 1e4};
constexpr Range kQuadraticLoss{1e-12, 1e3};
constexpr Range kStiffness{1e-3, 1e20};
constexpr Range kExponent{1, 10};
constexpr double kMinPosition = 1e-6;
constexpr Range kPitch{100, 1000};
constexpr Range kSpeed{1e-3, 100};
constexpr Range kDamping{0, 1e5};
constexpr Range kDamperTime{1e-5, 1};
constexpr Range kUnaCorda{1e-3, 1};
constexpr Range kBridgeRatio{1e-3, 10};
constexpr Range kOutputRatio{1e-3, 1e3};
constexpr Range kDetuning{-5, 5};
constexpr Range kPickupRatio{0, 1};
constexpr Range kMobility{0, 1e3};
constexpr Range kOutputAbove{1, 1000};
constexpr Range kQuality{0.1, 10};
constexpr Range kHorizontal{0, 1};
constexpr Range kHorizontalCents{-100, 100};
constexpr Range kLongitudinalFrequency{2, 100};
constexpr Range kLongitudinalOutput{1e-3, 10};
constexpr Range kPosition{0, 100};
constexpr double kNowhere = -1;  // of a place without a number

// Members of the emitted C++ struct, which must not be called like it.
constexpr const char* kTaken[] = {"name",
                                  "first_key",
                                  "keys",
                                  "last_damped_key",
                                  "concert_pitch_hz",
                                  "min_speed_m_per_s",
                                  "max_speed_m_per_s",
                                  "felt_loss_s_per_m",
                                  "damper_per_s",
                                  "damper_time_s",
                                  "format_version",
                                  "segments",
                                  "lengths",
                                  "masses",
                                  "tensions",
                                  "knots",
                                  "energies",
                                  "forces",
                                  "half_curvatures",
                                  "constant_losses",
                                  "quadratic_losses",
                                  "bending_stiffnesses",
                                  "strike_positions",
                                  "hammer_masses",
                                  "bridge_ratios",
                                  "bridge_places",
                                  "output_ratios",
                                  "horizontal_ratios",
                                  "bridge_losses",
                                  "strings",
                                  "body"};

PublishedNote read_note(const JsonObject& note) {
  PublishedNote read{
      note.integer("key", 0, kHighestKey),
      note.number("length_m", kLength),
      note.number("mass_kg", ranges::kMass),
      note.number("bending_stiffness_n_m2", kBending),
      {note.number("constant_loss_per_s", kConstantLoss), note.number("quadratic_loss_m2_per_s", kQuadraticLoss)},
      0,
      note.number("hammer_mass_kg", ranges::kMass),
      {note.number("stiffness_n_per_m_alpha", kStiffness), note.number("exponent", kExponent)},
      note.has("bridge_ratio") ? note.number("bridge_ratio", kBridgeRatio) : 1,
      note.has("output_ratio") ? note.number("output_ratio", kOutputRatio) : 1,
      note.has("horizontal_ratio") ? note.number("horizontal_ratio", kOutputRatio) : 1};
  read.strike_position_m = note.number("strike_position_m", {kMinPosition, read.length_m});
  return read;
}

std::vector<double> read_detuning(const JsonObject& body, const char* name, std::size_t strings) {
  std::vector<double> detuning_hz = body.numbers(name, kDetuning, strings);
  if (detuning_hz.size() != strings)
    body.fail(body.key(name), fmt::format("has {} entries", detuning_hz.size()), fmt::format("{} numbers", strings));
  return detuning_hz;
}

// Without these keys the sound is the velocity at the places of the ears.
Listening read_listening(const JsonObject& body) {
  Listening listening;
  if (body.has("pickup_ratio")) listening.pickup_ratio = body.number("pickup_ratio", kPickupRatio);
  if (body.has("mobility_m_per_n_s")) listening.mobility_m_per_n_s = body.number("mobility_m_per_n_s", kMobility);
  if (body.has("output_above_hz")) listening.above_hz = body.number("output_above_hz", kOutputAbove);
  if (body.has("output_quality")) listening.quality = body.number("output_quality", kQuality);
  return listening;
}

HorizontalMotion read_horizontal(const JsonObject& body) {
  const auto ratio = [&](const char* name) { return body.has(name) ? body.number(name, kHorizontal) : 0; };
  return {ratio("horizontal_strike_ratio"), ratio("horizontal_bridge_ratio"),
          body.has("horizontal_cents") ? body.number("horizontal_cents", kHorizontalCents) : 0};
}

// Which keys drive the body where. Whether it has such places, resonators_of() sees.
std::vector<BridgePlace> read_bridge_places(const JsonObject& body, int first_key, int last_key) {
  std::vector<BridgePlace> places;
  if (!body.has("bridge_places")) return places;
  for (const JsonObject& place :
       body.objects("bridge_places", {"first_key", "position_m", "across_m"}, kMaxBridgePlaces)) {
    const int first = place.integer("first_key", 0, last_key);
    if (places.empty() && first > first_key)
      place.fail(place.key("first_key"),
                 fmt::format("{} leaves the keys from {} on without a place", first, first_key),
                 fmt::format("at most {}", first_key));
    if (!places.empty() && first <= places.back().first_key)
      place.fail(place.key("first_key"), fmt::format("{} does not rise", first), "places by rising key");
    const auto position = [&](const char* name) {
      return place.has(name) ? place.number(name, kPosition) : kNowhere;
    };
    places.push_back({first, {position("position_m"), 0, position("across_m")}});
  }
  return places;
}

// A place on a plate.
void check_on_plate(const Plate& plate, const Place& place, std::string_view file, std::string_view key) {
  for (const auto& [name, value, extent_m] : {std::tuple("position_m", place.position_m, plate.length_m),
                                              std::tuple("across_m", place.across_m, plate.width_m)})
    if (!(value >= 0 && value <= extent_m))
      refuse(file, fmt::format("{}.{}", key, name),
             value == kNowhere ? "missing" : fmt::format("{} is beyond the plate", value),
             fmt::format("a number from 0 to {}", extent_m));
}

// Places on a plate, or as many as a table of modes has shapes.
void check_bridge_places(const std::vector<BridgePlace>& places, const Resonator& body, std::string_view file) {
  const std::string all = "keyboard.body.bridge_places";
  const auto* plate = std::get_if<Plate>(&body.body);
  const auto* table = std::get_if<ModeTable>(&body.body);
  const std::size_t columns = table != nullptr ? table->rows.front().bridge_shapes.size() : 0;
  if (plate == nullptr && columns == 0)
    refuse(file, all, fmt::format("{} has no such places", body.name), "a plate, or modes with bridge_shapes");
  if (plate == nullptr && columns != places.size())
    refuse(file, all, fmt::format("has {} places", places.size()),
           fmt::format("{}, as many as {} has bridge_shapes", columns, body.name));
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Place& place = places[p].place;
    const std::string key = fmt::format("{}[{}]", all, p);
    if (plate != nullptr)
      check_on_plate(*plate, place, file, key);
    else if (place.position_m != kNowhere || place.across_m != kNowhere)
      refuse(file, key, "has a position, but modes have bridge_shapes", "first_key alone");
  }
}

// Two ears in the room. Whether the body can be heard there, resonators_of() sees.
std::vector<ListeningPlace> read_ears(const JsonObject& body) {
  std::vector<ListeningPlace> ears;
  if (!body.has("ears")) return ears;
  for (const JsonObject& ear : body.objects("ears", {"distance_m", "angle_rad", "around_rad", "side_m"}, 2))
    ears.push_back(read_listening_place(ear));
  if (ears.size() != 2) body.fail(body.key("ears"), "has one entry", "two, the left ear and the right one");
  for (const char* key : {"pickup_ratio", "knock"})
    if (body.has(key))
      body.fail(body.key(key), "stands beside ears, which hear the body in the room", "one of the two");
  return ears;
}

// The distances from a body to the ears must be such as the filters of its sound can bridge.
void check_ears(const std::vector<ListeningPlace>& ears, const Resonator& body, std::string_view file) {
  check_radiation(body, file, "keyboard.body.ears");
  std::vector<Reach> reaches;
  for (std::size_t e = 0; e < ears.size(); ++e) {
    reaches.push_back(reach_of(body.body, ears[e]));
    check_reach(reaches.back(), file, fmt::format("keyboard.body.ears[{}].distance_m", e));
  }
  check_reach(
      {std::min(reaches[0].nearest_m, reaches[1].nearest_m), std::max(reaches[0].farthest_m, reaches[1].farthest_m)},
      file, "keyboard.body.ears");
}

// It sounds by the force on the bridge, times the mobility.
std::optional<KeyboardLongitudinal> read_longitudinal(const JsonObject& body, int first_key, int last_key) {
  if (!body.has("longitudinal")) return {};
  const JsonObject object = body.object("longitudinal", {"frequency_ratio", "constant_loss_per_s",
                                                         "quadratic_loss_m2_per_s", "output_ratio", "last_key"});
  const std::string key = body.key("longitudinal");
  if (body.has("ears")) body.fail(key, "stands beside ears, which do not hear it", "one of the two");
  if (!body.has("mobility_m_per_n_s") || body.number("mobility_m_per_n_s", kMobility) == 0)
    body.fail(key, "is not heard without mobility_m_per_n_s", "mobility_m_per_n_s above 0, such as 7e-4, beside it");
  return KeyboardLongitudinal{
      object.number("frequency_ratio", kLongitudinalFrequency),
      {object.number("constant_loss_per_s", kLongitudinalLoss),
       object.has("quadratic_loss_m2_per_s") ? object.number("quadratic_loss_m2_per_s", kLongitudinalQuadratic) : 0},
      object.number("output_ratio", kLongitudinalOutput),
      object.has("last_key") ? object.integer("last_key", first_key, last_key) : last_key};
}

KeyboardBody read_keyboard_body(const JsonObject& body, int first_key, int last_key) {
  constexpr const char* kResonator = "the name of a resonator that ships, or its .json file";
  return {body.text("resonator", kResonator),
          read_detuning(body, "double_hz", 2),
          read_detuning(body, "triple_hz", 3),
          body.number("una_corda_stiffness_ratio", kUnaCorda),
          read_listening(body),
          body.has("knock") ? body.text("knock", kResonator) : "",
          read_horizontal(body),
          read_bridge_places(body, first_key, last_key),
          read_ears(body),
          read_longitudinal(body, first_key, last_key)};
}

std::vector<PublishedNote> read_notes(const JsonObject& keyboard) {
  std::vector<PublishedNote> notes;
  for (const JsonObject& note :
       keyboard.objects("notes",
                        {"key", "length_m", "mass_kg", "bending_stiffness_n_m2", "constant_loss_per_s",
                         "quadratic_loss_m2_per_s", "strike_position_m", "hammer_mass_kg", "stiffness_n_per_m_alpha",
                         "exponent", "bridge_ratio", "output_ratio", "horizontal_ratio"},
                        kHighestKey + 1)) {
    notes.push_back(read_note(note));
    if (notes.size() > 1 && notes.back().key <= std::prev(notes.end(), 2)->key)
      note.fail(note.key("key"), fmt::format("{} does not rise", notes.back().key), "notes by rising key");
  }
  if (notes.size() < 2) keyboard.fail(keyboard.key("notes"), "fewer than two notes", "at least two, to interpolate");
  return notes;
}

/// A number that the published notes give a key, and what is allowed of it.
struct Outcome {
  const char* what;
  double value;
  Range allowed;
};

// Strings that are out of tune have a pitch above half of the key's.
void check_detuning(const Keyboard& keyboard, const JsonObject& object, int key, const KeyboardNote& note) {
  if (!keyboard.body || note.strings == 1) return;
  const bool has_two = note.strings == 2;
  for (const double hz : has_two ? keyboard.body->double_hz : keyboard.body->triple_hz)
    if (!(hz > -note.pitch_hz / 2))
      object.fail(has_two ? "keyboard.body.double_hz" : "keyboard.body.triple_hz",
                  fmt::format("at key {} {} leaves {:.4g} Hz of {:.4g}", key, hz, note.pitch_hz + hz, note.pitch_hz),
                  "numbers above minus half of each pitch");
}

// What lies beyond the outermost notes may leave any bounds.
void check_notes(const Keyboard& keyboard, const JsonObject& object) {
  for (int key = keyboard.first_key; key <= keyboard.last_key; ++key) {
    const KeyboardNote note = note_of(keyboard, key);
    check_detuning(keyboard, object, key, note);
    const StiffString& string = note.string;
    const PowerLaw& felt = *note.felt.contact.power_law();
    for (const auto& [what, value, allowed] :
         {Outcome{"length_m", string.length_m, kLength}, Outcome{"mass_kg", string.mass_kg, ranges::kMass},
          Outcome{"bending_stiffness_n_m2", string.bending_stiffness_n_m2, kBending},
          Outcome{"constant_loss_per_s", string.losses.constant_per_s - note.bridge_loss_per_s, kConstantLoss},
          Outcome{"the loss to the body in 1/s", note.bridge_loss_per_s, {0, kConstantLoss.max}},
          Outcome{"quadratic_loss_m2_per_s", string.losses.quadratic_m2_per_s, kQuadraticLoss},
          Outcome{"tension in N", string.tension_n, ranges::kTension},
          Outcome{"strike_position_m", note.strike_position_m, {kMinPosition, string.length_m}},
          Outcome{"hammer_mass_kg", note.hammer_mass_kg, ranges::kMass},
          Outcome{"bridge_ratio", note.bridge_ratio, kBridgeRatio},
          Outcome{"output_ratio", note.output_ratio, kOutputRatio},
          Outcome{"horizontal_ratio", note.horizontal_ratio, kOutputRatio},
          Outcome{"stiffness_n_per_m_alpha", felt.stiffness, kStiffness},
          Outcome{"exponent", felt.exponent, kExponent},
          Outcome{"max compression of the felt in m", note.felt.spline.max_compression_m, ranges::kCompression}})
      if (!(value >= allowed.min && value <= allowed.max))
        object.fail("keyboard.notes", fmt::format("at key {} {} is {}", key, what, value),
                    fmt::format("a number from {} to {}", allowed.min, allowed.max));
  }
}

}  // namespace

Keyboard parse_keyboard(std::string_view text, std::string_view file) {
  const JsonObject whole = parse_json(text, file, "keyboard", {"name", "description", "keyboard"});
  const JsonObject keyboard =
      whole.object("keyboard", {"first_key", "last_key", "first_double_key", "first_triple_key", "last_damped_key",
                                "concert_pitch_hz", "min_speed_m_per_s", "max_speed_m_per_s", "felt_loss_s_per_m",
                                "damper_per_s", "damper_time_s", "segments", "notes", "body"});
  const int first = keyboard.integer("first_key", 0, kHighestKey);
  const int last = keyboard.integer("last_key", first, kHighestKey);
  Keyboard read{read_name(whole, kTaken),
                read_description(whole),
                first,
                last,
                keyboard.integer("first_double_key", 0, kHighestKey + 1),
                keyboard.integer("first_triple_key", 0, kHighestKey + 1),
                keyboard.integer("last_damped_key", 0, kHighestKey),
                keyboard.number("concert_pitch_hz", kPitch),
                keyboard.number("min_speed_m_per_s", kSpeed),
                keyboard.number("max_speed_m_per_s", kSpeed),
                keyboard.number("felt_loss_s_per_m", ranges::kLoss),
                keyboard.number("damper_per_s", kDamping),
                keyboard.number("damper_time_s", kDamperTime),
                keyboard.integer("segments", 1, kMaxSegments),
                read_notes(keyboard)};
  if (keyboard.has("body"))
    read.body = read_keyboard_body(
        keyboard.object(
            "body", {"resonator", "double_hz", "triple_hz", "una_corda_stiffness_ratio", "pickup_ratio",
                     "mobility_m_per_n_s", "output_above_hz", "output_quality", "knock", "horizontal_strike_ratio",
                     "horizontal_bridge_ratio", "horizontal_cents", "bridge_places", "ears", "longitudinal"}),
        first, last);
  if (read.first_triple_key < read.first_double_key)
    keyboard.fail(keyboard.key("first_triple_key"),
                  fmt::format("{} is below first_double_key", read.first_triple_key),
                  fmt::format("at least {}", read.first_double_key));
  if (read.min_speed_m_per_s > read.max_speed_m_per_s)
    keyboard.fail(keyboard.key("min_speed_m_per_s"),
                  fmt::format("{} is above max_speed_m_per_s", read.min_speed_m_per_s),
                  fmt::format("at most {}", read.max_speed_m_per_s));
  check_notes(read, keyboard);
  return read;
}

KeyboardResonators resonators_of(const Keyboard& keyboard, const NamedText& file, const ReadFile& read) {
  const auto named = [&](const char* key, const std::string& name) {
    const NamedText found = named_text(file.file, key, name, Shipped::kResonators, reader_beside(file, read));
    return parse_resonator(found.text, found.file);
  };
  KeyboardResonators resonators;
  if (!keyboard.body) return resonators;
  resonators.body = named("keyboard.body.resonator", keyboard.body->resonator);
  resonators.bridge_places = keyboard.body->bridge_places;
  if (!resonators.bridge_places.empty()) check_bridge_places(resonators.bridge_places, *resonators.body, file.file);
  resonators.ears = keyboard.body->ears;
  if (!resonators.ears.empty()) check_ears(resonators.ears, *resonators.body, file.file);
  if (!keyboard.body->knock.empty()) resonators.knock = named("keyboard.body.knock", keyboard.body->knock);
  return resonators;
}

}  // namespace contactspline
