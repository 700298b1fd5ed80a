// SPDX-License-Identifier: MIT
// Gradients of networks: against the tangents read backwards, and against central differences in long double.
#include "contactspline/tangent/network_gradient.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "network_scene.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

/// A scene that is played for its gradient, and weights for its samples at random.
struct Backwards {
  Backwards(const Played& played, std::uint64_t seed) : scene(played), network(played.plan, played.rate) {
    network.set_motion(scene.masses[0], 0, scene.speed);
    network.set_motion(scene.masses[1], 0, 2 * scene.speed);
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (n < 50) network.push(scene.struck, scene.push);
      network.tick();
    }
    Random random(seed);
    weights.displacements.resize(scene.plan.places().size());
    weights.displacements[scene.struck] = random_weights(random, 1);
    for (std::size_t k = 0; k < scene.plan.connections().size(); ++k)
      weights.forces.push_back(random_weights(random, 1e-6));  // forces are large numbers
    gradient = network.gradient(weights);
  }

  static std::vector<double> random_weights(Random& random, double size) {
    std::vector<double> weights(kSamples);
    for (double& weight : weights) weight = random.between(-size, size);
    return weights;
  }

  /// The weight of a sample, as Scene::play() orders them.
  [[nodiscard]] double weight(std::size_t i) const {
    const std::size_t outputs = 1 + scene.plan.connections().size(), n = i / outputs, k = i % outputs;
    return k == 0 ? weights.displacements[scene.struck][n] : weights.forces[k - 1][n];
  }

  /// The derivative of the sum with respect to a number of the scene, as its Slopes count it.
  [[nodiscard]] double derivative_by(int number, const NetworkNumbers<double>& direction) const {
    double sum = derivative(gradient.numbers, direction);
    if (number == Played::kSpeed)
      sum += scene.speed * (gradient.motions[0].velocity_m_per_s + 2 * gradient.motions[1].velocity_m_per_s);
    if (number == Played::kPush)
      for (const double push : gradient.pushes) sum += scene.push * push;
    return sum;
  }

  const Played& scene;
  RecordedNetwork<double> network;
  NetworkWeights<double> weights;
  NetworkGradient<double> gradient;
};

// The same derivatives the other way round: sums of thousands of products, each rounded.
TEST(NetworkGradient, IsTheTangentReadBackwards) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Played scene(Random(seed), -1, 0, seed % 3);
    const Backwards backwards(scene, seed);
    Slopes slopes(scene);
    const std::size_t outputs = 1 + scene.plan.connections().size();
    std::array<double, Played::kNumbers> expected{}, scale{};
    for (std::size_t n = 0; n < kSamples; ++n) {
      slopes.tick(n);
      for (std::size_t k = 0; k < outputs; ++k)
        for (std::size_t p = 0; p < Played::kNumbers; ++p) {
          const double slope =
              k == 0 ? slopes.tangent.displacement(scene.struck).slopes[p] : slopes.tangent.force(k - 1).slopes[p];
          expected[p] += backwards.weight(n * outputs + k) * slope;
          scale[p] += std::abs(backwards.weight(n * outputs + k) * slope);
        }
    }
    const auto directions = slopes.directions();
    for (int p = 0; p < Played::kNumbers; ++p) {
      const double found = backwards.derivative_by(p, directions[std::size_t(p)]), size = scale[std::size_t(p)];
      EXPECT_TRUE(within(found, expected[std::size_t(p)], 1e-10 * size)) << "scene " << seed << ", number " << p;
      if (size > 0) worst = std::max(worst, std::abs(found - expected[std::size_t(p)]) / size);
    }
  }
  Measured() << "worst difference, over the sum of the sizes: " << worst;
}

// What the roundings of double grow to: of each output, in parts of its largest value.
double amplified_rounding(const Played& scene, const Scene<Real>& exact) {
  const std::vector<double> rounded = scene.play();
  const std::vector<Real> expected = exact.play();
  const std::size_t outputs = 1 + scene.plan.connections().size();
  double worst = 0;
  for (std::size_t k = 0; k < outputs; ++k) {
    double most = 0, difference = 0;
    for (std::size_t i = k; i < rounded.size(); i += outputs) {
      most = std::max(most, std::abs(rounded[i]));
      difference = std::max(difference, double(std::abs(Real(rounded[i]) - expected[i])));
    }
    if (most > 0) worst = std::max(worst, difference / most);
  }
  return worst;
}

// A sum over all samples, in long double, whose numbers move by a little. It is off by at most what each output may
// be off in NetworkTangent's test, 1e-6 of its largest slope, times its weights. In a scene that amplifies
// roundings beyond 1e-10, double and long double play two different samples: these scenes are left out.
TEST(NetworkGradient, IsTheCentralDifferenceInLongDouble) {
  double worst = 0;
  std::array<int, 3> compared{};  // with as many memories
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const std::size_t memories = seed % 3;
    const Played scene(Random(seed), -1, 0, memories);
    if (amplified_rounding(scene, Scene<Real>(Random(seed), -1, 0, memories)) > 1e-10) continue;
    ++compared[memories];
    const Backwards backwards(scene, seed);
    const auto directions = Slopes(scene).directions();
    const std::size_t outputs = 1 + scene.plan.connections().size();
    for (int p = 0; p < Played::kNumbers; ++p) {
      const auto slopes =
          middle_difference([&](Real h) { return Scene<Real>(Random(seed), p, h, memories).play(); }, width_for(p));
      double expected = 0, scale = 0;
      for (std::size_t k = 0; k < outputs; ++k) {
        double weight = 0, most = 0;
        for (std::size_t i = k; i < slopes.size(); i += outputs) {
          expected += backwards.weight(i) * slopes[i];
          weight += std::abs(backwards.weight(i));
          most = std::max(most, std::abs(slopes[i]));
        }
        scale += weight * most;
      }
      const double found = backwards.derivative_by(p, directions[std::size_t(p)]);
      EXPECT_TRUE(within(found, expected, 1e-6 * scale)) << "scene " << seed << ", number " << p;
      if (scale > 0) worst = std::max(worst, std::abs(found - expected) / scale);
    }
  }
  for (const int count : compared) EXPECT_GE(count, 4);
  Measured() << "worst difference, over the weights times the largest slope of each output: " << worst;
}

// The place of a contact on a string, by the derivatives of the shapes there; within 1e-6, as above.
TEST(NetworkGradient, IsThatOfAPlaceOnAString) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    using Scene = Slide<double>;
    const Scene scene(Random(seed), -1, 0);
    RecordedNetwork<double> network(scene.plan, Scene::kRate);
    network.set_motion(scene.mass, 0, 0.5);
    for (std::size_t n = 0; n < kSamples; ++n) {
      network.push(scene.on_mass, 5);
      network.tick();
    }
    Random random(seed);
    NetworkWeights<double> weights;
    weights.displacements.resize(scene.plan.places().size());
    weights.displacements[scene.output] = Backwards::random_weights(random, 1);
    NetworkNumbers<double> direction;
    direction.places.resize(scene.plan.places().size());
    direction.places[scene.slid] = shapes_tangent<double>(scene.wavenumbers, scene.start, scene.start);
    const auto slopes =
        middle_difference([&](Real h) { return Slide<Real>(Random(seed), Scene::kStart, h).play(false); }, 1e-8L);
    const std::size_t outputs = 2 + scene.plan.connections().size();
    double expected = 0, weight = 0, most = 0;
    for (std::size_t n = 0; n < kSamples; ++n) {
      expected += weights.displacements[scene.output][n] * slopes[n * outputs];
      weight += std::abs(weights.displacements[scene.output][n]);
      most = std::max(most, std::abs(slopes[n * outputs]));
    }
    const double found = derivative(network.gradient(weights).numbers, direction);
    EXPECT_TRUE(within(found, expected, 1e-6 * weight * most)) << "scene " << seed;
    worst = std::max(worst, std::abs(found - expected) / weight / most);
  }
  Measured() << "worst difference for a place, over the weights times the largest slope: " << worst;
}

// Two masses and two memories; the first mass is thrown twice. A spring of no stiffness has derivatives, too.
TEST(NetworkGradient, TakesWhatIsSetBetweenSamples) {
  constexpr std::size_t kThrow = 150, kAll = 333;
  const auto felt = power_table<double>(1e8, 2.3, 1e-3, 40);
  const std::vector<Memory> memories = {{0.4, 2e-5}, {0.2, 1e-4}};
  NetworkPlan<double> plan;
  const std::size_t a = plan.add_mass(0.003), b = plan.add_mass(0.008);
  const std::size_t on_a = plan.add_mass_place(a), on_b = plan.add_mass_place(b);
  plan.add_contact(on_a, on_b, SegmentTable<double>(felt), 1e-5, {1, 0.05}, 1, memories);
  plan.add_spring(on_b, kGround, 0, 0);
  plan.add_contact(on_b, kGround, SegmentTable<double>(felt), 3e-3);

  enum Number { kDisplacement, kVelocity, kFirst, kPush, kSpring, kResistance, kNumbers };
  using Tangent = NetworkTangent<double, kNumbers>;
  std::array<NetworkNumbers<double>, kNumbers> directions;
  for (const Number number : {kSpring, kResistance}) directions[number].connections.resize(3);
  directions[kSpring].connections[1].spring_n_per_m = 1;
  directions[kResistance].connections[1].resistance_n_s_per_m = 1;
  const auto along = [](std::size_t number, double value) {
    Tangent::Number result(value);
    result.slopes[number] = 1;
    return result;
  };
  RecordedNetwork<double> network(plan, 44100);
  Tangent tangent(plan, 44100, directions);
  network.set_motion(a, 0, 2);
  tangent.set_motion(a, 0, along(kFirst, 2));
  std::array<double, kNumbers> expected{};
  NetworkWeights<double> weights;
  weights.displacements.resize(2);
  weights.forces.resize(1);
  for (std::size_t n = 0; n < kAll; ++n) {
    if (n == kThrow) {
      network.set_motion(a, 1e-6, 3);
      tangent.set_motion(a, along(kDisplacement, 1e-6), along(kVelocity, 3));
    }
    if (n == 20 || n == 200) {
      network.push(on_b, 3);
      network.push(on_b, 1);
      tangent.push(on_b, along(kPush, 3));
      tangent.push(on_b, 1);
    }
    network.tick();
    tangent.tick();
    const double weight = std::cos(double(n) / 7);
    weights.displacements[1].push_back(weight);
    if (n < 300) weights.forces[0].push_back(1e-5 * weight);
    for (std::size_t p = 0; p < kNumbers; ++p)
      expected[p] +=
          weight * (tangent.displacement(on_b).slopes[p] + (n < 300 ? 1e-5 * tangent.force(0).slopes[p] : 0.0));
  }
  const auto gradient = network.gradient(weights);
  const auto& moved = gradient.motions[1];
  const std::array<double, kNumbers> found = {moved.displacement_m,
                                              moved.velocity_m_per_s,
                                              gradient.motions[0].velocity_m_per_s,
                                              gradient.pushes[0] + gradient.pushes[2],
                                              gradient.numbers.connections[1].spring_n_per_m,
                                              gradient.numbers.connections[1].resistance_n_s_per_m};
  EXPECT_EQ(gradient.pushes[0], gradient.pushes[1]);
  for (std::size_t p = 0; p < kNumbers; ++p)  // hundreds of products, each rounded
    EXPECT_TRUE(within(found[p], expected[p], 1e-11 * std::abs(expected[p]))) << "number " << p;
}

}  // namespace
}  // namespace contactspline::testing
