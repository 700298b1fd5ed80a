// SPDX-License-Identifier: MIT
// Friction files: what ships, `inspect`, instruments that name them, and all the errors that they can have.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "bad_input.hpp"
#include "cases.hpp"
#include "contactspline/data/friction_materials.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/material/friction_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/compare.hpp"
#include "svg.hpp"

namespace contactspline::testing {
namespace {

const std::string kRosinLike = R"({
  "name": "probe",
  "bristles": { "stiffness_per_m": 2e6, "damping_s_per_m": 0.25 },
  "heat": { "cold_coefficient": 0.8, "hot_coefficient": 0.1, "softening_k": 20, "capacity_j_per_n_k": 3e-6,
            "conduction_w_per_n_k": 2e-4, "renewal_w_per_m_k2": 0.05 },
  "width_m": 0.012
})";
const std::string kSkin = R"({ "name": "probe", "bristles": { "stiffness_per_m": 3000 }, "coefficient": 0.4 })";
const Bases kBases = {{"", kRosinLike}, {"rosin", kRosinLike}, {"skin", kSkin}};

RubbingSurfaces shipped_friction(const std::string& name) {
  return parse_friction(find_embedded(Shipped::kFrictions, name + ".json")->content, name);
}

class BadFrictionFile : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadFrictionFile, IsRefusedInOneLineAndNothingIsWritten) {
  const Sandbox box;
  write_file(box / "probe.json", GetParam().text);
  expect_refused(run({.arguments = {"inspect", "probe.json", "--figure", "probe.svg"}, .folder = box.path()}),
                 "probe.json: " + GetParam().key, GetParam().says);
  EXPECT_FALSE(fs::exists(box / "probe.svg"));
}

CONTACTSPLINE_CASES(Number, BadFrictionFile, bad_numbers("friction", "Number", kBases));
CONTACTSPLINE_CASES(Key, BadFrictionFile, bad_files("friction", "Key", kBases));

// What the runtime has under the same name.
TEST(FrictionFile, OfRosinIsThatOfTheRuntime) {
  const RubbingSurfaces rosin = shipped_friction("rosin");
  const auto& [bristles, heat] = rosin.friction;
  EXPECT_EQ(bristles.stiffness_per_m, kRosin.bristles.stiffness_per_m);
  EXPECT_EQ(bristles.damping_s_per_m, kRosin.bristles.damping_s_per_m);
  EXPECT_EQ(heat.cold_coefficient, kRosin.heat.cold_coefficient);
  EXPECT_EQ(heat.hot_coefficient, kRosin.heat.hot_coefficient);
  EXPECT_EQ(heat.softening_k, kRosin.heat.softening_k);
  EXPECT_EQ(heat.capacity_j_per_n_k, kRosin.heat.capacity_j_per_n_k);
  EXPECT_EQ(heat.conduction_w_per_n_k, kRosin.heat.conduction_w_per_n_k);
  EXPECT_DOUBLE_EQ(heat.renewal_w_per_m_k2, kRosin.heat.renewal_w_per_m_k2);
  EXPECT_EQ(rosin.width_m, 0.01);
}

// The rows of the table are where the runtime's friction settles: the temperature, step by step, until it stays.
TEST(FrictionFile, IsInspectedWithTheCoefficientsAtWhichItSlides) {
  const Sandbox box;
  write_file(box / "probe.json", kRosinLike);
  const std::string page = printed(box, {"inspect", "probe.json"});
  EXPECT_NE(page.find("bristles 2e+06 1/m and 0.25 s/m"), std::string::npos) << page;
  const RubbingSurfaces surfaces = parse_friction(kRosinLike, "probe");
  std::istringstream rows(page.substr(page.find("10 N") + 4));
  int count = 0;
  for (double speed = 0; rows >> speed; ++count)
    for (const double force : {0.1, 1.0, 10.0}) {
      double coefficient = 0, temperature = 0;
      ASSERT_TRUE(rows >> coefficient >> temperature);
      constexpr double kRate = 48000;
      FrictionTemperature<double> runtime(surfaces.friction.heat, surfaces.width_m, kRate);
      for (int n = 0; n < 48000; ++n)
        runtime.advance(force, speed / kRate, runtime.coefficient() * force * speed / kRate);
      EXPECT_TRUE(within(coefficient, runtime.coefficient(), 6e-5)) << speed << " m/s, " << force << " N";
      EXPECT_TRUE(within(temperature, runtime.temperature(), 6e-2)) << speed << " m/s, " << force << " N";
    }
  EXPECT_EQ(count, 6);
}

TEST(FrictionFile, IsInspectedAsJson) {
  const auto rosin = nlohmann::json::parse(succeed({.arguments = {"inspect", "rosin", "--json"}}));
  EXPECT_EQ(rosin.at("renewal_w_per_m_k2"), kRosin.heat.renewal_w_per_m_k2);
  const auto finger = nlohmann::json::parse(succeed({.arguments = {"inspect", "dry_finger", "--json"}}));
  EXPECT_EQ(finger.at("coefficient"), 0.5);
  EXPECT_EQ(finger.at("stiffness_per_m"), 2000);
}

TEST(FrictionFile, IsDrawn) {
  const Sandbox box;
  for (const std::string name : {"rosin", "dry_finger"}) {
    printed(box, {"inspect", name, "--figure", name + ".svg"});
    expect_drawn(box / (name + ".svg"), name == "rosin" ? 10 : 2);
    EXPECT_EQ(columns_of(box / (name + ".svg")).size(), 1u);
  }
}

TEST(FrictionFile, IsNotWhatGenerateTakes) {
  const Sandbox box;
  write_file(box / "probe.json", kSkin);
  for (const std::string name : {"probe.json", "rosin"})
    expect_refused(run({.arguments = {"generate", name}, .folder = box.path()}), name + ": ",
                   "is a friction; allowed: ");
  for (const std::string option : {"--compare", "--rate=48000"})
    expect_refused(run({.arguments = {"inspect", "rosin", option}, .folder = box.path()}), "rosin: --",
                   "cannot be used with a friction");
}

// A file beside the instrument, an object in it, and what ships.
TEST(FrictionFile, IsNamedByAnInstrument) {
  const auto friction_of = [](const std::string& material) {
    const std::string text = R"({ "name": "rod", "bodies": [ { "name": "rod", "modes": [
      { "frequency_hz": 440, "decay_per_s": 5, "mass_kg": 0.01 } ] } ],
      "places": [ { "name": "spot", "body": "rod", "shapes": [1] } ],
      "frictions": [ { "name": "rub", "between": ["ground", "spot"], "material": )" +
                             material + R"( } ], "outputs": [ { "name": "rod", "velocity_m_per_s": "spot" } ] })";
    const InstrumentModel model = parse_instrument(text, "rod.json", [](const std::string&) { return kRosinLike; });
    return model.connections.front().each.friction;
  };
  for (const std::string& material : {std::string("\"own.json\""), kRosinLike}) {
    const InstrumentFriction own = friction_of(material);
    EXPECT_EQ(own.material.bristles.damping_s_per_m, 0.25);
    EXPECT_EQ(own.material.heat.softening_k, 20);
    EXPECT_EQ(own.width_m, 0.012);
  }
  const InstrumentFriction finger = friction_of("\"dry_finger\"");
  EXPECT_EQ(finger.material.heat.cold_coefficient, 0.5);
  EXPECT_EQ(finger.material.heat.hot_coefficient, 0.5);
  EXPECT_EQ(finger.material.bristles.damping_s_per_m, 2);
}

}  // namespace
}  // namespace contactspline::testing
