// SPDX-License-Identifier: MIT
// Every coefficient of 10,000 random splines against 266 bits.
#include <gtest/gtest.h>

#include <set>

#include "support/measured.hpp"
#include "support/reference.hpp"

namespace contactspline::testing {
namespace {

constexpr int kShards = 8;
constexpr int kMaterialsPerShard = 1250;

/// Worst relative error of a group of coefficients, and how many have a double that is nearer to the exact value.
class Accuracy {
 public:
  void compare(double actual, const Real& exact) {
    ++count_;
    if (exact == 0 && actual == 0) return;
    if (!as_near_as_any_double(actual, exact)) ++misrounded_;
    const double error = abs(actual / exact - 1).convert_to<double>();
    if (!(error <= worst_)) worst_ = error;  // NaN stays
  }
  void compare(const std::vector<double>& actual, const std::vector<Real>& exact) {
    ASSERT_EQ(actual.size(), exact.size());
    for (std::size_t j = 0; j < exact.size(); ++j) compare(actual[j], exact[j]);
  }

  [[nodiscard]] double worst() const { return worst_; }
  [[nodiscard]] int misrounded() const { return misrounded_; }
  [[nodiscard]] int count() const { return count_; }

 private:
  // A knot such as 3/4 of the range is often half way between two doubles: either will do.
  static bool as_near_as_any_double(double actual, const Real& exact) {
    return abs(actual - exact) <= abs(exact.convert_to<double>() - exact) * (1 + 0x1p-20);
  }

  double worst_ = 0;
  int misrounded_ = 0;
  int count_ = 0;
};

struct Accuracies {
  Accuracy local, regular, normalised;

  void compare(const Spline& spline, const ReferenceSpline& exact) {
    ASSERT_EQ(spline.segments.size(), exact.knot.size());
    for (std::size_t j = 0; j < exact.knot.size(); ++j) {
      local.compare(spline.segments[j].knot, exact.knot[j]);
      local.compare(spline.segments[j].energy, exact.energy[j]);
      local.compare(spline.segments[j].force, exact.force[j]);
      local.compare(spline.segments[j].half_curvature, exact.half_curvature[j]);
    }
    local.compare(spline.length_scale_m, exact.width);
    local.compare(spline.energy_scale_j, exact.energy_scale);
    compare(regular, spline.regular, exact.regular);
    compare(normalised, spline.normalised, exact.normalised);
  }

  // The generator works in 113 bits. Its samples carry a few units of 2^-113; the recursion adds up j of them, and a
  // curvature is a second difference, j^2 times smaller than a sample, so that at N = 200 a coefficient is known to
  // about 2^-113 200^3 2^3 = 2^-87 before the one rounding to 2^-53. Hence the bound u (1 + 2^-20); and a double
  // other than the nearest has a probability of 2^-34 per coefficient, 1e-3 for all 1e7 of these (fixed)
  // coefficients.
  void expect_rounded_once() const {
    for (const auto& [name, group] : {std::pair{"local", local}, {"regular", regular}, {"normalised", normalised}}) {
      EXPECT_LE(group.worst(), kUnitRoundoff * (1 + 0x1p-20)) << name;
      EXPECT_EQ(group.misrounded(), 0) << name << ": of " << group.count();
      Measured() << name << ": " << group.count() << " coefficients, worst relative error " << group.worst();
      ::testing::Test::RecordProperty(std::string("worst_") + name,
                                      std::to_string(group.worst() / kUnitRoundoff) + " u");
    }
  }

 private:
  static void compare(Accuracy& group, const Coefficients& actual, const ReferenceSpline::Powers& exact) {
    group.compare(actual.a, exact.a);
    group.compare(actual.b, exact.b);
    group.compare(actual.c, exact.c);
  }
};

class RandomMaterials : public ::testing::TestWithParam<int> {};

TEST_P(RandomMaterials, HaveEveryCoefficientRoundedOnceAndAreConvex) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  Accuracies accuracies;
  for (int i = 0; i < kMaterialsPerShard; ++i) {
    const Material material = random_material(random);
    const Spline spline = uniform_spline(material, "random.json");
    for (const auto& segment : spline.segments)
      ASSERT_GE(segment.half_curvature, 0) << "exponent " << material.contact.power_law()->exponent;
    accuracies.compare(spline, reference_spline(material));
    ASSERT_FALSE(HasFatalFailure());
  }
  accuracies.expect_rounded_once();
}

INSTANTIATE_TEST_SUITE_P(Shard, RandomMaterials, ::testing::Range(0, kShards));

// The bits to spare shrink as N^3: 2^-113 10^12 2^3 = 2^-70 is still far below u.
TEST(LongSpline, OfTenThousandSegmentsIsRoundedOnceToo) {
  const Material material{"long", "", {4.5e9, 2.5}, {}, {10000, 1e-3}};
  Accuracies accuracies;
  accuracies.compare(uniform_spline(material, "long.json"), reference_spline(material));
  accuracies.expect_rounded_once();
}

// Only exponent and N: stiffness and compression are in energy_scale_j and length_scale_m alone.
TEST(NormalisedCoefficients, DoNotDependOnStiffnessAndCompression) {
  const Spline soft = uniform_spline({"soft", "", {1e3, 2.5}, {}, {50, 1e-2}}, "soft.json");
  const Spline hard = uniform_spline({"hard", "", {7e11, 2.5}, {}, {50, 3e-6}}, "hard.json");
  EXPECT_EQ(soft.normalised.a, hard.normalised.a);
  EXPECT_EQ(soft.normalised.b, hard.normalised.b);
  EXPECT_EQ(soft.normalised.c, hard.normalised.c);
}

}  // namespace
}  // namespace contactspline::testing
