// SPDX-License-Identifier: MIT
// A minute of bounces without loss: the energy stays, whatever rate, table, stiffness and precision.
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "runtime/bounce.hpp"
#include "runtime/random_steps.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

struct Dropped {
  const char* name;
  PowerLaw contact;
  double mass_kg, max_speed_m_per_s, range_m;
};

// As in materials/: felt, rubber, steel.
constexpr Dropped kDropped[] = {{"felt C4", {4.5e9, 2.5}, 0.00297, 6.0, 1.04e-3},
                                {"rubber on wood", {4.903e5, 1.5}, 0.009, 4.0, 2.76e-3},
                                {"steel on steel", {1.0879e10, 1.5}, 0.00411, 2.0, 2.1e-5}};
constexpr double kMinute = 60;

template <typename T>
EnergyDrift drift_of(const Dropped& dropped, int segments, const Drop& drop) {
  const auto table = in_precision<T>(
      segment_table(uniform_spline({"test", "", dropped.contact, {}, {segments, dropped.range_m}}, "test")));
  const EnergyDrift drift = follow(SegmentTable<T>(table), drop);
  Measured() << dropped.name << ", N = " << segments << ", " << drop.sample_rate_hz << " Hz, " << drop.speed_m_per_s
             << " m/s, stiffness * " << drop.stiffness_ratio << ", " << 8 * sizeof(T) << " bits: energy off by "
             << drift.worst << ", " << drift.worst / allowed_drift<T>(drop, drift) << " of its bound; "
             << drift.bounces << " bounces";
  EXPECT_TRUE(drift.is_finite);
  EXPECT_GT(drift.bounces, 40);
  EXPECT_LE(drift.worst, allowed_drift<T>(drop, drift));
  return drift;
}

class OfAMinuteOfBounces : public ::testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(OfAMinuteOfBounces, EnergyStaysWithin1eMinus12) {
  const auto [rate, segments] = GetParam();
  for (const Dropped& dropped : kDropped) {
    const Drop drop{dropped.mass_kg, dropped.max_speed_m_per_s, 1, rate, kMinute};
    EXPECT_LE(drift_of<double>(dropped, segments, drop).worst, 1e-12);
  }
}

constexpr double kRates[] = {22050.0, 44100.0, 96000.0, 192000.0};
std::string rate_name(const ::testing::TestParamInfo<double>& test) {
  return std::to_string(static_cast<int>(test.param)) + "_hz";
}
std::string rate_and_size_name(const ::testing::TestParamInfo<std::tuple<double, int>>& test) {
  const auto [rate, segments] = test.param;
  return std::to_string(static_cast<int>(rate)) + "_hz_n" + std::to_string(segments);
}
INSTANTIATE_TEST_SUITE_P(MassBarrier, OfAMinuteOfBounces,
                         ::testing::Combine(::testing::ValuesIn(kRates), ::testing::Values(1, 2, 16, 64, 256, 1024)),
                         rate_and_size_name);

class OfAMinute : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(MassBarrier, OfAMinute, ::testing::ValuesIn(kRates), rate_name);

// Contact shorter than a sample: displacement before and after are thousands of times the compression between.
TEST_P(OfAMinute, OnVeryStiffBarriersEnergyStaysWithin1eMinus12) {
  for (const Dropped& dropped : kDropped)
    for (const auto& [ratio, speed] : {std::pair{1e3, dropped.max_speed_m_per_s}, std::pair{1e6, 0.5}}) {
      const Drop drop{dropped.mass_kg, speed, ratio, GetParam(), kMinute};
      EXPECT_LE(drift_of<double>(dropped, 16, drop).worst, 1e-12);
    }
}

// From half a millimetre: 49 bounces a second, each of which may round the same way, so that 1e-12 is near.
TEST_P(OfAMinute, OfManySmallBouncesEnergyStaysWithinItsBound) {
  for (const Dropped& dropped : kDropped)
    drift_of<double>(dropped, 16, {dropped.mass_kg, 0.1, 1e3, GetParam(), kMinute});
}

TEST_P(OfAMinute, InSinglePrecisionEnergyStaysWithinItsBound) {
  for (const Dropped& dropped : kDropped)
    for (const auto& [ratio, speed] :
         {std::pair{1.0, dropped.max_speed_m_per_s}, std::pair{1e3, dropped.max_speed_m_per_s}, std::pair{1e6, 0.5}})
      drift_of<float>(dropped, 16, {dropped.mass_kg, speed, ratio, GetParam(), kMinute});
}

}  // namespace
}  // namespace contactspline::testing
