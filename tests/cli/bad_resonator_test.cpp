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
const std::string kRound = R"({
  "name": "probe",
  "round_plate": {
    "radius_m": 0.15, "thickness_m": 0.0012, "density_kg_m3": 8700, "youngs_modulus_pa": 1.1e11, "poisson_ratio": 0.34,
    "constant_loss_per_s": 1.4, "quadratic_loss_m2_per_s": 0.0002
  },
  "strike": { "position_m": 0.02, "angle_rad": 0 },
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

const Bases kBases = {{"string", kString}, {"bar", kBar},     {"membrane", kMembrane}, {"round", kRound},
                      {"plate", kPlate},   {"ribs", kRibbed}, {"modes", kModes}};

std::vector<BadFile> cut_cases() {
  return {{"truncated", kString.substr(0, kString.size() / 2), "line ", "; allowed: "}};
}

CONTACTSPLINE_REFUSED_BY_GENERATE(BadResonatorFile);
CONTACTSPLINE_CASES(Number, BadResonatorFile, bad_numbers("resonator", "Number", kBases));
CONTACTSPLINE_CASES(Key, BadResonatorFile, bad_files("resonator", "Key", kBases));
CONTACTSPLINE_CASES(Cut, BadResonatorFile, cut_cases());

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
  for (const std::string& text : {kString, kBar, kMembrane, kRound, kPlate, kModes}) {
    const Sandbox box;
    write_file(box / "probe.json", text);
    EXPECT_EQ(run({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()}).exit_code, 0) << text;
    EXPECT_EQ(std::distance(fs::directory_iterator(box / "out"), {}), 3) << text;
  }
}

}  // namespace
}  // namespace contactspline::testing
