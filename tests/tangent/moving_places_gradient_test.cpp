// SPDX-License-Identifier: MIT
// Gradients of networks whose places move along strings: against the tangents read backwards, and against central
// differences in long double.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "contactspline/tangent/network_gradient.hpp"
#include "moving_scene.hpp"
#include "random_weights.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using Scene = Moving<double>;
constexpr std::size_t kInitialShapes = Scene::kDirections, kAll = kInitialShapes + 1;

/// The directions of a scene, and of the shapes where its places begin.
std::array<NetworkNumbers<double>, kAll> directions_of(const Scene& scene) {
  std::array<NetworkNumbers<double>, kAll> all;
  all[Scene::kString].bodies.resize(scene.plan.bodies().size());
  auto& modes = all[Scene::kString].bodies[scene.string] = scene.plan.bodies()[scene.string];
  modes[0].angular_frequency_rad_per_s = 0;
  auto& connections = all[Scene::kContact].connections;
  connections.resize(scene.plan.connections().size());
  const auto& contact = scene.plan.connections()[0];
  connections[0].contact.stiffness_ratio = contact.contact.stiffness_ratio;
  connections[0].contact.loss_s_per_m = contact.contact.loss_s_per_m;
  connections[0].contact.memories = scene.memories;
  connections[1].spring_n_per_m = scene.plan.connections()[1].spring_n_per_m;
  connections[1].resistance_n_s_per_m = scene.plan.connections()[1].resistance_n_s_per_m;
  connections[2].gap_m = scene.plan.connections()[2].gap_m;
  if (connections.size() > 6) connections[6].spring_n_per_m = scene.plan.connections()[6].spring_n_per_m;
  all[kInitialShapes].places.resize(scene.plan.places().size());
  for (std::size_t p = 0; p < scene.plan.places().size(); ++p)
    if (p != scene.on_mass) all[kInitialShapes].places[p] = scene.plan.places()[p].shapes;
  return all;
}

/// A scene that is played for its gradient, and weights for its samples at random.
struct Backwards {
  explicit Backwards(const Scene& played, std::uint64_t seed) : scene(played), network(played.plan, Scene::kRate) {
    scene.play(
        network, [](const Scene::Call& c) { return c.to_m; }, [](std::size_t) {});
    weights = random_weights(scene.plan, {scene.slid, scene.heard}, kSamples, Random(seed));
    gradient = network.gradient(weights);
  }
  /// The weight of a sample, as Moving::samples() orders them.
  [[nodiscard]] double weight(std::size_t i) const {
    const std::size_t n = i / scene.outputs(), k = i % scene.outputs();
    return k == 0   ? weights.displacements[scene.slid][n]
           : k == 1 ? weights.displacements[scene.heard][n]
                    : weights.forces[k - 2][n];
  }
  /// The derivative of the sum in a direction of the scene.
  [[nodiscard]] double derivative_by(std::size_t direction) const {
    double sum = derivative(gradient.numbers, directions_of(scene)[direction]);
    std::size_t i = 0;
    for (const auto& call : scene.calls)
      if (direction < 2 && !std::isnan(call.to_m)) sum += gradient.moves[i++] * call.slopes[direction];
    return sum;
  }

  const Scene& scene;
  RecordedNetwork<double> network;
  NetworkWeights<double> weights;
  NetworkGradient<double> gradient;
};

// The same derivatives the other way round: sums of thousands of products, each rounded.
TEST(MovingPlacesGradient, IsTheTangentReadBackwards) {
  using Tangent = NetworkTangent<double, kAll>;
  double worst = 0;
  std::array<std::size_t, 6> pressing{};  // samples in which the mass moves, for each connection
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Scene scene(seed, -1, 0);
    const Backwards backwards(scene, seed);
    Tangent tangent(scene.plan, Scene::kRate, directions_of(scene));
    std::array<double, kAll> expected{}, scale{};
    scene.play(
        tangent,
        [](const Scene::Call& c) {
          return Tangent::Number(c.to_m, {c.slopes[0], c.slopes[1]});
        },
        [&](std::size_t n) {
          for (std::size_t k = 0; k < scene.outputs(); ++k)
            for (std::size_t p = 0; p < kAll; ++p) {
              const auto& output = k == 0   ? tangent.displacement(scene.slid)
                                   : k == 1 ? tangent.displacement(scene.heard)
                                            : tangent.force(k - 2);
              const double term = backwards.weight(n * scene.outputs() + k) * output.slopes[p];
              expected[p] += term, scale[p] += std::abs(term);
            }
          for (std::size_t k = 0; k < pressing.size(); ++k)
            if (n >= 40 && n < 140 && tangent.force(k).value != 0) ++pressing[k];
        });
    for (std::size_t p = 0; p < kAll; ++p) {
      EXPECT_GT(scale[p], 0);
      EXPECT_TRUE(within(backwards.derivative_by(p), expected[p], 1e-10 * scale[p]))
          << "scene " << seed << ", direction " << p;
      worst = std::max(worst, std::abs(backwards.derivative_by(p) - expected[p]) / scale[p]);
    }
  }
  for (const std::size_t samples : pressing) EXPECT_GT(samples, 200U);
  Measured() << "worst difference, over the sum of the sizes: " << worst;
}

// A sum over all samples, in long double; off by at most 1e-6 of the weights times the largest slope of each output,
// as in NetworkGradient's test.
TEST(MovingPlacesGradient, IsTheCentralDifferenceInLongDouble) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Scene scene(seed, -1, 0);
    const Backwards backwards(scene, seed);
    for (int p = 0; p < Scene::kDirections; ++p) {
      const auto slopes = middle_difference([&](Real h) { return Moving<Real>(seed, p, h).samples(p, h); }, 1e-8L);
      double expected = 0, scale = 0;
      for (std::size_t k = 0; k < scene.outputs(); ++k) {
        double weight = 0, most = 0;
        for (std::size_t i = k; i < slopes.size(); i += scene.outputs()) {
          expected += backwards.weight(i) * slopes[i];
          weight += std::abs(backwards.weight(i));
          most = std::max(most, std::abs(slopes[i]));
        }
        scale += weight * most;
      }
      const double found = backwards.derivative_by(std::size_t(p));
      EXPECT_TRUE(within(found, expected, 1e-6 * scale)) << "scene " << seed << ", direction " << p;
      worst = std::max(worst, std::abs(found - expected) / scale);
    }
  }
  Measured() << "worst difference, over the weights times the largest slope of each output: " << worst;
}

// Where a place begins: as put_place() before the first sample, also through a move that is too fast to follow.
TEST(MovingPlacesGradient, IsThatOfWhereAPlaceBegins) {
  using Tangent = NetworkTangent<double, 2>;
  constexpr std::size_t kEnd = 300;
  const Scene scene(4, -1, 0);
  RecordedNetwork<double> network(scene.plan, Scene::kRate);
  Tangent tangent(scene.plan, Scene::kRate, {});
  tangent.put_place(scene.slid, {scene.start, {1, 0}});
  tangent.put_place(scene.heard, {0.7, {0, 1}});
  NetworkWeights<double> weights;
  weights.displacements.resize(scene.plan.places().size());
  std::array<double, 2> expected{};
  const auto play = [&](auto& model, auto each) {
    model.set_motion(scene.mass, 0.0, 0.5);
    for (std::size_t n = 0; n < kEnd; ++n) {
      if (n == 100) model.move_place(scene.slid, scene.start + 0.4);  // which it does not reach
      if (n == 150) model.move_place(scene.heard, 0.705);             // which it does
      model.tick();
      each(n);
    }
  };
  play(network, [](std::size_t) {});
  EXPECT_LT(network.model().place_m(scene.slid), scene.start + 0.39);
  EXPECT_EQ(network.model().place_m(scene.heard), 0.705);
  for (const std::size_t place : {scene.slid, scene.heard}) weights.displacements[place].assign(kEnd, 0.0);
  play(tangent, [&](std::size_t n) {
    if (n != 50 && n != kEnd - 1) return;
    for (const std::size_t place : {scene.slid, scene.heard}) {
      weights.displacements[place][n] = 1;
      for (std::size_t p = 0; p < 2; ++p) expected[p] += tangent.displacement(place).slopes[p];
    }
  });
  const auto gradient = network.gradient(weights);
  EXPECT_TRUE(relatively_within(gradient.starts[scene.slid], expected[0], 1e-10));  // thousands of products
  EXPECT_TRUE(relatively_within(gradient.starts[scene.heard], expected[1], 1e-10));
  EXPECT_EQ(gradient.starts[scene.on_mass], 0);
}

TEST(MovingPlacesGradient, IsZeroWithoutASample) {
  const Scene scene(4, -1, 0);
  RecordedNetwork<double> network(scene.plan, Scene::kRate);
  const auto gradient = network.gradient(random_weights(scene.plan, {scene.slid, scene.heard}, kSamples, Random(4)));
  EXPECT_EQ(gradient.starts, std::vector<double>(scene.plan.places().size(), 0.0));
  const auto& shapes = gradient.numbers.places[scene.slid];
  for (std::size_t i = 0; i < shapes.size(); ++i) EXPECT_EQ(shapes[i], 0);
}

// What is not a number does nothing but stop a place. What is out of range does as the end of the range does, so its
// derivative is 0.
TEST(MovingPlacesGradient, TakesNumbersInTheirRangesAlone) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  constexpr std::size_t kEnd = 400;
  const Scene scene(3, -1, 0);
  const auto played = [&](double below, double above, bool has_none) {
    RecordedNetwork<double> network(scene.plan, Scene::kRate);
    network.set_motion(scene.mass, 0, 0.5);
    for (std::size_t n = 0; n < kEnd; ++n) {
      if (n == 10 && has_none) network.move_place(scene.heard, kNone);
      if (n == 20) network.put_place(scene.heard, above);
      if (n == 21) network.put_place(scene.heard, 0.99);
      if (n == 50) network.move_place(scene.heard, above);
      if (n == 150) network.put_place(scene.slid, 0.01);
      if (n == 160) network.move_place(scene.slid, below);
      if (n == 300) network.move_place(scene.slid, 0.02);
      network.push(scene.on_mass, 20);
      network.tick();
      if (n == 299) {
        EXPECT_EQ(network.model().place_m(scene.slid), 0);
      }
    }
    NetworkWeights<double> weights;
    weights.displacements.resize(scene.plan.places().size());
    weights.displacements[scene.heard].assign(kEnd, 1.0);
    return network.gradient(weights);
  };
  const auto most = played(0, 1, false);  // 1 m is the length of the string
  for (const bool is_infinite : {false, true}) {
    const auto found = is_infinite ? played(-kInfinite, kInfinite, true) : played(-0.1, 1.5, true);
    ASSERT_EQ(found.moves.size(), 6U);
    ASSERT_EQ(most.moves.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
      const bool is_beyond = i == 0 || i == 2 || i == 4;
      EXPECT_NE(most.moves[i], 0) << i;
      EXPECT_EQ(found.moves[i], is_beyond ? 0 : most.moves[i]) << i;
    }
    EXPECT_EQ(found.starts[scene.slid], most.starts[scene.slid]);
    EXPECT_EQ(found.starts[scene.heard], most.starts[scene.heard]);
  }
}

}  // namespace
}  // namespace contactspline::testing
