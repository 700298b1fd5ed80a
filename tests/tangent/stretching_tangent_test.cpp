// SPDX-License-Identifier: MIT
// Derivatives of networks in which bodies stretch: against central differences of the network in long double, and of
// Duffing's period.
#include "contactspline/tangent/stretching_tangent.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "network_scene.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

enum class Case { kPlucked, kAtStop, kStruck };

/// A string or head that stretches, with each number moved by a part `h` of itself, the exponent by `h`: plucked
/// alone; plucked at a stop; or struck by a mass with felt, pushed, and held by a spring with a damper.
template <typename T>
struct Stretched {
  enum Number {
    kTension,
    kDecay,
    kModeMass,
    kFormStiffness,
    kSquares,
    kFactor,
    kDisplacement,
    kVelocity,
    kShape,
    kStopStiffness,
    kGap,
    kMass,
    kSpeed,
    kStiffness,
    kExponent,
    kLoss,
    kWeight,
    kTime,
    kPush,
    kSpring,
    kResistance,
    kNumbers
  };
  using Slope = Dual<double, kNumbers>;
  using Directions = std::array<NetworkNumbers<double>, kNumbers>;
  static constexpr double kEnd_m = 1e-3;  // of the felt

  Stretched(Random random, Case how, int moved_number, T by) : played(how), moved(moved_number), h(by) {
    rate = random.log_between(30000, 100000);
    add_head(random);
    struck = add_place(random.between(0.1, 0.3), kShape);
    if (played == Case::kAtStop) {
      wood = power_table<T>(random.log_between(1e6, 1e7), 1.5, 1e-3, 40);
      plan.add_contact(add_place(0.6), kGround, SegmentTable<T>(wood), part(kGap, 5e-4),
                       {part(kStopStiffness, 1.0), T(0)});
    } else if (played == Case::kStruck) {
      add_hammer(random);
    }
  }

  void add_head(Random& random) {
    const double w = 2 * std::numbers::pi * random.log_between(80, 400), mass_kg = random.log_between(1e-3, 1e-2);
    std::vector<Mode> modes;
    const double square = std::pow(std::numbers::pi / 0.65, 2), share = random.log_between(0.03, 1);
    std::vector<StretchForm> forms{{2 * share * mass_kg * std::pow(w / square / 3e-3, 2), {}}};
    forms.push_back({forms[0].stiffness_j * random.between(0, 0.5), {}});
    forms[0].stiffness_j = double(part(kFormStiffness, forms[0].stiffness_j));
    for (std::size_t i = 0; i < kModes; ++i) {
      const double n = double(i) + 1;
      modes.push_back({double(T(w * n) * (moved == kTension ? std::sqrt(1 + h) : T(1))),
                       double(part(kDecay, 1.0 + n)), double(part(kModeMass, mass_kg))});
      forms[0].squares_per_m2.push_back(double(part(kSquares, square * n * n)));
      forms[1].squares_per_m2.push_back(square * random.between(-1, 1));
      displacements.push_back(random.between(-3e-3, 3e-3) / n), velocities.push_back(random.between(-2, 2) / n);
      if (i > 0) forms[1].products.push_back({i - 1, i, double(part(kFactor, square * random.between(-2, 2)))});
    }
    if (random.once_in(2)) forms.resize(1);
    head = plan.add_body(modes, forms);
  }
  void add_hammer(Random& random) {
    const double stiffness = random.log_between(1e7, 1e9), exponent = random.between(1.3, 3);
    felt = power_table<T>(stiffness, exponent, kEnd_m, 40);
    if (moved == kExponent)
      felt = table_through<T>(SegmentTable<T>(felt), T(kEnd_m), [table = felt, this](T y) {
        return y > 0 ? force(SegmentTable<T>(table), y) * std::pow(y / T(kEnd_m), h) : T(0);
      });
    memories = {
        {double(part(kWeight, random.between(0.2, 0.8))), double(part(kTime, random.log_between(2e-5, 2e-4)))}};
    mass = plan.add_mass(double(part(kMass, random.log_between(2e-3, 2e-2))));
    speed = random.between(0.5, 4);
    plan.add_contact(plan.add_mass_place(mass), struck, SegmentTable<T>(felt), T(0),
                     {part(kStiffness, 0.8), part(kLoss, 0.05)}, T(1.2), memories);
    plan.add_spring(add_place(0.9), kGround, part(kSpring, 1e4), part(kResistance, 0.3));
  }
  std::size_t add_place(double at, int number = kNumbers) {
    std::vector<double> shapes;
    for (std::size_t i = 0; i < kModes; ++i)
      shapes.push_back(double(part(number, std::sin(std::numbers::pi * double(i + 1) * at))));
    return plan.add_place(head, shapes);
  }
  [[nodiscard]] T part(int number, double value) const { return number == moved ? T(value) * (1 + h) : T(value); }

  /// The derivatives of all numbers of the plan by h.
  [[nodiscard]] Directions directions() const {
    Directions all;
    const auto& forms = plan.forms(head);
    for (NetworkNumbers<double>& each : all) {
      each.bodies.resize(head + 1), each.bodies[head].resize(kModes);
      each.forms.resize(head + 1), each.forms[head].resize(forms.size());
      each.places.resize(struck + 1);
      each.connections.resize(plan.connections().size());
    }
    for (std::size_t i = 0; i < kModes; ++i) {
      const Mode& mode = plan.bodies()[head][i];
      all[kTension].bodies[head][i].angular_frequency_rad_per_s = mode.angular_frequency_rad_per_s / 2;
      all[kDecay].bodies[head][i].decay_per_s = mode.decay_per_s;
      all[kModeMass].bodies[head][i].mass_kg = mode.mass_kg;
    }
    all[kFormStiffness].forms[head][0].stiffness_j = forms[0].stiffness_j;
    all[kSquares].forms[head][0].squares_per_m2 = forms[0].squares_per_m2;
    if (forms.size() > 1) all[kFactor].forms[head][1].products = forms[1].products;
    all[kShape].places[struck] = plan.places()[struck].shapes;
    if (!plan.connections().empty()) connect(all);
    return all;
  }
  void connect(Directions& all) const {
    const auto& contact = plan.connections()[0];
    if (played == Case::kAtStop) {
      all[kStopStiffness].connections[0].contact.stiffness_ratio = contact.contact.stiffness_ratio;
      all[kGap].connections[0].gap_m = contact.gap_m;
      return;
    }
    all[kMass].bodies.resize(mass + 1);
    all[kMass].bodies[mass] = {{0, 0, plan.bodies()[mass][0].mass_kg}};
    all[kStiffness].connections[0].contact.stiffness_ratio = contact.contact.stiffness_ratio;
    all[kLoss].connections[0].contact.loss_s_per_m = contact.contact.loss_s_per_m;
    all[kExponent].connections[0].contact.table = exponent_direction(contact.table, kEnd_m, kEnd_m);
    all[kWeight].connections[0].contact.memories = {{memories[0].weight, 0}};
    all[kTime].connections[0].contact.memories = {{0, memories[0].time_s}};
    all[kSpring].connections[1].spring_n_per_m = plan.connections()[1].spring_n_per_m;
    all[kResistance].connections[1].resistance_n_s_per_m = plan.connections()[1].resistance_n_s_per_m;
  }

  /// Plays a network or its tangent. number(index, value): a number to begin with or to push. hear(): after each
  /// sample.
  template <typename Model, typename Value, typename Hear>
  void play(Model& model, Value number, Hear hear) const {
    if (played == Case::kStruck)
      model.set_motion(mass, 0, number(kSpeed, speed));
    else
      for (std::size_t i = 0; i < kModes; ++i)
        model.set_motion(head, number(kDisplacement, displacements[i]), number(kVelocity, velocities[i]), i);
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (played == Case::kStruck && n < 50) model.push(struck, number(kPush, 3.0));
      model.tick();
      hear();
    }
  }
  /// Displacement and forces.
  template <typename Model, typename Samples>
  void hear(const Model& model, Samples& samples) const {
    samples.push_back(model.displacement(struck));
    for (std::size_t k = 0; k < plan.connections().size(); ++k) samples.push_back(model.force(k));
  }
  [[nodiscard]] std::vector<T> play() const {
    ContactNetwork<T> network(plan, rate);
    std::vector<T> samples;
    play(
        network, [&](int number, double value) { return part(number, value); }, [&] { hear(network, samples); });
    return samples;
  }
  static Slope along(int number, double value) {
    Slope result(value);
    result.slopes[std::size_t(number)] = value;
    return result;
  }
  [[nodiscard]] std::vector<Slope> play_with_slopes(StretchingTangent<double, kNumbers>& tangent) const {
    std::vector<Slope> samples;
    play(tangent, along, [&] { hear(tangent, samples); });
    return samples;
  }

  Case played;
  int moved;
  T h;
  double rate = 0, speed = 0;
  std::vector<Segment<T>> felt, wood;
  std::vector<Memory> memories;
  std::vector<double> displacements, velocities;
  NetworkPlan<T> plan;
  std::size_t head = 0, struck = 0, mass = 0;
};

using Scene64 = Stretched<double>;
using StretchedTangent = StretchingTangent<double, Scene64::kNumbers>;

// The samples follow some numbers weakly.
Real width_of(int number) {
  constexpr std::array kWeak = {Scene64::kDecay, Scene64::kFactor, Scene64::kSpring, Scene64::kResistance};
  return std::ranges::count(kWeak, number) > 0 ? 1e-6L : 1e-8L;
}

// Every output over its largest slope, as in network_tangent_test, for the numbers listed.
void compare_with_differences(Case played, const std::vector<int>& numbers) {
  double worst = 0;
  std::vector<double> most(Scene64::kNumbers);
  for (std::uint64_t seed = 1; seed <= 8 && !::testing::Test::HasFailure(); ++seed) {
    const Scene64 scene(Random(seed), played, -1, 0);
    StretchedTangent tangent(scene.plan, scene.rate, scene.directions());
    const auto found = scene.play_with_slopes(tangent);
    const auto exact = scene.play();
    const std::size_t outputs = 1 + scene.plan.connections().size();
    for (const int p : numbers) {
      const auto expected =
          middle_difference([&](Real h) { return Stretched<Real>(Random(seed), played, p, h).play(); }, width_of(p));
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t k = 0; k < outputs; ++k) {
        double scale = 0;
        for (std::size_t i = k; i < found.size(); i += outputs) scale = std::max(scale, std::abs(expected[i]));
        for (std::size_t i = k; i < found.size(); i += outputs) {
          ASSERT_EQ(found[i].value, exact[i]);
          ASSERT_TRUE(within(found[i].slopes[std::size_t(p)], expected[i], 1e-6 * scale))
              << "scene " << seed << ", number " << p << ", output " << k << ", sample " << i / outputs;
          if (scale > 0) worst = std::max(worst, std::abs(found[i].slopes[std::size_t(p)] - expected[i]) / scale);
        }
        most[std::size_t(p)] = std::max(most[std::size_t(p)], scale);
      }
    }
  }
  for (const int p : numbers) EXPECT_GT(most[std::size_t(p)], 0) << p;
  Measured() << "worst difference, over the largest slope of each output: " << worst;
}

const std::vector<int> kOfHead{Scene64::kTension, Scene64::kDecay,  Scene64::kModeMass, Scene64::kFormStiffness,
                               Scene64::kSquares, Scene64::kFactor, Scene64::kShape};

std::vector<int> with_those_of_head(std::initializer_list<int> numbers) {
  std::vector<int> all = kOfHead;
  all.insert(all.end(), numbers);
  return all;
}

TEST(StretchingTangent, IsTheCentralDifferenceOfAPluckedString) {
  compare_with_differences(Case::kPlucked, with_those_of_head({Scene64::kDisplacement, Scene64::kVelocity}));
}

TEST(StretchingTangent, IsTheCentralDifferenceAtAStop) {
  compare_with_differences(Case::kAtStop, with_those_of_head({Scene64::kDisplacement, Scene64::kVelocity,
                                                              Scene64::kStopStiffness, Scene64::kGap}));
}

TEST(StretchingTangent, IsTheCentralDifferenceOfAStruckHead) {
  compare_with_differences(
      Case::kStruck,
      with_those_of_head({Scene64::kMass, Scene64::kSpeed, Scene64::kStiffness, Scene64::kExponent, Scene64::kLoss,
                          Scene64::kWeight, Scene64::kTime, Scene64::kPush, Scene64::kSpring, Scene64::kResistance}));
}

// Duffing's mode q'' + w^2 q + b q^3 = 0, from rest at the amplitude a, has the period T = 4 K(k)/W with W^2 = w^2 +
// b a^2 and k^2 = b a^2/(2 W^2). It falls with the amplitude: the derivative, with E(k).
double period_by_amplitude(double w, double b, double a) {
  const double square = w * w + b * a * a, root = std::sqrt(square), k = std::sqrt(b * a * a / 2 / square);
  const double first = std::comp_ellint_1(k), second = std::comp_ellint_2(k);
  const double by_k = (second / (1 - k * k) - first) / k, k_by_a = b * a * w * w / (2 * k * square * square);
  return 4 * (by_k * k_by_a / root - first * b * a / (square * root));
}

// A zero of the displacement q comes later by -q'/velocity, where ' is the slope by the amplitude. From one zero to
// the one `periods` later that grows by so many times the slope of the period. The mean over as many zeros: where
// between two samples a zero lies changes the straight line that finds it.
double slope_of_period(double rate, double w, double mass_kg, double stiffness_j, double amplitude_m,
                       std::size_t periods) {
  NetworkPlan<double> plan;
  const std::size_t body =
      plan.add_body(std::vector{Mode{w, 0, mass_kg}}, std::vector{StretchForm{stiffness_j, {1e4}}});
  const std::size_t place = plan.add_mass_place(body);
  StretchingTangent<double, 1> tangent(plan, rate, {});
  tangent.set_motion(body, {amplitude_m, {1}}, 0);
  Dual<double, 1> before(amplitude_m);
  std::vector<double> later;
  while (later.size() < 2 * periods) {
    tangent.tick();
    const auto q = tangent.displacement(place);
    if (before.value > 0 && q.value <= 0) {
      const double step = q.value - before.value, part = -before.value / step;
      later.push_back(-(before.slopes[0] + part * (q.slopes[0] - before.slopes[0])) / (step * rate));
    }
    before = q;
  }
  double sum = 0;
  for (std::size_t i = 0; i < periods; ++i) sum += later[i + periods] - later[i];
  return sum / double(periods * periods);
}

// As stretching_bank_test compares the period: errors are of second order.
TEST(StretchingTangent, HasTheSlopeOfDuffingsPeriod) {
  const double w = 2 * std::numbers::pi * 110, mass_kg = 0.002, amplitude_m = 1e-3;
  const double stiffness_j = 2 * mass_kg * std::pow(w / 1e4 / amplitude_m, 2);  // half of the energy in stretching
  const double expected = period_by_amplitude(w, stiffness_j * 1e8 / mass_kg, amplitude_m);
  const auto error_at = [&](double rate) {
    return slope_of_period(rate, w, mass_kg, stiffness_j, amplitude_m, 50) / expected - 1;
  };
  const double at_96 = error_at(96000), at_192 = error_at(192000);
  Measured() << "error at 192 kHz " << at_192 << ", order " << std::log2(at_96 / at_192);
  EXPECT_TRUE(within(at_192, 0, 3e-5));
  EXPECT_TRUE(within(std::log2(at_96 / at_192), 2, 0.1));
}

TEST(StretchingTangent, AllocatesNothingAfterConstruction) {
  const Scene64 scene(Random(3), Case::kStruck, -1, 0);
  StretchedTangent tangent(scene.plan, scene.rate, scene.directions());
  const std::size_t before = allocations;
  scene.play(tangent, Scene64::along, [] {});
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace contactspline::testing
