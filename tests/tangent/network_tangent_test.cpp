// SPDX-License-Identifier: MIT
// Derivatives of networks of bodies, contacts and springs: against central differences of the network in long double.
#include "contactspline/tangent/network_tangent.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "exact_felt.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr std::size_t kSamples = 400, kModes = 6;

/// Two masses with felts, the first on a string, which lies on a bridge of three points, the second above the first;
/// a spring with a damper at the end of the string and one between the masses. In any type, with each number moved by
/// a part `h` of itself.
template <typename T>
struct Scene {
  enum Number {
    kStiffness,
    kLoss,
    kWeight,
    kTime,
    kSpring,
    kResistance,
    kGap,
    kMass,
    kFrequency,
    kDecay,
    kModeMass,
    kShape,
    kSpeed,
    kPush,
    kNumbers
  };

  Scene(Random random, int moved, T h) : speed(T(random.between(0.5, 4))), push(T(random.between(0, 5))) {
    const auto part = [&](Number number, double value) { return number == moved ? T(value) * (1 + h) : T(value); };
    rate = random.log_between(30000, 100000);
    speed = part(kSpeed, double(speed)), push = part(kPush, double(push));
    exponent = random.between(1.3, 3);
    felt = power_table<T>(random.log_between(1e7, 1e10), exponent, 1e-3, 40);
    wood = power_table<T>(random.log_between(1e7, 1e8), 1.3, 1e-3, 40);
    memories = {
        {double(part(kWeight, random.between(0.2, 0.8))), double(part(kTime, random.log_between(5e-6, 2e-4)))}};
    const double mass = double(part(kMass, random.log_between(2e-3, 2e-2)));
    masses = {plan.add_mass(mass), plan.add_mass(random.log_between(2e-3, 2e-2))};
    std::vector<Mode> modes;
    const double w = 2 * std::numbers::pi * random.log_between(80, 400), mode_mass = random.log_between(1e-3, 1e-2);
    for (std::size_t i = 1; i <= kModes; ++i)
      modes.push_back({double(part(kFrequency, w * double(i))), double(part(kDecay, 1.0 + double(i))),
                       double(part(kModeMass, mode_mass))});
    const std::size_t string = plan.add_body(modes);
    const std::size_t hammer = plan.add_mass_place(masses[0]), second = plan.add_mass_place(masses[1]);
    const auto place = [&](double at, bool is_moved) {
      std::vector<double> shapes;
      for (std::size_t i = 1; i <= kModes; ++i) {
        const double shape = std::sin(std::numbers::pi * double(i) * at);
        shapes.push_back(is_moved ? double(part(kShape, shape)) : shape);
      }
      return plan.add_place(string, shapes);
    };
    struck = place(random.between(0.1, 0.3), true);
    const ContactControls<T> controls{part(kStiffness, random.log_between(0.5, 2)),
                                      part(kLoss, random.between(0.01, 0.1))};
    plan.add_contact(hammer, struck, SegmentTable<T>(felt), part(kGap, 1e-5), controls, T(1.3), memories);
    plan.add_contact(second, hammer, SegmentTable<T>(felt), T(2e-4));
    for (const double at : {0.55, 0.6, 0.65})
      plan.add_contact(place(at, false), kGround, SegmentTable<T>(wood), T(1e-5), {}, T(0.1));
    plan.add_spring(place(0.9, false), kGround, part(kSpring, random.log_between(1e3, 1e5)), part(kResistance, 0.3));
    plan.add_spring(hammer, second, T(200));
  }

  [[nodiscard]] std::vector<T> play() const {
    ContactNetwork<T> network(plan, rate);
    network.set_motion(masses[0], 0, speed);
    network.set_motion(masses[1], 0, 2 * speed);
    std::vector<T> samples;
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (n < 50) network.push(struck, push);
      network.tick();
      samples.push_back(network.displacement(struck));
      for (std::size_t k = 0; k < plan.connections().size(); ++k) samples.push_back(network.force(k));
    }
    return samples;
  }

  T speed, push;
  double rate, exponent;
  std::vector<Segment<T>> felt, wood;
  std::vector<Memory> memories;
  NetworkPlan<T> plan;
  std::array<std::size_t, 2> masses{};
  std::size_t struck = 0;
};

using Played = Scene<double>;
using Tangent = NetworkTangent<double, Played::kNumbers>;

/// The derivatives for all numbers, as play() orders the samples.
struct Slopes {
  explicit Slopes(const Played& scene) : scene_(scene), tangent(scene.plan, scene.rate, directions()) {
    tangent.set_motion(scene.masses[0], 0, along(Played::kSpeed, scene.speed));
    tangent.set_motion(scene.masses[1], 0, along(Played::kSpeed, 2 * scene.speed));
  }

  static Tangent::Number along(std::size_t number, double value) {
    Tangent::Number result(value);
    result.slopes[number] = value;
    return result;
  }

  [[nodiscard]] std::array<NetworkNumbers<double>, Played::kNumbers> directions() const {
    const NetworkPlan<double>& plan = scene_.plan;
    std::array<NetworkNumbers<double>, Played::kNumbers> all;
    const auto& contact = plan.connections()[0];
    const auto& spring = plan.connections()[5];
    for (auto& direction : all) direction.connections.resize(plan.connections().size());
    all[Played::kStiffness].connections[0].contact.stiffness_ratio = contact.contact.stiffness_ratio;
    all[Played::kLoss].connections[0].contact.loss_s_per_m = contact.contact.loss_s_per_m;
    all[Played::kWeight].connections[0].contact.memories = {{scene_.memories[0].weight, 0}};
    all[Played::kTime].connections[0].contact.memories = {{0, scene_.memories[0].time_s}};
    all[Played::kSpring].connections[5].spring_n_per_m = spring.spring_n_per_m;
    all[Played::kResistance].connections[5].resistance_n_s_per_m = spring.resistance_n_s_per_m;
    all[Played::kGap].connections[0].gap_m = contact.gap_m;
    for (const auto number : {Played::kMass, Played::kFrequency, Played::kDecay, Played::kModeMass}) {
      auto& bodies = all[number].bodies;
      bodies.resize(plan.bodies().size());
      const std::size_t body = number == Played::kMass ? 0 : 2;
      for (const Mode& mode : plan.bodies()[body])
        bodies[body].push_back({number == Played::kFrequency ? mode.angular_frequency_rad_per_s : 0,
                                number == Played::kDecay ? mode.decay_per_s : 0,
                                number == Played::kMass || number == Played::kModeMass ? mode.mass_kg : 0});
    }
    auto& places = all[Played::kShape].places;
    places.resize(plan.places().size());
    places[scene_.struck] = plan.places()[scene_.struck].shapes;
    return all;
  }

  void tick(std::size_t n) {
    if (n < 50) tangent.push(scene_.struck, along(Played::kPush, scene_.push));
    tangent.tick();
  }

  const Played& scene_;
  Tangent tangent;
};

double largest(std::span<const double> values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

// Knots bend what is played: the wider a central difference, the more of them lie within it. The narrower, the more
// its values round. Of three widths the middle difference is the right one, sample by sample.
template <typename Play>
std::vector<double> middle_difference(Play play, Real width) {
  const auto wide = central_difference(play, 10 * width), middle = central_difference(play, width),
             narrow = central_difference(play, width / 10);
  std::vector<double> differences;
  for (std::size_t n = 0; n < wide.size(); ++n)
    differences.push_back(std::max(std::min(wide[n], middle[n]), std::min(std::max(wide[n], middle[n]), narrow[n])));
  return differences;
}

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
      constexpr std::array kWeak = {Played::kLoss, Played::kSpring, Played::kResistance, Played::kDecay};
      const Real width = std::ranges::count(kWeak, p) > 0 ? 1e-6L : 1e-8L;
      const auto expected = middle_difference([&](Real h) { return Scene<Real>(Random(seed), p, h).play(); }, width);
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

TEST(NetworkTangent, AllocatesNothingAfterConstruction) {
  const Played scene(Random(3), -1, 0);
  Slopes slopes(scene);
  const std::size_t before = allocations;
  for (std::size_t n = 0; n < kSamples; ++n) slopes.tick(n);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace contactspline::testing
