// SPDX-License-Identifier: MIT
// All the errors that a keyboard file can have: one line that names file, key and what is allowed, and nothing
// written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>

#include "bad_input.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

const std::string kLowNote = R"({ "key": 36, "length_m": 1.602, "mass_kg": 0.03324, "bending_stiffness_n_m2": 0.0121,
        "strike_position_m": 0.192, "constant_loss_per_s": 0.25, "quadratic_loss_m2_per_s": 7.5e-5,
        "hammer_mass_kg": 0.0102, "stiffness_n_per_m_alpha": 3.105e8, "exponent": 2.276, "bridge_ratio": 0.5,
        "output_ratio": 0.41, "horizontal_ratio": 0.62 })";
const std::string kGood = R"({
  "name": "probe",
  "keyboard": {
    "first_key": 35, "last_key": 61, "first_double_key": 40, "first_triple_key": 50, "last_damped_key": 60,
    "concert_pitch_hz": 440, "min_speed_m_per_s": 0.2, "max_speed_m_per_s": 6, "felt_loss_s_per_m": 0.1,
    "damper_per_s": 60, "damper_time_s": 0.005, "segments": 4,
    "body": { "resonator": "soundboard", "double_hz": [-0.25, 0.35], "triple_hz": [-0.45, 0.15, 0.55],
      "pickup_ratio": 0.125, "mobility_m_per_n_s": 7e-4, "output_above_hz": 81, "output_quality": 1.25,
      "horizontal_strike_ratio": 0.375, "horizontal_bridge_ratio": 0.275, "horizontal_cents": 3.5,
      "una_corda_stiffness_ratio": 0.51 },
    "notes": [
      )" + kLowNote + R"(,
      { "key":60, "length_m":0.657, "mass_kg":4.051e-3, "bending_stiffness_n_m2":0.0099, "strike_position_m":0.079,
        "constant_loss_per_s":1.1, "quadratic_loss_m2_per_s":0.00027,
        "hammer_mass_kg":8.71e-3, "stiffness_n_per_m_alpha":5.84e9, "exponent":2.418, "bridge_ratio":0.5, "output_ratio":0.41,
        "horizontal_ratio":0.62 }
    ]
  }
})";

const std::string kMass = "a number from 1e-09 to 10000";
const std::vector<std::string> kNotMidi = {"-1", "129", "4294967297"};

std::vector<BadFile> all_number_cases() {
  const std::vector<NumberKey> numbers = {
      {"keyboard.", "first_key", "35", "an integer from 0 to 127", kNotMidi, true},
      {"keyboard.", "last_key", "61", "an integer from 35 to 127", {"34", "128"}, true},
      {"keyboard.", "first_double_key", "40", "an integer from 0 to 128", kNotMidi, true},
      {"keyboard.", "first_triple_key", "50", "an integer from 0 to 128", kNotMidi, true},
      {"keyboard.", "last_damped_key", "60", "an integer from 0 to 127", kNotMidi, true},
      {"keyboard.", "concert_pitch_hz", "440", "a number from 100 to 1000", {"0", "99", "1001"}},
      {"keyboard.", "min_speed_m_per_s", "0.2", "a number from 0.001 to 100", {"0", "-1", "101"}},
      {"keyboard.", "max_speed_m_per_s", "6", "a number from 0.001 to 100", {"0", "-1", "101"}},
      {"keyboard.", "felt_loss_s_per_m", "0.1", "a number from 0 to 1000", {"-1", "1001"}},
      {"keyboard.", "damper_per_s", "60", "a number from 0 to 100000", {"-1", "1.1e5"}},
      {"keyboard.", "damper_time_s", "0.005", "a number from 1e-05 to 1", {"0", "-1", "1.1"}},
      {"keyboard.", "segments", "4", "an integer from 1 to 256", {"0", "-1", "257"}, true},
      {"keyboard.body.", "pickup_ratio", "0.125", "a number from 0 to 1", {"-0.1", "1.1"}},
      {"keyboard.body.", "mobility_m_per_n_s", "7e-4", "a number from 0 to 1000", {"-0.1", "1001"}},
      {"keyboard.body.", "output_above_hz", "81", "a number from 1 to 1000", {"0", "1001"}},
      {"keyboard.body.", "output_quality", "1.25", "a number from 0.1 to 10", {"0", "11"}},
      {"keyboard.body.", "horizontal_strike_ratio", "0.375", "a number from 0 to 1", {"-0.1", "1.1"}},
      {"keyboard.body.", "horizontal_bridge_ratio", "0.275", "a number from 0 to 1", {"-0.1", "1.1"}},
      {"keyboard.body.", "horizontal_cents", "3.5", "a number from -100 to 100", {"-101", "101"}},
      {"keyboard.body.", "una_corda_stiffness_ratio", "0.51", "a number from 0.001 to 1", {"0", "1.1"}},
      {"keyboard.notes[0].", "key", "36", "an integer from 0 to 127", kNotMidi, true},
      {"keyboard.notes[0].", "length_m", "1.602", "a number from 0.001 to 100", {"0", "-1", "101"}},
      {"keyboard.notes[0].", "mass_kg", "0.03324", kMass, {"0", "-1", "10001"}},
      {"keyboard.notes[0].", "bending_stiffness_n_m2", "0.0121", "a number from 1e-12 to 1000000", {"0", "1.1e6"}},
      {"keyboard.notes[0].", "strike_position_m", "0.192", "a number from 1e-06 to 1.602", {"0", "-1", "1.603"}},
      {"keyboard.notes[0].", "constant_loss_per_s", "0.25", "a number from 1e-06 to 10000", {"0", "-1", "10001"}},
      {"keyboard.notes[0].", "quadratic_loss_m2_per_s", "7.5e-5", "a number from 1e-12 to 1000", {"0", "1001"}},
      {"keyboard.notes[0].", "hammer_mass_kg", "0.0102", kMass, {"0", "-1", "10001"}},
      {"keyboard.notes[0].", "stiffness_n_per_m_alpha", "3.105e8", "a number from 0.001 to 1e+20", {"0", "1.1e20"}},
      {"keyboard.notes[0].", "exponent", "2.276", "a number from 1 to 10", {"0", "0.9", "10.1"}},
      {"keyboard.notes[0].", "bridge_ratio", "0.5", "a number from 0.001 to 10", {"0", "-1", "10.1"}},
      {"keyboard.notes[0].", "output_ratio", "0.41", "a number from 0.001 to 1000", {"0", "-1", "1001"}},
      {"keyboard.notes[0].", "horizontal_ratio", "0.62", "a number from 0.001 to 1000", {"0", "-1", "1001"}}};
  std::vector<BadFile> cases;
  for (const NumberKey& number : numbers)
    std::ranges::move(number_cases("keyboard", kGood, number), std::back_inserter(cases));
  return cases;
}

std::vector<BadFile> key_cases() {
  const std::string keys =
      "first_key, last_key, first_double_key, first_triple_key, last_damped_key, concert_pitch_hz, "
      "min_speed_m_per_s, max_speed_m_per_s, felt_loss_s_per_m, damper_per_s, damper_time_s, segments, notes, body";
  return {
      {"name_missing", changed(kGood, R"("name": "probe",)", ""), "name", "missing; allowed: a-z"},
      {"name_is_member", changed(kGood, R"("probe")", R"("tensions")"), "name", "is not a usable identifier"},
      {"triple_before_double", changed(kGood, R"("first_triple_key": 50)", R"("first_triple_key": 39)"),
       "keyboard.first_triple_key", "39 is below first_double_key; allowed: at least 40"},
      {"body_of_no_resonator", changed(kGood, R"("soundboard")", R"("bord")"), "keyboard.body.resonator",
       "'bord' does not ship; allowed: a .json file, drum_head"},
      {"body_of_a_material", changed(kGood, R"("soundboard")", R"("felt_c4")"), "keyboard.body.resonator",
       "'felt_c4' is a material; allowed: a .json file, drum_head"},
      {"body_without_resonator", changed(kGood, R"("resonator": "soundboard", )", ""), "keyboard.body.resonator",
       "missing; allowed: the name of a resonator that ships"},
      {"body_is_text",
       changed(kGood, R"("body": { "resonator": "soundboard",)", R"("body": "soundboard", "impact": {)"),
       "keyboard.impact", "unknown key; allowed: " + keys},
      {"unknown_in_body", changed(kGood, R"("pickup_ratio")", R"("loss": 1, "pickup_ratio")"), "keyboard.body.loss",
       "unknown key; allowed: resonator, double_hz, triple_hz, "
       "una_corda_stiffness_ratio, pickup_ratio, mobility_m_per_n_s, output_above_hz, output_quality, knock, "
       "horizontal_strike_ratio, horizontal_bridge_ratio, horizontal_cents, bridge_places, ears, longitudinal"},
      {"knock_of_no_resonator", changed(kGood, R"("pickup_ratio")", R"("knock": "cupboard", "pickup_ratio")"),
       "keyboard.body.knock", "'cupboard' does not ship; allowed: a .json file, soundboard"},
      {"knock_is_number", changed(kGood, R"("pickup_ratio")", R"("knock": 1, "pickup_ratio")"), "keyboard.body.knock",
       "is not a string; allowed: the name of a resonator that ships"},
      {"one_string_of_two", changed(kGood, "[-0.25, 0.35]", "[0]"), "keyboard.body.double_hz",
       "has 1 entries; allowed: 2 numbers"},
      {"flat_by_most_of_its_pitch",
       changed(changed(changed(changed(kGood, R"("first_key": 35)", R"("first_key": 21)"),
                               R"("concert_pitch_hz": 440)", R"("concert_pitch_hz": 100)"),
                       R"("first_double_key": 40)", R"("first_double_key": 0)"),
               "0.35", "-4.9"),
       "keyboard.body.double_hz", "at key 21 -4.9 leaves 1.35 Hz of 6.25; allowed: numbers above minus half"},
      {"mobility_in_another_unit", changed(kGood, "7e-4", "700"), "keyboard.notes", "at key 35 the loss to the body"},
      {"four_strings_of_three", changed(kGood, "[-0.45, 0.15, 0.55]", "[0, 0, 0, 0]"), "keyboard.body.triple_hz",
       "has 4 entries; allowed: "},
      {"far_out_of_tune", changed(kGood, "0.35", "5.1"), "keyboard.body.double_hz[1]",
       "5.1 is out of range; allowed: a number from -5 to 5"},
      {"unknown_at_root", changed(kGood, R"("name")", R"("impact": 1, "name")"), "impact",
       "unknown key; allowed: name, description, keyboard"},
      {"unknown_in_keyboard", changed(kGood, R"("first_key")", R"("colour": 1, "first_key")"), "keyboard.colour",
       "unknown key; allowed: " + keys},
      {"unknown_in_note", changed(kGood, R"("key": 36)", R"("tension_n": 1, "key": 36)"),
       "keyboard.notes[0].tension_n", "unknown key; allowed: key, length_m"},
      {"keyboard_is_array", R"({ "name": "probe", "keyboard": [] })", "keyboard",
       "is not an object; allowed: " + keys},
      {"first_key_missing", changed(kGood, R"("first_key": 35,)", ""), "keyboard.first_key",
       "missing; allowed: an integer"},
      {"speeds_crossed", changed(kGood, R"("min_speed_m_per_s": 0.2)", R"("min_speed_m_per_s": 7)"),
       "keyboard.min_speed_m_per_s", "7 is above max_speed_m_per_s; allowed: at most 6"},
      {"damper_missing", changed(kGood, R"("damper_per_s": 60, )", ""), "keyboard.damper_per_s",
       "missing; allowed: a number from 0 to 100000"},
      {"exponent_missing", changed(kGood, R"("exponent": 2.276, )", ""), "keyboard.notes[0].exponent",
       "missing; allowed: a number"},
      {"notes_is_object", changed(changed(kGood, "\"notes\": [", "\"notes\": {\"a\": ["), "\n    ]", "\n    ]}"),
       "keyboard.notes", "is not an array"},
      {"one_note", changed(kGood, kLowNote + ",", ""), "keyboard.notes",
       "fewer than two notes; allowed: at least two"},
      {"notes_fall", changed(kGood, R"("key": 36)", R"("key": 61)"), "keyboard.notes[1].key",
       "60 does not rise; allowed: notes by rising key"},
      {"too_stiff_for_its_pitch",
       changed(kGood, R"("bending_stiffness_n_m2": 0.0121)", R"("bending_stiffness_n_m2": 1000)"), "keyboard.notes",
       "at key 35 tension in N is -"},
      {"extrapolated_exponent", changed(kGood, R"("exponent": 2.276)", R"("exponent": 1.001)"), "keyboard.notes",
       "at key 35 exponent is 0.9"},
      {"extrapolated_hammer",
       changed(changed(kGood, R"("last_key": 61)", R"("last_key": 127)"), R"("hammer_mass_kg": 0.0102)",
               R"("hammer_mass_kg": 0.02)"),
       "keyboard.notes", "hammer_mass_kg is -"},
      {"truncated", kGood.substr(0, kGood.size() / 2), "line ", "; allowed: "}};
}

/// kGood with strings that move along themselves.
std::string along(const std::string& longitudinal) {
  return changed(kGood, R"("pickup_ratio")", R"("longitudinal": )" + longitudinal + R"(, "pickup_ratio")");
}
const std::string kAlong = R"({ "frequency_ratio": 13.5, "constant_loss_per_s": 29,
  "quadratic_loss_m2_per_s": 0.013, "output_ratio": 0.21, "last_key": 59 })";

std::vector<BadFile> longitudinal_cases() {
  const std::string all = "keyboard.body.longitudinal", keys =
                                                            "frequency_ratio, constant_loss_per_s, "
                                                            "quadratic_loss_m2_per_s, output_ratio, last_key";
  std::vector<BadFile> cases = {
      {"along_is_number", along("1"), all, "is not an object; allowed: " + keys},
      {"unknown_along", along(changed(kAlong, "last_key", "first_key")), all + ".first_key",
       "unknown key; allowed: " + keys},
      {"along_without_frequency", along(changed(kAlong, R"("frequency_ratio": 13.5, )", "")),
       all + ".frequency_ratio", "missing; allowed: a number from 2 to 100"},
      {"along_without_loss", along(changed(kAlong, R"("constant_loss_per_s": 29,)", "")),
       all + ".constant_loss_per_s", "missing; allowed: a number from 10 to 10000"},
      {"along_without_ratio", along(changed(kAlong, R"("output_ratio": 0.21, )", "")), all + ".output_ratio",
       "missing; allowed: a number from 0.001 to 10"},
      {"along_unheard", changed(along(kAlong), R"("mobility_m_per_n_s": 7e-4, )", ""), all,
       "is not heard without mobility_m_per_n_s; allowed: mobility_m_per_n_s above 0, such as 7e-4, beside it"},
      {"along_unheard_by_0", changed(along(kAlong), "7e-4", "0"), all, "is not heard without mobility_m_per_n_s"}};
  for (const NumberKey& number : std::vector<NumberKey>{
           {all + ".", "frequency_ratio", "13.5", "a number from 2 to 100", {"0", "1.9", "101"}},
           {all + ".", "constant_loss_per_s", "29", "a number from 10 to 10000", {"0", "9.9", "10001"}},
           {all + ".", "quadratic_loss_m2_per_s", "0.013", "a number from 0 to 1000", {"-1", "1001"}},
           {all + ".", "output_ratio", "0.21", "a number from 0.001 to 10", {"0", "-1", "11"}},
           {all + ".", "last_key", "59", "an integer from 35 to 61", {"34", "62"}, true}})
    std::ranges::move(number_cases("along", along(kAlong), number), std::back_inserter(cases));
  return cases;
}

/// kGood on another body, with places along its bridges.
std::string placed(const std::string& body, const std::string& places) {
  return changed(changed(kGood, R"("soundboard")", '"' + body + '"'), R"("pickup_ratio")",
                 R"("bridge_places": )" + places + R"(, "pickup_ratio")");
}

std::vector<BadFile> place_cases() {
  const std::string all = "keyboard.body.bridge_places", where = R"("position_m": 0.1, "across_m": 0.2)";
  const auto places = [&](const std::vector<int>& first_keys) {
    std::string text;
    for (const int key : first_keys)
      text += fmt::format(R"({}{{ "first_key": {}, {} }})", text.empty() ? "" : ", ", key, where);
    return placed("soundboard", "[" + text + "]");
  };
  std::vector<int> too_many(17);
  std::iota(too_many.begin(), too_many.end(), 35);
  return {
      {"no_place", places({}), all, "has 0 entries; allowed: an array of 1 to 16 objects"},
      {"too_many_places", places(too_many), all, "17 entries; allowed: an array of 1 to 16 objects"},
      {"keys_without_place", places({36, 40}), all + "[0].first_key",
       "36 leaves the keys from 35 on without a place; allowed: at most 35"},
      {"places_fall", places({35, 40, 40}), all + "[2].first_key", "40 does not rise; allowed: places by rising key"},
      {"place_without_keys", places({35, 62}), all + "[1].first_key",
       "62 is out of range; allowed: an integer from 0 to 61"},
      {"place_without_first_key", placed("soundboard", "[{ " + where + " }]"), all + "[0].first_key",
       "missing; allowed: an integer from 0 to 61"},
      {"unknown_in_place", placed("soundboard", R"([{ "first_key": 1, "angle_rad": 0 }])"), all + "[0].angle_rad",
       "unknown key; allowed: first_key, position_m, across_m"},
      {"place_below_zero", placed("soundboard", R"([{ "first_key": 1, "position_m": -0.1 }])"),
       all + "[0].position_m", "-0.1 is out of range; allowed: a number from 0 to 100"},
      {"modes_without_places", places({35, 40}), all,
       "soundboard has no such places; allowed: a plate, or modes with bridge_shapes"},
      {"places_on_a_membrane", placed("drum_head", "[{ \"first_key\": 1, " + where + " }]"), all,
       "drum_head has no such places; allowed: a plate, or modes with bridge_shapes"}};
}

CONTACTSPLINE_REFUSED_BY_GENERATE(BadKeyboardFile);
CONTACTSPLINE_CASES(Number, BadKeyboardFile, all_number_cases());
CONTACTSPLINE_CASES(Key, BadKeyboardFile, key_cases());
CONTACTSPLINE_CASES(Place, BadKeyboardFile, place_cases());
CONTACTSPLINE_CASES(Longitudinal, BadKeyboardFile, longitudinal_cases());

const std::string kPlate = R"({ "name": "board", "plate": { "length_m": 1.5, "width_m": 0.5, "thickness_m": 0.01,
  "density_kg_m3": 400, "youngs_modulus_pa": 1e10, "poisson_ratio": 0.3, "constant_loss_per_s": 5,
  "quadratic_loss_m2_per_s": 0.1 }, "strike": { "position_m": 0.3, "across_m": 0.25 },
  "pickup": { "position_m": 0.3, "across_m": 0.25 }, "max_modes": 2 })";
const std::string kTable = R"({ "name": "board", "modes": [
  { "frequency_hz": 100, "decay_per_s": 5, "mass_kg": 3, "strike_shape": 1, "pickup_shape": 1, "bridge_shapes": [0.5, 2] },
  { "frequency_hz": 200, "decay_per_s": 5, "mass_kg": 3, "strike_shape": 1, "pickup_shape": 1, "bridge_shapes": [1, -3] }
  ] })";

// Places that do not fit to the body beside the keyboard.
TEST(BadBridgePlaces, AreRefusedInOneLine) {
  const std::string all = "probe.json: keyboard.body.bridge_places";
  const struct {
    std::string board, places, begins, says;
  } cases[] = {
      {kPlate, R"([{ "first_key": 1, "position_m": 0.1 }])", all + "[0].across_m",
       "missing; allowed: a number from 0 to 0.5"},
      {kPlate, R"([{ "first_key": 1, "position_m": 1.6, "across_m": 0.1 }])", all + "[0].position_m",
       "1.6 is beyond the plate; allowed: a number from 0 to 1.5"},
      {kTable, R"([{ "first_key": 1 }])", all, "has 1 places; allowed: 2, as many as board has bridge_shapes"},
      {kTable, R"([{ "first_key": 1 }, { "first_key": 40, "position_m": 0 }])", all + "[1]",
       "has a position, but modes have bridge_shapes; allowed: first_key alone"}};
  for (const auto& [board, places, begins, says] : cases) {
    const Sandbox box;
    write_file(box / "probe.json", placed("board.json", places));
    write_file(box / "board.json", board);
    expect_refused(run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()}), begins, says);
    EXPECT_FALSE(fs::exists(box / "out"));
  }
}

// Ears in the room that the file or the body beside it do not allow.
TEST(BadEars, AreRefusedInOneLine) {
  const std::string ear = R"({ "distance_m": 1.2, "side_m": 0.1 })", all = "probe.json: keyboard.body.ears";
  const std::string large = changed(changed(kPlate, "1.5", "9"), "0.5", "3.5");
  const struct {
    std::string board, body, begins, says;
  } cases[] = {
      {kPlate, R"("ears": [)" + ear + "]", all, "has one entry; allowed: two, the left ear and the right one"},
      {kPlate, R"("ears": [)" + ear + ", " + ear + ", " + ear + "]", all,
       "has 3 entries; allowed: an array of 1 to 2"},
      {kPlate, R"("ears": 1)", all, "is not an array; allowed: an array of 1 to 2 objects"},
      {kPlate, R"("ears": [)" + ear + R"(, { "distance_m": 0.01 }])", all + "[1].distance_m",
       "is out of range; allowed: a number from 0.05 to 20"},
      {kPlate, R"("ears": [)" + ear + R"(, { "distance_m": 0.06, "angle_rad": 1.4 }])", all + "[1].angle_rad",
       "puts the place 0.0102 m before the plane of the body; allowed: at least 0.05 m"},
      {kPlate, R"("ears": [)" + ear + R"(, { "side_m": 1 }])", all + "[1].distance_m", "missing; allowed: a number"},
      {kPlate, R"("ears": [)" + ear + R"(, { "distance_m": 1, "height_m": 1 }])", all + "[1].height_m",
       "unknown key; allowed: distance_m"},
      {kPlate, R"("pickup_ratio": 0.5, "ears": [)" + ear + ", " + ear + "]", "probe.json: keyboard.body.pickup_ratio",
       "stands beside ears, which hear the body in the room; allowed: one of the two"},
      {kPlate, R"("longitudinal": )" + kAlong + R"(, "ears": [)" + ear + ", " + ear + "]",
       "probe.json: keyboard.body.longitudinal", "stands beside ears, which do not hear it; allowed: one of the two"},
      {kPlate, R"("knock": "piano_case", "ears": [)" + ear + ", " + ear + "]", "probe.json: keyboard.body.knock",
       "stands beside ears"},
      {kPlate, R"("ears": [)" + ear + R"(, { "distance_m": 9 }])", all,
       "is 7.83 m farther from one point of the body than from another; allowed: at most 2 m"},
      {large, R"("ears": [)" + ear + ", " + ear + "]", all, "names a body of 9 m; allowed: at most 3 m"},
      {kTable, R"("ears": [)" + ear + ", " + ear + "]", all,
       "names a body of the kind 'modes'; allowed: a plate or a membrane"}};
  for (const auto& [board, body, begins, says] : cases) {
    const Sandbox box;
    write_file(box / "probe.json",
               changed(changed(kGood, R"("soundboard")", R"("board.json")"), R"("pickup_ratio": 0.125)", body));
    write_file(box / "board.json", board);
    expect_refused(run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()}), begins, says);
    EXPECT_FALSE(fs::exists(box / "out"));
  }
}

// The generator computes the shapes of a plate at the places, and takes those of a table: place after place, and for
// each key the number of its place. Faust has the strike alone.
TEST(GoodKeyboardFile, HasPlacesAlongItsBridges) {
  const auto emitted = [](const std::string& board, const std::string& places) {
    const Sandbox box;
    write_file(box / "probe.json", placed("board.json", places));
    write_file(box / "board.json", board);
    const auto outcome = run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return std::array{read_file(box / "out" / "probe.hpp"), read_file(box / "out" / "probe.json"),
                      read_file(box / "out" / "probe.lib")};
  };
  const auto [header, json, faust] = emitted(kTable, R"([{ "first_key": 20 }, { "first_key": 60 }])");
  for (const char* text : {"places = 2;", "bridge_shapes = {\n    0.5, 1.0, 2.0, -3.0}", " 0, 0, 0, 1, 1};"})
    EXPECT_NE(header.find(text), header.npos) << text;
  EXPECT_NE(json.find("\"bridge_shape\": [\n    0.5, 1.0, 2.0, -3.0]"), json.npos);
  EXPECT_NE(json.find(" 0, 0, 0, 1, 1]"), json.npos);
  EXPECT_NE(faust.find("body_bridge_shape(0) = 1.0;"), faust.npos);
  // Modes sin(m pi x/1.5) sin(pi y/0.5), m = 1 and 2.
  const std::string plate = emitted(kPlate, R"([{ "first_key": 20, "position_m": 0.25, "across_m": 0.25 },
    { "first_key": 60, "position_m": 0.75, "across_m": 0.25 }])")[0];
  EXPECT_NE(plate.find("bridge_shapes = {\n    0.5, 0.8660254037844, 1.0, 0.0}"), plate.npos);
}

// What the tables above are made of is good itself.
TEST(GoodKeyboardFile, IsAccepted) {
  const Sandbox box;
  write_file(box / "probe.json", kGood);
  const auto outcome = run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(std::distance(fs::directory_iterator(box / "out"), {}), 3);
}

// A body of its own lies beside the keyboard, and its file is one that the output depends on.
TEST(GoodKeyboardFile, HoldsTheBodyOfItsFolder) {
  const Sandbox box;
  fs::create_directory(box / "mine");
  write_file(box / "mine" / "probe.json",
             changed(kGood, "\"soundboard\"", "\"board.json\", \"knock\": \"case.json\""));
  write_file(box / "mine" / "case.json", R"({ "name": "casing", "modes": [
    { "frequency_hz": 90, "decay_per_s": 8, "mass_kg": 12.5, "strike_shape": 2, "pickup_shape": 0.5,
      "right_shape": -0.5 }] })");
  write_file(box / "mine" / "board.json", R"({ "name": "board", "modes": [
    { "frequency_hz": 100, "decay_per_s": 5, "mass_kg": 3.25, "strike_shape": 1.5, "pickup_shape": -0.75 }] })");
  const auto outcome =
      run({.arguments = {"generate", "mine/probe.json", "-o", "out", "--depfile", "out.d"}, .folder = box.path()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string header = read_file(box / "out" / "probe.hpp"), rule = read_file(box / "out.d");
  for (const char* text :
       {"masses = {\n    3.25, 12.5}", "bridge_shapes = {\n    1.5, 0.0}", "knock_shapes = {\n    0.0, 2.0}",
        "left_shapes = {\n    -0.75, 0.5}", "right_shapes = {\n    -0.75, -0.5}", "double_hz = {-0.25, 0.35}",
        "output_ratios = {\n    0.41", "pickup_ratio = 0.125", "output_above_hz = 81", "output_quality = 1.25",
        "horizontal_strike_ratio = 0.375", "horizontal_bridge_ratio = 0.275", "horizontal_cents = 3.5",
        "bridge_ratios = {\n    0.5", "horizontal_ratios = {\n    0.62"})
    EXPECT_NE(header.find(text), header.npos) << text;
  for (const char* file : {" mine/board.json", " mine/case.json"}) EXPECT_NE(rule.find(file), rule.npos) << rule;
}

// Without a knock keys strike strings alone.
TEST(GoodKeyboardFile, NeedsNoKnock) {
  const Sandbox box;
  write_file(box / "probe.json", changed(kGood, "\"soundboard\"", "\"board.json\""));
  write_file(box / "board.json", R"({ "name": "board", "modes": [
    { "frequency_hz": 100, "decay_per_s": 5, "mass_kg": 3.25, "strike_shape": 1.5, "pickup_shape": -0.75 }] })");
  const auto outcome = run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(read_file(box / "out" / "probe.hpp").find("knock_shapes = {\n    0.0}"), std::string::npos);
}

// Without a body nothing of it is written.
TEST(GoodKeyboardFile, NeedsNoBody) {
  const Sandbox box;
  const std::size_t begin = kGood.find("\"body\""), end = kGood.find("\"notes\"");
  write_file(box / "probe.json", kGood.substr(0, begin) + kGood.substr(end));
  const auto outcome = run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string header = read_file(box / "out" / "probe.hpp"), json = read_file(box / "out" / "probe.json");
  EXPECT_EQ(header.find("struct body"), header.npos);
  EXPECT_EQ(json.find("\"body\""), json.npos);
  EXPECT_NE(json.find("\"half_curvature_n_per_m\""), json.npos);
}

}  // namespace
}  // namespace contactspline::testing
