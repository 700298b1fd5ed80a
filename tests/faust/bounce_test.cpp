// SPDX-License-Identifier: MIT
// A mass that bounces for a second. Rounding grows from bounce to bounce, so runs are judged by what must hold of
// any: height, momentum, number of contacts, rest.
#include <gtest/gtest.h>

#include <numeric>

#include "strike_cases.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kHeight = 1e-3;
constexpr double kGravity = 9.81;

// Let go 1 mm before the barrier.
Strike fall(const MaterialUnderTest& material, double loss_s_per_m, double seconds) {
  Strike strike;
  strike.mass_kg = mass_for(material);
  strike.speed_m_per_s = 0;
  strike.start_m = -kHeight;
  strike.loss_s_per_m = loss_s_per_m;
  strike.gravity_m_per_s2 = kGravity;
  strike.samples = static_cast<std::size_t>(seconds * strike.sample_rate_hz);
  return strike;
}

template <typename T>
Motion<T> run(const MaterialUnderTest& material, const Strike& strike) {
  return run_faust(*material.in<T>().mass_barrier(strike.sample_rate_hz), strike);
}

template <typename T>
std::size_t contacts(const Motion<T>& motion) {
  std::size_t count = 0;
  for (std::size_t i = 1; i < motion.force.size(); ++i) count += motion.force[i - 1] == 0 && motion.force[i] > 0;
  return count;
}

/// Highest points between contacts, as distances from the barrier [m], where they lie between two samples too:
/// parabola through three of them.
template <typename T>
std::vector<double> heights(const Motion<T>& motion) {
  std::vector<double> found;
  const auto& q = motion.displacement;
  for (std::size_t i = 1; i + 1 < q.size(); ++i) {
    const double before = q[i - 1], here = q[i], after = q[i + 1];
    if (!(here < 0 && here <= before && here < after)) continue;
    const double slope = (after - before) / 2, bend = after - 2 * here + before;
    found.push_back(-(here - slope * slope / (2 * bend)));
  }
  return found;
}

template <typename T>
double mean_force(const Motion<T>& motion) {
  return std::accumulate(motion.force.begin(), motion.force.end(), 0.0) / static_cast<double>(motion.force.size());
}

class BounceTest : public ::testing::TestWithParam<MaterialUnderTest> {};

// Without loss each bounce reaches the height of the first; n samples round the energy by no more than 8 u each, and
// the parabola is exact for the midpoint rule but for u n. Impulse: the mean force is the weight, but for what the
// mass carries at both ends.
template <typename T>
void expect_lossless_bounces(const MaterialUnderTest& material) {
  const Strike strike = fall(material, 0, 1);
  const auto motion = run<T>(material, strike);
  const auto twin = run_twin(material.in<T>().table, strike);
  ASSERT_TRUE(all_finite(motion.displacement) && all_finite(motion.force));

  const double roundoff = std::numeric_limits<T>::epsilon() / 2;
  const double samples = static_cast<double>(strike.samples);
  const auto reached = heights(motion);
  const double worst = std::ranges::max(reached, {}, [](double h) { return std::abs(h - kHeight); }) / kHeight - 1;
  Measured() << contacts(motion) << " contacts (twin " << contacts(twin) << "), worst height off by " << worst;
  ASSERT_GE(reached.size(), 10u);
  for (const double height : reached) EXPECT_TRUE(relatively_within(height, kHeight, 8 * samples * roundoff));
  EXPECT_LE(std::max(contacts(motion), contacts(twin)) - std::min(contacts(motion), contacts(twin)), 1u);

  const double top_speed = std::sqrt(2 * kGravity * kHeight);
  const double seconds = samples / strike.sample_rate_hz;
  EXPECT_TRUE(within(mean_force(motion), strike.mass_kg * kGravity, 2.01 * strike.mass_kg * top_speed / seconds));
}

TEST_P(BounceTest, InDoubleKeepsHeightAndMomentum) {
  expect_lossless_bounces<double>(GetParam());
}

TEST_P(BounceTest, InSingleKeepsHeightAndMomentum) {
  expect_lossless_bounces<float>(GetParam());
}

// Energy of the mass after each sample, its velocity followed through the forces as the model does.
std::vector<double> energies(const MaterialUnderTest& material, const Strike& strike, const Motion<double>& motion) {
  std::vector<double> energy;
  double velocity = strike.speed_m_per_s;
  for (std::size_t i = 0; i < motion.force.size(); ++i) {
    velocity += (kGravity - motion.force[i] / strike.mass_kg) / strike.sample_rate_hz;
    energy.push_back(strike.mass_kg * (velocity * velocity / 2 - kGravity * motion.displacement[i]) +
                     potential(material.in_double.table, motion.displacement[i]));
  }
  return energy;
}

TEST_P(BounceTest, KeepsEnergyAtEverySample) {
  const Strike strike = fall(GetParam(), 0, 1);
  const auto energy = energies(GetParam(), strike, run<double>(GetParam(), strike));
  const double start = strike.mass_kg * kGravity * kHeight;
  double worst = 0;
  for (const double e : energy) worst = std::max(worst, std::abs(e / start - 1));
  Measured() << "worst relative error of the energy " << worst;
  EXPECT_LE(worst, 8 * static_cast<double>(strike.samples) * 0x1p-53);
}

// With loss no bounce is higher than the one before, down to a micrometre, below which a bounce lasts few samples; in
// the last second the barrier carries the weight, but for what such bounces carry at both ends.
template <typename T>
void expect_rest(const MaterialUnderTest& material) {
  constexpr double kMicrometre = 1e-6;
  const Strike strike = fall(material, 2, 8);
  const auto motion = run<T>(material, strike);
  ASSERT_TRUE(all_finite(motion.displacement) && all_finite(motion.force));
  double before = kHeight;
  for (const double height : heights(motion)) {
    EXPECT_LE(height, std::max(before, kMicrometre));
    before = height;
  }
  EXPECT_LT(before, kHeight / 50);

  const Motion<T> last_second{{}, {motion.force.end() - strike.sample_rate_hz, motion.force.end()}};
  const double weight = strike.mass_kg * kGravity;
  const double speed = std::sqrt(2 * kGravity * kMicrometre);
  Measured() << contacts(motion) << " contacts, mean force of the last second "
             << mean_force(last_second) / weight - 1 << " off the weight";
  EXPECT_TRUE(within(mean_force(last_second), weight, 2 * strike.mass_kg * speed));
}

TEST_P(BounceTest, InDoubleComesToRestWithLoss) {
  expect_rest<double>(GetParam());
}

TEST_P(BounceTest, InSingleComesToRestWithLoss) {
  expect_rest<float>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Materials, BounceTest, ::testing::ValuesIn(materials_under_test()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace contactspline::testing
