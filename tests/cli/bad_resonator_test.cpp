// SPDX-License-Identifier: MIT
// All the errors that a resonator file can have: one line that names file, key and what is allowed, and nothing
// written.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "bad_input.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

const std::string kString = R"({
  "name": "probe",
  "description": "a probe",
  "string": {
    "length_m": 0.6, "mass_kg": 0.004, "tension_n": 670, "bending_stiffness_n_m2": 0.01,
    "constant_loss_per_s": 0.5, "quadratic_loss_m2_per_s": 0.0001, "detuning_cents": [0, 1.5]
  },
  "strike": { "position_m": 0.07 },
  "pickup": { "position_m": 0.25 },
  "max_modes": 20
})";
const std::string kBar = R"({
  "name": "probe",
  "bar": {
    "length_m": 0.33, "mass_kg": 0.3, "bending_stiffness_n_m2": 64,
    "constant_loss_per_s": 2.5, "quadratic_loss_m2_per_s": 0.008
  },
  "strike": { "position_m": 0.165 },
  "pickup": { "position_m": 0.01 }
})";
const std::string kMembrane = R"({
  "name": "probe",
  "membrane": {
    "radius_m": 0.165, "mass_per_area_kg_m2": 0.35, "tension_n_per_m": 1500,
    "constant_loss_per_s": 6, "quadratic_loss_m2_per_s": 0.02
  },
  "strike": { "position_m": 0.05, "angle_rad": 0.1 },
  "pickup": { "position_m": 0.09, "angle_rad": 0.7 },
  "max_modes": 20
})";
const std::string kPlate = R"({
  "name": "probe",
  "plate": {
    "length_m": 1.4, "width_m": 0.9, "thickness_m": 0.008, "density_kg_m3": 400,
    "youngs_modulus_pa": 11e9, "youngs_modulus_across_pa": 0.6e9, "shear_modulus_pa": 0.7e9, "poisson_ratio": 0.4,
    "constant_loss_per_s": 7, "quadratic_loss_m2_per_s": 0.03
  },
  "strike": { "position_m": 0.5, "across_m": 0.21 },
  "pickup": { "position_m": 0.91, "across_m": 0.7 },
  "max_modes": 20
})";
const std::string kRibbed = changed(kPlate, R"("length_m")", R"("ribs": [
      { "from_m": [0, 0.3], "to_m": [1.4, 0.35], "mass_per_length_kg_m": 0.25, "bending_stiffness_n_m2": 120 } ],
    "length_m")");
const std::string kModes = R"({
  "name": "probe",
  "modes": [
    { "frequency_hz": 440, "decay_per_s": 1.5, "mass_kg": 0.01, "strike_shape": 0.9, "pickup_shape": -0.5,
      "right_shape": 0.25, "bridge_shapes": [0.125, 0.75] }
  ]
})";

const std::string kLength = "a number from 0.0001 to 100";
const std::string kMass = "a number from 1e-09 to 10000";
const std::string kLoss = "a number from 0 to 1000000";
const std::string kModulus = "a number from 1000 to 2000000000000";
const std::string kQuadratic = "a number from 0 to 1000";
const std::string kShape = "a number from -1000000 to 1000000";

std::vector<BadFile> all_number_cases() {
  struct Body {
    std::string name, text;
    std::vector<NumberKey> numbers;
  };
  const std::vector<Body> bodies = {
      {"string",
       kString,
       {{"string.", "length_m", "0.6", kLength, {"0", "-1", "9e-5", "101"}},
        {"string.", "mass_kg", "0.004", kMass, {"0", "-1", "9e-10", "10001"}},
        {"string.", "tension_n", "670", "a number from 0.001 to 1000000", {"0", "-1", "9e-4", "1.1e6"}},
        {"string.", "bending_stiffness_n_m2", "0.01", "a number from 0 to 1000000", {"-1", "1.1e6"}},
        {"string.", "constant_loss_per_s", "0.5", kLoss, {"-1", "1.1e6"}},
        {"string.", "quadratic_loss_m2_per_s", "0.0001", kQuadratic, {"-1", "1001"}},
        {"strike.", "position_m", "0.07", "a number from 0 to 0.6", {"-0.1", "0.61"}},
        {"pickup.", "position_m", "0.25", "a number from 0 to 0.6", {"-0.1", "0.61"}},
        {"", "max_modes", "20", "an integer from 1 to 4096", {"0", "-1", "4097", "4294967297"}, true}}},
      {"bar",
       kBar,
       {{"bar.", "length_m", "0.33", kLength, {"0", "-1", "9e-5", "101"}},
        {"bar.", "mass_kg", "0.3", kMass, {"0", "-1", "9e-10", "10001"}},
        {"bar.", "bending_stiffness_n_m2", "64", "a number from 1e-09 to 1000000", {"0", "-1", "1.1e6"}},
        {"bar.", "constant_loss_per_s", "2.5", kLoss, {"-1", "1.1e6"}},
        {"bar.", "quadratic_loss_m2_per_s", "0.008", kQuadratic, {"-1", "1001"}},
        {"strike.", "position_m", "0.165", "a number from 0 to 0.33", {"-0.1", "0.34"}},
        {"pickup.", "position_m", "0.01", "a number from 0 to 0.33", {"-0.1", "0.34"}}}},
      {"membrane",
       kMembrane,
       {{"membrane.", "radius_m", "0.165", kLength, {"0", "-1", "9e-5", "101"}},
        {"membrane.", "mass_per_area_kg_m2", "0.35", "a number from 1e-06 to 10000", {"0", "-1", "10001"}},
        {"membrane.", "tension_n_per_m", "1500", "a number from 0.001 to 1000000", {"0", "-1", "1.1e6"}},
        {"membrane.", "constant_loss_per_s", "6", kLoss, {"-1", "1.1e6"}},
        {"membrane.", "quadratic_loss_m2_per_s", "0.02", kQuadratic, {"-1", "1001"}},
        {"strike.", "position_m", "0.05", "a number from 0 to 0.165", {"-0.1", "0.17"}},
        {"strike.", "angle_rad", "0.1", "a number from -7 to 7", {"-7.1", "7.1"}},
        {"pickup.", "position_m", "0.09", "a number from 0 to 0.165", {"-0.1", "0.17"}},
        {"pickup.", "angle_rad", "0.7", "a number from -7 to 7", {"-7.1", "7.1"}}}},
      {"plate",
       kPlate,
       {{"plate.", "length_m", "1.4", kLength, {"0", "-1", "9e-5", "101"}},
        {"plate.", "width_m", "0.9", kLength, {"0", "-1", "9e-5", "101"}},
        {"plate.", "thickness_m", "0.008", "a number from 1e-06 to 1", {"0", "-1", "1.1"}},
        {"plate.", "density_kg_m3", "400", "a number from 1 to 30000", {"0", "-1", "30001"}},
        {"plate.", "youngs_modulus_pa", "11e9", kModulus, {"0", "-1", "2.1e12"}},
        {"plate.", "youngs_modulus_across_pa", "0.6e9", kModulus, {"0", "-1", "2.1e12"}},
        {"plate.", "shear_modulus_pa", "0.7e9", kModulus, {"0", "-1", "2.1e12"}},
        {"plate.", "poisson_ratio", "0.4", "a number from -0.999 to 0.999", {"-1", "1"}},
        {"plate.", "constant_loss_per_s", "7", kLoss, {"-1", "1.1e6"}},
        {"plate.", "quadratic_loss_m2_per_s", "0.03", kQuadratic, {"-1", "1001"}},
        {"strike.", "position_m", "0.5", "a number from 0 to 1.4", {"-0.1", "1.41"}},
        {"strike.", "across_m", "0.21", "a number from 0 to 0.9", {"-0.1", "0.91"}},
        {"pickup.", "position_m", "0.91", "a number from 0 to 1.4", {"-0.1", "1.41"}},
        {"pickup.", "across_m", "0.7", "a number from 0 to 0.9", {"-0.1", "0.91"}}}},
      {"ribs",
       kRibbed,
       {{"plate.ribs[0].", "mass_per_length_kg_m", "0.25", "a number from 0 to 1000", {"-1", "1001"}},
        {"plate.ribs[0].", "bending_stiffness_n_m2", "120", "a number from 0 to 1000000", {"-1", "1.1e6"}}}},
      {"modes",
       kModes,
       {{"modes[0].", "frequency_hz", "440", "a number from 0.1 to 1000000", {"0", "-1", "0.09", "1.1e6"}},
        {"modes[0].", "decay_per_s", "1.5", kLoss, {"-1", "1.1e6"}},
        {"modes[0].", "mass_kg", "0.01", kMass, {"0", "-1", "10001"}},
        {"modes[0].", "strike_shape", "0.9", kShape, {"-1.1e6", "1.1e6"}},
        {"modes[0].", "pickup_shape", "-0.5", kShape, {"-1.1e6", "1.1e6"}},
        {"modes[0].", "right_shape", "0.25", kShape, {"-1.1e6", "1.1e6"}}}}};
  std::vector<BadFile> cases;
  for (const auto& [name, text, numbers] : bodies)
    for (const NumberKey& number : numbers) {
      auto of_number = number_cases(name, text, number);
      for (BadFile& bad : of_number)
        bad.test += '_', bad.test += number.path.substr(0, number.path.find_first_of(".["));
      std::ranges::move(of_number, std::back_inserter(cases));
    }
  return cases;
}

std::vector<BadFile> key_cases() {
  const std::string root = "name, description, string, bar, membrane, plate, modes, strike, pickup, max_modes";
  const std::string ends = R"(allowed: two of free, clamped, supported, such as ["clamped", "free"])";
  const std::string kinds = "kinds of body are given; allowed: just one of string, bar, membrane, plate, modes";
  std::vector<BadFile> cases = {
      {"name_missing", changed(kString, R"("name": "probe",)", ""), "name", "missing; allowed: a-z"},
      {"name_is_path", changed(kString, R"("probe")", R"("../probe")"), "name", "is not a usable identifier"},
      {"name_is_member", changed(kString, R"("probe")", R"("decays")"), "name", "is not a usable identifier"},
      {"description_is_number", changed(kString, R"("a probe")", "1"), "description", "is not a string"},
      {"unknown_at_root", changed(kString, R"("name")", R"("colour": 1, "name")"), "colour",
       "unknown key; allowed: " + root},
      {"unknown_in_string", changed(kString, R"("length_m")", R"("length_mm": 1, "length_m")"), "string.length_mm",
       "unknown key; allowed: length_m"},
      {"one_end", changed(kBar, R"("length_m")", R"("ends": ["free"], "length_m")"), "bar.ends",
       "names one end; " + ends},
      {"word_for_ends", changed(kBar, R"("length_m")", R"("ends": "clamped", "length_m")"), "bar.ends",
       "names one end; " + ends},
      {"unknown_end", changed(kBar, R"("length_m")", R"("ends": ["free", "glued"], "length_m")"), "bar.ends[1]",
       "'glued' is no end of a bar; " + ends},
      {"number_for_an_end", changed(kBar, R"("length_m")", R"("ends": ["free", 1], "length_m")"), "bar.ends[1]",
       "is not a string; " + ends},
      {"unknown_in_bar", changed(kBar, R"("length_m")", R"("tension_n": 1, "length_m")"), "bar.tension_n",
       "unknown key; allowed: length_m"},
      {"unknown_in_membrane", changed(kMembrane, R"("radius_m")", R"("length_m": 1, "radius_m")"),
       "membrane.length_m", "unknown key; allowed: radius_m"},
      {"unknown_in_plate", changed(kPlate, R"("length_m")", R"("tension_n": 1, "length_m")"), "plate.tension_n",
       "unknown key; allowed: length_m"},
      {"across_missing", changed(kPlate, R"(, "across_m": 0.21)", ""), "strike.across_m",
       "missing; allowed: a number from 0 to 0.9"},
      {"angle_on_plate", changed(kPlate, R"("across_m": 0.21)", R"("angle_rad": 0)"), "strike.angle_rad",
       "unknown key; allowed: position_m, across_m"},
      {"one_modulus_missing", changed(kPlate, R"("youngs_modulus_across_pa": 0.6e9, )", ""),
       "plate.youngs_modulus_across_pa", "missing; allowed: both youngs_modulus_across_pa and shear_modulus_pa"},
      {"shear_missing", changed(kPlate, R"("shear_modulus_pa": 0.7e9, )", ""), "plate.shear_modulus_pa",
       "missing; allowed: both youngs_modulus_across_pa and shear_modulus_pa"},
      {"poisson_too_large", changed(kPlate, "0.6e9", "90e9"), "plate.poisson_ratio",
       "0.4 is too large for these moduli; allowed: poisson_ratio^2"},
      {"mixed_stiffness_is_negative",
       changed(changed(kPlate, R"("poisson_ratio": 0.4)", R"("poisson_ratio": -0.9)"), R"("shear_modulus_pa": 0.7e9)",
               R"("shear_modulus_pa": 1e5)"),
       "plate.poisson_ratio", "-0.9 needs a larger shear modulus; allowed: frequencies that rise"},
      {"critical_loss", changed(kPlate, "0.03", "20"), "plate.quadratic_loss_m2_per_s",
       "20 is critical; allowed: less than"},
      {"rib_beyond_the_plate", changed(kRibbed, "[1.4, 0.35]", "[1.4, 0.95]"), "plate.ribs[0].to_m[1]",
       "0.95 is beyond the plate's 0.9 m; allowed: a place on the plate, such as [0.7, 0.45]"},
      {"rib_before_the_plate", changed(kRibbed, "[0, 0.3]", "[-0.1, 0.3]"), "plate.ribs[0].from_m[0]",
       "is out of range; allowed: a number from 0 to 1.4"},
      {"rib_to_one_number", changed(kRibbed, "[1.4, 0.35]", "[1.4]"), "plate.ribs[0].to_m",
       "has one number; allowed: a place on the plate, such as"},
      {"rib_without_length", changed(kRibbed, "[1.4, 0.35]", "[0, 0.3]"), "plate.ribs[0].to_m",
       "is 0 m from from_m; allowed: at least 0.001 m"},
      {"rib_much_stiffer_than_the_plate",
       changed(changed(kRibbed, R"("thickness_m": 0.008)", R"("thickness_m": 1e-4)"), R"(m2": 120)", R"(m2": 1e3)"),
       "plate.ribs[0].bending_stiffness_n_m2",
       "1000 is 2.2e+07 times as much as the plate has; allowed: at most 45.37"},
      {"rib_much_heavier_than_the_plate",
       changed(changed(changed(kRibbed, "0.03", "0"), R"("thickness_m": 0.008)", R"("thickness_m": 1e-6)"),
               R"(kg_m": 0.25)", R"(kg_m": 900)"),
       "plate.ribs[0].mass_per_length_kg_m", "900 is 2.5e+06 times as much as the plate has; allowed: at most 359"},
      {"unknown_in_rib", changed(kRibbed, R"("from_m")", R"("width_m": 1, "from_m")"), "plate.ribs[0].width_m",
       "unknown key; allowed: from_m"},
      {"no_ribs", changed(kPlate, R"("length_m")", R"("ribs": [], "length_m")"), "plate.ribs",
       "has 0 entries; allowed: an array of 1 to 64 objects"},
      {"too_many_modes_with_ribs", changed(kRibbed, R"("max_modes": 20)", R"("max_modes": 401)"), "max_modes",
       "is out of range; allowed: an integer from 1 to 400"},
      {"unknown_in_mode", changed(kModes, R"("decay_per_s")", R"("t60_s": 1, "decay_per_s")"), "modes[0].t60_s",
       "unknown key; allowed: frequency_hz"},
      {"bridge_shape_is_number", changed(kModes, "[0.125, 0.75]", "0.125"), "modes[0].bridge_shapes",
       "is not an array; allowed: an array of 1 to 16 numbers"},
      {"bridge_shape_out_of_range", changed(kModes, "[0.125, 0.75]", "[0.125, 1.1e6]"), "modes[0].bridge_shapes[1]",
       "is out of range; allowed: " + kShape},
      {"other_bridge_shapes", changed(kModes, R"([0.125, 0.75] })", R"([0.125, 0.75] },
      { "frequency_hz": 500, "decay_per_s": 1.5, "mass_kg": 0.02, "strike_shape": 0, "pickup_shape": 0,
        "bridge_shapes": [1] })"),
       "modes[1].bridge_shapes", "has 1 entries; allowed: 2 numbers, as in modes[0]"},
      {"no_bridge_shapes", changed(kModes, R"([0.125, 0.75] })", R"([0.125, 0.75] },
      { "frequency_hz": 500, "decay_per_s": 1.5, "mass_kg": 0.02, "strike_shape": 0, "pickup_shape": 0 })"),
       "modes[1].bridge_shapes", "has 0 entries; allowed: 2 numbers, as in modes[0]"},
      {"angle_on_string", changed(kString, R"("position_m": 0.07)", R"("position_m": 0.07, "angle_rad": 0)"),
       "strike.angle_rad", "unknown key; allowed: position_m"},
      {"no_body", R"({ "name": "probe", "strike": { "position_m": 0 }, "pickup": { "position_m": 0 } })", "string",
       "0 " + kinds},
      {"two_bodies", changed(kBar, R"("name": "probe",)", R"("name": "probe", "modes": [],)"), "string",
       "2 " + kinds},
      {"string_is_array", changed(kString, R"("string": {)", R"("string": [1], "bar": {)"), "string", "2 " + kinds},
      {"bar_is_array", R"({ "name": "probe", "bar": [] })", "bar", "is not an object; allowed: length_m"},
      {"strike_missing", changed(kString, R"("strike": { "position_m": 0.07 },)", ""), "strike",
       "missing; allowed: position_m"},
      {"pickup_missing",
       changed(kBar, R"(,
  "pickup": { "position_m": 0.01 })",
               ""),
       "pickup", "missing; allowed: position_m"},
      {"position_missing", changed(kString, R"("position_m": 0.07)", ""), "strike.position_m",
       "missing; allowed: a number from 0 to 0.6"},
      {"angle_missing", changed(kMembrane, R"(, "angle_rad": 0.1)", ""), "strike.angle_rad",
       "missing; allowed: a number from -7 to 7"},
      {"strike_beside_modes", changed(kModes, R"("name")", R"("strike": {}, "name")"), "strike",
       "cannot be used with modes"},
      {"pickup_beside_modes", changed(kModes, R"("name")", R"("pickup": {}, "name")"), "pickup",
       "cannot be used with modes"},
      {"modes_empty", R"({ "name": "probe", "modes": [] })", "modes",
       "has 0 entries; allowed: an array of 1 to 4096 objects"},
      {"modes_is_object", R"({ "name": "probe", "modes": {} })", "modes",
       "is not an array; allowed: an array of 1 to 4096 objects"},
      {"mode_is_number", R"({ "name": "probe", "modes": [1] })", "modes[0]",
       "is not an object; allowed: frequency_hz"},
      {"detuning_is_number", changed(kString, "[0, 1.5]", "1"), "string.detuning_cents",
       "is not an array; allowed: an array of 1 to 8 numbers"},
      {"detuning_is_empty", changed(kString, "[0, 1.5]", "[]"), "string.detuning_cents", "has 0 entries"},
      {"detuning_is_long", changed(kString, "[0, 1.5]", "[0,0,0,0,0,0,0,0,0]"), "string.detuning_cents",
       "has 9 entries"},
      {"detuning_holds_text", changed(kString, "[0, 1.5]", R"([0, "x"])"), "string.detuning_cents[1]",
       "is not a number; allowed: a number from -1200 to 1200"},
      {"detuning_holds_much", changed(kString, "[0, 1.5]", "[0, 1201]"), "string.detuning_cents[1]",
       "is out of range; allowed: a number from -1200 to 1200"},
      {"truncated", kString.substr(0, kString.size() / 2), "line ", "; allowed: "},
      {"trailing_garbage", kBar + "x", "line ", "; allowed: "}};
  for (const auto& [body, text, members] :
       std::vector<std::tuple<std::string, std::string, std::vector<std::string>>>{
           {"string.",
            kString,
            {R"("length_m": 0.6, )", R"("mass_kg": 0.004, )", R"("tension_n": 670, )",
             R"("bending_stiffness_n_m2": 0.01,)", R"("constant_loss_per_s": 0.5, )",
             R"("quadratic_loss_m2_per_s": 0.0001, )"}},
           {"bar.", kBar, {R"("length_m": 0.33, )", R"("mass_kg": 0.3, )", R"("constant_loss_per_s": 2.5, )"}},
           {"membrane.",
            kMembrane,
            {R"("radius_m": 0.165, )", R"("mass_per_area_kg_m2": 0.35, )", R"("constant_loss_per_s": 6, )"}},
           {"plate.",
            kPlate,
            {R"("width_m": 0.9, )", R"("thickness_m": 0.008, )", R"("density_kg_m3": 400,)",
             R"("youngs_modulus_pa": 11e9, )", R"("poisson_ratio": 0.4,)", R"("constant_loss_per_s": 7, )"}},
           {"modes[0].",
            kModes,
            {R"("frequency_hz": 440, )", R"("decay_per_s": 1.5, )", R"("mass_kg": 0.01, )",
             R"("strike_shape": 0.9, )"}}})
    for (const std::string& member : members) {
      const std::string name = member.substr(1, member.find('"', 1) - 1);
      cases.push_back({name + "_missing_in_" + body.substr(0, body.find_first_of(".[")), changed(text, member, ""),
                       body + name, "missing; allowed: a number from"});
    }
  return cases;
}

CONTACTSPLINE_REFUSED_BY_GENERATE(BadResonatorFile);
CONTACTSPLINE_CASES(Number, BadResonatorFile, all_number_cases());
CONTACTSPLINE_CASES(Key, BadResonatorFile, key_cases());

// 1e10 overdamped modes below half the rate, none of which sounds: refused at once.
TEST(BadResonator, WhoseModesAreAllOverdampedIsRefused) {
  const Sandbox box;
  std::string text = changed(changed(kMembrane, "0.165", "100"), "0.35", "1e4");
  text = changed(changed(text, "1500", "0.001"), R"("constant_loss_per_s": 6)", R"("constant_loss_per_s": 1e6)");
  write_file(box / "probe.json", text);
  for (const std::string command : {"generate", "inspect"})
    expect_refused(run({.arguments = {command, "probe.json"}, .folder = box.path()}), "probe: ", "no mode");
  EXPECT_EQ(std::distance(fs::directory_iterator(box.path()), {}), 1);
}

// What the tables above are made of is good itself.
TEST(GoodResonatorFile, IsAccepted) {
  for (const std::string& text : {kString, kBar, kMembrane, kPlate, kModes}) {
    const Sandbox box;
    write_file(box / "probe.json", text);
    EXPECT_EQ(run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()}).exit_code, 0) << text;
    EXPECT_EQ(std::distance(fs::directory_iterator(box / "out"), {}), 3) << text;
  }
}

}  // namespace
}  // namespace contactspline::testing
