// SPDX-License-Identifier: MIT
// Derivatives of networks of bodies, contacts and springs: against central differences of the network in long double.
#include "contactspline/tangent/network_tangent.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

// The slopes of all outputs of a slide, one sample after the other, against a central difference: as above. Returns
// the worst difference.
template <typename Number>
double worst_of_slide(const std::vector<Number>& found, std::size_t p, const std::vector<double>& expected,
                      std::size_t outputs) {
  double worst = 0;
  for (std::size_t k = 0; k < outputs; ++k) {
    double scale = 0;
    for (std::size_t i = k; i < expected.size(); i += outputs) scale = std::max(scale, std::abs(expected[i]));
    for (std::size_t i = k; i < expected.size() && scale > 0; i += outputs) {
      EXPECT_TRUE(within(found[i].slopes[p], expected[i], 1e-6 * scale))
          << "number " << p << ", output " << k << ", sample " << i / outputs;
      worst = std::max(worst, std::abs(found[i].slopes[p] - expected[i]) / scale);
    }
  }
  return worst;
}

// A place that moves, with a contact to the ground that presses meanwhile.
TEST(NetworkTangent, FollowsAPlaceThatMoves) {
  double worst = 0;
  std::size_t limited = 0;  // samples
  for (std::uint64_t seed = 1; seed <= 6 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    const Slide<double> scene(Random(seed), -1, 0);
    SlideSlopes slopes(scene);
    const std::size_t outputs = 2 + scene.plan.connections().size();
    std::vector<SlideSlopes::Tangent::Number> found;
    for (std::size_t n = 0; n < kSamples; ++n) {
      slopes.tick(n);
      for (std::size_t k = 0; k < outputs; ++k) found.push_back(slopes.output(k));
      if (n >= 60 && n < 300 && slopes.tangent.force(scene.limit).value > 0) ++limited;
    }
    for (std::size_t p = 0; p < Slide<double>::kNumbers; ++p)
      worst = std::max(
          worst,
          worst_of_slide(
              found, p, middle_difference([&](Real h) { return Slide<Real>(Random(seed), int(p), h).play(); }, 1e-8L),
              outputs));
  }
  EXPECT_GE(limited, 100U);
  Measured() << "worst difference of a slide, over the largest slope of each output: " << worst;
}

// A place that stays where it is, though its target follows a parameter: smoothly, at rest, then with a jump.
TEST(NetworkTangent, FollowsATargetThatThePlaceHasReached) {
  using Tangent = NetworkTangent<double, 1>;
  const auto slope = [](std::size_t n) { return n < 60 ? 0 : n < 200 ? std::sin(double(n - 60) / 20) : 0.5; };
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 6 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    const Slide<double> scene(Random(seed), -1, 0);
    const std::size_t outputs = 2 + scene.plan.connections().size();
    Tangent tangent(scene.plan, Slide<double>::kRate, {});
    tangent.set_motion(scene.mass, 0, 0.5);
    std::vector<Tangent::Number> found;
    for (std::size_t n = 0; n < kSamples; ++n) {
      tangent.push(scene.on_mass, 5);
      tangent.move_place(scene.slid, {scene.start, {slope(n)}});
      tangent.tick();
      for (const std::size_t place : {scene.output, scene.slid}) found.push_back(tangent.displacement(place));
      for (std::size_t k = 0; k + 2 < outputs; ++k) found.push_back(tangent.force(k));
    }
    const Slide<Real> exact(Random(seed), -1, 0);
    const auto play = [&](Real h) {
      return exact.play_to([&](std::size_t n) { return exact.start + h * Real(slope(n)); });
    };
    worst = std::max(worst, worst_of_slide(found, 0, middle_difference(play, 1e-8L), outputs));
  }
  Measured() << "worst difference of a target, over the largest slope of each output: " << worst;
}

// What is not a number changes nothing. What is out of range does as the end of the range does, whatever the slopes.
TEST(NetworkTangent, TakesNumbersInTheirRangesAlone) {
  using Tangent = NetworkTangent<double, 1>;
  const Tangent::Number kNone(std::numeric_limits<double>::quiet_NaN(), {1});
  const Slide<double> scene(Random(1), -1, 0);
  Tangent tangent(scene.plan, Slide<double>::kRate, {}), expected(scene.plan, Slide<double>::kRate, {});
  tangent.put_place(scene.slid, {-0.5, {1}});
  tangent.set_motion(scene.mass, {-2e3, {1}}, {1e4, {1}});
  expected.put_place(scene.slid, 0);
  expected.set_motion(scene.mass, -1000, 1000);
  for (int n = 0; n < 300; ++n) {
    if (n == 10)
      for (Tangent* each : {&tangent, &expected}) {
        each->put_place(scene.slid, {0.5, {1}});
        each->set_motion(scene.mass, {1e-6, {1}}, {0.5, {2}});
      }
    if (n == 20) {
      tangent.set_motion(scene.mass, kNone, 1);
      tangent.set_motion(scene.mass, 1, kNone);
      tangent.push(scene.on_mass, kNone);
      tangent.put_place(scene.slid, kNone);
      expected.put_place(scene.slid, {0.5, {1}});
    }
    if (n == 30) tangent.move_place(scene.slid, kNone);
    if (n >= 40 && n < 60) {
      tangent.push(scene.on_mass, {1e4, {1}});
      expected.push(scene.on_mass, 1000);
    }
    tangent.tick(), expected.tick();
    for (const std::size_t place : {scene.slid, scene.on_mass}) {
      const auto moved = tangent.displacement(place), wanted = expected.displacement(place);
      ASSERT_EQ(moved.value, wanted.value) << n;
      ASSERT_EQ(moved.slopes[0], wanted.slopes[0]) << n;
    }
  }
}

// Compressions follow by increments, and their slopes are measured anew after 64 samples. Meanwhile roundings add up,
// in single precision each 6e-8 of what the masses at the ends of a rigid link move: the root of 64 of them is 5e-7.
TEST(NetworkTangent, KeepsCompressionsWithDisplacements) {
  NetworkPlan<float> plan;
  const std::size_t a = plan.add_mass(0.003), b = plan.add_mass(0.008);
  const std::size_t on_a = plan.add_mass_place(a), on_b = plan.add_mass_place(b);
  plan.add_rigid_link(on_a, on_b);
  plan.add_spring(on_b, kGround, 1e4F, 0.01F);
  NetworkTangent<float, 1> tangent(plan, 44100, {});
  tangent.set_motion(a, 0, {1, {1}});
  float worst = 0, most = 0;
  for (int n = 0; n < 100000; ++n) {
    tangent.tick();
    const float first = tangent.displacement(on_a).slopes[0], second = tangent.displacement(on_b).slopes[0];
    worst = std::max(worst, std::abs(tangent.compression(0).slopes[0] - (first - second)));
    most = std::max(most, std::abs(first));
  }
  EXPECT_LE(worst, 2e-6F * most);
  Measured() << "worst difference, over the largest displacement: " << worst / most;
}

// A mass on a spring that is put elsewhere moves as a new one does, and so do its derivatives.
TEST(NetworkTangent, BeginsAnewWhereAMassIsPut) {
  using Tangent = NetworkTangent<double, 2>;
  NetworkPlan<double> plan;
  const std::size_t mass = plan.add_mass(0.01), on_mass = plan.add_mass_place(mass);
  plan.add_spring(on_mass, kGround, 1e4, 0.1);
  std::array<NetworkNumbers<double>, 2> directions;
  directions[0].connections.resize(1);
  directions[0].connections[0].spring_n_per_m = 1;
  Tangent moved(plan, 44100, directions), fresh(plan, 44100, directions);
  moved.set_motion(mass, 0.002, {1.0, {0, 1}});
  for (int n = 0; n < 100; ++n) moved.tick();
  for (Tangent* each : {&moved, &fresh}) each->set_motion(mass, {1e-3, {0, 2}}, {-3.0, {0, 1}});
  double largest_slope[2] = {};
  for (int n = 0; n < 1000; ++n) {
    moved.tick(), fresh.tick();
    for (const std::size_t p : {0, 1}) {
      const double expected = fresh.force(0).slopes[p];
      largest_slope[p] = std::max(largest_slope[p], std::abs(expected));
      // Rounding of a thousand steps at most.
      ASSERT_TRUE(within(moved.force(0).slopes[p], expected, 1e3 * 2.3e-16 * largest_slope[p])) << n;
    }
  }
  EXPECT_GT(largest_slope[0], 0);
  EXPECT_GT(largest_slope[1], 0);
}

// What is missing at the end of a list of a direction is 0, and what is too much does not count.
TEST(NetworkTangent, TakesDirectionsOfAnyLength) {
  const Played scene(Random(3), -1, 0, 2);
  const auto directions = Slopes(scene).directions();
  const auto sound = [&](const auto& along) {
    Tangent tangent(scene.plan, scene.rate, along);
    tangent.set_motion(scene.masses[0], 0, scene.speed);
    std::vector<double> slopes;
    for (std::size_t n = 0; n < kSamples; ++n) {
      tangent.tick();
      for (const double slope : tangent.displacement(scene.struck).slopes) slopes.push_back(slope);
    }
    return slopes;
  };
  auto longer = directions, shorter = directions;
  for (auto& direction : longer) {
    direction.bodies.resize(scene.plan.bodies().size());
    for (auto& body : direction.bodies)
      if (!body.empty()) body.resize(body.size() + 2, {1, 1, 1});
    direction.bodies.push_back({{1, 1, 1}});
    direction.places.resize(scene.plan.places().size());
    direction.places.emplace_back(3);
    for (auto& connection : direction.connections)
      if (auto& memories = connection.contact.memories; !memories.empty())
        memories.resize(memories.size() + 1, {1, 1});
    direction.connections.resize(scene.plan.connections().size());
    direction.connections.push_back({.gap_m = 1});
  }
  for (auto& direction : shorter) {
    direction.places.resize(std::min(direction.places.size(), scene.struck + 1));
    for (auto& connection : direction.connections)
      if (auto& memories = connection.contact.memories; !memories.empty()) memories.resize(1);
    direction.connections.resize(6);
  }
  const std::vector<double> expected = sound(directions);
  EXPECT_GT(*std::ranges::max_element(expected), 0);
  EXPECT_EQ(sound(longer), expected);
  EXPECT_EQ(sound(shorter), expected);
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
