// SPDX-License-Identifier: MIT
// Strikes on masses that are joined to others, and connections that have nothing to move.
#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/error.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

// A hammer of two masses under a wall; `joint` joins them.
InstrumentArrays hammer_of_two(const std::string& joint) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "head", "mass_kg": 0.006 }, { "name": "shank", "mass_kg": 0.004 } ],
    "contacts": [ { "name": "wall", "between": ["head", "ground"], "material": "felt_c4", "gap_m": 0.004 }
    )" + joint + R"(,
    "strikes": ["head"],
    "outputs": [ { "name": "wall", "force_n": "wall" }, { "name": "head", "displacement_m": "head" } ]
  })",
                                                 "probe.json");
  return arrays_of(model, kRate / 2);
}

// Each blow at 2 m/s reaches the wall after 2 ms and brings in at most the kinetic energy of both masses.
class JoinedMasses : public ::testing::TestWithParam<const char*> {};

TEST_P(JoinedMasses, AreThrownOrPutBackTogether) {
  const InstrumentArrays arrays = hammer_of_two(GetParam());
  BySample<double> instrument(arrays.view(), kRate);
  for (int blow = 0; blow < 3; ++blow) {
    instrument.strike(0, 2);
    double strongest = 0;
    for (int n = 0; n < 5 * 44100; ++n) {
      instrument.tick();
      if (n == 0) {
        EXPECT_LE(instrument.work(), 0.021) << "blow " << blow;
      }
      if (n < 441) strongest = std::max(strongest, instrument.output(0));
    }
    EXPECT_GT(strongest, 5) << "blow " << blow;
  }
}

INSTANTIATE_TEST_SUITE_P(
    , JoinedMasses,
    ::testing::Values(
        R"(], "links": [ { "name": "joint", "between": ["head", "shank"] } ])",
        R"(], "springs": [ { "name": "joint", "between": ["head", "shank"], "stiffness_n_per_m": 1e4 } ])",
        R"(, { "name": "joint", "between": ["shank", "head"], "material": "felt_c4" } ])"));

// A thrown mass that nothing holds flies 10 m and stops.
TEST(ThrownMass, StopsFarAway) {
  const InstrumentArrays arrays = hammer_of_two("]");
  BySample<double> instrument(arrays.view(), kRate);
  instrument.strike(0, -2);
  for (int n = 0; n < 6 * 44100; ++n) instrument.tick();
  EXPECT_TRUE(within(instrument.output(1), -10, 1e-3));
  EXPECT_EQ(instrument.energy(), 0);
}

// A strike that would begin inside a displaced mass begins where the two touch.
TEST(ThrownMass, BeginsOutsideOfWhatStandsInTheWay) {
  const InstrumentModel model = parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "head", "mass_kg": 0.006 }, { "name": "plate", "mass_kg": 0.1 } ],
    "springs": [ { "name": "rest", "between": ["plate", "ground"], "stiffness_n_per_m": 1e3 } ],
    "contacts": [ { "name": "felt", "between": ["head", "plate"], "material": "steel_on_steel", "gap_m": 0.001 } ],
    "controls": [ { "name": "hand", "force_n": "plate" } ],
    "strikes": ["head"],
    "outputs": [ { "name": "felt", "force_n": "felt" } ]
  })",
                                                 "probe.json");
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  BySample<double> instrument(arrays.view(), kRate);
  instrument.strike(0, -1);
  for (int n = 0; n < 441; ++n) instrument.tick();
  instrument.set(0, -20);  // 20 mm towards the head
  for (int n = 0; n < 1000; ++n) instrument.tick();
  instrument.set(0, 0);
  instrument.strike(0, 1);
  instrument.tick();
  EXPECT_LT(instrument.work(), 0.02);
}

// The line with which a file is refused, or nothing.
std::string refusal_of(const std::string& bodies, const std::string& places, const std::string& place) {
  try {
    (void)parse_instrument(R"({ "name": "probe", "bodies": [ )" + bodies + R"( ], "places": [ )" + places + R"( ],
      "links": [ { "name": "link", "between": [")" +
                               place + R"(", "ground"] } ],
      "outputs": [ { "name": "out", "force_n": "link" } ] })",
                           "probe.json");
  } catch (const BadInput& refused) {
    return refused.what();
  }
  return {};
}

constexpr auto kString = R"({ "name": "s", "resonator": "guitar_b3" })";

TEST(Connections, AreRefusedWhereNoModeMoves) {
  EXPECT_EQ(refusal_of(kString, R"({ "name": "p", "body": "s", "position_m": 0.1 })", "p"), "");
  const std::string refusal = refusal_of(kString, R"({ "name": "p", "body": "s", "position_m": 0 })", "p");
  EXPECT_NE(refusal.find("no mode moves at place 'p'"), refusal.npos) << refusal;
}

TEST(Connections, AreRefusedWhereAlmostNothingIsMoved) {
  const auto table = [](const char* shape) {
    return std::string(R"({ "name": "p", "body": "s", "shapes": [)") + shape + "] }";
  };
  constexpr auto kLight =
      R"({ "name": "s", "modes": [ { "frequency_hz": 100, "decay_per_s": 1, "mass_kg": 1e-9 } ] })";
  EXPECT_EQ(refusal_of(kLight, table("1"), "p"), "");
  const std::string refusal = refusal_of(kLight, table("1e4"), "p");
  EXPECT_NE(refusal.find("moves like a mass of 1e-17 kg"), refusal.npos) << refusal;
  EXPECT_NE(refusal.find("at least 1e-09 kg"), refusal.npos) << refusal;
}

}  // namespace
}  // namespace contactspline::testing
