// SPDX-License-Identifier: MIT
// A keyboard whose ears are in the room, against an instrument of a file that has the same plate, places and ears,
// and is driven by the forces that the keyboard's strings had on it. pressure_test holds that instrument beside a
// direct integration.
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "contactspline/instrument/keyboard_instrument.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/player/instrument_parts.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

const std::string kPlate = R"("plate": { "length_m": 1.1, "width_m": 0.7, "thickness_m": 0.009, "density_kg_m3": 392,
  "youngs_modulus_pa": 11.5e9, "youngs_modulus_across_pa": 2e9, "shear_modulus_pa": 1e9, "poisson_ratio": 0.3,
  "constant_loss_per_s": 8, "quadratic_loss_m2_per_s": 0.2,
  "ribs": [ { "from_m": [0.3, 0], "to_m": [0.4, 0.7], "mass_per_length_kg_m": 0.2, "bending_stiffness_n_m2": 200 } ] },
  "max_modes": 120)";
const std::string kEars = R"({ "distance_m": 1.2, "angle_rad": 0.7, "around_rad": 1.1, "side_m": -0.09 },
  { "distance_m": 1.4, "angle_rad": 0.7, "around_rad": 1.1, "side_m": 0.09 })";
const std::string kNotes = R"([ { "key": 40, "length_m": 1.2, "mass_kg": 0.01, "bending_stiffness_n_m2": 0.01,
    "strike_position_m": 0.15, "constant_loss_per_s": 0.3, "quadratic_loss_m2_per_s": 1e-4, "hammer_mass_kg": 0.009,
    "stiffness_n_per_m_alpha": 4e9, "exponent": 2.5 },
  { "key": 80, "length_m": 0.2, "mass_kg": 0.001, "bending_stiffness_n_m2": 0.006,
    "strike_position_m": 0.02, "constant_loss_per_s": 0.3, "quadratic_loss_m2_per_s": 1e-4, "hammer_mass_kg": 0.006,
    "stiffness_n_per_m_alpha": 2e10, "exponent": 2.8 } ])";

std::string keyboard_text(const std::string& of_body) {
  return R"({ "name": "heard", "keyboard": { "first_key": 40, "last_key": 80, "first_double_key": 50,
    "first_triple_key": 60, "last_damped_key": 80, "concert_pitch_hz": 440, "min_speed_m_per_s": 0.2,
    "max_speed_m_per_s": 6, "felt_loss_s_per_m": 0.1, "damper_per_s": 60, "damper_time_s": 0.005, "segments": 24,
    "body": { "resonator": "board.json", "double_hz": [-0.1, 0.1], "triple_hz": [-0.1, 0, 0.1],
      "una_corda_stiffness_ratio": 0.5, )" +
         of_body + R"( }, "notes": )" + kNotes + " } }";
}

/// The keyboard of a text, with its body beside it.
class Heard {
 public:
  explicit Heard(const std::string& of_body) : keyboard_(made(keyboard_text(of_body)), kRate) {}

  PedaledKeyboard<double>* operator->() { return &keyboard_; }

 private:
  static std::shared_ptr<const KeyboardParts> made(const std::string& text) {
    const ReadFile read = [=](const std::string& name) {
      return name == "board.json" ? R"({ "name": "board", )" + kPlate +
                                        R"(, "strike": { "position_m": 0.5, "across_m": 0.31 },
                                            "pickup": { "position_m": 0.3, "across_m": 0.2 } })"
                                  : text;
    };
    std::string events;
    for (int key = 40; key <= 80; ++key)
      events += R"({ "time_s": 0, "key": )" + std::to_string(key) +
                (key < 80 ? R"(, "hold_s": 0 }, )" : R"(, "hold_s": 0 })");
    return std::make_shared<const KeyboardParts>(
        keyboard_parts(parse_keyboard(text, "heard.json"),
                       std::make_shared<const Score>(parse_score(
                           R"({ "instrument": "heard.json", "duration_s": 1, "events": [ )" + events + " ] }",
                           "score.json", read))));
  }

  PedaledKeyboard<double> keyboard_;
};

// The same plate and ears, with a control of the force at each place.
InstrumentModel driven_plate(const std::vector<std::array<double, 2>>& places) {
  std::string all_places, controls;
  for (std::size_t p = 0; p < places.size(); ++p) {
    const std::string name = "\"place_" + std::to_string(p) + "\"", comma = p == 0 ? "" : ", ";
    all_places += comma + R"({ "name": )" + name + R"(, "body": "body", "position_m": )" +
                  std::to_string(places[p][0]) + R"(, "across_m": )" + std::to_string(places[p][1]) + " }";
    controls += comma + R"({ "name": )" + name + R"(, "force_n": )" + name + " }";
  }
  const std::size_t second = kEars.find("},") + 3;
  const auto output = [&](const std::string& name, std::string ear) {
    return R"({ "name": ")" + name + R"(", "pressure_pa": "body", )" + ear.substr(ear.find('{') + 1);
  };
  return parse_instrument(R"({ "name": "driven", "bodies": [ { "name": "body", )" + kPlate + R"( } ], "places": [ )" +
                              all_places + R"( ], "controls": [ )" + controls + R"( ], "outputs": [ )" +
                              output("left", kEars.substr(0, second - 2)) + ", " +
                              output("right", kEars.substr(second)) + " ] }",
                          "driven.json");
}

// Plays three keys, with a pedal, sample by sample.
void expect_heard(const std::string& of_body, const std::vector<std::array<double, 2>>& places) {
  Heard keyboard(of_body);
  const InstrumentArrays arrays = arrays_of(driven_plate(places), kRate / 2);
  BySample<double> plate(arrays.view(), kRate);
  ASSERT_EQ(keyboard->body().places(), places.size());
  double largest = 0, error = 0;
  for (int n = 0; n < 13230; ++n) {
    if (n == 10) keyboard->strike(2, 3), keyboard->strike(38, 2);
    if (n == 3000) keyboard->set(KeyboardParameter::kSustain, 1), keyboard->strike(20, 2.5);
    if (n == 6000) keyboard->release(2);
    std::array<double, 1> left, right;
    keyboard->process(left, right);
    for (std::size_t p = 0; p < places.size(); ++p) plate.set(p, keyboard->body().force(p));
    plate.tick();
    largest = std::max({largest, std::abs(plate.output(0)), std::abs(plate.output(1))});
    error = std::max({error, std::abs(left[0] - plate.output(0)), std::abs(right[0] - plate.output(1))});
    ASSERT_TRUE(is_finite(left[0]) && is_finite(right[0]));
  }
  Measured() << error / largest << " of " << largest << " Pa";
  EXPECT_GT(largest, 0.01);
  // Numbers of the file are rounded to 13 digits, and a mode of 5 kHz turns by 1e4 rad in 0.3 s.
  EXPECT_LT(error, 1e-8 * largest);
}

TEST(KeyboardEars, HearOnePlaceAsAnInstrumentOfAFileDoes) {
  expect_heard(R"("ears": [ )" + kEars + " ]", {{0.5, 0.31}});
}

TEST(KeyboardEars, HearEachPlaceOfTheBridge) {
  expect_heard(R"("ears": [ )" + kEars + R"( ], "bridge_places": [
    { "first_key": 40, "position_m": 0.9, "across_m": 0.2 }, { "first_key": 55, "position_m": 0.62, "across_m": 0.4 },
    { "first_key": 70, "position_m": 0.2, "across_m": 0.33 } ])",
               {{0.9, 0.2}, {0.62, 0.4}, {0.2, 0.33}});
}

TEST(KeyboardEars, HearNothingAfterReset) {
  Heard keyboard(R"("ears": [ )" + kEars + " ]");
  std::array<double, 64> left, right;
  keyboard->strike(20, 3);
  for (int block = 0; block < 20; ++block) keyboard->process(left, right);
  EXPECT_NE(left.back(), 0);
  keyboard->reset();
  keyboard->process(left, right);
  for (std::size_t n = 0; n < left.size(); ++n) EXPECT_TRUE(left[n] == 0 && right[n] == 0) << n;
}

TEST(KeyboardEars, ArePressures) {
  Heard keyboard(R"("ears": [ )" + kEars + " ]"), at_the_wood(R"("pickup_ratio": 1)");
  EXPECT_STREQ(keyboard->outputs()[1].name, "right_pressure_pa");
  EXPECT_STREQ(keyboard->outputs()[1].unit, "Pa");
  EXPECT_STREQ(at_the_wood->outputs()[0].name, "left_velocity_m_per_s");
}

}  // namespace
}  // namespace contactspline::testing
