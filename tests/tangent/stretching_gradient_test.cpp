// SPDX-License-Identifier: MIT
// Gradients of networks in which bodies stretch: against the tangents read backwards.
#include "contactspline/tangent/stretching_gradient.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "random_weights.hpp"
#include "stretching_scene.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

/// A scene that is played for its gradient, with weights for its samples at random.
struct Backwards {
  Backwards(const Scene64& played, std::uint64_t seed) : scene(played), network(played.plan, played.rate) {
    scene.play(
        network, [](int, double value) { return value; }, [] {});
    weights = random_weights(scene.plan, {scene.struck}, kSamples, Random(seed));
    gradient = network.gradient(weights);
  }

  /// The weight of a number, as Stretched::hear() orders them.
  [[nodiscard]] double weight(std::size_t i) const { return weight_of(weights, scene.struck, i); }

  /// The derivative of the sum with respect to a number of the scene.
  [[nodiscard]] double derivative_by(int number, const NetworkNumbers<double>& direction) const {
    double sum = derivative(gradient.numbers, direction);
    for (std::size_t i = 0; i < gradient.motions.size(); ++i) {
      const auto &by = gradient.motions[i], motion = scene.motion(i);
      const bool is_mass = scene.played == Case::kStruck && i == 0;
      if (number == Scene64::kDisplacement) sum += motion.displacement_m * by.displacement_m;
      if (number == (is_mass ? Scene64::kSpeed : Scene64::kVelocity))
        sum += motion.velocity_m_per_s * by.velocity_m_per_s;
    }
    if (number == Scene64::kPush)
      for (const double push : gradient.pushes) sum += 3 * push;
    return sum;
  }

  const Scene64& scene;
  RecordedStretching<double> network;
  NetworkWeights<double> weights;
  NetworkGradient<double> gradient;
};

// The same derivatives the other way round: sums of thousands of products, each rounded.
TEST(StretchingGradient, IsTheTangentReadBackwards) {
  double worst = 0;
  for (const Case played : {Case::kPlucked, Case::kAtStop, Case::kStruck})
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Scene64 scene(Random(seed), played, -1, 0);
      const Backwards backwards(scene, seed);
      const auto directions = scene.directions();
      StretchedTangent tangent(scene.plan, scene.rate, directions);
      const auto slopes = scene.play_with_slopes(tangent);
      for (std::size_t p = 0; p < Scene64::kNumbers; ++p) {
        double expected = 0, scale = 0;
        for (std::size_t i = 0; i < slopes.size(); ++i) {
          expected += backwards.weight(i) * slopes[i].slopes[p];
          scale += std::abs(backwards.weight(i) * slopes[i].slopes[p]);
        }
        const double found = backwards.derivative_by(int(p), directions[p]);
        EXPECT_TRUE(within(found, expected, 1e-12 * scale))
            << "case " << int(played) << ", scene " << seed << ", number " << p;
        if (scale > 0) worst = std::max(worst, std::abs(found - expected) / scale);
      }
    }
  Measured() << "worst difference, over the sum of the sizes: " << worst;
}

// What is not a number changes nothing. What is out of range does as the end of the range does: its derivative is 0.
TEST(StretchingGradient, TakesNumbersInTheirRangesAlone) {
  const double kNone = std::numeric_limits<double>::quiet_NaN();
  const Scene64 scene(Random(1), Case::kPlucked, -1, 0);
  RecordedStretching<double> network(scene.plan, scene.rate), expected(scene.plan, scene.rate);
  StretchingTangent<double, 1> tangent(scene.plan, scene.rate, {});
  network.set_motion(scene.head, kNone, 1), tangent.set_motion(scene.head, {kNone, {1}}, 1);
  network.set_motion(scene.head, 1, kNone), tangent.set_motion(scene.head, 1, {kNone, {1}});
  network.set_motion(scene.head, 1e-3, 2e3), tangent.set_motion(scene.head, 1e-3, {2e3, {1}});
  network.push(scene.struck, kNone), tangent.push(scene.struck, {kNone, {1}});
  network.push(scene.struck, -2e3), tangent.push(scene.struck, {-2e3, {1}});
  expected.set_motion(scene.head, 1e-3, 1000);
  expected.push(scene.struck, -1000);
  NetworkWeights<double> weights;
  weights.displacements = {{1, 2, 3}};
  for (int n = 0; n < 3; ++n) {
    network.tick(), expected.tick(), tangent.tick();
    EXPECT_EQ(network.model().displacement(scene.struck), expected.model().displacement(scene.struck));
    EXPECT_EQ(tangent.displacement(scene.struck).value, expected.model().displacement(scene.struck));
    EXPECT_EQ(tangent.displacement(scene.struck).slopes[0], 0);
  }
  const auto found = network.gradient(weights), wanted = expected.gradient(weights);
  ASSERT_EQ(found.motions.size(), 1U);
  ASSERT_EQ(found.pushes.size(), 1U);
  EXPECT_EQ(found.motions[0].displacement_m, wanted.motions[0].displacement_m);
  EXPECT_NE(wanted.motions[0].velocity_m_per_s, 0);
  EXPECT_EQ(found.motions[0].velocity_m_per_s, 0);
  EXPECT_NE(wanted.pushes[0], 0);
  EXPECT_EQ(found.pushes[0], 0);
}

}  // namespace
}  // namespace contactspline::testing
