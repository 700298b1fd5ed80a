// SPDX-License-Identifier: MIT
// Impacts with memory: the continuous equations against closed forms and an independent solution, and the simulation
// at a rate against them.
#include "generator/contact/memory_impact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "generator/material/material.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/simulated_impact.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kMass = 0.008, kSpeed = 2;
constexpr PowerLaw kFelt{4e9, 2.6};

BarrierImpact impact_with(const std::vector<Memory>& memories, const PowerLaw& law = kFelt) {
  const ContactLaw contact(law);
  return memory_impact(law_view(contact), kMass, kSpeed, 0, memories);
}

/// As a blow without memory on this law is. ending: the largest part of the largest force that is remembered when the
/// contact ends. The felt then has its surface ending^(1/p) of the compression away, where the bodies part earlier.
void expect_elastic(const BarrierImpact& found, const PowerLaw& law, double bound, double ending) {
  const double compression = law.max_compression(kMass, kSpeed), duration = law.contact_duration(kMass, kSpeed);
  const double earlier = std::pow(ending, 1 / law.exponent) * compression / kSpeed;
  EXPECT_TRUE(relatively_within(found.max_compression_m, compression, bound));
  EXPECT_TRUE(within(found.contact_duration_s, duration, earlier + bound * duration));
  EXPECT_TRUE(relatively_within(found.max_force_n, law.force(compression), bound));
  EXPECT_TRUE(relatively_within(found.exit_speed_m_per_s, kSpeed, bound));
}

// A memory that does not move during the blow leaves the fast stiffness. It has moved by duration/time = 1e-4.
TEST(MemoryImpact, OfALongMemoryIsTheBlowOnTheFastStiffness) {
  const double part = kFelt.contact_duration(kMass, kSpeed) / 10;
  expect_elastic(impact_with({{0.5, 10}}), kFelt, part, part / 2);
}

TEST(MemoryImpact, OfNearlyNoWeightIsTheBlowWithoutMemory) {
  expect_elastic(impact_with({{1e-6, 1e-4}}), kFelt, 1e-6, 1e-6);
}

// A memory that follows at once leaves the slow stiffness. The blow feels its delay as a part time/duration, some
// 1e-4, times weight/(1 - weight); the end of the contact, where the force rises with a power above 2, feels it most.
TEST(MemoryImpact, OfAShortMemoryIsTheBlowOnTheSlowStiffness) {
  const PowerLaw slow{kFelt.stiffness / 2, kFelt.exponent};
  expect_elastic(impact_with({{0.5, 1e-7}}), slow, 1e-3, 0);
  expect_elastic(impact_with({{0.25, 1e-7}, {0.25, 1e-7}}), slow, 1e-3, 0);
}

// Two memories with one time are one with the sum of the weights.
TEST(MemoryImpact, AddsTheWeightsOfEqualTimes) {
  const BarrierImpact one = impact_with({{0.6, 2e-5}}), two = impact_with({{0.4, 2e-5}, {0.2, 2e-5}});
  EXPECT_TRUE(relatively_within(two.contact_duration_s, one.contact_duration_s, 1e-7));
  EXPECT_TRUE(relatively_within(two.exit_speed_m_per_s, one.exit_speed_m_per_s, 1e-9));
  EXPECT_TRUE(relatively_within(two.max_force_n, one.max_force_n, 1e-9));
}

struct Case {
  double weight, time_s, exit_speed;  ///< the speed to four digits, by an independent adaptive solution
};
constexpr Case kCases[] = {{0.5, 2e-6, 1.9824}, {0.5, 1e-5, 1.9143}, {0.5, 5e-5, 1.6284}, {0.9, 2e-6, 1.9017},
                           {0.9, 1e-5, 1.5713}, {0.9, 2e-5, 1.2667}, {0.9, 5e-5, 0.7609}, {0.97, 1e-5, 1.1304}};

TEST(MemoryImpact, HasTheExitSpeedOfAnIndependentSolution) {
  for (const auto& [weight, time_s, exit_speed] : kCases)
    EXPECT_TRUE(within(impact_with({{weight, time_s}}).exit_speed_m_per_s, exit_speed, 5.1e-5)) << weight;
}

// At 44.1 kHz, where the relaxation times are 0.09 to 2.2 samples. At all phases between two samples.
TEST(MemoryImpact, SimulatedAtAudioRateIsWithinAPercent) {
  const Impact elastic = elastic_impact({kMass, kSpeed, kSpeed}, {{0.97, 1e-5}});
  const double range = kFelt.max_compression(elastic.mass_kg, kSpeed);
  const auto table = segment_table(uniform_spline({"felt", "", kFelt, {}, {4096, range}}, "felt.json"));
  for (const auto& [weight, time_s, exit_speed] : kCases) {
    const std::vector<Memory> memories = {{weight, time_s}};
    const BarrierImpact exact = impact_with(memories);
    double worst_exit = 0, worst_force = 0, worst_duration = 0;
    for (int phase = 0; phase < 10; ++phase) {
      const SimulatedImpact found = simulate_impact(table, kMass, kSpeed, 44100, phase / 10.0, 0, memories);
      const auto worse = [](double& worst, double error) { worst = std::max(worst, std::abs(error)); };
      worse(worst_exit, (found.exit_speed_m_per_s - exact.exit_speed_m_per_s) / kSpeed);
      worse(worst_force, found.max_force_n / exact.max_force_n - 1);
      worse(worst_duration, found.contact_duration_s / exact.contact_duration_s - 1);
    }
    const double bound = weight <= 0.9 ? 0.006 : 0.015;
    EXPECT_LE(worst_exit, bound) << weight << ", " << time_s;
    EXPECT_LE(worst_force, bound) << weight << ", " << time_s;
    EXPECT_LE(worst_duration, 0.005) << weight << ", " << time_s;
    Measured() << "weight " << weight << ", " << time_s << " s: exit " << worst_exit << ", force " << worst_force
               << ", duration " << worst_duration;
  }
}

}  // namespace
}  // namespace contactspline::testing
