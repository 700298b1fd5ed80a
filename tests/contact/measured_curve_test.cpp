// SPDX-License-Identifier: MIT
// Smoothing of measured curves: a power law comes back out of noise, the shape holds, and nothing fits better.
#include "generator/contact/measured_curve.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "generator/contact/barrier_impact.hpp"
#include "generator/spline/contact_spline.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/reference.hpp"

namespace contactspline::testing {
namespace {

constexpr double kMass = 0.003;

// Box and Muller, the same on every machine but for the last bits of log and cos.
double normal(std::mt19937_64& random) {
  const double radius = std::sqrt(-2 * std::log(1 - uniform(random)));
  return radius * std::cos(2 * std::numbers::pi * uniform(random));
}

enum class Noise { kOfTheLargest, kOfEach };

std::vector<CurveSample> sampled(const PowerLaw& law, double range_m, int count, Noise kind, double noise,
                                 std::mt19937_64& random) {
  std::vector<CurveSample> samples;
  for (int i = 1; i <= count; ++i) {
    const double y = range_m * i / count, force = law.force(y);
    const double deviation = noise * (kind == Noise::kOfEach ? force : law.force(range_m));
    samples.push_back({y, force + deviation * normal(random)});
  }
  return samples;
}

double speed_to(const PowerLaw& law, double compression_m) {
  return std::sqrt(2 * law.energy(compression_m) / kMass);
}

/// Worst errors over many curves.
struct Recovery {
  double exponent = 0, duration_at_top = 0, duration_at_third = 0;
  int curves = 0;

  void add(const PowerLaw& law, double range_m, const std::vector<CurveSample>& samples) {
    const ContactLaw smooth = smooth_curve(samples, CurveShape::kHardening);
    const auto error = [&](double part) {
      const double speed = part * speed_to(law, range_m);
      return std::abs(contact_duration(smooth, kMass, speed) / law.contact_duration(kMass, speed) - 1);
    };
    exponent = std::max(exponent, std::abs(nearest_power_law(samples).exponent / law.exponent - 1));
    duration_at_top = std::max(duration_at_top, error(1));
    duration_at_third = std::max(duration_at_third, error(1.0 / 3));
    ++curves;
  }
};

struct NoiseCase {
  const char* name;
  Noise kind;
  int samples;
};

class NoisyCurve : public ::testing::TestWithParam<NoiseCase> {};

// 2 % of noise, of the largest force or of each: exponent within 3 %, duration within 5 %. How well the exponent can
// be known at all is a matter of statistics: with noise of the largest force least squares leave a standard deviation
// of 0.02 sqrt((2 a + 1)^3 (1 + ...)/n) / a, 0.9 % of 3.5 with 200 samples, 0.65 % with 400; the worst of 50 is 3 of
// those.
TEST_P(NoisyCurve, GivesThePowerLawBack) {
  const auto& [name, kind, count] = GetParam();
  for (const double exponent : {1.5, 2.5, 3.5}) {
    Recovery recovery;
    for (unsigned seed = 0; seed < 50; ++seed) {
      std::mt19937_64 random(seed);
      const PowerLaw law{log_uniform(random, 1e6, 1e12), exponent};
      const double range_m = log_uniform(random, 1e-4, 1e-2);
      recovery.add(law, range_m, sampled(law, range_m, count, kind, 0.02, random));
    }
    Measured() << name << ", exponent " << exponent << ", " << recovery.curves << " curves: exponent within "
               << 100 * recovery.exponent << " %, duration within " << 100 * recovery.duration_at_top
               << " %, at a third of the speed " << 100 * recovery.duration_at_third << " %";
    EXPECT_LE(recovery.exponent, 0.03);
    EXPECT_LE(recovery.duration_at_top, 0.05);
    EXPECT_LE(recovery.duration_at_third, 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(Noise, NoisyCurve,
                         ::testing::Values(NoiseCase{"of_the_largest", Noise::kOfTheLargest, 400},
                                           NoiseCase{"of_each", Noise::kOfEach, 60}),
                         [](const auto& test) { return test.param.name; });

// Without noise: the slope is a power of a - 1, drawn with straight lines between 24 knots.
TEST(CleanCurve, GivesThePowerLawBackToAFewTenThousandths) {
  std::mt19937_64 random(1);
  for (const double exponent : {1.0, 1.5, 2.5, 3.5}) {
    const PowerLaw law{1e9, exponent};
    const auto samples = sampled(law, 1e-3, 100, Noise::kOfEach, 0, random);
    const ContactLaw smooth = smooth_curve(samples, CurveShape::kHardening);
    EXPECT_TRUE(relatively_within(nearest_power_law(samples).exponent, exponent, 1e-6));
    EXPECT_TRUE(relatively_within(nearest_power_law(samples).stiffness, law.stiffness, 1e-5));
    for (const double part : {0.2, 0.5, 1.0}) {
      const double speed = part * speed_to(law, 1e-3);
      EXPECT_TRUE(
          relatively_within(contact_duration(smooth, kMass, speed), law.contact_duration(kMass, speed), 1e-3));
    }
  }
}

double squares(const std::vector<CurveSample>& samples, const ForceCurve& curve) {
  double sum = 0;
  for (const auto& [y, f, speed] : samples) sum += std::pow(f - curve.force(y), 2);
  return sum;
}

bool is_of_shape(const ForceCurve& curve, CurveShape shape) {
  double min = 0;
  for (const double slope : curve.slope_n_per_m) {
    if (!(slope >= min)) return false;
    if (shape == CurveShape::kHardening) min = slope;
  }
  return true;
}

class CurveFit : public ::testing::TestWithParam<CurveShape> {};

// Least squares over a convex set: from the solution no step that keeps the shape goes down. Single slopes and random
// directions, forwards and backwards, small and large.
TEST_P(CurveFit, HasItsShapeAndNothingOfThatShapeIsNearer) {
  std::mt19937_64 random(2);
  int tried = 0;
  for (int round = 0; round < 20; ++round) {
    const PowerLaw law{1e8, uniform(random, 0.8, 3)};
    const auto samples = sampled(law, 1e-3, 20 + 10 * round, Noise::kOfTheLargest, 0.05, random);
    const ForceCurve fit = smooth_curve(samples, GetParam());
    EXPECT_TRUE(is_of_shape(fit, GetParam()));
    const double min = squares(samples, fit), top = std::ranges::max(fit.slope_n_per_m);
    for (int i = 0; i < 400; ++i) {
      std::vector<double> slopes = fit.slope_n_per_m;
      const double size = log_uniform(random, 1e-5, 0.3) * top;
      if (i % 2 == 0)
        slopes[static_cast<std::size_t>(uniform(random) * static_cast<double>(slopes.size()))] +=
            (uniform(random) < 0.5 ? -size : size);
      else
        for (double& slope : slopes) slope += size * uniform(random, -1, 1);
      const ForceCurve other(fit.knot_m, slopes);
      if (!is_of_shape(other, GetParam())) continue;
      ++tried;
      EXPECT_GE(squares(samples, other), min * (1 - 1e-12));
    }
  }
  Measured() << tried << " neighbours of the shape, none nearer";
  EXPECT_GE(tried, 100);
}

INSTANTIATE_TEST_SUITE_P(Shape, CurveFit, ::testing::Values(CurveShape::kMonotone, CurveShape::kHardening),
                         [](const auto& test) {
                           return test.param == CurveShape::kMonotone ? "monotone" : "hardening";
                         });

// A foam that softens: only `monotone` can follow.
TEST(CurveShapes, DifferWhereAForceSoftens) {
  std::vector<CurveSample> samples;
  for (int i = 1; i <= 100; ++i) samples.push_back({i * 1e-5, std::tanh(i / 30.0)});
  EXPECT_LT(relative_scatter(samples, smooth_curve(samples, CurveShape::kMonotone)), 1e-3);
  EXPECT_GT(relative_scatter(samples, smooth_curve(samples, CurveShape::kHardening)), 0.05);
}

// An impact with loss as a sensor would measure it: m y'' = -F(y) (1 + loss y') by Runge and Kutta, sampled at equal
// times.
struct MeasuredImpact {
  std::string csv = "compression_m,force_n\n";
  std::vector<double> speeds;  ///< speeds of the samples
};

MeasuredImpact measured_impact(const PowerLaw& law, double loss, double speed, double noise,
                               std::mt19937_64& random) {
  constexpr int kStepsPerSample = 20, kSamples = 100;
  const double h = 1.2 * law.contact_duration(kMass, speed) / (kStepsPerSample * kSamples);
  const auto force = [&](double y, double v) { return law.force(y) * (1 + loss * v); };
  const double largest = law.force(law.max_compression(kMass, speed));
  MeasuredImpact impact;
  double y = 0, v = speed;
  for (int i = 1;; ++i) {
    const double a1 = -force(y, v) / kMass, v2 = v + h / 2 * a1;
    const double a2 = -force(y + h / 2 * v, v2) / kMass, v3 = v + h / 2 * a2;
    const double a3 = -force(y + h / 2 * v2, v3) / kMass, v4 = v + h * a3;
    const double a4 = -force(y + h * v3, v4) / kMass;
    y += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if (!(y > 0)) return impact;
    if (i % kStepsPerSample != 0) continue;
    impact.csv += fmt::format("{},{}\n", y, force(y, v) + noise * largest * normal(random));
    impact.speeds.push_back(v);
  }
}

// Speeds follow from the work of the force. The turning point lies between two samples, and the one of largest
// compression is taken for it; from one to the next the speed changes by at most about pi v/n.
TEST(MeasuredImpact, HasTheSpeedsOfItsMass) {
  std::mt19937_64 random(3);
  for (const double loss : {0.0, 0.05, 0.4}) {
    const MeasuredImpact impact = measured_impact({4.5e9, 2.5}, loss, 2, 0, random);
    auto samples = parse_curve(impact.csv, "felt.csv", 2.0);
    ASSERT_EQ(samples.size(), impact.speeds.size());
    std::ranges::sort(samples, std::greater<>(), &CurveSample::speed_m_per_s);  // in the order of time again
    const double bound = std::numbers::pi * 2 / static_cast<double>(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
      EXPECT_TRUE(within(samples[i].speed_m_per_s, impact.speeds[i], bound)) << loss << ' ' << i;
  }
}

// The loss comes back out of the two branches, and with it the force at rest. Without noise the error is that of the
// speeds and of the smoothing; with noise of 1 % of the largest force in n samples the loop, which is 2 loss v F
// wide, is known to some 0.01/sqrt(n) of the force.
TEST(MeasuredImpact, GivesLossAndForceBack) {
  std::mt19937_64 random(4);
  for (const double exponent : {1.5, 2.5})
    for (const double scaled : {0.05, 0.2, 0.8})  // loss times speed
      for (const double noise : {0.0, 0.01}) {
        const PowerLaw law{4.5e4 * std::pow(1e4, exponent - 1), exponent};
        const double speed = 2, loss = scaled / speed;
        const auto samples = parse_curve(measured_impact(law, loss, speed, noise, random).csv, "felt.csv", speed);
        const double fitted = fitted_loss(samples, CurveShape::kHardening, 0.49);
        const ForceCurve curve = smooth_curve(samples, CurveShape::kHardening, fitted);
        Measured() << "exponent " << exponent << ", loss times speed " << scaled << ", noise " << noise << ": loss "
                   << fitted / loss << " of the true one";
        EXPECT_TRUE(within(fitted * speed, scaled, noise == 0 ? 0.01 : 0.02));
        const double deepest = samples.back().compression_m;
        for (const double part : {0.3, 0.6, 1.0})
          EXPECT_TRUE(within(curve.force(part * deepest), law.force(part * deepest), 0.03 * law.force(deepest)));
        EXPECT_LE(relative_scatter(samples, curve, fitted), noise == 0 ? 3e-3 : 0.02);
        EXPECT_TRUE(relatively_within(nearest_power_law(samples, fitted).exponent, exponent, 0.05));
      }
}

TEST(CurveSpline, IsConvexAndNearItsCurve) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    const auto samples = sampled({4e8, 2.3}, 1.6e-3, 120, Noise::kOfTheLargest, 0.02, random);
    Material material{"felt", "", smooth_curve(samples, CurveShape::kHardening), {}, {48, 1.5e-3}};
    const Spline spline = uniform_spline(material, "felt.json");
    for (const auto& segment : spline.segments) EXPECT_GE(segment.half_curvature, 0);
    for (const auto& segment : spline.segments)
      EXPECT_TRUE(within(segment.force, material.contact.force(segment.knot), 1e-2 * material.contact.force(1.5e-3)));
  }
}

}  // namespace
}  // namespace contactspline::testing
