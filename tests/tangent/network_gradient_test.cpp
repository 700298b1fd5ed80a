// SPDX-License-Identifier: MIT
// Gradients of networks: against the tangents read backwards, and against central differences in long double.
#include "contactspline/tangent/network_gradient.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "network_scene.hpp"
#include "random_weights.hpp"
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
    weights = random_weights(scene.plan, {scene.struck}, kSamples, Random(seed));
    gradient = network.gradient(weights);
  }

  /// The weight of a number, as Scene::play() orders them.
  [[nodiscard]] double weight(std::size_t i) const { return weight_of(weights, scene.struck, i); }

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
    NetworkWeights<double> weights = random_weights(scene.plan, {scene.output}, kSamples, Random(seed));
    weights.forces.clear();
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
// is_forgotten: before the second blow.
void expect_what_is_set(const std::vector<Memory>& memories, bool is_forgotten) {
  constexpr std::size_t kThrow = 150, kAll = 333;
  const auto felt = power_table<double>(1e8, 2.3, 1e-3, 40);
  NetworkPlan<double> plan;
  const std::size_t a = plan.add_mass(0.003), b = plan.add_mass(0.008);
  const std::size_t on_a = plan.add_mass_place(a), on_b = plan.add_mass_place(b);
  plan.add_contact(on_a, on_b, SegmentTable<double>(felt), 1e-5, {1, 0.05}, 1, memories);
  plan.add_spring(on_b, kGround, 0, 0);
  plan.add_contact(on_b, kGround, SegmentTable<double>(felt), 3e-3);

  enum Number { kDisplacement, kVelocity, kFirst, kPush, kSpring, kResistance, kWeight, kTime, kNumbers };
  using Tangent = NetworkTangent<double, kNumbers>;
  std::array<NetworkNumbers<double>, kNumbers> directions;
  for (const Number number : {kSpring, kResistance, kWeight, kTime}) directions[number].connections.resize(3);
  directions[kSpring].connections[1].spring_n_per_m = 1;
  directions[kResistance].connections[1].resistance_n_s_per_m = 1;
  directions[kWeight].connections[0].contact.memories = {{1, 0}, {0, 0}};
  directions[kTime].connections[0].contact.memories = {{0, 0}, {0, 1}};
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
  bool is_struck_again = false;
  for (std::size_t n = 0; n < kAll; ++n) {
    if (n == kThrow) {
      EXPECT_EQ(network.model().solver()[0].memory.remembered().line() == 0, is_forgotten);
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
    is_struck_again = is_struck_again || (n > kThrow && network.model().force(0) > 0);
    const double weight = std::cos(double(n) / 7);
    weights.displacements[1].push_back(weight);
    if (n < 300) weights.forces[0].push_back(1e-5 * weight);
    for (std::size_t p = 0; p < kNumbers; ++p)
      expected[p] +=
          weight * (tangent.displacement(on_b).slopes[p] + (n < 300 ? 1e-5 * tangent.force(0).slopes[p] : 0.0));
  }
  EXPECT_TRUE(is_struck_again);
  const auto gradient = network.gradient(weights);
  const auto& moved = gradient.motions[1];
  const auto& connections = gradient.numbers.connections;
  const std::array<double, kNumbers> found = {moved.displacement_m,
                                              moved.velocity_m_per_s,
                                              gradient.motions[0].velocity_m_per_s,
                                              gradient.pushes[0] + gradient.pushes[2],
                                              connections[1].spring_n_per_m,
                                              connections[1].resistance_n_s_per_m,
                                              connections[0].contact.memories[0].weight,
                                              connections[0].contact.memories[1].time_s};
  EXPECT_EQ(gradient.pushes[0], gradient.pushes[1]);
  for (std::size_t p = 0; p < kNumbers; ++p)  // hundreds of products, each rounded
    EXPECT_TRUE(within(found[p], expected[p], 1e-11 * std::abs(expected[p]))) << "number " << p;
}

TEST(NetworkGradient, TakesWhatIsSetBetweenSamples) {
  expect_what_is_set({{0.4, 2e-5}, {0.2, 1e-4}}, false);
}

TEST(NetworkGradient, ForgetsBetweenTwoBlows) {
  expect_what_is_set({{0.4, 2e-6}, {0.2, 3e-6}}, true);
}

/// A mass on a felt of much loss, at a high rate. Pushes tear it off, so that the felt does not follow, and press it
/// again before it is off; once it is put elsewhere meanwhile. In any type, with each number moved by a part `h` of
/// itself.
template <typename T>
struct TornOff {
  enum Number { kStiffness, kLoss, kGap, kPush, kSpeed, kPlace, kNumbers };
  static constexpr double kRate = 192000;
  static constexpr std::size_t kThrow = 125, kAll = 250;

  TornOff(std::size_t memory_count, int moved, T h) {
    const auto part = [&](Number number, double value) { return number == moved ? T(value) * (1 + h) : T(value); };
    push_n = part(kPush, 700), speed = part(kSpeed, 2), place_m = part(kPlace, 1.5e-4);
    memories.resize(memory_count);
    mass = plan.add_mass(0.01);
    on_mass = plan.add_mass_place(mass);
    plan.add_contact(on_mass, kGround, SegmentTable<T>(felt), part(kGap, 1e-5),
                     {part(kStiffness, 1.0), part(kLoss, 2.0)}, 1, memories);
  }

  /// Plays a model. number(which, value): a number that it is given. Calls each(n) after sample n.
  template <typename Model, typename NumberOf, typename Each>
  void play(Model& model, NumberOf number, Each each) const {
    model.set_motion(mass, number(-1, T(0)), number(kSpeed, speed));
    for (std::size_t n = 0; n < kAll; ++n) {
      if (n == kThrow) model.set_motion(mass, number(kPlace, place_m), number(-1, T(1)));
      model.push(on_mass, number(kPush, push_n * T(n % 24 < 10 ? 1 : -0.7)));
      model.tick();
      each(n);
    }
  }

  std::vector<Segment<T>> felt = power_table<T>(1e9, 2.3, 1e-3, 40);
  std::vector<Memory> memories = {{0.3, 2e-5}, {0.1, 1e-4}};
  T push_n, speed, place_m;
  NetworkPlan<T> plan;
  std::size_t mass = 0, on_mass = 0;
};

// Forwards, backwards and by central differences of a sum over all samples. The bounds are those of other scenes.
TEST(NetworkGradient, TakesALossThatLetsGo) {
  using Scene = TornOff<double>;
  using Tangent = NetworkTangent<double, Scene::kNumbers>;
  constexpr std::array<double, 2> kWeights = {1, 1e-6};  // of displacement and force
  const auto weight = [](std::size_t n) { return std::cos(double(n) / 7); };
  double worst = 0;
  for (const std::size_t memories : {0U, 1U, 2U}) {
    const Scene scene(memories, -1, 0);
    std::array<NetworkNumbers<double>, Scene::kNumbers> directions;
    for (const auto number : {Scene::kStiffness, Scene::kLoss, Scene::kGap}) directions[number].connections.resize(1);
    directions[Scene::kStiffness].connections[0].contact.stiffness_ratio = 1;
    directions[Scene::kLoss].connections[0].contact.loss_s_per_m = 2;
    directions[Scene::kGap].connections[0].gap_m = 1e-5;

    RecordedNetwork<double> network(scene.plan, Scene::kRate);
    NetworkWeights<double> weights{{{}}, {{}}};
    std::size_t torn_off = 0;
    scene.play(
        network, [](int, double value) { return value; },
        [&](std::size_t n) {
          weights.displacements[0].push_back(kWeights[0] * weight(n));
          weights.forces[0].push_back(kWeights[1] * weight(n));
          if (network.model().force(0) == 0 && network.model().compression(0) > 0) ++torn_off;
        });
    EXPECT_GT(torn_off, 10U);
    const auto gradient = network.gradient(weights);
    const auto& contact = gradient.numbers.connections[0];
    std::array<double, Scene::kNumbers> found = {contact.contact.stiffness_ratio,
                                                 2 * contact.contact.loss_s_per_m,
                                                 1e-5 * contact.gap_m,
                                                 0,
                                                 scene.speed * gradient.motions[0].velocity_m_per_s,
                                                 scene.place_m * gradient.motions[1].displacement_m};
    for (std::size_t n = 0; n < Scene::kAll; ++n)
      found[Scene::kPush] += scene.push_n * (n % 24 < 10 ? 1 : -0.7) * gradient.pushes[n];

    Tangent tangent(scene.plan, Scene::kRate, directions);
    std::array<double, Scene::kNumbers> forwards{}, scale{};
    scene.play(
        tangent,
        [](int number, double value) {
          typename Tangent::Number given(value);
          if (number >= 0) given.slopes[std::size_t(number)] = value;
          return given;
        },
        [&](std::size_t n) {
          for (std::size_t p = 0; p < Scene::kNumbers; ++p)
            for (const double term : {kWeights[0] * weight(n) * tangent.displacement(scene.on_mass).slopes[p],
                                      kWeights[1] * weight(n) * tangent.force(0).slopes[p]})
              forwards[p] += term, scale[p] += std::abs(term);
        });
    for (int p = 0; p < Scene::kNumbers; ++p) {
      const auto sum_of = [&](Real h) {
        const TornOff<Real> exact(memories, p, h);
        ContactNetwork<Real> model(exact.plan, Scene::kRate);
        Real sum = 0;
        exact.play(
            model, [](int, Real value) { return value; },
            [&](std::size_t n) {
              sum += weight(n) * (kWeights[0] * model.displacement(exact.on_mass) + kWeights[1] * model.force(0));
            });
        return std::vector<Real>{sum};
      };
      const auto i = std::size_t(p);
      const double expected = middle_difference(sum_of, 1e-8L)[0];
      EXPECT_TRUE(within(found[i], forwards[i], 1e-10 * scale[i])) << memories << " memories, number " << p;
      EXPECT_TRUE(within(found[i], expected, 1e-6 * scale[i])) << memories << " memories, number " << p;
      worst = std::max(worst, std::abs(found[i] - expected) / scale[i]);
    }
  }
  Measured() << "worst difference where a loss lets go, over the sum of the sizes: " << worst;
}

// What is not a number does nothing. What is out of range does as the end of the range does, so its derivative is 0.
TEST(NetworkGradient, TakesNumbersInTheirRangesAlone) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr std::size_t kAll = 50;
  const auto played = [](double too_much, bool has_none) {
    NetworkPlan<double> plan;
    const std::size_t mass = plan.add_mass(0.003), on_mass = plan.add_mass_place(mass);
    plan.add_spring(on_mass, kGround, 1000, 0.1);
    RecordedNetwork<double> network(plan, 44100);
    for (std::size_t n = 0; n < kAll; ++n) {
      if (n == 0) network.set_motion(mass, 1e-3, too_much);
      if (n == 10) network.push(on_mass, -too_much);
      if (n == 10) network.push(on_mass, 3);
      if (n == 30) network.set_motion(mass, -too_much, 2);
      if (n == 20 && has_none) {
        network.push(on_mass, kNone);
        network.set_motion(mass, kNone, 1);
        network.set_motion(mass, 1, kNone);
      }
      network.tick();
    }
    return network.gradient({{std::vector<double>(kAll, 1.0)}, {}});
  };
  const auto found = played(5000, true), most = played(1000, false);  // 1000 is still within the ranges
  ASSERT_EQ(found.motions.size(), 2U);
  ASSERT_EQ(found.pushes.size(), 2U);
  EXPECT_EQ(found.numbers.connections[0].spring_n_per_m, most.numbers.connections[0].spring_n_per_m);
  EXPECT_EQ(found.motions[0].displacement_m, most.motions[0].displacement_m);
  EXPECT_EQ(found.motions[0].velocity_m_per_s, 0);
  EXPECT_EQ(found.motions[1].displacement_m, 0);
  EXPECT_EQ(found.motions[1].velocity_m_per_s, most.motions[1].velocity_m_per_s);
  EXPECT_EQ(found.pushes[0], 0);
  EXPECT_EQ(found.pushes[1], most.pushes[1]);
  for (const double value : {most.motions[0].displacement_m, most.motions[0].velocity_m_per_s,
                             most.motions[1].displacement_m, most.motions[1].velocity_m_per_s, most.pushes[0]})
    EXPECT_NE(value, 0);
}

// A body without modes stays where it is, as the ground does. Here it is the last body.
TEST(NetworkGradient, TakesABodyWithoutModes) {
  using Tangent = NetworkTangent<double, 1>;
  constexpr std::size_t kAll = 200;
  const auto felt = power_table<double>(1e8, 2.3, 1e-3, 40);
  const std::vector<Memory> memories = {{0.4, 2e-5}};
  std::vector<NetworkGradient<double>> gradients;
  for (const bool is_ground : {true, false}) {
    NetworkPlan<double> plan;
    const std::size_t mass = plan.add_mass(0.003), on_mass = plan.add_mass_place(mass);
    const std::size_t still = plan.add_place(plan.add_body({}), {}), under = is_ground ? kGround : still;
    plan.add_contact(on_mass, under, SegmentTable<double>(felt), 1e-5, {1, 0.05}, 1, memories);
    plan.add_spring(on_mass, under, 1000, 0.1);
    RecordedNetwork<double> network(plan, 44100);
    Tangent tangent(plan, 44100, {});
    network.set_motion(mass, 0, 2);
    tangent.set_motion(mass, 0, {2, {1}});
    NetworkWeights<double> weights;
    weights.displacements.resize(2);
    double expected = 0;
    for (std::size_t n = 0; n < kAll; ++n) {
      network.push(still, 3);
      tangent.push(still, 3);
      network.tick();
      tangent.tick();
      for (auto& displacements : weights.displacements) displacements.push_back(std::cos(double(n) / 7));
      expected += weights.displacements[0][n] * tangent.displacement(on_mass).slopes[0];
    }
    gradients.push_back(network.gradient(weights));
    EXPECT_TRUE(within(gradients.back().motions[0].velocity_m_per_s, expected, 1e-11 * std::abs(expected)));
    EXPECT_EQ(gradients.back().pushes, std::vector<double>(kAll, 0.0));
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const auto &found = gradients[1].numbers.connections[k], &wanted = gradients[0].numbers.connections[k];
    EXPECT_EQ(found.contact.stiffness_ratio, wanted.contact.stiffness_ratio);
    EXPECT_EQ(found.gap_m, wanted.gap_m);
    EXPECT_EQ(found.spring_n_per_m, wanted.spring_n_per_m);
  }
}

// The numbers of a gradient in one list.
std::vector<double> list_of(const NetworkGradient<double>& gradient) {
  std::vector<double> all = gradient.pushes;
  for (const auto& connection : gradient.numbers.connections)
    all.insert(all.end(), {connection.contact.stiffness_ratio, connection.gap_m, connection.spring_n_per_m});
  for (const auto& body : gradient.numbers.bodies)
    for (const Mode& mode : body)
      all.insert(all.end(), {mode.angular_frequency_rad_per_s, mode.decay_per_s, mode.mass_kg});
  return all;
}

// What is missing at the end of a list of weights is 0, and what is too much does not count.
TEST(NetworkGradient, TakesWeightsOfAnyLength) {
  const Played scene(Random(5), -1, 0, 2);
  const Backwards backwards(scene, 5);
  NetworkWeights<double> more = backwards.weights;
  for (auto* lists : {&more.displacements, &more.forces}) {
    for (auto& list : *lists)
      if (!list.empty()) list.resize(kSamples + 3, 1.0);
    lists->resize(lists->size() + 20, std::vector<double>(kSamples, 1.0));
  }
  EXPECT_EQ(list_of(backwards.network.gradient(more)), list_of(backwards.gradient));
  NetworkWeights<double> fewer = backwards.weights, zeros = fewer;
  fewer.forces.resize(1);
  for (std::size_t k = 1; k < zeros.forces.size(); ++k) zeros.forces[k].assign(kSamples, 0.0);
  EXPECT_EQ(list_of(backwards.network.gradient(fewer)), list_of(backwards.network.gradient(zeros)));
  EXPECT_NE(list_of(backwards.network.gradient(fewer)), list_of(backwards.gradient));
}

// Nothing moves, so the force is that of the table at the compression that the gap leaves, but for the least
// receptance that the solver knows, 1e-18 m/N: by it the compression creeps in each sample.
TEST(NetworkGradient, TakesAPlanWithoutModes) {
  constexpr std::size_t kAll = 130;  // more than a block
  const auto felt = power_table<double>(1e8, 2.3, 1e-3, 40);
  NetworkPlan<double> plan;
  const std::size_t still = plan.add_place(plan.add_body({}), {});
  plan.add_contact(still, kGround, SegmentTable<double>(felt), -2e-4);
  RecordedNetwork<double> network(plan, 44100);
  for (std::size_t n = 0; n < kAll; ++n) {
    network.push(still, 1);
    network.tick();
  }
  const std::vector<double> ones(kAll, 1.0);
  const auto gradient = network.gradient({{ones}, {ones}});
  const auto& segment = felt[segment_index(SegmentTable<double>(felt), 2e-4)];
  const double force = kAll * segment.force_at(2e-4), slope = kAll * 2 * segment.half_curvature;
  const auto& found = gradient.numbers.connections[0];
  const double rounding = 1e-13;  // more than that of 130 sums
  const double creep = slope * force / 2 * 1e-18;
  EXPECT_TRUE(within(found.contact.stiffness_ratio, force, rounding * force + creep));
  EXPECT_TRUE(relatively_within(found.gap_m, -slope, rounding));
}

}  // namespace
}  // namespace contactspline::testing
