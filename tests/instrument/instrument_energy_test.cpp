// SPDX-License-Identifier: MIT
// The energy balance of each instrument that ships, over its score: work of hands, pushes and strikes included.
#include <cstdlib>

#include "generator/player/instrument_parts.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/player/voice_tracks.hpp"
#include "generator/support/embedded_files.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/one_voice.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

class ShippedInstrument : public ::testing::TestWithParam<std::string> {};

struct Balance {
  double peak_j, error_j;
  double rounding_j = 0;    ///< of friction: eps times the sum of |f| (|xf| + xi |f|), as in friction_network_test
  std::size_t solved = 0;   ///< samples with coupled contacts or springs
  std::size_t steps = 0;    ///< steps of the solver in all samples
  int largest_steps = 0;    ///< most steps in one sample
  std::size_t bounded = 0;  ///< samples that took the bounding law
};

// The largest energy, the largest difference between the energy and what went in and out, and what the solver did.
Balance balance_of(const Voice& voice, double rate, double duration_s) {
  const InstrumentArrays arrays = instrument_arrays(*voice.model, rate);
  SeenNetwork<double> instrument(arrays.view(), rate);
  ControlTrack controls(voice, rate);
  StrikeTrack strikes(voice.strikes, rate);
  NoteTrack notes(voice.notes, rate);
  const double begin = instrument.energy();
  double received = 0;
  Balance balance{0, 0};
  for (std::size_t n = 0; static_cast<double>(n) < duration_s * rate; ++n) {
    const auto values = controls.at(n);
    for (std::size_t i = 0; i < values.size(); ++i) instrument.set(i, values[i]);
    while (const auto* change = strikes.next_until(n))
      instrument.strike(change->strike->strike, change->strike->speed_m_per_s);
    while (const auto* change = notes.next_until(n))
      EXPECT_TRUE(play_note(instrument, *change)) << change->strike->key;
    instrument.tick();
    received += instrument.work() - instrument.dissipated();
    const double energy = instrument.energy();
    balance.peak_j = std::max(balance.peak_j, energy);
    const double error = std::abs(energy - begin - received);
    if (!(error <= balance.error_j)) balance.error_j = error;
    for (std::size_t k = 0; k < arrays.connections.size(); ++k)
      if (arrays.connections[k].kind == ConnectionKind::kFriction) balance.rounding_j += instrument.rounding_j(k);
    const int steps = instrument.steps();
    balance.solved += steps > 0;
    balance.steps += static_cast<std::size_t>(steps);
    balance.largest_steps = std::max(balance.largest_steps, steps);
  }
  balance.bounded = instrument.bounded();
  return balance;
}

// 3 s at two rates, or 10 s at four of them. Each sample's forces are right to some roundings of 1e-16, which add up.
// A bow does much more work than its string stores: its bound is that of friction_network_test.
TEST_P(ShippedInstrument, KeepsItsEnergyToRounding) {
  const bool is_full = std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr;
  const auto rates = is_full ? std::vector<double>{22050, 44100, 96000, 192000} : std::vector<double>{44100, 96000};
  const auto* file = find_embedded(Shipped::kScores, GetParam() + ".json");
  ASSERT_NE(file, nullptr);
  const Score score = parse_score(file->content, file->name, shipped_file);
  for (const double rate : rates)
    for (const Voice& voice : score.voices) {
      const Balance balance = balance_of(voice, rate, is_full ? score.duration_s : 3);
      EXPECT_GT(balance.peak_j, 1e-4) << voice.name;
      EXPECT_TRUE(within(balance.error_j, 0, 1e-12 * balance.peak_j + 8 * balance.rounding_j))
          << voice.name << " at " << rate << " Hz";
      EXPECT_EQ(balance.bounded, 0U) << voice.name << ": no sample may need more than the largest number of steps";
      Measured() << voice.name << " at " << rate << " Hz: " << balance.error_j / balance.peak_j << " of the peak; "
                 << static_cast<double>(balance.steps) / static_cast<double>(std::max<std::size_t>(balance.solved, 1))
                 << " steps on average, " << balance.largest_steps << " at most";
    }
}

// A drum head and a string that stretch: a hammer, a string that is pulled at rest, a contact between the two, keys
// that tune, a damper that falls. At rest nothing moves.
constexpr auto kStretching = R"({
  "name": "probe",
  "bodies": [
    { "name": "head", "membrane": { "radius_m": 0.15, "mass_per_area_kg_m2": 0.35, "tension_n_per_m": 900,
                                    "constant_loss_per_s": 4, "quadratic_loss_m2_per_s": 6e-4 },
      "stretch": { "youngs_modulus_pa": 4.9e9, "thickness_m": 2.5e-4, "poisson_ratio": 0.38 }, "max_modes": 40 },
    { "name": "string", "resonator": "guitar_e2", "max_modes": 40,
      "stretch": { "youngs_modulus_pa": 2e11, "core_diameter_m": 4e-4 } },
    { "name": "hammer", "mass_kg": 0.01 } ],
  "places": [ { "name": "struck", "body": "string", "position_m": 0.1 },
              { "name": "held", "body": "string", "position_m": 0.4 },
              { "name": "over", "body": "string", "position_m": 0.3 },
              { "name": "under", "body": "head", "position_m": 0.03 } ],
  "contacts": [ { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4", "gap_m": 0.004 },
                { "name": "rattle", "between": ["under", "over"], "material": "rubber_on_wood", "gap_m": 0.0002 } ],
  "springs": [ { "name": "hook", "between": ["held", "ground"], "stiffness_n_per_m": 300, "gap_m": 0.001 } ],
  "strikes": ["hammer"],
  "keys": [ { "first": 36, "last": 48, "event": "strike_hammer", "tuned_key": 40 } ],
  "damper": { "bodies": ["string"], "damping_per_s": 60 },
  "polyphony": 1,
  "outputs": [ { "name": "string", "end_force_n": "string" } ]
})";

TEST(StretchingInstrument, KeepsItsEnergyToRounding) {
  const Score score = parse_score(
      R"({ "instrument": "probe.json", "duration_s": 2, "events": [
           { "time_s": 0.2, "hammer_speed_m_per_s": 6 },
           { "time_s": 0.6, "key": 40, "hold_s": 1 }, { "time_s": 0.9, "key": 43, "hold_s": 0.5 } ] })",
      "score.json", [](const std::string&) { return std::string(kStretching); });
  const Balance balance = balance_of(score.voices.front(), 44100, 2);
  Measured() << balance.error_j / balance.peak_j << " of the peak, " << balance.peak_j << " J";
  EXPECT_GT(balance.peak_j, 0.1);
  EXPECT_TRUE(within(balance.error_j, 0, 1e-12 * balance.peak_j));
  EXPECT_EQ(balance.bounded, 0U);

  const InstrumentArrays arrays = instrument_arrays(*score.voices.front().model, 44100);
  BySample<double> at_rest(arrays.view(), 44100);
  ASSERT_FALSE(arrays.holds.empty());
  for (int n = 0; n < 1000; ++n) at_rest.tick();
  EXPECT_TRUE(within(at_rest.output(0), 0, 1e-9));
}

// The shipped instrument that the text of a score names, or nothing.
std::string instrument_in(std::string_view score) {
  for (const std::string& name : shipped_names(Shipped::kInstruments))
    if (score.find("\"instrument\": \"" + name + "\"") != score.npos) return name;
  return {};
}

std::vector<std::string> scores_of_instruments() {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embedded_files(Shipped::kScores))
    if (!instrument_in(file.content).empty()) names.emplace_back(file.name.substr(0, file.name.rfind('.')));
  return names;
}

INSTANTIATE_TEST_SUITE_P(, ShippedInstrument, ::testing::ValuesIn(scores_of_instruments()),
                         [](const auto& test) { return test.param; });

TEST(ShippedInstruments, EachHasAScore) {
  std::vector<std::string> played;
  for (const std::string& name : scores_of_instruments())
    played.push_back(instrument_in(find_embedded(Shipped::kScores, name + ".json")->content));
  std::ranges::sort(played);
  EXPECT_EQ(played, shipped_names(Shipped::kInstruments));
}

}  // namespace
}  // namespace contactspline::testing
