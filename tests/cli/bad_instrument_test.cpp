// SPDX-License-Identifier: MIT
// All the errors that an instrument file can have: one line that names file, key and what is allowed, and nothing
// written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bad_input.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

const std::string kGood = R"({
  "name": "probe",
  "description": "a probe",
  "bodies": [
    { "name": "string", "resonator": "string_c4", "tuning_cents": 3, "max_modes": 20 },
    {
      "name": "other",
      "string": { "length_m": 0.7, "mass_kg": 0.004, "tension_n": 600, "bending_stiffness_n_m2": 0.01,
                  "constant_loss_per_s": 0.5, "quadratic_loss_m2_per_s": 0.0001 }
    },
    { "name": "head", "resonator": "drum_head", "max_modes": 21 },
    { "name": "board", "modes": [ { "frequency_hz": 100, "decay_per_s": 20, "mass_kg": 4 },
                                  { "frequency_hz": 200, "decay_per_s": 25, "mass_kg": 5 } ] },
    { "name": "hammer", "mass_kg": 0.0031 },
    { "name": "bolt", "mass_kg": 0.002 },
    { "name": "lid", "max_modes": 30,
      "plate": { "length_m": 0.4, "width_m": 0.3, "thickness_m": 0.003, "density_kg_m3": 450,
                 "youngs_modulus_pa": 1e10, "poisson_ratio": 0.37, "constant_loss_per_s": 8,
                 "quadratic_loss_m2_per_s": 0.02 } }
  ],
  "places": [
    { "name": "struck", "body": "string", "position_m": 0.07 },
    { "name": "end", "body": "string", "position_m": 0.61 },
    { "name": "line", "body": "string", "positions_m": [0.1, 0.2, 0.3] },
    { "name": "opposite", "body": "other", "positions_m": [0.15, 0.25, 0.35] },
    { "name": "pair", "body": "other", "positions_m": [0.16, 0.26] },
    { "name": "spot", "body": "head", "position_m": 0.05, "angle_rad": 0.4 },
    { "name": "foot", "body": "board", "shapes": [1, -0.5] },
    { "name": "corner", "body": "lid", "position_m": 0.12, "across_m": 0.13 }
  ],
  "contacts": [
    { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4", "gap_m": 0.004, "weight": 1.25 },
    { "name": "rattle", "between": ["line", "opposite"], "material": "rubber_on_wood", "gaps_m": [1e-4, 2e-4, 3e-4],
      "weights": [0.3, 0.4, 0.6] }
  ],
  "springs": [
    { "name": "coil", "between": ["bolt", "ground"], "stiffness_n_per_m": 150, "resistance_n_s_per_m": 0.7,
      "gap_m": 0.001 }
  ],
  "links": [ { "name": "pin", "between": ["end", "foot"] } ],
  "controls": [
    { "name": "push", "force_n": "spot", "initial": 0.11, "min": -7, "max": 8, "release_n": 1.75 },
    { "name": "hand", "damping_per_s": ["string", "other"], "initial": 12 },
    { "name": "felt", "stiffness_ratio": "felt", "initial": 2.5 },
    { "name": "felt", "loss_s_per_m": "felt", "initial": 0.35 },
    { "name": "felt", "gap_shift_m": "felt", "initial": 0.0015 },
    { "name": "coil", "stiffness_n_per_m": "coil", "initial": 180 },
    { "name": "coil", "resistance_n_s_per_m": "coil", "initial": 0.8 }
  ],
  "strikes": ["hammer"],
  "outputs": [
    { "name": "string", "end_force_n": "string" },
    { "name": "spot", "displacement_m": "spot" },
    { "name": "foot", "velocity_m_per_s": ["foot", "spot"] },
    { "name": "felt", "force_n": ["felt", "rattle"] },
    { "name": "corner", "velocity_m_per_s": "corner", "full_scale": 0.06 },
    { "name": "ear", "pressure_pa": "lid", "distance_m": 0.81, "angle_rad": 0.3, "around_rad": 1.3, "side_m": 0.09 }
  ],
  "input": { "force_n": ["spot", "corner"], "full_scale": 3.5 }
})";

std::vector<BadFile> long_cases() {
  return {{"outputs_missing", kGood.substr(0, kGood.find(",\n  \"outputs\"")) + "}", "outputs",
           "missing; allowed: an array of 1 to 64 objects"},
          {"truncated", kGood.substr(0, kGood.size() / 2), "line ", "; allowed: "},
          {"large", kGood + std::string(1 << 20, ' '), "file", "is larger than 1 MiB"}};
}

Outcome generate(const Sandbox& box, const Words& options = {}) {
  return run({.arguments = followed_by({"generate", "probe.json", "-o", "out"}, options), .folder = box.path()});
}

CONTACTSPLINE_REFUSED_BY_GENERATE(BadInstrumentFile);
CONTACTSPLINE_CASES(Number, BadInstrumentFile, bad_numbers("instrument", "Number", {{"", kGood}}));
CONTACTSPLINE_CASES(Body, BadInstrumentFile, bad_files("instrument", "Body", {{"", kGood}}));
CONTACTSPLINE_CASES(Place, BadInstrumentFile, bad_files("instrument", "Place", {{"", kGood}}));
CONTACTSPLINE_CASES(Connection, BadInstrumentFile, bad_files("instrument", "Connection", {{"", kGood}}));
CONTACTSPLINE_CASES(Note, BadInstrumentFile, bad_files("instrument", "Note", {{"", kGood}}));
CONTACTSPLINE_CASES(Outside, BadInstrumentFile, bad_files("instrument", "Outside", {{"", kGood}}));
CONTACTSPLINE_CASES(Long, BadInstrumentFile, long_cases());

// What the tables above are made of is good itself.
TEST(GoodInstrumentFile, IsAccepted) {
  const Sandbox box;
  write_file(box / "probe.json", kGood);
  const Outcome outcome = generate(box);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "wrote out/probe.lib\nwrote out/probe.hpp\nwrote out/probe.json\n");
}

// Strings that stretch have a Faust program, but not beside a felt that remembers; plates have none. `inspect` tells
// what stretches.
TEST(BadInstrument, ThatStretchesMayHaveNoFaustText) {
  const Sandbox box;
  const std::string good =
      changed(kGood, R"("name": "other",)",
              R"("name": "other", "stretch": { "youngs_modulus_pa": 2e11, "core_diameter_m": 3e-4 },)");
  write_file(box / "probe.json", good);
  const Outcome outcome = generate(box);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "wrote out/probe.lib\nwrote out/probe.hpp\nwrote out/probe.json\n");
  // E S L/8
  const Outcome inspected = run({.arguments = {"inspect", "probe.json"}, .folder = box.path()});
  EXPECT_NE(inspected.out.find("Hz, stretches with 14137"), std::string::npos) << inspected.out;

  const std::string of_plate = changed(kGood, R"("name": "lid", "max_modes": 30,)",
                                       R"("name": "lid", "max_modes": 8, "stretch": { "airy_functions": 2 },)");
  const std::string of_both = changed(good, R"("name": "lid", "max_modes": 30,)",
                                      R"("name": "lid", "max_modes": 8, "stretch": { "airy_functions": 2 },)");
  for (const auto& [file, what] :
       {std::pair(of_plate, "plate lid with stretch"),
        {of_both, "plate lid with stretch"},
        {changed(good, "felt_c4", "felt_stulov_c4"), "body other with stretch and a contact with memory"}}) {
    write_file(box / "probe.json", file);
    const std::string why = fmt::format("probe has the {}, which only the C++ class plays", what);
    expect_refused(generate(box, {"--emit", "faust"}), "probe.json: --emit: " + why, "allowed: cpp, whose class");
    const Outcome left = generate(box, {"--force"});
    EXPECT_EQ(left.exit_code, 0) << left.err;
    EXPECT_NE(left.out.find("left out probe.lib: " + why + "\n"), std::string::npos) << left.out;
  }
}

TEST(BadInstrument, ThatIsRoughHasNoFaustText) {
  const Sandbox box;
  write_file(box / "probe.json", changed(kGood, R"("weight": 1.25)",
                                         R"("weight": 1.25, "roughness": { "height_m": 1e-5, "length_m": 1e-3 })"));
  expect_refused(generate(box, {"--emit", "faust"}),
                 "probe.json: --emit: probe has the rough contact felt, which only the C++ class plays",
                 "allowed: cpp, whose class");
}

// A Faust program of many contacts would take too long to compile.
TEST(BadInstrument, OfManyContactsHasNoFaustText) {
  const Sandbox box;
  std::string many = kGood;
  for (const auto& [three, six] : {std::pair("[0.1, 0.2, 0.3]", "[0.1, 0.15, 0.2, 0.25, 0.3, 0.35]"),
                                   {"[0.15, 0.25, 0.35]", "[0.1, 0.15, 0.2, 0.25, 0.3, 0.35]"},
                                   {"[1e-4, 2e-4, 3e-4]", "[1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4]"},
                                   {"[0.3, 0.4, 0.6]", "[1, 1, 1, 1, 1, 1]"}})
    many = changed(many, three, six);
  write_file(box / "probe.json", many);
  const std::string why = "probe has 7 points of contact, and Faust compiles at most 6 in reasonable time";
  expect_refused(generate(box, {"--emit", "faust"}), "probe.json: --emit: " + why, "allowed: cpp, whose class");
  const Outcome outcome = generate(box);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "wrote out/probe.hpp\nwrote out/probe.json\nleft out probe.lib: " + why + "\n");
}

// A program solves one point of friction that is alone on its bodies.
TEST(BadInstrument, WithCoupledFrictionHasNoFaustText) {
  const Sandbox box;
  const auto generated = [&](const std::string& frictions) {
    write_file(box / "probe.json",
               changed(kGood, R"("links": [)", R"("frictions": [)" + frictions + R"(], "links": [)"));
    return generate(box, {"--emit", "faust", "--force"});
  };
  const auto bow_on = [](const std::string& name, const std::string& place) {
    return fmt::format(R"({{ "name": "{}", "between": ["ground", "{}"], "material": "rosin" }})", name, place);
  };
  const std::string alone = " on bodies that move each other, and Faust solves a friction that is alone there";
  EXPECT_EQ(generated(bow_on("bow", "spot")).err, "");
  for (const auto& [frictions, why] :
       {std::pair(bow_on("bow", "struck"), " and the contact felt" + alone),
        {bow_on("bow", "foot"), " and the contact felt" + alone},  // by a link
        {bow_on("bow", "spot") + ", " + bow_on("brush", "spot"), " and the friction brush" + alone},
        {R"({ "name": "bow", "between": ["ground", "spot"], "material": "rosin", "pressed_by": "felt" })",
         " that a contact presses, which only the C++ class plays"},
        {bow_on("bow", "pair"), " of 2 points, and Faust solves one point that is alone on its bodies"}})
    expect_refused(generated(frictions), "probe.json: --emit: probe has the friction bow" + why,
                   "allowed: cpp, whose class");
}

// The good file with so many modes of its board.
std::string with_board_modes(std::size_t count) {
  std::string modes, shapes;
  for (std::size_t i = 0; i < count; ++i) {
    modes +=
        fmt::format(R"({}{{ "frequency_hz": {}, "decay_per_s": 20, "mass_kg": 4 }})", i > 0 ? ", " : "", 100 + i);
    shapes += i > 0 ? ", 1" : "1";
  }
  const std::size_t begin = kGood.find(R"({ "frequency_hz": 100)"), end = kGood.find(" ] },", begin);
  return changed(changed(kGood, kGood.substr(begin, end - begin), modes), "[1, -0.5]", "[" + shapes + "]");
}

TEST(BadInstrument, Of401ModesHasNoFaustText) {
  const Sandbox box;
  const auto generated = [&](std::size_t board_modes) {
    write_file(box / "probe.json", with_board_modes(board_modes));
    const Outcome outcome = generate(box);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  const auto left_out = [](std::size_t modes) {
    return fmt::format("left out probe.lib: probe has {} modes, and Faust compiles at most 400 in reasonable time\n",
                       modes);
  };
  constexpr std::size_t modes = 500;  // modes of the board; the other bodies get what is left
  const std::string message = generated(modes);
  std::size_t others = 0;
  while (others < 400 && message.find(left_out(modes + others)) == std::string::npos) ++others;
  ASSERT_LT(others, 400U) << message;
  EXPECT_NE(generated(401 - others).find(left_out(401)), std::string::npos);
  EXPECT_NE(generated(400 - others).find("wrote out/probe.lib\n"), std::string::npos);
}

TEST(BadInstrument, HasNoModeAtALowRate) {
  const Sandbox box;
  write_file(box / "probe.json", changed(kGood, R"("frequency_hz": 100)", R"("frequency_hz": 21000)"));
  EXPECT_EQ(generate(box).exit_code, 0);
  write_file(box / "probe.json", changed(changed(kGood, R"("frequency_hz": 100)", R"("frequency_hz": 21000)"),
                                         R"("frequency_hz": 200)", R"("frequency_hz": 21500)"));
  expect_refused(generate(box, {"--rate", "40000"}), "probe.json: bodies: body 'board' has no mode below 20000 Hz",
                 "allowed: a higher --rate, a lower frequency, or losses below the frequencies");
}

const std::string kScore = R"({
  "instrument": "probe.json",
  "duration_s": 0.05,
  "voices": [ { "name": "a", "tuning_cents": 4, "pan": 0.2 } ],
  "events": [
    { "time_s": 0.01, "voice": "a", "hammer_speed_m_per_s": 2.5 },
    { "time_s": 0.02, "over_s": 0.005, "push_release_n": 0.6 },
    { "time_s": 0.03, "hand_damping_per_s": 7 }
  ]
})";

class BadInstrumentScore : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadInstrumentScore, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [test, text, key, says] = GetParam();
  const Sandbox box;
  write_file(box / "probe.json", kGood);
  write_file(box / "score.json", text);
  const auto before = box.listing();
  expect_refused(run({.arguments = {"render", "--score", "score.json", "-o", "a.wav"}, .folder = box.path()}),
                 "score.json: " + key, says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

CONTACTSPLINE_CASES(All, BadInstrumentScore, bad_files("instrument", "Score", {{"", kScore}}));

TEST(GoodInstrumentScore, IsPlayedFromAnyFolderWithEachOutput) {
  const Sandbox box;
  fs::create_directory(box / "music");
  write_file(box / "music/probe.json", kGood);
  write_file(box / "music/score.json", kScore);
  const auto render = [&](const Words& options) {
    return run(
        {.arguments = followed_by({"render", "--score", "music/score.json", "-o", "a.wav", "--no-figure"}, options),
         .folder = box.path()});
  };
  for (const auto& [output, unit] : {std::pair("string_end_force_n", "N (string end force)"),
                                     {"spot_displacement_m", "m (spot displacement)"},
                                     {"foot_velocity_m_per_s", "m/s (foot velocity)"},
                                     {"corner_velocity_m_per_s", "m/s (corner velocity)"},
                                     {"ear", "Pa (ear pressure)"},
                                     {"spot", "m (spot displacement)"},
                                     {"force", "N (felt force)"}}) {  // not that of the string's end
    const Outcome outcome = render({"--signal", output});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find(unit), std::string::npos) << outcome.out;
  }
  write_file(box / "music/probe.json", changed(kGood, R"("name": "string", "end)", R"("name": "force_at", "end)"));
  EXPECT_NE(render({"--signal", "force"}).out.find("N (felt force)"), std::string::npos);
  write_file(box / "music/probe.json", kGood);
  expect_refused(render({"--signal", "velocity"}), "--signal: 'velocity' is no output",
                 "allowed: string_end_force_n, spot_displacement_m, foot_velocity_m_per_s, felt_force_n, "
                 "corner_velocity_m_per_s, ear_pressure_pa");
}

// What names a missing file is told: the file, as its own reader names it, and the key.
TEST(BadInstrumentScore, NamesWhoNamesAMissingFile) {
  const Sandbox box;
  fs::create_directory(box / "music");
  write_file(box / "music/score.json", kScore);
  write_file(box / "music/probe.json", changed(kGood, R"("felt_c4")", R"("felts/own.json")"));
  const Call call{.arguments = {"render", "music/score.json", "-o", "a.wav"}, .folder = box.path()};
  expect_refused(run(call),
                 "probe.json: contacts[0].material: music/felts/own.json: file: does not exist; allowed: a file "
                 "of at most 1 MiB",
                 "");
  fs::create_directory(box / "music/felts");
  write_file(box / "music/felts/own.json", R"({"name": "own", "contact": {"curve": {"file": "own.csv",
    "shape": "hardening"}}, "spline": {"knots": "uniform", "segments": 8, "max_compression_m": 0.001}})");
  expect_refused(run(call), "felts/own.json: contact.curve.file: music/felts/own.csv: file: does not exist",
                 "a file of at most 1 MiB");
  fs::remove(box / "music/probe.json");
  expect_refused(run(call), "music/score.json: instrument: music/probe.json: file: does not exist", "");
}

}  // namespace
}  // namespace contactspline::testing
