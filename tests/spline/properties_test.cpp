// SPDX-License-Identifier: MIT
// What holds for every spline, of random materials from one end of the documented ranges to the other.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "contactspline/models/mass_barrier.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/error.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr int kMaterials = 200;
constexpr double kEpsilon = 0x1p-52;

double uniform(std::mt19937_64& random, double min, double max) {
  return min + (max - min) * static_cast<double>(random() >> 11) * 0x1p-53;
}
double logarithmic(std::mt19937_64& random, double min, double max) {
  return std::exp(uniform(random, std::log(min), std::log(max)));
}

/// Stiffness, exponent, mass and speeds in the ranges of docs/reference/materials.md, logarithmically, so that the
/// ends are drawn too.
Material random_material(std::mt19937_64& random) {
  const PowerLaw law{logarithmic(random, 1e-3, 1e18), uniform(random, 1, 10)};
  const double max_speed = logarithmic(random, 1e-6, 1e3);
  const Impact impact{logarithmic(random, 1e-9, 1e4), max_speed, max_speed * logarithmic(random, 1e-2, 0.9)};
  const double range = law.max_compression(impact.mass_kg, max_speed);
  if (range < 1e-9 || range > 1) return random_material(random);  // as the reader of materials
  Material material{"probe", "", law, impact, {1 + static_cast<int>(random() % 60), range}};
  material.spline.knots = random() % 4 == 0 ? Knots::graded : Knots::uniform;
  return material;
}

/// The splines of random materials; a few are refused because they leave the range of double.
std::vector<std::pair<Material, Spline>> random_splines() {
  std::mt19937_64 random(11);
  std::vector<std::pair<Material, Spline>> splines;
  for (int i = 0; i < kMaterials; ++i) {
    Material material = random_material(random);
    try {
      Spline spline = design_spline(material, "probe");
      splines.emplace_back(std::move(material), std::move(spline));
    } catch (const BadInput&) {
    }
  }
  EXPECT_GT(splines.size(), kMaterials * 3u / 4);
  return splines;
}

const auto& splines() {
  static const auto designed = random_splines();
  return designed;
}

TEST(EverySpline, IsConvexAndContinuousAndPushes) {
  for (const auto& [material, spline] : splines()) {
    const auto& segments = spline.segments;
    ASSERT_EQ(segments.front().knot, 0);
    ASSERT_EQ(segments.front().energy, 0);
    ASSERT_EQ(segments.front().force, 0);
    for (std::size_t j = 0; j < segments.size(); ++j) {
      const auto& s = segments[j];
      ASSERT_GE(s.half_curvature, 0) << j;
      ASSERT_GE(s.force, 0) << j;
      if (j + 1 == segments.size()) break;
      // Each number was rounded once, and so were the sums here.
      const auto& next = segments[j + 1];
      const double width = next.knot - s.knot, width_error = 2 * kEpsilon * next.knot;
      ASSERT_GT(width, 0) << j;
      ASSERT_GE(next.force, s.force) << j;
      ASSERT_TRUE(within(s.force + 2 * s.half_curvature * width, next.force,
                         4 * kEpsilon * next.force + 2 * s.half_curvature * width_error));
      ASSERT_TRUE(within(s.energy + (s.force + s.half_curvature * width) * width, next.energy,
                         6 * kEpsilon * next.energy + 2 * next.force * width_error));
    }
  }
}

// A mass that is thrown at it is pushed, never pulled, and leaves with the speed it came with. The steps are coarse
// and fine.
TEST(EverySpline, ThrowsAMassBackWithItsSpeed) {
  std::mt19937_64 random(5);
  for (const auto& [material, spline] : splines()) {
    const auto table = segment_table(spline);
    const auto& [mass, max_speed, min_speed] = *material.impact;
    const double speed = uniform(random, min_speed, max_speed);
    const double rate = logarithmic(random, 3, 300) / impact_on_spline(spline, mass, speed).contact_duration_s;
    MassBarrier<double> model(table, rate);
    model.throw_from(-speed / rate * uniform(random, 0, 2), speed);
    int samples = 0;
    bool touched = false;
    while (!(touched && model.force() == 0) && ++samples < 2000) {
      model.tick({.mass_kg = std::clamp(mass, 1e-9, 1e4)});
      ASSERT_GE(model.force(), 0);
      touched |= model.force() > 0;
    }
    ASSERT_LT(samples, 2000) << "still in contact";
    ASSERT_TRUE(within(model.velocity() / speed, -1, 1e-9));
  }
}

// In other units of length, mass and time, all powers of two, the same spline comes out to the bit: the stiffness is
// in N/m^a, the exponents are whole.
TEST(EverySpline, IsTheSameInOtherUnits) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 100; ++i) {
    const int exponent = 1 + static_cast<int>(random() % 4), length = static_cast<int>(random() % 20) - 10,
              force = static_cast<int>(random() % 20) - 10;
    const double stiffness = logarithmic(random, 1e3, 1e12), range = logarithmic(random, 1e-5, 1e-2);
    const int segments = 1 + static_cast<int>(random() % 40);
    const Spline spline =
        uniform_spline({"a", "", PowerLaw{stiffness, double(exponent)}, {}, {segments, range}}, "a");
    const Spline scaled =
        uniform_spline({"b",
                        "",
                        PowerLaw{std::ldexp(stiffness, force - exponent * length), double(exponent)},
                        {},
                        {segments, std::ldexp(range, length)}},
                       "b");
    ASSERT_EQ(spline.segments.size(), scaled.segments.size());
    for (std::size_t j = 0; j < spline.segments.size(); ++j) {
      const auto &s = spline.segments[j], &t = scaled.segments[j];
      ASSERT_EQ(std::ldexp(s.knot, length), t.knot);
      ASSERT_EQ(std::ldexp(s.energy, force + length), t.energy);
      ASSERT_EQ(std::ldexp(s.force, force), t.force);
      ASSERT_EQ(std::ldexp(s.half_curvature, force - length), t.half_curvature);
    }
  }
}

TEST(EverySpline, IsTheSameTwice) {
  const auto& first = splines();
  const auto second = random_splines();
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].second.segments.size(), second[i].second.segments.size());
    for (std::size_t j = 0; j < first[i].second.segments.size(); ++j) {
      const auto &s = first[i].second.segments[j], &t = second[i].second.segments[j];
      ASSERT_TRUE(s.knot == t.knot && s.energy == t.energy && s.force == t.force &&
                  s.half_curvature == t.half_curvature);
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
