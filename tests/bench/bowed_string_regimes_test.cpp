// SPDX-License-Identifier: MIT
// What bench/bowing draws: regimes of a bowed string, and how it starts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "bench/bowed_string.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kHz = 44100, kSpeed = 0.1;

bench::BowedMotion violin_d(double force_n, bool from_rest) {
  bench::BowedString<double> bowed(bench::kViolinD, 0.113, 4, kHz);
  return bench::bowed_motion(bowed, force_n, kSpeed, from_rest);
}

bench::BowedStart cello_d(double force_n, double acceleration_m_per_s2, std::size_t points = 4, double rate = kHz) {
  bench::BowedString<double> bowed(bench::kCelloD, 0.09, points, rate);
  return bench::bowed_start(bowed, force_n, acceleration_m_per_s2);
}

// With little force a string that starts from rest slips several times in a period; what moves as Helmholtz found
// still does.
TEST(BowedString, SlipsOnceAPeriodBetweenLittleForceAndMuch) {
  EXPECT_EQ(violin_d(0.04, true).name, 'm');
  EXPECT_EQ(violin_d(0.04, false).name, 'H');
  for (const bool from_rest : {true, false}) {
    const bench::BowedMotion inside = violin_d(0.3, from_rest);
    EXPECT_EQ(inside.name, 'H');
    EXPECT_TRUE(within(inside.cents, -5, 5));
    EXPECT_EQ(violin_d(2, from_rest).name, 'r');
  }
  EXPECT_NE(violin_d(0.005, false).name, 'H');
}

// Measured limits: 0.73 kg/s speed/place, and 4.2 g/s speed/place^2.
TEST(BowedString, KeepsHelmholtzMotionInsideMeasuredLimits) {
  constexpr double kPlace = 0.113;
  EXPECT_EQ(violin_d(1.1 * 4.2e-3 * kSpeed / (kPlace * kPlace), false).name, 'H');
  EXPECT_EQ(violin_d(0.9 * 0.73 * kSpeed / kPlace, false).name, 'H');
  EXPECT_EQ(violin_d(2 * 0.73 * kSpeed / kPlace, false).name, 'r');
}

TEST(BowedString, StartsPerfectlyWhereForceAndAccelerationFit) {
  EXPECT_TRUE(cello_d(1.35, 1.35).is_perfect());
  EXPECT_TRUE(cello_d(1.65, 1.8).is_perfect());
  EXPECT_EQ(cello_d(0.84, 1.56).periods, bench::BowedStart::kNever) << "measured: never";
  EXPECT_EQ(cello_d(0.6, 2.4).periods, bench::BowedStart::kNever);
}

// The string follows the bow until it pulls with mu N: F = a t^2/2 over the compliance of string and torsion.
TEST(BowedString, SlipsFirstWhereItsPullReachesTheFriction) {
  using namespace bench::bowing;
  const double length = bench::kCelloD.length_m(),
               tension = 2 * bench::kCelloD.impedance_kg_per_s * length * bench::kCelloD.frequency_hz;
  const double compliance = 0.09 * 0.91 * length / tension * (1 + 1 / (kTorsionalImpedance * kTorsionalSpeed));
  for (const double force_n : {0.5, 1.0, 2.0}) {
    const double time_s = std::sqrt(2 * kRosin.heat.cold_coefficient * force_n * compliance / 0.15);
    EXPECT_TRUE(relatively_within(cello_d(force_n, 0.15, 1).first_slip_s, time_s, 0.01)) << force_n;
  }
}

TEST(BowedString, SlipsFirstAtTheSameTimeAtEachRate) {
  for (const double acceleration : {0.3, 1.2, 2.4})
    EXPECT_TRUE(relatively_within(cello_d(1.2, acceleration).first_slip_s,
                                  cello_d(1.2, acceleration, 4, 4 * kHz).first_slip_s, 0.02));
}

}  // namespace
}  // namespace contactspline::testing
