// SPDX-License-Identifier: MIT
// Derivatives of networks with friction: forwards against central differences in long double, backwards against
// forwards.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "contactspline/tangent/network_gradient.hpp"
#include "contactspline/tangent/network_tangent.hpp"
#include "power_table.hpp"
#include "random_weights.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/random.hpp"

namespace contactspline::testing {
namespace {

constexpr std::size_t kSamples = 1500, kModes = 8;

/// A string that is bowed at two points of rosin, which a felted mass presses on at one of them; the string ends on a
/// second body, which a third friction of a constant coefficient rubs. Each number may be moved by a part h of
/// itself.
template <typename T>
struct Bowed {
  enum Number {
    kStiffness,
    kDamping,
    kCold,
    kHot,
    kSoftening,
    kCapacity,
    kConduction,
    kRenewal,
    kWidth,
    kNormal,
    kSpeed,
    kFrequency,
    kShape,
    kFelt,
    kThrow,
    kNumbers
  };

  Bowed(Random random, int moved, double h) {
    const auto part = [&](Number number, double value) { return number == moved ? value * (1 + h) : value; };
    rate = random.log_between(30000, 100000);
    material = {
        .bristles = {part(kStiffness, random.log_between(1e5, 1e7)), part(kDamping, random.log_between(0.01, 1))},
        .heat = {part(kCold, random.between(0.8, 1.2)), part(kHot, random.between(0.1, 0.3)),
                 part(kSoftening, random.between(15, 40)), part(kCapacity, random.log_between(5e-7, 5e-6)),
                 part(kConduction, random.log_between(5e-5, 5e-4)), part(kRenewal, random.between(0.02, 0.08))}};
    width_m = part(kWidth, 0.01);
    normal_n = part(kNormal, random.between(0.2, 2)), speed = part(kSpeed, random.between(0.05, 0.3));
    thrown = part(kThrow, random.between(0.5, 1.5));
    felt = power_table<T>(random.log_between(1e7, 1e9), 2.3, 1e-3, 40);
    std::vector<Mode> modes;
    const double w = 2 * std::numbers::pi * random.log_between(150, 600);
    for (std::size_t i = 1; i <= kModes; ++i)
      modes.push_back({part(kFrequency, w * double(i)), 2.0 + double(i), random.log_between(1e-3, 5e-3)});
    const std::size_t string = plan.add_body(modes);
    const auto place = [&](double at, bool is_moved) {
      std::vector<double> shapes;
      for (std::size_t i = 1; i <= kModes; ++i) {
        const double shape = std::sin(std::numbers::pi * double(i) * at);
        shapes.push_back(is_moved ? part(kShape, shape) : shape);
      }
      return plan.add_place(string, shapes);
    };
    bowed = place(random.between(0.07, 0.15), true);
    const std::size_t beside = place(random.between(0.16, 0.2), false), end = place(0.93, false);
    hammer = plan.add_mass(random.log_between(2e-3, 2e-2));
    const std::array<Mode, 1> board = {Mode{2 * std::numbers::pi * 300, 20, 0.05}};
    const std::array<double, 1> one = {1};
    const std::size_t bridge = plan.add_place(plan.add_body(board), one);
    const auto controls = ContactControls<T>{T(part(kFelt, 1.2)), T(0.02)};
    const std::size_t contact =
        plan.add_contact(plan.add_mass_place(hammer), bridge, SegmentTable<T>(felt), T(1e-5), controls);
    plan.add_spring(end, bridge, T(2e4), T(0.2));
    frictions = {plan.add_friction(kGround, bowed, material, width_m),
                 plan.add_friction(kGround, beside, material, width_m, contact),
                 plan.add_friction(kGround, bridge, coulomb_friction(0.3, {.stiffness_per_m = 1e5}))};
  }

  /// What each friction is given: normal force and speed change once, so that there are several calls.
  template <typename Network, typename Value>
  void control(Network& network, std::size_t n, const Value& normal, const Value& moved) const {
    if (n != 0 && n != kSamples / 2) return;
    for (const std::size_t k : {frictions[0], frictions[1]}) {
      network.set_normal_force(k, n == 0 ? normal : normal * Value(0.75));
      network.set_surface_speed(k, n == 0 ? moved : moved * Value(1.25));
    }
    if (n == 0) network.set_normal_force(frictions[2], Value(T(0.02)));
  }

  /// Displacement of the bowed place and the forces, in each sample.
  [[nodiscard]] std::vector<T> play() const {
    ContactNetwork<T> network(plan, rate);
    network.set_motion(hammer, T(0), T(thrown));
    std::vector<T> samples;
    for (std::size_t n = 0; n < kSamples; ++n) {
      control(network, n, T(normal_n), T(speed));
      network.tick();
      samples.push_back(network.displacement(bowed));
      for (std::size_t k = 0; k < plan.connections().size(); ++k) samples.push_back(network.force(k));
      slips += network.slip(frictions[0]) > 0;
    }
    return samples;
  }

  double rate = 0, width_m = 0, normal_n = 0, speed = 0, thrown = 0;
  FrictionMaterial material;
  std::vector<Segment<T>> felt;
  NetworkPlan<T> plan;
  std::size_t bowed = 0, hammer = 0;
  std::array<std::size_t, 3> frictions{};
  mutable std::size_t slips = 0;
};

using Played = Bowed<double>;
using Tangent = NetworkTangent<double, Played::kNumbers>;

std::array<NetworkNumbers<double>, Played::kNumbers> directions_of(const Played& scene) {
  std::array<NetworkNumbers<double>, Played::kNumbers> directions;
  const auto numbers = FrictionNumbers<double>::of(scene.material, scene.width_m).values();
  const std::size_t connections = scene.plan.connections().size();
  for (std::size_t p = 0; p < numbers.size(); ++p) {
    directions[p].connections.resize(connections);
    std::array<double, FrictionNumbers<double>::kCount> one{};
    one[p] = numbers[p];
    for (const std::size_t k : {scene.frictions[0], scene.frictions[1]})
      directions[p].connections[k].friction = FrictionNumbers<double>::of(one);
  }
  for (const Mode& mode : scene.plan.bodies()[0]) {
    auto& bodies = directions[Played::kFrequency].bodies;
    if (bodies.empty()) bodies.emplace_back();
    bodies[0].push_back({mode.angular_frequency_rad_per_s, 0, 0});
  }
  directions[Played::kShape].places = {scene.plan.places()[scene.bowed].shapes};
  directions[Played::kFelt].connections.resize(connections);
  directions[Played::kFelt].connections[0].contact.stiffness_ratio = 1.2;
  return directions;
}

/// The slopes of all samples, as play() orders them.
struct Slopes {
  explicit Slopes(const Played& of) : scene(of), tangent(of.plan, of.rate, directions_of(of)) {
    tangent.set_motion(scene.hammer, 0, along(Played::kThrow, scene.thrown));
  }
  [[nodiscard]] static Tangent::Number along(int number, double value) {
    Tangent::Number result(value);
    result.slopes[std::size_t(number)] = value;
    return result;
  }
  void tick(std::size_t n) {
    scene.control(tangent, n, along(Played::kNormal, scene.normal_n), along(Played::kSpeed, scene.speed));
    tangent.tick();
  }

  const Played& scene;
  Tangent tangent;
};

// Numbers of double, moved by 1e-9 of themselves, are rounded by 1e-7 of that; the sums cancel to a hundredth at
// most. Steps so small meet no sample that begins or ends to slip, where the force has a kink.
TEST(FrictionTangent, IsTheLimitOfCentralDifferences) {
  std::array<double, Played::kNumbers> worst{};
  std::size_t slipped = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const Played scene(Random(seed), -1, 0);
    Slopes slopes(scene);
    const std::size_t outputs = 1 + scene.plan.connections().size();
    const auto weights = random_weights(scene.plan, {scene.bowed}, kSamples, Random(seed));
    std::array<double, Played::kNumbers> found{}, scale{};
    for (std::size_t n = 0; n < kSamples; ++n) {
      slopes.tick(n);
      for (std::size_t k = 0; k < outputs; ++k)
        for (std::size_t p = 0; p < Played::kNumbers; ++p) {
          const double slope =
              k == 0 ? slopes.tangent.displacement(scene.bowed).slopes[p] : slopes.tangent.force(k - 1).slopes[p];
          found[p] += weight_of(weights, scene.bowed, n * outputs + k) * slope;
          scale[p] += std::abs(weight_of(weights, scene.bowed, n * outputs + k) * slope);
        }
    }
    for (int p = 0; p < Played::kNumbers; ++p) {
      constexpr double kStep = 1e-9;
      const Bowed<long double> above(Random(seed), p, kStep), below(Random(seed), p, -kStep);
      const auto up = above.play(), down = below.play();
      long double expected = 0;
      for (std::size_t i = 0; i < up.size(); ++i)
        expected += weight_of(weights, scene.bowed, i) * (up[i] - down[i]) / (2 * kStep);
      const auto i = std::size_t(p);
      EXPECT_GT(scale[i], 0) << p;
      EXPECT_TRUE(within(found[i], double(expected), 2e-5 * scale[i])) << "scene " << seed << ", number " << p;
      worst[i] = std::max(worst[i], std::abs(found[i] - double(expected)) / scale[i]);
      slipped += above.slips;
    }
  }
  for (std::size_t p = 0; p < worst.size(); ++p) Measured() << "number " << p << ": " << worst[p];
  EXPECT_GT(slipped, 15u * Played::kNumbers * kSamples / 20);  // it sticks and slips
}

// The same derivatives the other way round: sums of thousands of products, each rounded.
TEST(FrictionGradient, IsTheTangentReadBackwards) {
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const Played scene(Random(seed), -1, 0);
    RecordedNetwork<double> network(scene.plan, scene.rate);
    network.set_motion(scene.hammer, 0, scene.thrown);
    Slopes slopes(scene);
    const std::size_t outputs = 1 + scene.plan.connections().size();
    const auto weights = random_weights(scene.plan, {scene.bowed}, kSamples, Random(seed));
    std::array<double, Played::kNumbers> expected{}, scale{};
    for (std::size_t n = 0; n < kSamples; ++n) {
      scene.control(network, n, scene.normal_n, scene.speed);
      network.tick();
      slopes.tick(n);
      for (std::size_t k = 0; k < outputs; ++k)
        for (std::size_t p = 0; p < Played::kNumbers; ++p) {
          const double slope =
              k == 0 ? slopes.tangent.displacement(scene.bowed).slopes[p] : slopes.tangent.force(k - 1).slopes[p];
          expected[p] += weight_of(weights, scene.bowed, n * outputs + k) * slope;
          scale[p] += std::abs(weight_of(weights, scene.bowed, n * outputs + k) * slope);
        }
    }
    const NetworkGradient<double> gradient = network.gradient(weights);
    ASSERT_EQ(gradient.normal_forces.size(), 5u);
    ASSERT_EQ(gradient.surface_speeds.size(), 4u);
    const auto directions = directions_of(scene);
    for (std::size_t p = 0; p < Played::kNumbers; ++p) {
      double found = derivative(gradient.numbers, directions[p]);
      if (p == Played::kThrow) found += scene.thrown * gradient.motions[0].velocity_m_per_s;
      if (p == Played::kNormal)
        found += scene.normal_n * (gradient.normal_forces[0] + gradient.normal_forces[1] +
                                   0.75 * (gradient.normal_forces[3] + gradient.normal_forces[4]));
      if (p == Played::kSpeed)
        found += scene.speed * (gradient.surface_speeds[0] + gradient.surface_speeds[1] +
                                1.25 * (gradient.surface_speeds[2] + gradient.surface_speeds[3]));
      worst = std::max(worst, std::abs(found - expected[p]) / scale[p]);
      EXPECT_TRUE(within(found, expected[p], 1e-9 * scale[p])) << "scene " << seed << ", number " << p;
    }
  }
  Measured() << "worst difference, over the sum of the sizes: " << worst;
}

// Beyond their ranges controls have no derivative.
TEST(FrictionGradient, IsZeroBeyondTheRanges) {
  const Played scene(Random(3), -1, 0);
  RecordedNetwork<double> network(scene.plan, scene.rate);
  network.set_normal_force(scene.frictions[0], 2000);
  network.set_surface_speed(scene.frictions[0], 0.1);
  for (int n = 0; n < 200; ++n) network.tick();
  network.set_normal_force(scene.frictions[0], 1);  // acts in no sample
  const auto weights = random_weights(scene.plan, {scene.bowed}, 200, Random(3));
  const NetworkGradient<double> gradient = network.gradient(weights);
  EXPECT_EQ(gradient.normal_forces, (std::vector<double>{0, 0}));
  EXPECT_NE(gradient.surface_speeds[0], 0);
  const NetworkGradient<double> none = RecordedNetwork<double>(scene.plan, scene.rate).gradient(weights);
  EXPECT_TRUE(none.normal_forces.empty());
}

}  // namespace
}  // namespace contactspline::testing
