// SPDX-License-Identifier: MIT
// All the errors that a keyboard file can have: one line that names file, key and what is allowed, and nothing
// written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <iterator>

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

/// kGood with strings that move along themselves.
std::string along(const std::string& longitudinal) {
  return changed(kGood, R"("pickup_ratio")", R"("longitudinal": )" + longitudinal + R"(, "pickup_ratio")");
}
const std::string kAlong = R"({ "frequency_ratio": 13.5, "constant_loss_per_s": 29,
  "quadratic_loss_m2_per_s": 0.013, "output_ratio": 0.21, "last_key": 59 })";

/// kGood on another body, with places along its bridges.
std::string placed(const std::string& body, const std::string& places) {
  return changed(changed(kGood, R"("soundboard")", '"' + body + '"'), R"("pickup_ratio")",
                 R"("bridge_places": )" + places + R"(, "pickup_ratio")");
}

Bases bases() {
  return {{"", kGood},
          {"along", along(kAlong)},
          {"places", placed("soundboard", R"([{ "first_key": 35, "position_m": 0.1, "across_m": 0.2 }])")}};
}

std::vector<BadFile> long_cases() {
  std::string many;
  for (int key = 35; key < 52; ++key)
    many += fmt::format(R"({}{{ "first_key": {}, "position_m": 0.1, "across_m": 0.2 }})", key > 35 ? ", " : "", key);
  return {{"too_many_places", placed("soundboard", "[" + many + "]"), "keyboard.body.bridge_places",
           "17 entries; allowed: an array of 1 to 16 objects"},
          {"one_note", changed(kGood, kLowNote + ",", ""), "keyboard.notes",
           "fewer than two notes; allowed: at least two"},
          {"truncated", kGood.substr(0, kGood.size() / 2), "line ", "; allowed: "}};
}

CONTACTSPLINE_REFUSED_BY_GENERATE(BadKeyboardFile);
CONTACTSPLINE_CASES(Number, BadKeyboardFile, bad_numbers("keyboard", "Number", bases()));
CONTACTSPLINE_CASES(Key, BadKeyboardFile, bad_files("keyboard", "Key", bases()));
CONTACTSPLINE_CASES(Place, BadKeyboardFile, bad_files("keyboard", "Place", bases()));
CONTACTSPLINE_CASES(Longitudinal, BadKeyboardFile, bad_files("keyboard", "Longitudinal", bases()));
CONTACTSPLINE_CASES(Long, BadKeyboardFile, long_cases());

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
       "names a body of the kind 'modes'; allowed: a plate, a round_plate or a membrane"}};
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
