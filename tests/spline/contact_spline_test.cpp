// SPDX-License-Identifier: MIT
// The companion derivation, equation by equation, on generated splines; and what is refused.
#include "generator/spline/contact_spline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>
#include <tuple>

#include "generator/contact/contact_law_quad.hpp"
#include "generator/support/error.hpp"
#include "support/measured.hpp"
#include "support/reference.hpp"

namespace contactspline::testing {
namespace {

/// a-bar, b-bar, c-bar in joules, as the derivation has them, read from a spline; indices from 1 as there.
class Bars {
 public:
  // From the local segments: units off.
  static Bars of_segments(const Spline& spline, const Real& width) {
    Bars bars;
    for (const auto& s : spline.segments) {
      bars.a_.push_back(s.half_curvature * width * width);
      bars.b_.push_back(s.force * width);
      bars.c_.emplace_back(s.energy);
    }
    return bars;
  }
  // From the normalised coefficients: scale on.
  static Bars of_normalised(const Spline& spline, const Real& scale) {
    Bars bars;
    for (const double a : spline.normalised.a) bars.a_.push_back(a * scale);
    for (const double b : spline.normalised.b) bars.b_.push_back(b * scale);
    for (const double c : spline.normalised.c) bars.c_.push_back(c * scale);
    return bars;
  }
  [[nodiscard]] const Real& a(int j) const { return a_.at(static_cast<std::size_t>(j - 1)); }
  [[nodiscard]] const Real& b(int j) const { return b_.at(static_cast<std::size_t>(j - 1)); }
  [[nodiscard]] const Real& c(int j) const { return c_.at(static_cast<std::size_t>(j - 1)); }

 private:
  std::vector<Real> a_, b_, c_;
};

/// A generated spline and the exact quantities of the derivation's text; j = 1..N as there.
struct Case {
  explicit Case(const Material& of)
      : material(of),
        n(of.spline.segments),
        width(Real(of.spline.max_compression_m) / n),
        scale(of.contact.power_law()->stiffness * pow(width, Real(of.contact.power_law()->exponent) + 1)),
        spline(uniform_spline(of, "case.json")),
        bars{Bars::of_segments(spline, width), Bars::of_normalised(spline, scale)} {
    for (int j = 0; j <= n; ++j) samples_.push_back(exact_energy(material.contact, width * j));
  }
  [[nodiscard]] Real y(int j) const { return width * j; }                     ///< y_j
  [[nodiscard]] const Real& v(int j) const { return samples_.at(index(j)); }  ///< V(y_j)
  [[nodiscard]] const Segment<double>& segment(int j) const { return spline.segments.at(index(j - 1)); }
  [[nodiscard]] Real regular_a(int j) const { return spline.regular.a.at(index(j - 1)); }
  [[nodiscard]] Real regular_b(int j) const { return spline.regular.b.at(index(j - 1)); }
  [[nodiscard]] Real regular_c(int j) const { return spline.regular.c.at(index(j - 1)); }

  Material material;
  int n;
  Real width, scale;
  Spline spline;
  std::array<Bars, 2> bars;

 private:
  static std::size_t index(int j) { return static_cast<std::size_t>(j); }
  std::vector<Real> samples_;
};

// Exponents from linear to well beyond felt and Hertz, N from no equation in (22) to many, stiffness and range from
// steel to rubber.
const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> made;
    std::mt19937_64 random(1);
    for (const double exponent : {1.0, 1.3, 1.5, 2.3, 2.5, 3.155, 5.0})
      for (const int segments : {1, 2, 3, 16, 64, 200}) {
        Material material = random_material(random);
        material.contact = PowerLaw{material.contact.power_law()->stiffness, exponent};
        material.spline.segments = segments;
        made.emplace_back(material);
      }
    return made;
  }();
  return all;
}

/// Runs a check for every case and j = 1..N less `fewer`; stops at the first failure and says where.
template <typename Check>
void for_each_segment(int fewer, Check check) {
  int checked = 0;
  for (const Case& c : cases())
    for (int j = 1; j <= c.n - fewer; ++j, ++checked) {
      const ::testing::AssertionResult result = check(c, j);
      ASSERT_TRUE(result) << "exponent " << c.material.contact.power_law()->exponent << ", segment " << j << " of "
                          << c.n;
    }
  ASSERT_GT(checked, 0);
}

/// The same for both readings of the bars: the local segments and the normalised coefficients.
template <typename Check>
void for_each_bar(int fewer, Check check) {
  for (const std::size_t reading : {0U, 1U})
    for_each_segment(fewer, [&](const Case& c, int j) { return check(c, c.bars.at(reading), j); });
}

// Exact coordinates within a segment, y-bar.
const std::array kInside = {Real(0), Real(1) / 7, Real(1) / 2, Real(6) / 7, Real(1)};

/// First failure of several balances.
::testing::AssertionResult all_of(std::initializer_list<::testing::AssertionResult> results) {
  for (const auto& result : results)
    if (!result) return result;
  return ::testing::AssertionSuccess();
}

// All bounds below are those of balances(): one rounding to double per coefficient, nothing else.

TEST(Derivation, Eq01_SegmentsInPowersOfYMeetThePotentialAtBothEnds) {
  for_each_segment(0, [](const Case& c, int j) {
    const auto meets = [&](int knot) {
      const Real y = c.y(knot);
      return balances({c.regular_a(j) * y * y, c.regular_b(j) * y, c.regular_c(j)}, c.v(knot));
    };
    return all_of({meets(j - 1), meets(j)});
  });
}

TEST(Derivation, Eq02_SlopeInPowersOfYIsTheForceOfTheLocalSegment) {
  for_each_segment(0, [](const Case& c, int j) {
    for (const Real& bar : kInside) {
      const Real t = bar * c.width;
      const auto& s = c.segment(j);
      const auto result = balances(
          {2 * c.regular_a(j) * (c.y(j - 1) + t), c.regular_b(j), -Real(s.force), -2 * s.half_curvature * t}, 0);
      if (!result) return result;
    }
    return ::testing::AssertionSuccess();
  });
}

TEST(Derivation, Eq03_CompressionInASegmentRunsFromZeroToOne) {
  for_each_segment(0, [](const Case& c, int j) {
    return all_of(
        {balances({Real(c.segment(j).knot)}, c.y(j - 1)), balances({Real(c.spline.length_scale_m)}, c.width)});
  });
}

TEST(Derivation, Eq04_ReparametrisedAndRegularSegmentsAreTheSameCurve) {
  for_each_bar(0, [](const Case& c, const Bars& bars, int j) {
    for (const Real& bar : kInside) {
      const Real y = c.y(j - 1) + bar * c.width;
      const auto result = balances({bars.a(j) * bar * bar, bars.b(j) * bar, bars.c(j), -c.regular_a(j) * y * y,
                                    -c.regular_b(j) * y, -c.regular_c(j)},
                                   0);
      if (!result) return result;
    }
    return ::testing::AssertionSuccess();
  });
}

// energy_at() in double. The knot and t = y - knot are each off by u y, which moves V by V' 2 u y; Horner's four
// operations on rounded coefficients add at most 5 u of V (all terms are positive).
TEST(Derivation, Eq05_EvaluatedSegmentIsTheReparametrisedQuadratic) {
  for_each_bar(0, [](const Case& c, const Bars& bars, int j) {
    for (const Real& bar : kInside) {
      const double y = Real(c.y(j - 1) + bar * c.width).convert_to<double>();
      const Real exact_bar = (y - c.y(j - 1)) / c.width;
      const Real exact = bars.a(j) * exact_bar * exact_bar + bars.b(j) * exact_bar + bars.c(j);
      const Real slope = (2 * bars.a(j) * exact_bar + bars.b(j)) / c.width;
      const Real bound = kUnitRoundoff * (2 * slope * y + 6 * exact) * (1 + 0x1p-20);
      if (!(abs(c.segment(j).energy_at(y) - exact) <= bound)) return ::testing::AssertionFailure() << "at " << y;
    }
    return ::testing::AssertionSuccess();
  });
}

// force_at() in double: t is off by 2 u y, three operations on rounded coefficients add at most 4 u of the force.
TEST(Derivation, Eq06_EvaluatedForceIsTheSlopeOfTheReparametrisedQuadratic) {
  for_each_bar(0, [](const Case& c, const Bars& bars, int j) {
    for (const Real& bar : kInside) {
      const double y = Real(c.y(j - 1) + bar * c.width).convert_to<double>();
      const Real exact_bar = (y - c.y(j - 1)) / c.width;
      const Real exact = (2 * bars.a(j) * exact_bar + bars.b(j)) / c.width;
      const Real curvature = 2 * bars.a(j) / (c.width * c.width);
      const Real bound = kUnitRoundoff * (2 * curvature * y + 5 * exact) * (1 + 0x1p-20);
      if (!(abs(c.segment(j).force_at(y) - exact) <= bound)) return ::testing::AssertionFailure() << "at " << y;
    }
    return ::testing::AssertionSuccess();
  });
}

TEST(Derivation, Eq07_LocalSegmentsAreTheNormalisedOnesWithUnitsPutBack) {
  for_each_segment(0, [](const Case& c, int j) {
    const auto& s = c.segment(j);
    const Bars& normalised = c.bars[1];
    return all_of({balances({Real(s.half_curvature) * c.width * c.width, -normalised.a(j)}, 0),
                   balances({Real(s.force) * c.width, -normalised.b(j)}, 0),
                   balances({Real(s.energy), -normalised.c(j)}, 0),
                   balances({Real(c.spline.energy_scale_j)}, c.scale)});
  });
}

TEST(Derivation, Eq08_RegularCoefficientsFollowFromTheReparametrisedOnes) {
  for_each_bar(0, [](const Case& c, const Bars& bars, int j) {
    const Real& dy = c.width;
    const int i = j - 1;
    return all_of({balances({c.regular_a(j), -bars.a(j) / (dy * dy)}, 0),
                   balances({c.regular_b(j), -bars.b(j) / dy, 2 * i * bars.a(j) / dy}, 0),
                   balances({c.regular_c(j), -bars.a(j) * i * i, bars.b(j) * i, -bars.c(j)}, 0)});
  });
}

TEST(Derivation, Eq09_SegmentEndsOnTheSampledPotential) {
  for_each_bar(0, [](const Case& c, const Bars& bars, int j) {
    const Real bar = 1;
    return balances({bars.a(j) * bar * bar, bars.b(j) * bar, bars.c(j)}, c.v(j));
  });
}

TEST(Derivation, Eq10_NoEnergyAtFirstTouch) {
  for (const Case& c : cases()) {
    EXPECT_EQ(c.spline.normalised.c[0], 0);
    EXPECT_EQ(c.spline.regular.c[0], 0);
    EXPECT_EQ(c.segment(1).energy_at(0), 0);
  }
}

TEST(Derivation, Eq11_NoForceAtFirstTouch) {
  for (const Case& c : cases()) {
    EXPECT_EQ(c.spline.normalised.b[0], 0);
    EXPECT_EQ(c.spline.regular.b[0], 0);
    EXPECT_EQ(c.segment(1).force_at(0), 0);
  }
}

TEST(Derivation, Eq12_EnergyIsContinuousAtEveryKnot) {
  for_each_bar(1, [](const Case& c, const Bars& bars, int j) {
    const Real y = c.y(j);
    return all_of({balances({bars.a(j), bars.b(j), bars.c(j), -bars.c(j + 1)}, 0),
                   balances({c.regular_a(j) * y * y, c.regular_b(j) * y, c.regular_c(j), -c.regular_a(j + 1) * y * y,
                             -c.regular_b(j + 1) * y, -c.regular_c(j + 1)},
                            0)});
  });
}

TEST(Derivation, Eq13_SegmentBeginsOnTheSampledPotential) {
  for_each_segment(1, [](const Case& c, int j) {
    const auto& next = c.segment(j + 1);
    return balances({Real(next.energy_at(next.knot))}, c.v(j));
  });
}

TEST(Derivation, Eq14_ForceIsContinuousAtEveryKnot) {
  for_each_segment(1, [](const Case& c, int j) {
    const auto& s = c.segment(j);
    const Real y = c.y(j);
    return all_of(
        {balances({Real(s.force), 2 * s.half_curvature * c.width, -Real(c.segment(j + 1).force)}, 0),
         balances({2 * c.regular_a(j) * y, c.regular_b(j), -2 * c.regular_a(j + 1) * y, -c.regular_b(j + 1)}, 0)});
  });
}

TEST(Derivation, Eq15_ConstantTermIsTheSampledPotential) {
  for_each_bar(1, [](const Case& c, const Bars& bars, int j) { return balances({bars.c(j + 1)}, c.v(j)); });
}

// In pure numbers: Vn(j) = j^(a + 1)/(a + 1).
TEST(Derivation, Eq16_NormalisedCoefficientsSumToTheNormalisedPotential) {
  for_each_segment(0, [](const Case& c, int j) {
    const auto i = static_cast<std::size_t>(j - 1);
    const auto& [a, b, constant] = c.spline.normalised;
    const Real power = Real(c.material.contact.power_law()->exponent) + 1;
    return balances({Real(a[i]), Real(b[i]), Real(constant[i])}, pow(Real(j), power) / power);
  });
}

TEST(Derivation, Eq17_QuadraticTermIsWhatEnergyAndSlopeLeave) {
  for_each_segment(0, [](const Case& c, int j) {
    const auto& s = c.segment(j);
    const Real& dy = c.width;
    return balances({Real(s.half_curvature), s.force / dy, s.energy / (dy * dy)}, c.v(j) / (dy * dy));
  });
}

TEST(Derivation, Eq18_QuadraticTermIsTheRiseLessTheSlope) {
  for_each_bar(0, [](const Case& c, const Bars& bars, int j) {
    return balances({bars.a(j), bars.b(j)}, c.v(j) - c.v(j - 1));
  });
}

TEST(Derivation, Eq19_SlopeGrowsByTwiceTheQuadraticTerm) {
  for_each_bar(1, [](const Case&, const Bars& bars, int j) {
    return balances({2 * bars.a(j), bars.b(j), -bars.b(j + 1)}, 0);
  });
}

TEST(Derivation, Eq20_NextSlopeFollowsFromRiseAndSlope) {
  for_each_bar(1, [](const Case& c, const Bars& bars, int j) {
    return balances({-2 * bars.b(j) + bars.b(j), -bars.b(j + 1)}, -2 * (c.v(j) - c.v(j - 1)));
  });
}

TEST(Derivation, Eq21_NeighbouringSlopesSumToTwiceTheRise) {
  for_each_bar(1, [](const Case& c, const Bars& bars, int j) {
    return balances({bars.b(j), bars.b(j + 1)}, 2 * (c.v(j) - c.v(j - 1)));
  });
}

// The inverse of a bidiagonal matrix of ones is a triangle of alternating ones: b_j+1 = 2 (rise_j - rise_j-1 + ...).
TEST(Derivation, Eq22_SlopesAreTheSolutionOfTheBidiagonalSystem) {
  for_each_bar(1, [](const Case& c, const Bars& bars, int j) {
    Real solution = 0;
    for (int i = 1; i <= j; ++i) solution = 2 * (c.v(i) - c.v(i - 1)) - solution;
    Real alternating = 0;
    for (int i = 1; i <= j; ++i) alternating += ((j - i) % 2 == 0 ? 2 : -2) * (c.v(i) - c.v(i - 1));
    return all_of({balances({bars.b(j + 1)}, alternating), balances({bars.b(j + 1)}, solution)});
  });
}

TEST(Derivation, Conclusion_ThreeCoefficientsPerSegment) {
  for (const Case& c : cases()) {
    const auto n = static_cast<std::size_t>(c.n);
    EXPECT_EQ(c.spline.segments.size(), n);
    for (const auto* coefficients : {&c.spline.regular, &c.spline.normalised}) {
      EXPECT_EQ(coefficients->a.size(), n);
      EXPECT_EQ(coefficients->b.size(), n);
      EXPECT_EQ(coefficients->c.size(), n);
    }
  }
}

TEST(SegmentTable, IsOutOfContactFollowedByTheSegments) {
  for (const Case& c : cases()) {
    const auto table = segment_table(c.spline);
    ASSERT_EQ(table.size(), c.spline.segments.size() + 1);
    const auto& out = table.front();
    EXPECT_EQ(std::tie(out.knot, out.energy, out.force, out.half_curvature), std::make_tuple(0, 0, 0, 0));
    for (int j = 1; j <= c.n; ++j)
      EXPECT_EQ(std::memcmp(&table[static_cast<std::size_t>(j)], &c.segment(j), sizeof(Segment<double>)), 0);
  }
}

/// One-line answer to a refused material, empty where it is accepted.
std::string refusal(const Material& material) {
  try {
    static_cast<void>(uniform_spline(material, "soft_felt.json"));
    return {};
  } catch (const BadInput& refused) {
    return refused.what();
  }
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// Exponent 1/2, N = 2 by hand: rises 2/3 and (2 sqrt 8 - 2)/3, so b_2 = 4/3 and a_2 = (4 sqrt 2 - 6)/3 < 0.
TEST(Convexity, RefusalNamesFileKeySegmentAndRemedy) {
  const std::string message = refusal({"felt", "", {1e6, 0.5}, {}, {16, 1e-3}});
  EXPECT_TRUE(message.starts_with("soft_felt.json: contact.exponent: ")) << message;
  EXPECT_TRUE(contains(message, "with 0.5 ")) << message;
  EXPECT_TRUE(contains(message, "segment 2 of 16")) << message;
  EXPECT_TRUE(contains(message, "allowed: an exponent >= 1")) << message;
  EXPECT_FALSE(contains(message, "\n")) << message;
}

// Below 1 the ringing of (21) beats the falling curvature sooner or later: sooner for small exponents and many
// segments. The generator must refuse exactly the splines that are concave somewhere, and name the first such
// segment.
TEST(Convexity, BelowExponentOneExactlyTheConcaveSplinesAreRefused) {
  int refused = 0, accepted = 0;
  for (const double exponent : {0.1, 0.25, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 0.95, 0.99, 0.999})
    for (const int segments : {1, 2, 3, 8, 16, 64, 200}) {
      const Material material{"felt", "", {1e6, exponent}, {}, {segments, 1e-3}};
      const std::string message = refusal(material);
      const auto concave = reference_spline(material).first_concave_segment();
      ++(concave ? refused : accepted);
      EXPECT_EQ(message.empty(), !concave) << "exponent " << exponent << ", N " << segments << ": " << message;
      if (!concave) continue;
      const std::string named = "(segment " + std::to_string(*concave) + " of " + std::to_string(segments) + " ";
      EXPECT_TRUE(contains(message, named)) << message << " does not name " << named;
    }
  Measured() << "exponents below 1: " << refused << " refused, " << accepted << " convex";
  EXPECT_GT(refused, 20);
  EXPECT_GT(accepted, 7);  // N = 1 is always convex
}

TEST(Convexity, HalfIsRefusedForEverySegmentCountAboveOne) {
  for (int segments = 2; segments <= 200; ++segments)
    EXPECT_NE(refusal({"felt", "", {1e6, 0.5}, {}, {segments, 1e-3}}), "") << segments;
}

// The first k segments do not depend on N, so N = 1000 speaks for every smaller N. From the exponent next above 1 to
// the largest a material file may hold.
TEST(Convexity, EveryExponentFromOneToTenIsConvex) {
  std::vector<double> exponents = {std::nextafter(1.0, 2.0), 1 + 1e-12, 1 + 1e-6, 1.001, 1.01};
  for (int i = 0; i <= 90; ++i) exponents.push_back(1 + i / 10.0);
  for (const double exponent : exponents) {
    const Material material{"felt", "", {1e6, exponent}, {}, {1000, 1e-3}};
    EXPECT_EQ(refusal(material), "");
    for (const auto& segment : uniform_spline(material, "convex.json").segments) ASSERT_GE(segment.half_curvature, 0);
  }
}

// A linear contact is one parabola: every segment has half the stiffness as its half-curvature, with no ringing at
// all.
TEST(LinearContact, IsReproducedExactly) {
  const Spline spline = uniform_spline({"linear", "", {8e5, 1.0}, {}, {37, 0x1p-10}}, "linear.json");
  for (const auto& segment : spline.segments) EXPECT_EQ(segment.half_curvature, 4e5);
  for (const double b : spline.regular.b) EXPECT_EQ(b, 0);
  for (const double c : spline.regular.c) EXPECT_EQ(c, 0);
}

TEST(Range, CoefficientsBeyondDoubleAreRefused) {
  for (const PowerLaw& law : {PowerLaw{1e-3, 10}, PowerLaw{1e300, 2}}) {
    const std::string message = refusal({"far", "", law, {}, {16, law.stiffness > 1 ? 1e9 : 1e-30}});
    EXPECT_TRUE(message.starts_with("soft_felt.json: contact.stiffness_n_per_m_alpha: ")) << message;
    EXPECT_FALSE(contains(message, "\n")) << message;
  }
}

}  // namespace
}  // namespace contactspline::testing
