// SPDX-License-Identifier: MIT
// Finding segments, and tables that are compile-time constants: of emitted headers and of anything with their
// members.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "felt_c4.hpp"
#include "generator/material/material.hpp"
#include "generator/material/material_reader.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/design.hpp"
#include "rubber_on_wood.hpp"
#include "runtime/random_steps.hpp"
#include "steel_on_steel.hpp"
#include "support/compare.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

// Each search takes 3 ceil(log4(n + 1)) probes, whatever it finds.
TEST(CountLeading, TakesAsManyProbesAsPromised) {
  std::size_t rounds = 0, reach = 1;  // 4^rounds
  for (std::size_t n = 0; n <= 300; ++n) {
    if (n + 1 > reach) ++rounds, reach *= 4;
    for (std::size_t leading = 0; leading <= n; ++leading) {
      std::size_t probes = 0;
      const auto holds = [&](std::size_t i) { return ++probes, i <= leading; };
      ASSERT_EQ(detail::count_leading(n, holds), leading) << n;
      ASSERT_EQ(probes, 3 * rounds) << n;
    }
  }
}

template <typename T>
std::size_t index_by_looking(const std::vector<Segment<T>>& table, T y) {
  std::size_t index = 0;
  while (index + 1 < table.size() && table[index + 1].knot <= y) ++index;
  return index;
}

// Knots, their neighbours among the numbers of T, and points between and beyond.
template <typename T>
std::vector<T> telling_points(const std::vector<Segment<T>>& table) {
  constexpr T kMax = std::numeric_limits<T>::max();
  std::vector<T> points = {-kMax, -1, -std::numeric_limits<T>::min(), std::numeric_limits<T>::denorm_min(), 1, kMax};
  for (std::size_t j = 1; j < table.size(); ++j) {
    const T knot = table[j].knot;
    const T next = j + 1 < table.size() ? table[j + 1].knot : 2 * knot + 1;
    points.insert(points.end(), {knot, std::nextafter(knot, -kMax), std::nextafter(knot, kMax), (knot + next) / 2});
  }
  return points;
}

CONTACTSPLINE_EACH_PRECISION(SegmentLookup);

TYPED_TEST(SegmentLookup, FindsWhatLookingThroughTheTableFinds) {
  for (const auto& [segments, exponent, range, force_n] : test_tables<TypeParam>()) {
    const SegmentTable<TypeParam> table(segments);
    for (const TypeParam y : telling_points(segments)) {
      const std::size_t index = index_by_looking(segments, y);
      ASSERT_EQ(segment_index(table, y), index) << y << " of " << segments.size() - 1;
      const auto& [knot, energy, at_knot, half_curvature] = segments[index];
      if (!(std::abs(y) < 1e15)) continue;  // beyond, y^2 leaves the range of float
      const TypeParam t = y - knot;
      ASSERT_EQ(potential(table, y), energy + t * (at_knot + t * half_curvature)) << y;
      ASSERT_EQ(force(table, y), at_knot + 2 * half_curvature * t) << y;
    }
  }
}

TYPED_TEST(SegmentLookup, IsExactlyZeroOutOfContactAndContinuousAtKnots) {
  for (const auto& [segments, exponent, range, force_n] : test_tables<TypeParam>()) {
    const SegmentTable<TypeParam> table(segments);
    for (const TypeParam y : {TypeParam(-1e9), TypeParam(-1), -std::numeric_limits<TypeParam>::min(), TypeParam(0)}) {
      EXPECT_EQ(potential(table, y), 0);
      EXPECT_EQ(force(table, y), 0);
    }
    for (std::size_t j = 2; j < segments.size(); ++j) {
      const double roundings = (4 * exponent + 12) * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
      const TypeParam y = segments[j].knot;
      EXPECT_TRUE(relatively_within(segments[j - 1].energy_at(y), segments[j].energy, roundings));
      EXPECT_TRUE(relatively_within(segments[j - 1].force_at(y), segments[j].force, roundings));
    }
  }
}

template <typename Header>
struct Shipped;
template <>
struct Shipped<materials::felt_c4> {
  static constexpr const char* kFile = "felt_c4.json";
};
template <>
struct Shipped<materials::rubber_on_wood> {
  static constexpr const char* kFile = "rubber_on_wood.json";
};
template <>
struct Shipped<materials::steel_on_steel> {
  static constexpr const char* kFile = "steel_on_steel.json";
};

template <typename T>
class EmittedTable : public ::testing::Test {};
using Materials = ::testing::Types<materials::felt_c4, materials::rubber_on_wood, materials::steel_on_steel>;
TYPED_TEST_SUITE(EmittedTable, Materials);

TYPED_TEST(EmittedTable, HoldsTheBitsOfTheGenerator) {
  const std::string file = Shipped<TypeParam>::kFile;
  std::ifstream stream(MATERIALS_FOLDER "/" + file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const auto designed = segment_table(design_material(text, file).spline);
  const auto& emitted = segments_of<TypeParam, double>;
  ASSERT_EQ(emitted.size(), designed.size());
  for (std::size_t j = 0; j < designed.size(); ++j)
    for (const auto member : {&Segment<double>::knot, &Segment<double>::energy, &Segment<double>::force,
                              &Segment<double>::half_curvature})
      EXPECT_EQ(std::bit_cast<std::uint64_t>(emitted[j].*member), std::bit_cast<std::uint64_t>(designed[j].*member));
}

TYPED_TEST(EmittedTable, OfFixedAndOfDynamicExtentHaveTheSameDigits) {
  const auto run = [&]<typename T>(T) {
    const auto& segments = segments_of<TypeParam, T>;
    const SegmentTable<T, TypeParam::segments + 1> fixed(segments);
    const SegmentTable<T> dynamic(segments);
    Random random(4);
    for (int i = 0; i < 10'000; ++i) {
      const double range = TypeParam::max_compression_m;
      const Approach<T> approach{static_cast<T>(range * random.between(-1, 2)),
                                 static_cast<T>(range * random.between(-1, 1)),
                                 static_cast<T>(random.decades(-6, 0) * range)};
      ASSERT_EQ(contact_force(fixed, approach), contact_force(dynamic, approach));
      ASSERT_EQ(potential(fixed, approach.compression), potential(dynamic, approach.compression));
    }
  };
  run(0.0);
  run(0.0f);
}

// The unit of length of the normalised table: uniform knots have their width, others the largest compression.
template <typename Material>
constexpr double length_unit() {
  if constexpr (requires { Material::segment_width_m; })
    return Material::segment_width_m;
  else
    return Material::length_scale_m;
}

// V(y; k, dy) = k dy^(a + 1) Vn(y / dy) (design 2.1).
TYPED_TEST(EmittedTable, NormalisedScalesToTheMaterial) {
  const SegmentTable<double, TypeParam::segments + 1> table(segments_of<TypeParam, double>);
  const SegmentTable<double, TypeParam::segments + 1> normalised(segments_of<typename TypeParam::normalised, double>);
  const double width = length_unit<TypeParam>(), energy = TypeParam::energy_scale_j;
  for (int i = 1; i <= 1000; ++i) {
    const double y = TypeParam::max_compression_m * (i + 0.37) / 900;
    EXPECT_TRUE(relatively_within(energy * potential(normalised, y / width), potential(table, y), 1e-13));
    EXPECT_TRUE(relatively_within(energy / width * force(normalised, y / width), force(table, y), 1e-13));
  }
}

/// Hand-written, with the members of an emitted material: F = 2 y up to 1, 6 y - 4 beyond.
struct TwoSprings {
  static constexpr std::size_t segments = 2;
  static constexpr std::array<double, 2> knots = {0.0, 1.0};
  static constexpr std::array<double, 2> energies = {0.0, 1.0};
  static constexpr std::array<double, 2> forces = {0.0, 2.0};
  static constexpr std::array<double, 2> half_curvatures = {1.0, 3.0};
};

constexpr SegmentTable<double, 3> kTwoSprings(segments_of<TwoSprings, double>);
static_assert(segment_index(kTwoSprings, -1.0) == 0 && segment_index(kTwoSprings, 0.0) == 1);
static_assert(segment_index(kTwoSprings, 0.5) == 1 && segment_index(kTwoSprings, 1.0) == 2);
static_assert(potential(kTwoSprings, -1.0) == 0 && force(kTwoSprings, -1.0) == 0);
static_assert(potential(kTwoSprings, -std::numeric_limits<double>::infinity()) == 0 &&
              force(kTwoSprings, -std::numeric_limits<double>::infinity()) == 0);
static_assert(potential(kTwoSprings, 0.5) == 0.25 && force(kTwoSprings, 0.5) == 1);
static_assert(potential(kTwoSprings, 2.0) == 6 && force(kTwoSprings, 2.0) == 8);
static_assert(force(SegmentTable<float, 3>(segments_of<TwoSprings, float>), 2.0f) == 8);

TEST(TableOfAHandWrittenStruct, IsAContact) {
  // From -1 to 2 the energy rises to 6, so the mean force is 2: xf = 3 + 0.5 * 2.
  EXPECT_EQ(contact_force(kTwoSprings, Approach<double>{-1.0, 4.0, 0.5}), 2.0);
}

}  // namespace
}  // namespace contactspline::testing
