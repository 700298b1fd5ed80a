// SPDX-License-Identifier: MIT
// Motion through any contact law, with and without loss, against closed forms and a Runge-Kutta integration; and the
// laws themselves.
#include "generator/contact/barrier_impact.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "generator/contact/contact_law_quad.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/simulated_impact.hpp"
#include "generator/spline/spline_error.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/reference.hpp"

namespace contactspline::testing {
namespace {

// Felt that bottoms out, and a curve with soft, stiff and flat parts.
const ContactLaw kFeltOverWood = PowerSum{{{{4.5e9, 2.5}}, {{1.03e8, 1.5}, 5e-4}}};
const ContactLaw kFeltAndLeather = PowerSeries{{{4.5e9, 2.5}, {3e6, 1.4}}};
const ContactLaw kCurve = ForceCurve({0, 2e-4, 5e-4, 1e-3}, {1e4, 3e4, 0, 2e5});

std::vector<ContactLaw> laws() {
  return {ContactLaw(1e9, 1.3), ContactLaw(4.5e9, 2.5), kFeltOverWood, kFeltAndLeather, kCurve};
}

constexpr double kMass = 0.003;

// The quadrature against the closed forms of the power law.
TEST(Collide, WithoutLossIsTheClosedFormOfAPowerLaw) {
  double worst = 0;
  for (const double exponent : {1.0, 1.3, 1.5, 2.5, 5.0})
    for (const double speed : {1e-3, 0.1, 2.0, 100.0}) {
      const PowerLaw law{1e9, exponent};
      const BarrierImpact found = barrier_impact(law_view(ContactLaw(law)), kMass, speed, 0);
      EXPECT_TRUE(relatively_within(found.max_compression_m, law.max_compression(kMass, speed), 1e-14));
      EXPECT_TRUE(relatively_within(found.contact_duration_s, law.contact_duration(kMass, speed), 1e-10));
      EXPECT_TRUE(relatively_within(found.exit_speed_m_per_s, speed, 1e-15));
      worst = std::max(worst, std::abs(found.contact_duration_s / law.contact_duration(kMass, speed) - 1));
    }
  Measured() << "duration by quadrature: worst relative error " << worst;
}

// A spring that gets a second one beside it at d: the motion is a sine up to d and one with a shifted centre beyond.
TEST(Collide, OfTwoSpringsIsTwoArcs) {
  const double k1 = 1e5, k2 = 4e5, d = 1e-4, speed = 2;
  const ContactLaw springs = PowerSum{{{{k1, 1}}, {{k2, 1}, d}}};
  const double w1 = std::sqrt(k1 / kMass), w2 = std::sqrt((k1 + k2) / kMass);
  const double speed_there = std::sqrt(speed * speed - w1 * w1 * d * d);
  const double lead = k1 * d / (k1 + k2);  // force at d, as displacement beyond the second centre
  const double arc = std::numbers::pi / 2 - std::atan(w2 * lead / speed_there);
  const double duration = 2 * (std::asin(w1 * d / speed) / w1 + arc / w2);
  const double deepest = d - lead + std::sqrt(lead * lead + std::pow(speed_there / w2, 2));
  EXPECT_TRUE(relatively_within(contact_duration(springs, kMass, speed), duration, 1e-10));
  EXPECT_TRUE(relatively_within(max_compression(springs, kMass, speed), deepest, 1e-13));
}

// A quadratic spline is a law too, with a closed form of its own.
TEST(Collide, ThroughASplineIsItsClosedForm) {
  const Spline spline = uniform_spline({"felt", "", {4.5e9, 2.5}, {}, {16, 1e-3}}, "felt.json");
  for (const double speed : {0.1, 1.0, 6.0}) {
    const SplineImpact exact = impact_on_spline(spline, kMass, speed);
    const BarrierImpact found = barrier_impact(law_view(spline), kMass, speed, 0);
    EXPECT_TRUE(relatively_within(found.contact_duration_s, exact.contact_duration_s, 1e-10));
    EXPECT_TRUE(relatively_within(found.max_compression_m, exact.max_compression_m, 1e-13));
  }
}

// A linear spring: the compression is a sine and the force k times it.
TEST(BarrierMotion, OfASpringIsASine) {
  const double k = 1e6, speed = 2, w = std::sqrt(k / kMass);
  const auto motion = barrier_motion(law_view(ContactLaw(k, 1)), kMass, speed, 0, 64);
  ASSERT_EQ(motion.size(), 129u);
  for (const auto& [time_s, compression_m, force_n] : motion) {
    EXPECT_TRUE(within(compression_m, speed / w * std::sin(w * time_s), 1e-12 * speed / w)) << time_s;
    EXPECT_TRUE(within(force_n, k * compression_m, 1e-12 * k * speed / w)) << time_s;
  }
  EXPECT_TRUE(relatively_within(motion[64].time_s, std::numbers::pi / 2 / w, 1e-12));
  EXPECT_TRUE(relatively_within(motion[128].time_s, std::numbers::pi / w, 1e-12));
}

// It takes the time of the impact, reaches its compression and its force, and its impulse turns the mass around. The
// bound of the impulse: the trapezoidal rule, whose error is (h^2/12) (F'(end) - F'(begin)), here below 1e-5 of it.
TEST(BarrierMotion, IsTheImpactOverTime) {
  for (const ContactLaw& law : laws())
    for (const double loss : {0.0, 0.1, 2.0}) {
      const double speed = 2;
      const BarrierImpact impact = barrier_impact(law_view(law), kMass, speed, loss);
      const auto motion = barrier_motion(law_view(law), kMass, speed, loss, 2000);
      EXPECT_TRUE(relatively_within(motion.back().time_s, impact.contact_duration_s, 1e-9));
      EXPECT_EQ(motion[2000].compression_m, impact.max_compression_m);
      double impulse = 0, largest = 0;
      for (std::size_t i = 1; i < motion.size(); ++i) {
        ASSERT_GT(motion[i].time_s, motion[i - 1].time_s);
        impulse += (motion[i].time_s - motion[i - 1].time_s) * (motion[i].force_n + motion[i - 1].force_n) / 2;
        largest = std::max(largest, motion[i].force_n);
      }
      EXPECT_TRUE(relatively_within(impulse, kMass * (speed + impact.exit_speed_m_per_s), 1e-5)) << loss;
      EXPECT_TRUE(relatively_within(largest, impact.max_force_n, 1e-5)) << loss;
    }
}

/// m dv/dt = -F(y)(1 + loss v) by the classical Runge-Kutta method; exit by the last step's straight line.
BarrierImpact by_runge_kutta(const ContactLaw& law, double speed, double loss, double time_step) {
  using State = std::array<double, 2>;
  const auto slope = [&](const State& s) { return State{s[1], -law.force(s[0]) * (1 + loss * s[1]) / kMass}; };
  const auto ahead = [](const State& s, const State& k, double h) { return State{s[0] + h * k[0], s[1] + h * k[1]}; };
  State s{0, speed};
  double time = 0, deepest = 0, largest = 0;
  for (;;) {
    const State a = slope(s), b = slope(ahead(s, a, time_step / 2)), c = slope(ahead(s, b, time_step / 2)),
                d = slope(ahead(s, c, time_step));
    const State next{s[0] + time_step / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0]),
                     s[1] + time_step / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])};
    if (s[1] > 0 && next[1] <= 0) deepest = s[0] + s[1] * s[1] / (2 * (s[1] - next[1])) * time_step;
    if (next[0] <= 0) return {deepest, time - s[0] / next[1], -next[1], largest};
    largest = std::max(largest, -kMass * slope(next)[1]);
    s = next;
    time += time_step;
  }
}

// 20,000 steps: the method itself is off by 1e-12 and less, where the law is smooth; at a break, and at the exit's
// straight line, by the square of a step's part of the contact, 1e-8 and less. The largest force may lie at a break
// between two steps.
TEST(Collide, IsTheMotionByRungeKutta) {
  for (const ContactLaw& law : laws())
    for (const double loss : {0.0, 0.01, 0.3, 5.0}) {
      const double speed = 1.5;
      const BarrierImpact found = barrier_impact(law_view(law), kMass, speed, loss);
      const BarrierImpact stepped = by_runge_kutta(law, speed, loss, found.contact_duration_s / 20000);
      EXPECT_TRUE(relatively_within(found.contact_duration_s, stepped.contact_duration_s, 2e-8)) << loss;
      EXPECT_TRUE(relatively_within(found.max_compression_m, stepped.max_compression_m, 2e-8)) << loss;
      EXPECT_TRUE(relatively_within(found.exit_speed_m_per_s, stepped.exit_speed_m_per_s, 2e-8)) << loss;
      EXPECT_TRUE(relatively_within(found.max_force_n, stepped.max_force_n, 2e-7)) << loss;
    }
}

// Of second order: the error falls to a quarter with half the step, down to what the spline errs.
TEST(Collide, IsWhatTheContactStepConvergesTo) {
  const Material felt{"felt", "", {4.5e9, 2.5}, {}, {512, 1e-3}};
  const auto table = segment_table(uniform_spline(felt, "felt.json"));
  for (const double loss : {0.05, 0.5}) {
    const BarrierImpact exact = barrier_impact(law_view(felt.contact), kMass, 2.0, loss);
    const auto errors = [&](double rate) {
      const SimulatedImpact found = simulate_impact(table, kMass, 2.0, rate, 0.5, loss);
      return std::array{std::abs(found.exit_speed_m_per_s / exact.exit_speed_m_per_s - 1),
                        std::abs(found.max_compression_m / exact.max_compression_m - 1),
                        std::abs(found.contact_duration_s / exact.contact_duration_s - 1),
                        std::abs(found.max_force_n / exact.max_force_n - 1)};
    };
    const auto coarse = errors(2e6), fine = errors(4e6);
    for (std::size_t i = 0; i < fine.size(); ++i) {
      Measured() << "loss " << loss << ": " << coarse[i] << " at 2 MHz, " << fine[i] << " at 4 MHz";
      EXPECT_LT(fine[i], 1e-5);
      EXPECT_LT(fine[i], 0.3 * coarse[i] + 2e-6);
    }
  }
}

TEST(LossForRestitution, IsTheLossThatLeavesIt) {
  for (const ContactLaw& law : laws())
    for (const double e : {0.05, 0.1, 0.3, 0.5, 0.9, 0.99, 0.9999})
      for (const double speed : {0.05, 1.0, 20.0}) {
        const double loss = loss_for_restitution(e, speed);
        const BarrierImpact found = barrier_impact(law_view(law), kMass, speed, loss);
        EXPECT_TRUE(relatively_within(found.exit_speed_m_per_s, e * speed, 1e-11)) << e;
      }
  EXPECT_EQ(loss_for_restitution(1, 2), 0);
}

// For small losses 1 - e = (2/3) loss v, the first term of the series.
TEST(LossForRestitution, BeginsWithThreeHalves) {
  EXPECT_TRUE(relatively_within(loss_for_restitution(1 - 1e-6, 2.0), 1.5e-6 / 2, 2e-6));
}

TEST(PowerSum, OfEqualExponentsIsOnePowerLaw) {
  const ContactLaw sum = PowerSum{{{{1e9, 2.5}}, {{3e9, 2.5}}}}, one(4e9, 2.5);
  for (const double y : {-1e-4, 0.0, 1e-6, 1e-4, 1e-3}) {
    EXPECT_TRUE(relatively_within(sum.force(y), one.force(y), 1e-15));
    EXPECT_TRUE(relatively_within(sum.energy(y), one.energy(y), 1e-15));
  }
  EXPECT_TRUE(relatively_within(max_compression(sum, kMass, 2), max_compression(one, kMass, 2), 1e-14));
  EXPECT_TRUE(relatively_within(contact_duration(sum, kMass, 2), contact_duration(one, kMass, 2), 1e-10));
}

// Compressions add up: k = (sum of k_i^(-1/a))^(-a). One layer is the power law itself.
TEST(PowerSeries, OfEqualExponentsIsOnePowerLaw) {
  for (const double exponent : {0.1, 1.0, 2.5, 10.0}) {
    const double k = std::pow(std::pow(1e9, -1 / exponent) + 2 * std::pow(3e9, -1 / exponent), -exponent);
    const ContactLaw series = PowerSeries{{{1e9, exponent}, {3e9, exponent}, {3e9, exponent}}}, one(k, exponent);
    const ContactLaw layer = PowerSeries{{{1e9, exponent}}}, alone(1e9, exponent);
    for (const double y : {-1e-4, 0.0, 1e-6, 1e-4, 1e-3}) {
      EXPECT_TRUE(relatively_within(series.force(y), one.force(y), 4e-15 * (1 + exponent)));
      EXPECT_TRUE(relatively_within(series.energy(y), one.energy(y), 4e-15 * (1 + exponent)));
      EXPECT_TRUE(relatively_within(layer.force(y), alone.force(y), 4e-15 * (1 + exponent)));
    }
  }
}

// With exponents 1 and 2 y = F/k1 + sqrt(F/k2), a quadratic equation for sqrt(F), and V = F^2/(2 k1) + F^1.5/(3
// sqrt(k2)). Over 24 decades of compression, and in 113 bits.
TEST(PowerSeries, OfASpringAndASquareIsTheRootOfAQuadraticEquation) {
  const double k1 = 3e5, k2 = 2e8;
  const ContactLaw series = PowerSeries{{{k1, 1}, {k2, 2}}};
  for (double y = 1e-18; y < 1e7; y *= 7) {
    const Quad b = 1 / sqrt(Quad(k2));
    const Quad root = 2 * Quad(y) / (b + sqrt(b * b + 4 * Quad(y) / k1));
    const Quad energy = root * root * root * (root / (2 * Quad(k1)) + b / 3);
    EXPECT_TRUE(relatively_within(series.force(y), Quad(root * root).convert_to<double>(), 1e-14)) << y;
    EXPECT_TRUE(relatively_within(series.energy(y), energy.convert_to<double>(), 2e-14)) << y;
    EXPECT_LT(Quad(abs(exact_energy(series, Quad(y)) / energy - 1)).convert_to<double>(), 1e-31) << y;
  }
}

// The force is monotone and finite over all layers a file may give, and no layer is compressed by more than the
// whole.
TEST(PowerSeries, IsSofterThanEachLayer) {
  for (const double k : {1e-3, 1e18})
    for (const double exponent : {0.1, 10.0}) {
      const PowerLaw one{k, exponent}, other{1e6, 1.5};
      const ContactLaw series = PowerSeries{{one, other}};
      double before = 0;
      for (double y = 1e-9; y < 1; y *= 1.5) {
        const double force = series.force(y);
        EXPECT_GE(force, before) << k << ' ' << exponent << ' ' << y;
        EXPECT_LE(force, std::min(one.force(y), other.force(y)) * (1 + 1e-13)) << k << ' ' << exponent << ' ' << y;
        before = force;
      }
      EXPECT_TRUE(std::isfinite(before) && before > 0);
    }
}

// Energy is the integral of the force: Simpson's rule, 4 pieces between breaks, is exact for the cubics of a curve.
TEST(ForceCurve, HasTheEnergyOfItsForce) {
  const double knots[] = {0, 2e-4, 5e-4, 1e-3, 1.4e-3};
  double energy = 0;
  for (int j = 0; j < 4; ++j) {
    const double width = knots[j + 1] - knots[j];
    energy +=
        width / 6 * (kCurve.force(knots[j]) + 4 * kCurve.force(knots[j] + width / 2) + kCurve.force(knots[j + 1]));
    EXPECT_TRUE(relatively_within(kCurve.energy(knots[j + 1]), energy, 1e-14));
  }
  EXPECT_EQ(kCurve.force(-1e-9), 0);
  EXPECT_EQ(kCurve.energy(0), 0);
}

TEST(ForceCurve, RisesWithTheSlopesGiven) {
  for (const auto& [y, slope] : {std::pair{2e-4, 3e4}, {5e-4, 0.0}, {1.0e-3, 2e5}, {2e-3, 2e5}}) {
    const double h = 1e-9;
    EXPECT_TRUE(within((kCurve.force(y + h) - kCurve.force(y - h)) / (2 * h), slope, 1)) << y;
  }
}

// In 113 bits what double says, to double. Its inverse is rounded once: the energy lies between those half a unit in
// the last place to either side.
TEST(ExactEnergy, AgreesWithDoubleAndIsInvertedWithOneRounding) {
  for (const ContactLaw& law : laws())
    for (const double y : {1e-5, 3e-4, 9e-4}) {
      const Quad energy = exact_energy(law, Quad(y));
      EXPECT_TRUE(relatively_within(energy.convert_to<double>(), law.energy(y), 1e-14));
      const double stored = energy.convert_to<double>();
      const double back = exact_max_compression(law, 2 * stored, 1);
      const Quad below = (Quad(back) + Quad(std::nextafter(back, 0))) / 2;
      const Quad above = (Quad(back) + Quad(std::nextafter(back, 1))) / 2;
      EXPECT_LE(exact_energy(law, below), Quad(stored)) << y;
      EXPECT_GE(exact_energy(law, above), Quad(stored)) << y;
    }
}

}  // namespace
}  // namespace contactspline::testing
