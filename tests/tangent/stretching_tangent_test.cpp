// SPDX-License-Identifier: MIT
// Derivatives of networks in which bodies stretch: against central differences of the network in long double, and of
// Duffing's period.
#include "contactspline/tangent/stretching_tangent.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "stretching_scene.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

// The samples follow some numbers weakly.
Real width_of(int number) {
  constexpr std::array kWeak = {Scene64::kDecay, Scene64::kFactor, Scene64::kLinear, Scene64::kSpring,
                                Scene64::kResistance};
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
                               Scene64::kSquares, Scene64::kFactor, Scene64::kLinear,   Scene64::kShape};

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
      Case::kStruck, with_those_of_head({Scene64::kDisplacement, Scene64::kVelocity, Scene64::kMass, Scene64::kSpeed,
                                         Scene64::kStiffness, Scene64::kExponent, Scene64::kLoss, Scene64::kWeight,
                                         Scene64::kTime, Scene64::kPush, Scene64::kSpring, Scene64::kResistance}));
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
