// SPDX-License-Identifier: MIT
// The physics of a mass on a barrier: rebound, loss, rest, count of bounces.
#include "contactspline/models/mass_barrier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "runtime/bounce.hpp"
#include "runtime/random_steps.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

// Rubber on wood, as in materials/.
constexpr double kMass = 0.009;
constexpr PowerLaw kRubber{4.903e5, 1.5};
constexpr double kRange = 2.76e-3;
constexpr long kPatience = 1'000'000;

std::vector<Segment<double>> rubber(int segments) {
  return segment_table(uniform_spline({"test", "", kRubber, {}, {segments, kRange}}, "test"));
}

/// Exit speed over impact speed of a mass thrown without gravity.
double restitution(const std::vector<Segment<double>>& table, double rate, double speed,
                   ContactControls<double> contact, double from = -1e-4) {
  const MassBarrierControls<double> controls{kMass, 0, contact};
  MassBarrier<double> barrier(SegmentTable<double>(table), rate);
  barrier.throw_from(from, speed);
  for (long i = 0; i < kPatience; ++i) {
    barrier.tick(controls);
    if (barrier.velocity() < 0 && barrier.force() == 0) return -barrier.velocity() / speed;
  }
  ADD_FAILURE() << "no rebound";
  return 0;
}

TEST(MassBarrier, ReboundsElasticallyWithoutLoss) {
  for (const int segments : {1, 2, 16, 64, 1024}) {
    const auto table = rubber(segments);
    for (const double rate : {22050.0, 44100.0, 192000.0})
      for (const double ratio : {1.0, 1e3, 1e6})
        for (const double speed : {0.05, 1.0, 4.0, 40.0})
          EXPECT_TRUE(within(restitution(table, rate, speed, {ratio, 0}), 1, 2e-13)) << segments << " " << speed;
  }
}

TEST(MassBarrier, KeepsAConstantSpeedWhileApart) {
  const auto table = rubber(16);
  const MassBarrierControls<double> controls{kMass};
  MassBarrier<double> barrier(SegmentTable<double>(table), 48000);
  barrier.throw_from(-1, -2);
  for (int i = 0; i < 48000; ++i) barrier.tick(controls);
  EXPECT_TRUE(relatively_within(barrier.displacement(), -3, 1e-12));
  EXPECT_TRUE(relatively_within(barrier.velocity(), -2, 1e-15));
  EXPECT_EQ(barrier.force(), 0);
}

TEST(MassBarrier, FallsAsGalileoSays) {
  const auto table = rubber(16);
  const MassBarrierControls<double> controls{kMass, kGravity};
  for (const double rate : {22050.0, 192000.0}) {
    MassBarrier<double> barrier(SegmentTable<double>(table), rate);
    barrier.throw_from(-10, 0.5);
    const int samples = static_cast<int>(rate);
    for (int i = 0; i < samples; ++i) barrier.tick(controls);
    EXPECT_TRUE(relatively_within(barrier.displacement(), -10 + 0.5 + kGravity / 2, 1e-12));
    EXPECT_TRUE(relatively_within(barrier.velocity(), 0.5 + kGravity, 1e-13));
  }
}

TEST(MassBarrier, LossNeverLetsTheEnergyRise) {
  for (const int segments : {1, 16, 256})
    for (const double rate : {22050.0, 192000.0})
      for (const double ratio : {0.01, 1.0, 1e4})
        for (const double loss : {0.001, 0.3, 5.0}) {
          const auto table = rubber(segments);
          const SegmentTable<double> view(table);
          const MassBarrierControls<double> controls{kMass, kGravity, {ratio, loss}};
          MassBarrier<double> barrier(view, rate);
          barrier.throw_from(-0.02, 0.3);
          long double energy = energy_of(barrier, view, controls);
          const long double initial = energy;
          for (int i = 0; i < 40'000; ++i) {
            barrier.tick(controls);
            const long double next = energy_of(barrier, view, controls);
            ASSERT_LE(static_cast<double>((next - energy) / initial), 32 * kRoundoff<double>)
                << segments << " " << rate << " " << ratio << " " << loss << " sample " << i;
            energy = next;
          }
          EXPECT_LT(static_cast<double>(energy / initial), 0.9999);
        }
}

// m v dv/dy = -F (1 + lambda v) gives G(v in) = G(-v out), G(v) = v/lambda - ln(1 + lambda v)/lambda^2, whatever the
// potential.
double hunt_crossley_restitution(double loss, double speed) {
  const auto g = [&](double v) { return v / loss - std::log1p(loss * v) / (loss * loss); };
  double low = 0, high = std::min(speed, 1 / loss);
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (g(-middle) < g(speed) ? low : high) = middle;
  }
  return low / speed;
}

TEST(MassBarrier, RestitutionFallsWithLossAsHuntAndCrossleySay) {
  const auto table = rubber(64);
  for (const double speed : {0.2, 1.0, 4.0}) {
    double last = 1;
    for (const double loss : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0}) {
      const double found = restitution(table, 192000, speed, {1, loss});
      EXPECT_LT(found, last) << loss;
      last = found;
      // The resistance is taken in the middle of the sample, where the last one predicts it: an error of second
      // order.
      const double exact = hunt_crossley_restitution(loss, speed);
      const double error = std::abs(found - exact);
      const double finer = std::abs(restitution(table, 8 * 192000, speed, {1, loss}) - exact);
      EXPECT_LT(error, 1e-5) << speed << " " << loss;
      EXPECT_LT(finer, 1e-5 / 64) << speed << " " << loss;
    }
    // For little loss 1 - (2/3) lambda v.
    EXPECT_TRUE(within(restitution(table, 192000, speed, {1, 1e-3}), 1 - 2e-3 / 3 * speed, 2e-5));
  }
}

TEST(MassBarrier, RestitutionStaysBetween0And1AtAnyRate) {
  const auto table = rubber(16);
  for (const double rate : {8000.0, 22050.0, 48000.0})
    for (const double ratio : {1.0, 1e5}) {
      double last = 1 + 1e-12;
      for (const double loss : {0.0, 0.01, 0.1, 1.0}) {
        const double found = restitution(table, rate, 2, {ratio, loss});
        EXPECT_LE(found, last) << rate << " " << ratio << " " << loss;
        EXPECT_GT(found, 0);
        last = found;
      }
    }
}

TEST(MassBarrier, ComesToRestAtTheStaticCompression) {
  for (const int segments : {1, 16, 256})
    for (const double ratio : {0.1, 1.0, 100.0}) {
      const auto table = rubber(segments);
      const MassBarrierControls<double> controls{kMass, kGravity, {ratio, 3.0}};
      MassBarrier<double> barrier(SegmentTable<double>(table), 44100);
      barrier.throw_from(-1e-3, 0);
      for (int i = 0; i < 6 * 44100; ++i) barrier.tick(controls);
      // Where the table's force carries the weight.
      const double weight = kMass * kGravity / ratio;
      std::size_t j = 1;
      while (j + 1 < table.size() && table[j + 1].force <= weight) ++j;
      const double compression = table[j].knot + (weight - table[j].force) / (2 * table[j].half_curvature);
      EXPECT_TRUE(relatively_within(barrier.displacement(), compression, 1e-12)) << segments << " " << ratio;
      EXPECT_TRUE(relatively_within(barrier.force(), kMass * kGravity, 1e-10));
      EXPECT_TRUE(within(barrier.velocity(), 0, 1e-12));
    }
}

// A flight takes 2 v/g, a contact T of its closed form but for the weight, which is 1e-4 of the greatest force.
TEST(MassBarrier, BouncesAsOftenAsTheClosedFormSays) {
  const auto table = rubber(256);
  for (const double rate : {22050.0, 96000.0})
    for (const double speed : {0.5, 2.0}) {
      const Drop drop{kMass, speed, 1, rate, 60};
      const double flight = 2 * speed / kGravity, contact = kRubber.contact_duration(kMass, speed);
      const EnergyDrift drift = follow(SegmentTable<double>(table), drop);
      const double expected = (drop.seconds - flight / 2) / (flight + contact);
      EXPECT_TRUE(within(static_cast<double>(drift.bounces), expected, 1 + 1e-3 * expected)) << rate << " " << speed;
    }
}

// Each rebound is lower, until the mass stays: bounces die out as 1, 2, 3... contacts of falling height.
TEST(MassBarrier, WithLossBouncesGrowSmallerAndCease) {
  const auto table = rubber(64);
  const MassBarrierControls<double> controls{kMass, kGravity, {1, 0.5}};
  MassBarrier<double> barrier(SegmentTable<double>(table), 44100);
  barrier.throw_from(-0.2, 0);
  std::vector<double> heights;
  double highest = 0;
  bool was_touching = false;
  for (int i = 0; i < 20 * 44100; ++i) {
    barrier.tick(controls);
    const bool is_touching = barrier.force() > 0;
    if (is_touching && !was_touching) heights.push_back(std::exchange(highest, 0.0));
    if (!is_touching) highest = std::max(highest, -barrier.displacement());
    was_touching = is_touching;
  }
  EXPECT_GT(heights.size(), 10u);
  for (std::size_t i = 1; i < heights.size(); ++i) EXPECT_LT(heights[i], heights[i - 1]) << i;
  EXPECT_TRUE(was_touching);
  EXPECT_TRUE(relatively_within(barrier.force(), kMass * kGravity, 1e-3));
}

}  // namespace
}  // namespace contactspline::testing
