// SPDX-License-Identifier: MIT
// A sample does not depend on those that the same instrument played before.
#include "generator/dataset/sample_player.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "generator/material/contact_reader.hpp"

namespace contactspline::testing {
namespace {

/// Plays a sample into arrays of its own.
std::vector<std::vector<float>> played(SamplePlayer& player, const Plan& plan, const std::vector<double>& values) {
  std::vector<std::vector<float>> sounds;
  std::vector<double> energy;
  SampleArrays arrays;
  for (const Recorded& one : plan.recorded) {
    const bool is_energy = one.kind == Recorded::kEnergy;
    if (is_energy) energy.resize(plan.length_of(one));
    sounds.emplace_back(is_energy ? 0 : plan.length_of(one));
  }
  for (auto& sound : sounds) arrays.sounds.emplace_back(sound);
  arrays.energy = energy;
  player.play(values, arrays, [] {});
  sounds.emplace_back(energy.begin(), energy.end());
  return sounds;
}

struct Case {
  const char* name;
  const char* text;  ///< of the plan, but for what all have in common
};

std::ostream& operator<<(std::ostream& to, const Case& one) {
  return to << one.name;
}

class SamplePlayers : public ::testing::TestWithParam<Case> {};

TEST_P(SamplePlayers, PlayTheSameSampleAgainAsForTheFirstTime) {
  for (const char* precision : {"single", "double"}) {
    const std::string text = std::string(
                                 "{\"name\": \"probe\", \"seed\": 1, \"count\": 8, \"seconds\": 0.05, "
                                 "\"precision\": \"") +
                             precision + "\", " + GetParam().text + "}";
    const Plan plan = parse_plan(text, "probe.json", shipped_file);
    const Sampler sampler(plan.columns, plan.sequence, plan.seed);
    SamplePlayer reused(plan);
    std::vector<std::vector<std::vector<float>>> sounds;
    for (std::uint64_t i = 0; i < plan.count; ++i) {
      SamplePlayer fresh(plan);
      sounds.push_back(played(fresh, plan, sampler.values(i)));
      EXPECT_EQ(played(reused, plan, sampler.values(i)), sounds.back()) << precision << i;
    }
    for (std::uint64_t i = plan.count; i-- > 0;)
      EXPECT_EQ(played(reused, plan, sampler.values(i)), sounds[i]) << precision << i;
    EXPECT_NE(sounds[0], sounds[1]);
    const auto largest = std::ranges::max(sounds[0][0], {}, [](float x) { return std::abs(x); });
    EXPECT_NE(largest, 0);
  }
}

constexpr auto kHammer = R"(
  "instrument": "hammer_string", "parts": {"resonator": "string_c4", "material": "felt_c4"},
  "parameters": {"speed_m_per_s": {"uniform": [1, 4]}, "strike_m": {"uniform": [0.01, 0.3]},
                 "bend_cents": {"uniform": [-100, 100]}, "damping_per_s": {"table": [0, 30]}},
  "events": [{"time_s": 0, "event": "strike", "hold_s": 0.01}, {"time_s": 0.02, "parameter": "bend_cents", "to": 50},
             {"time_s": 0.03, "event": "strike"}],
  "outputs": ["bridge_force_n", "force_n", "energy_j"], "energy_step_samples": 100)";
constexpr auto kBarrier = R"(
  "instrument": "mass_barrier", "parts": {"material": "felt_c4"}, "sequence": "sobol",
  "parameters": {"speed_m_per_s": {"logarithmic": [0.5, 5]}},
  "events": [{"time_s": 0, "event": "throw"}], "outputs": ["displacement_m", "force_n"])";
constexpr auto kTrichord = R"(
  "instrument": "trichord_c4", "parameters": {"felt_stiffness_ratio": {"logarithmic": [0.5, 2]}},
  "events": [{"time_s": 0, "event": "strike_hammer"}], "outputs": ["bridge_force_n", "force_n"])";
constexpr auto kSnare = R"(
  "instrument": "snare", "parameters": {"stick_speed_m_per_s": {"uniform": [1, 3]}},
  "events": [{"time_s": 0, "event": "strike_stick"}], "outputs": ["head_velocity_m_per_s", "force_n"])";
constexpr auto kBass = R"(
  "instrument": "slap_bass", "parameters": {"pop_release_n": {"uniform": [5, 20]}, "press_5_force_n": {"table": [0, 9]}},
  "events": [{"time_s": 0, "event": "pluck_pop"}, {"time_s": 0.03, "event": "strike_thumb"}],
  "outputs": ["pickup_velocity_m_per_s", "frets_force_n"])";
constexpr auto kTanpura = R"(
  "instrument": "tanpura", "parameters": {"finger_release_n": {"uniform": [0.3, 2]}},
  "events": [{"time_s": 0, "event": "pluck_finger"}], "outputs": ["wire_end_force_n", "bridge_force_n"])";

constexpr auto kPiano = R"(
  "instrument": "piano", "parameters": {"stiffness_ratio": {"uniform": [0.5, 2]}},
  "events": [{"time_s": 0, "key": {"table": [60, 64]}, "velocity": {"uniform": [0.3, 1]}, "hold_s": 0.02}],
  "outputs": ["left_velocity_m_per_s", "force_n"])";

INSTANTIATE_TEST_SUITE_P(Instruments, SamplePlayers,
                         ::testing::Values(Case{"hammer_string", kHammer}, Case{"mass_barrier", kBarrier},
                                           Case{"trichord", kTrichord}, Case{"snare", kSnare},
                                           Case{"slap_bass", kBass}, Case{"tanpura", kTanpura},
                                           Case{"piano", kPiano}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace contactspline::testing
