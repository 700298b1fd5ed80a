// SPDX-License-Identifier: MIT
// Points of a string that one control moves together: a bow as wide as its hair.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "generator/instrument/instrument_reader.hpp"
#include "support/compare.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

// A string under a bow and a finger that rubs. Controls: speed and place of the bow, and its force, which without
// control is `pressed`.
std::string bowed(const std::string& positions, const std::string& pressed, const std::string& tip_gap_m) {
  const std::string control =
      pressed.empty() ? R"({ "name": "bow", "normal_force_n": "bow", "initial": 0.3, "max": 3 },)" : "";
  return R"({ "name": "probe",
    "bodies": [ { "name": "string", "string": { "length_m": 0.325, "mass_kg": 0.0004, "tension_n": 48,
                  "bending_stiffness_n_m2": 5e-5, "constant_loss_per_s": 2, "quadratic_loss_m2_per_s": 0.002 },
                  "max_modes": 40 } ],
    "places": [ { "name": "bowed", "body": "string", )" +
         positions + R"( } ],
    "contacts": [ { "name": "tip", "between": ["ground", "bowed"], "material": "rubber_on_wood", "gap_m": )" +
         tip_gap_m + R"( } ],
    "frictions": [ { "name": "bow", "between": ["ground", "bowed"], "material": "rosin", "width_m": 0.008)" +
         pressed + R"( },
                   { "name": "rub", "between": ["ground", "bowed"], "coefficient": 0.3, "pressed_by": "tip" } ],
    "controls": [ )" +
         control + R"(
                  { "name": "bow", "surface_speed_m_per_s": "bow", "initial": 0.2 },
                  { "name": "bow", "place_m": "bowed" } ],
    "outputs": [ { "name": "string", "end_force_n": "string" }, { "name": "bow", "force_n": "bow" } ] })";
}

struct Probe {
  explicit Probe(const std::string& positions, const std::string& pressed = "", const std::string& tip_gap_m = "1e-5")
      : arrays(arrays_of(parse_instrument(bowed(positions, pressed, tip_gap_m), "probe.json"), kRate / 2)),
        instrument(arrays.view(), kRate) {}

  std::vector<double> played(std::size_t output, int samples) {
    std::vector<double> sound;
    for (int n = 0; n < samples; ++n) {
      instrument.tick();
      sound.push_back(instrument.output(output));
    }
    return sound;
  }

  InstrumentArrays arrays;
  SeenNetwork<double> instrument;
};

// Points of friction at one place share force, width and heat, so they are one point. A contact of four points is
// four times as stiff as one, so nothing touches here.
TEST(PointsTogether, AtOnePlaceAreOnePoint) {
  const std::string together = R"("positions_m": [0.286, 0.286, 0.286, 0.286])";
  for (const std::string pressed : {"", R"(, "normal_force_n": 0.3)"})
    for (const std::size_t output : {0, 1}) {
      Probe one(R"("position_m": 0.286)", pressed, "0.05"), four(together, pressed, "0.05");
      const std::vector<double> expected = one.played(output, 300), found = four.played(output, 300);
      double largest = 0;
      for (const double value : expected) largest = std::max(largest, std::abs(value));
      EXPECT_GT(largest, 0.1);
      EXPECT_TRUE(
          sequences_within(std::span<const double>(found), std::span<const double>(expected), 1e-10 * largest));
    }
}

// The control is their middle, and ends where one of them meets an end of the string.
TEST(PointsTogether, KeepTheirDistances) {
  Probe probe(R"("positions_m": [0.28, 0.285, 0.293])");
  const Parameter& place = probe.arrays.parameters[2];
  EXPECT_TRUE(within(place.initial, 0.286, 1e-15));
  EXPECT_TRUE(within(place.allowed.min, 0.006, 1e-15));
  EXPECT_TRUE(within(place.allowed.max, 0.325 - 0.007, 1e-15));
  const auto& network = probe.instrument;
  double balance = probe.instrument.energy(), largest = 0;
  for (int n = 0; n < 22050; ++n) {
    if (n == 4410) probe.instrument.set(2, 0.1);
    if (n == 8820) probe.instrument.set(2, 1);
    probe.instrument.tick();
    balance += probe.instrument.work() - probe.instrument.dissipated();
    largest = std::max(largest, probe.instrument.energy());
    ASSERT_TRUE(within(network.place_m(1) - network.place_m(0), 0.005, 1e-12)) << n;
    ASSERT_TRUE(within(network.place_m(2) - network.place_m(1), 0.008, 1e-12)) << n;
    if (n == 8819) {
      EXPECT_TRUE(within(network.place_m(1), 0.1 - 0.001, 1e-12));
    }
  }
  EXPECT_TRUE(within(network.place_m(2), 0.325, 1e-12));
  EXPECT_GT(largest, 1e-6);
  EXPECT_TRUE(within(probe.instrument.energy(), balance, 1e-11 * largest));
}

// Under friction that is lifted they wait, and are where their control is in the sample in which it is pressed.
TEST(PointsTogether, ArePutWhereTheyArePressed) {
  std::string text = bowed(R"("positions_m": [0.28, 0.285, 0.293])", "", "0");
  const auto erase = [&](const std::string& from, const std::string& to) {
    const std::size_t begin = text.find(from);
    text.erase(begin, text.find(to, begin) - begin);
  };
  erase(R"("contacts")", R"("frictions")");
  erase(R"(,
                   { "name": "rub")",
        " ],\n    \"controls\"");
  const InstrumentArrays arrays = arrays_of(parse_instrument(text, "probe.json"), kRate / 2);
  SeenNetwork<double> instrument(arrays.view(), kRate);
  double balance = instrument.energy(), largest = 0;
  const auto play = [&](int samples) {
    for (int n = 0; n < samples; ++n) {
      instrument.tick();
      balance += instrument.work() - instrument.dissipated();
      largest = std::max(largest, instrument.energy());
    }
  };
  play(4410);
  instrument.set(0, 0);
  play(1);  // the bristles let go
  instrument.set(2, 0.2);
  play(100);
  EXPECT_TRUE(within(instrument.place_m(1), 0.285, 1e-12));
  instrument.set(0, 0.3);
  play(1);
  EXPECT_TRUE(within(instrument.place_m(1), 0.2 - 0.001, 1e-12));
  play(4410);
  EXPECT_GT(largest, 1e-6);
  EXPECT_TRUE(within(instrument.energy(), balance, 1e-11 * largest));
}

// Each point of a friction is pressed by its point of the contact.
TEST(PointsTogether, ArePressedPointByPoint) {
  const Probe probe(R"("positions_m": [0.28, 0.285, 0.293])");
  const auto& connections = probe.arrays.connections;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(connections[6 + i].friction.pressed_by, i);
}

}  // namespace
}  // namespace contactspline::testing
