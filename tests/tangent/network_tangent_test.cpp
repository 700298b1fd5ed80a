// SPDX-License-Identifier: MIT
// Derivatives of networks of bodies, contacts and springs: against central differences of the network in long double.
#include "contactspline/tangent/network_tangent.hpp"

#include <cmath>
#include <vector>

#include "network_scene.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

// Every output, displacement and forces, over its largest slope.
TEST(NetworkTangent, IsTheCentralDifferenceInLongDouble) {
  double worst = 0;
  std::size_t touching = 0;
  for (std::uint64_t seed = 1; seed <= 12 && !HasFailure(); ++seed) {
    const Played scene(Random(seed), -1, 0);
    Slopes slopes(scene);
    const std::size_t outputs = 1 + scene.plan.connections().size();
    std::vector<std::vector<double>> found(Played::kNumbers);
    for (std::size_t n = 0; n < kSamples; ++n) {
      slopes.tick(n);
      std::size_t together = 0;
      for (std::size_t k = 0; k < 5; ++k) together += slopes.tangent.force(k).value > 0 ? 1 : 0;
      touching = std::max(touching, together);
      for (std::size_t p = 0; p < Played::kNumbers; ++p)
        for (std::size_t k = 0; k < outputs; ++k)
          found[p].push_back(k == 0 ? slopes.tangent.displacement(scene.struck).slopes[p]
                                    : slopes.tangent.force(k - 1).slopes[p]);
    }
    for (int p = 0; p < Played::kNumbers; ++p) {
      const auto expected =
          middle_difference([&](Real h) { return Scene<Real>(Random(seed), p, h).play(); }, width_for(p));
      for (std::size_t k = 0; k < outputs; ++k) {
        std::vector<double> a, b;
        for (std::size_t n = k; n < expected.size(); n += outputs)
          a.push_back(found[std::size_t(p)][n]), b.push_back(expected[n]);
        const double scale = largest(b);
        for (std::size_t n = 0; n < a.size() && scale > 0; ++n) {
          ASSERT_TRUE(within(a[n], b[n], 1e-6 * scale))
              << "scene " << seed << ", number " << p << ", output " << k << ", sample " << n;
          worst = std::max(worst, std::abs(a[n] - b[n]) / scale);
        }
      }
    }
  }
  EXPECT_GE(touching, 3U);  // coupled contacts
  Measured() << "worst difference, over the largest slope of each output: " << worst;
}

/// The derivatives of a slide for all its numbers.
struct SlideSlopes {
  using Numbers = Slide<double>;
  using Tangent = NetworkTangent<double, Numbers::kNumbers>;

  explicit SlideSlopes(const Numbers& slide) : scene(slide), tangent(slide.plan, Numbers::kRate, directions()) {
    tangent.put_place(slide.slid, along(Numbers::kStart, slide.start));
    tangent.set_motion(slide.mass, 0, 0.5);
  }
  static Tangent::Number along(std::size_t number, double value) {
    Tangent::Number result(value);
    result.slopes[number] = value;
    return result;
  }
  [[nodiscard]] std::array<NetworkNumbers<double>, Numbers::kNumbers> directions() const {
    std::array<NetworkNumbers<double>, Numbers::kNumbers> all;
    auto& bodies = all[Numbers::kFrequency].bodies;
    bodies.resize(scene.plan.bodies().size());
    for (const Mode& mode : scene.plan.bodies()[1]) bodies[1].push_back({mode.angular_frequency_rad_per_s, 0, 0});
    all[Numbers::kStiffness].connections.resize(scene.plan.connections().size());
    all[Numbers::kStiffness].connections[0].contact.stiffness_ratio = 1;
    return all;
  }
  void tick(std::size_t n) {
    tangent.push(scene.on_mass, 5);
    if (n >= 60)
      tangent.move_place(scene.slid,
                         Numbers::target(n - 60, along(Numbers::kStart, scene.start), along(Numbers::kEnd, scene.end),
                                         along(Numbers::kSlideSpeed, scene.metres_per_sample)));
    tangent.tick();
  }
  [[nodiscard]] Tangent::Number output(std::size_t k) const {
    if (k >= 2) return tangent.force(k - 2);
    return tangent.displacement(k == 0 ? scene.output : scene.slid);
  }

  const Numbers& scene;
  Tangent tangent;
};

// As above, of a place that moves.
TEST(NetworkTangent, FollowsAPlaceThatMoves) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Slide<double> scene(Random(seed), -1, 0);
    SlideSlopes slopes(scene);
    const std::size_t outputs = 2 + scene.plan.connections().size();
    std::vector<SlideSlopes::Tangent::Number> found;
    for (std::size_t n = 0; n < kSamples; ++n) {
      slopes.tick(n);
      for (std::size_t k = 0; k < outputs; ++k) found.push_back(slopes.output(k));
    }
    for (std::size_t p = 0; p < Slide<double>::kNumbers; ++p) {
      const auto expected =
          middle_difference([&](Real h) { return Slide<Real>(Random(seed), int(p), h).play(); }, 1e-8L);
      for (std::size_t k = 0; k < outputs; ++k) {
        double scale = 0;
        for (std::size_t i = k; i < expected.size(); i += outputs) scale = std::max(scale, std::abs(expected[i]));
        for (std::size_t i = k; i < expected.size() && scale > 0; i += outputs) {
          ASSERT_TRUE(within(found[i].slopes[p], expected[i], 1e-6 * scale))
              << "scene " << seed << ", number " << p << ", output " << k << ", sample " << i / outputs;
          worst = std::max(worst, std::abs(found[i].slopes[p] - expected[i]) / scale);
        }
      }
    }
  }
  Measured() << "worst difference of a slide, over the largest slope of each output: " << worst;
}

TEST(NetworkTangent, AllocatesNothingAfterConstruction) {
  const Played scene(Random(3), -1, 0);
  Slopes slopes(scene);
  const std::size_t before = allocations;
  for (std::size_t n = 0; n < kSamples; ++n) slopes.tick(n);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace contactspline::testing
