// SPDX-License-Identifier: MIT
// Friction at one point: its step against its definition and the contact step, blocks and belts against closed forms,
// its energy and its heat.
#include "contactspline/step/friction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "contactspline/data/friction_materials.hpp"
#include "contactspline/step/contact.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/precisions.hpp"
#include "support/random.hpp"

namespace contactspline::testing {
namespace {

// A sample of bristles drawn at random, in numbers of T.
template <typename T>
struct RandomSample {
  explicit RandomSample(Random& random, bool is_damped = true) {
    const double k = random.log_between(1, 1e9), yield = random.log_between(1e-8, 1e-3);
    const double resistance = is_damped && random.once_in(2) ? k * random.log_between(1e-3, 1e3) : 0;
    const double strain = random.once_in(4) ? random.sign() * yield : random.between(-yield, yield);
    law = {T(k), T(resistance), T(yield), std::clamp(T(strain), -T(yield), T(yield))};
    xi = T(random.log_between(1e-3, 1e6) / (k + resistance));
    const double reach = yield + double(xi) * double(limit());
    xf = T(random.sign() * reach * random.log_between(1e-6, 1e3));
  }

  // No force is larger [N].
  [[nodiscard]] T limit() const { return (law.stiffness + 2 * law.resistance) * law.yield; }

  // The definition of the force.
  [[nodiscard]] long double force(long double x) const {
    const long double k = law.stiffness, yield = law.yield, z = law.strain;
    const auto potential = [&](long double u) {
      return std::abs(u) <= yield ? k * u * u / 2 : k * (yield * std::abs(u) - yield * yield / 2);
    };
    const long double viscous = law.resistance * (std::clamp(z + x, -yield, yield) - z);
    return viscous + (x == 0 ? k * z : (potential(z + x) - potential(z)) / x);
  }

  detail::BristleLaw<T> law;
  T xi, xf;
};

CONTACTSPLINE_EACH_PRECISION(FrictionStepOf);

// By bisection on the definition. Each term of force and increment is no larger than limit and xf + xi limit, and
// passes through at most eight roundings of T; long double loses 2e-19 |x/limit| times the energy that cancels.
TYPED_TEST(FrictionStepOf, SolvesItsEquation) {
  using T = TypeParam;
  constexpr double kRounding = 8 * std::numeric_limits<T>::epsilon();
  Random random(1);
  int yielded = 0;
  for (int n = 0; n < 20000; ++n) {
    const RandomSample<T> sample(random);
    const auto step = sample.law.step(sample.xf, sample.xi);
    const double reach = std::abs(double(sample.xf)) + double(sample.xi) * double(sample.limit());
    long double low = -reach, high = reach;
    for (int i = 0; i < 120; ++i) {
      const long double x = (low + high) / 2;
      (x + sample.xi * sample.force(x) < sample.xf ? low : high) = x;
    }
    const double x = double(low), force = double(sample.force(low));
    ASSERT_TRUE(within(step.increment, x, kRounding * reach)) << n;
    ASSERT_TRUE(within(step.force, force, kRounding * sample.limit() + 1e-15 * sample.limit())) << n;
    ASSERT_TRUE(within(sample.law.at(step.increment).force, step.force,
                       kRounding * (sample.limit() + sample.law.at(step.increment).slope * reach)))
        << n;
    const auto end_of = sample.law.end_of(step.increment, step.force);
    const double moved = reach + double(sample.law.yield);
    const double end = std::clamp(sample.law.strain + x, -double(sample.law.yield), double(sample.law.yield));
    ASSERT_TRUE(within(step.strain, end, kRounding * moved)) << n;
    ASSERT_TRUE(within(step.slip, std::abs(sample.law.strain + x - end), kRounding * moved)) << n;
    ASSERT_TRUE(within(end_of.strain, end, kRounding * moved)) << n;
    ASSERT_TRUE(within(end_of.slip, step.slip, kRounding * moved)) << n;
    const T slope = sample.law.at(step.increment).slope, margin = T(1e-3) * std::abs(step.increment);
    const T below = sample.law.at(step.increment - margin).force,
            above = sample.law.at(step.increment + margin).force;
    if (sample.law.holds(step.increment - margin) == sample.law.holds(step.increment + margin)) {
      ASSERT_TRUE(within(slope * 2 * margin, above - below, kRounding * sample.limit() + 1e-5 * (above - below)))
          << n;
    }
    yielded += step.slip > 0;
  }
  EXPECT_GT(yielded, 5000);
  EXPECT_LT(yielded, 15000);
}

// Friction is a contact: y = z + L on two segments, beside the constant force -k L.
TYPED_TEST(FrictionStepOf, IsTheContactStepOnTwoSegments) {
  using T = TypeParam;
  constexpr double kRounding = 16 * std::numeric_limits<T>::epsilon();
  Random random(2);
  for (int n = 0; n < 20000; ++n) {
    const RandomSample<T> sample(random, false);
    const T k = sample.law.stiffness, yield = sample.law.yield, limit = k * yield;
    const std::array<Segment<T>, 3> table{
        {{0, 0, 0, 0}, {0, 0, 0, k / 2}, {2 * yield, 2 * limit * yield, 2 * limit, 0}}};
    const Approach<T> approach{sample.law.strain + yield, sample.xf + sample.xi * limit, sample.xi};
    const auto expected = contact_step(SegmentTable<T>(table), approach);
    const auto step = sample.law.step(sample.xf, sample.xi);
    ASSERT_TRUE(within(step.force, expected.force - limit, kRounding * limit)) << n;
    ASSERT_TRUE(within(step.strain, std::clamp(expected.compression - yield, -yield, yield),
                       kRounding * (yield + std::abs(sample.xf) + sample.xi * limit)))
        << n;
  }
}

// A stroke to the left is one to the right, to the bit.
TYPED_TEST(FrictionStepOf, IsTheSameInBothDirections) {
  using T = TypeParam;
  Random random(3);
  for (int n = 0; n < 20000; ++n) {
    const RandomSample<T> sample(random);
    auto mirrored = sample.law;
    mirrored.strain = -mirrored.strain;
    const auto step = sample.law.step(sample.xf, sample.xi), other = mirrored.step(-sample.xf, sample.xi);
    ASSERT_EQ(step.force, -other.force) << n;
    ASSERT_EQ(step.increment, -other.increment) << n;
    ASSERT_EQ(step.strain, -other.strain) << n;
    ASSERT_EQ(step.slip, other.slip) << n;
  }
}

// A block on a surface that moves by itself, held by a spring and pushed, by the midpoint rule in long double: only
// the friction rounds.
template <typename T>
struct Block {
  Block(double block_kg, double spring, const Bristles& bristles, double sample_rate_hz)
      : mass_kg(block_kg),
        spring_n_per_m(spring),
        time_step_s(1 / static_cast<long double>(sample_rate_hz)),
        friction(bristles, sample_rate_hz) {}

  FrictionStep<T> tick(const FrictionControls<T>& controls, long double surface_speed = 0, long double push_n = 0) {
    const long double dt = time_step_s, receptance = 1 / (2 * mass_kg / (dt * dt) + spring_n_per_m / 2);
    const long double free = receptance * (2 * mass_kg * velocity / dt - spring_n_per_m * displacement + push_n);
    const long double carried = surface_speed * dt;
    const auto step = friction.tick(controls, T(carried - free), T(receptance));
    const long double moved = free + receptance * step.force;
    work_j += step.force * carried + push_n * moved;
    heat_j += friction.heat();
    displacement += moved;
    velocity = 2 * moved / dt - velocity;
    return step;
  }

  [[nodiscard]] long double energy() const {
    return mass_kg * velocity * velocity / 2 + spring_n_per_m * displacement * displacement / 2 + friction.energy();
  }

  long double mass_kg, spring_n_per_m, time_step_s;
  Friction<T> friction;
  long double displacement = 0, velocity = 0;
  long double work_j = 0, heat_j = 0;
};

// A block slides m v^2/(2 mu N) far at any rate, because the energy is exact. It stops at the end of a sample, or
// what it had left would swing in the bristles.
TEST(Friction, StopsASlidingBlockWhereItsEnergyIsSpent) {
  for (const double rate : {8000.0, 48000.0, 192000.0}) {
    Block<double> block(0.2, 0, {.stiffness_per_m = 1e11}, rate);
    block.velocity = 1.5;
    const FrictionControls<double> pressed{2, 0.4};
    for (int n = 0; n < rate; ++n) block.tick(pressed);
    EXPECT_TRUE(relatively_within(double(block.displacement), 0.2 * 1.5 * 1.5 / (2 * 0.4 * 2), 1e-9)) << rate;
  }
}

// Beyond mu N a push accelerates a block by what is left of it.
TEST(Friction, LetsABlockSlideUnderALargePush) {
  Block<double> block(0.2, 0, {.stiffness_per_m = 1e6}, 44100);
  const FrictionControls<double> pressed{2, 0.4};
  while (block.tick(pressed, 0, 1.0).slip == 0) {
  }
  const double before = double(block.velocity);
  for (int n = 0; n < 44100; ++n) block.tick(pressed, 0, 1.0);
  EXPECT_TRUE(relatively_within(double(block.velocity) - before, (1.0 - 0.4 * 2) / 0.2, 1e-9));
}

// Below mu N/2 a sudden push makes it swing on its bristles, w the root of k/m; the midpoint rule has
// tan(w' dt/2) = w dt/2.
TEST(Friction, SwingsABlockOnItsBristles) {
  constexpr double kRate = 44100, kMass = 0.2, kPush = 0.39, kStiffness = 2 * 1e6;
  Block<double> block(kMass, 0, {.stiffness_per_m = 1e6}, kRate);
  const double w = 2 * kRate * std::atan(std::sqrt(kStiffness / kMass) / (2 * kRate));
  for (int n = 1; n < 10000; ++n) {
    ASSERT_EQ(block.tick({2, 0.4}, 0, kPush).slip, 0) << n;
    const double expected = kPush / kStiffness * (1 - std::cos(n * w / kRate));
    ASSERT_TRUE(within(double(block.displacement), expected, 1e-9 * kPush / kStiffness)) << n;
  }
}

// A load that swings below mu N neither moves a block for good nor heats it: at rest it is F/k from where it was.
TEST(Friction, LetsNothingCreep) {
  constexpr double kRate = 44100, kStiffness = 2 * 1e6;
  Block<double> block(0.02, 0, {.stiffness_per_m = 1e6, .damping_s_per_m = 200}, kRate);
  const auto rest_under = [&](double push) {
    for (int n = 0; n < 4000; ++n) block.tick({2, 0.4}, 0, push);
    return double(block.displacement);
  };
  for (int n = 0; n < 400000; ++n) ASSERT_EQ(block.tick({2, 0.4}, 0, 0.3 + 0.3 * std::sin(0.02 * n)).slip, 0) << n;
  EXPECT_TRUE(relatively_within(rest_under(0.75), 0.75 / kStiffness, 1e-9));
  EXPECT_TRUE(relatively_within(rest_under(-0.75), -0.75 / kStiffness, 1e-9));
  EXPECT_TRUE(within(rest_under(0), 0, 1e-9 * 0.75 / kStiffness));
}

// A block on a belt, with a coefficient that is larger while it sticks: the limit cycle of textbooks
// (E. Rabinowicz, Friction and Wear of Materials, 1965), for surfaces without bristles. It slips for
// (pi + 2 phi)/w, tan phi = v s/(w D), and sticks for 2 D/(s v), D the drop of the force; bristles of 1e6 times the
// spring's stiffness that follow within 6 us, and samples of 1.3 us, change it by some 1e-5 s.
TEST(Friction, FindsTheLimitCycleOfABlockOnABelt) {
  constexpr double kRate = 768000, kMass = 1, kSpring = 1000, kSpeed = 0.02, kNormal = 10, kStatic = 0.4,
                   kKinetic = 0.3;
  Block<double> block(kMass, kSpring, {.stiffness_per_m = 1e10, .damping_s_per_m = 6.3e4}, kRate);
  const double drop = (kStatic - kKinetic) * kNormal, w = std::sqrt(kSpring / kMass);
  const double phi = std::atan(kSpeed * kSpring / (w * drop)), amplitude = std::hypot(drop / kSpring, kSpeed / w);
  const double slip_s = (std::numbers::pi + 2 * phi) / w, stick_s = 2 * drop / (kSpring * kSpeed);
  bool is_slipping = false;
  int slips = 0, slipping = 0, sticking = 0;
  double highest = 0, lowest = 1;
  while (slips < 4) {
    const bool was_slipping = is_slipping;
    is_slipping = block.tick({kNormal, is_slipping ? kKinetic : kStatic}, kSpeed).slip > 0;
    slips += is_slipping && !was_slipping;
    if (slips != 3) continue;  // one period in the limit cycle
    (is_slipping ? slipping : sticking) += 1;
    highest = std::max(highest, double(block.displacement));
    lowest = std::min(lowest, double(block.displacement));
  }
  Measured() << "slip " << slipping / kRate / slip_s - 1 << ", stick " << sticking / kRate / stick_s - 1;
  EXPECT_TRUE(relatively_within(slipping / kRate, slip_s, 2e-4));
  EXPECT_TRUE(relatively_within(sticking / kRate, stick_s, 2e-4));
  EXPECT_TRUE(within(highest, kKinetic * kNormal / kSpring + amplitude, 1e-4 * amplitude));
  EXPECT_TRUE(within(lowest, kKinetic * kNormal / kSpring - amplitude, 1e-4 * amplitude));
}

CONTACTSPLINE_EACH_PRECISION(FrictionAtRandom);

// Blocks of all masses and springs on bristles of all stiffnesses, at 8 to 768 kHz, while normal force, coefficient,
// push and speed of the surface jump. In each sample the bristles' own numbers round: force and increment as in
// FrictionStepOf, the strain at its end to eps L. So the energy is off by at most 8 eps (F (|xf| + xi F) + F L), F
// the largest force.
TYPED_TEST(FrictionAtRandom, BalancesItsEnergy) {
  using T = TypeParam;
  constexpr long double kEpsilon = std::numeric_limits<T>::epsilon(), kOwnRounding = 1e-18L;
  long double worst = 0, worst_of_forces = 0;
  int slipped = 0, held = 0;
  Random random(4);
  for (int run = 0; run < 200; ++run) {
    const double rate = random.log_between(8000, 768000);
    const Bristles bristles{random.log_between(1e3, 1e9), random.once_in(2) ? random.log_between(1e-3, 1e4) : 0};
    Block<T> block(random.log_between(1e-5, 10), random.once_in(2) ? random.log_between(1, 1e6) : 0, bristles, rate);
    long double allowed = 0, of_forces = 0, off = 0;
    FrictionControls<T> controls;
    double speed = 0, push = 0;
    for (int n = 0; n < 2000; ++n) {
      if (random.once_in(8)) controls.normal_force_n = T(random.once_in(4) ? 0 : random.decades(-4, 2));
      if (random.once_in(8)) controls.coefficient = T(random.once_in(8) ? 0 : random.between(0, 2));
      if (random.once_in(100)) speed = random.once_in(4) ? 0 : random.between(-1, 1);
      if (random.once_in(100)) push = random.once_in(4) ? 0 : random.between(-50, 50);
      const long double kinetic = block.energy() - block.friction.energy();
      const long double heat = block.heat_j, work = block.work_j, stored = block.friction.energy();
      const auto step = block.tick(controls, speed, push);
      const auto law = block.friction.law();
      const long double largest = static_cast<long double>(law.stiffness + 2 * law.resistance) * law.yield;
      const long double dt = block.time_step_s, xi = 1 / (2 * block.mass_kg / (dt * dt) + block.spring_n_per_m / 2);
      const long double force = std::abs(static_cast<long double>(step.force));
      const long double xf = std::abs(step.increment + xi * step.force);
      allowed += 8 * kEpsilon * (largest * (xf + xi * largest) + largest * law.yield + stored) +
                 kOwnRounding * (block.energy() + std::abs(block.work_j - work));
      of_forces += kEpsilon * force * (xf + xi * force);
      off += block.energy() - block.friction.energy() - kinetic + (block.friction.energy() - stored) +
             (block.heat_j - heat) - (block.work_j - work);
      ASSERT_GE(block.friction.heat(), -double(8 * kEpsilon * stored)) << run << " " << n;
      ASSERT_TRUE(within(double(off), 0, double(allowed))) << run << " " << n;
      slipped += step.slip > 0;
      held += step.slip == 0 && step.force != 0;
    }
    worst = std::max(worst, std::abs(off) / allowed);
    worst_of_forces = std::max(worst_of_forces, std::abs(off) / of_forces);
  }
  Measured() << "energy off by " << double(worst) << " of its bound, " << double(worst_of_forces)
             << " eps times the sum of |f| (|xf| + xi |f|); " << slipped << " samples slip, " << held << " hold";
  EXPECT_GT(slipped, 50000);
  EXPECT_GT(held, 50000);
}

// What cannot be used as a control holds the last value or the end of the range.
TEST(Friction, HoldsItsControlsInTheirRanges) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInfinity = std::numeric_limits<double>::infinity();
  Friction<double> friction(kRosin.bristles, 44100);
  friction.press({2, 0.5});
  friction.press({kNan, kNan});
  EXPECT_EQ(friction.normal_force(), 2);
  EXPECT_EQ(friction.law().yield, 0.5 / 1e6);
  friction.press({kInfinity, -1});
  EXPECT_EQ(friction.normal_force(), 1e3);
  EXPECT_EQ(friction.law().yield, 0);
  EXPECT_EQ(friction.tick({-1, 1}, 1e-3, 1e-5).force, 0);
}

// A jump of the normal force adds no force, and no energy.
TEST(Friction, LosesEnergyWhereItIsPressedOtherwise) {
  Friction<double> friction(kRosin.bristles, 44100);
  const double force = 0.4, xi = 1e-9;
  friction.press({1, 1});
  friction.advance(friction.law().step(force / 1e6, xi));
  const double strain = friction.strain(), stored = friction.energy();
  friction.press({4, 1});
  EXPECT_TRUE(relatively_within(friction.law().force_at_rest(), strain * 1e6, 1e-15));
  EXPECT_TRUE(relatively_within(friction.energy(), stored / 4, 1e-15));
  friction.press({2, 1});
  EXPECT_TRUE(relatively_within(friction.law().force_at_rest(), strain * 1e6 / 2, 1e-15));
  EXPECT_TRUE(relatively_within(friction.energy(), stored / 8, 1e-15));
  EXPECT_TRUE(relatively_within(friction.heat(), stored / 8, 1e-15));
  friction.press({2, 1e-2});
  EXPECT_EQ(friction.strain(), 1e-8);
}

// At constant speed and power the heat has a closed form.
TEST(FrictionTemperature, FollowsConstantPower) {
  constexpr double kRate = 44100, kNormal = 0.8, kWidth = 0.01, kSpeed = 0.3, kPower = 0.05;
  FrictionTemperature<double> surfaces(kRosin.heat, kWidth, kRate);
  const auto& heat = kRosin.heat;
  const double flow =
      std::sqrt(heat.renewal_w_per_m_k2 * kWidth * kNormal * kSpeed) + heat.conduction_w_per_n_k * kNormal;  // [W/K]
  for (int n = 1; n < 1000; ++n) {
    surfaces.advance(kNormal, -kSpeed / kRate, kPower / kRate);
    const double expected = kPower / flow * -std::expm1(-n / kRate * flow / (heat.capacity_j_per_n_k * kNormal));
    ASSERT_TRUE(relatively_within(surfaces.temperature(), expected, 1e-12)) << n;
  }
}

TEST(FrictionTemperature, WeakensTheFriction) {
  FrictionTemperature<double> surfaces({1.05, 0.12, 25, 1e-6}, 0.01, 44100);
  EXPECT_EQ(surfaces.coefficient(), 1.05);
  surfaces.advance(1, 0, 25e-6);  // nothing cools
  EXPECT_TRUE(relatively_within(surfaces.temperature(), 25, 1e-14));
  EXPECT_TRUE(relatively_within(surfaces.coefficient(), (1.05 + 0.12) / 2, 1e-14));
  surfaces.advance(4, 0, 0);  // what joins is cold
  EXPECT_TRUE(relatively_within(surfaces.temperature(), 25.0 / 4, 1e-14));
  surfaces.advance(2, 0, 0);
  EXPECT_TRUE(relatively_within(surfaces.temperature(), 25.0 / 4, 1e-14));
  surfaces.advance(0, 1, 0);
  surfaces.advance(1, 0, 0);
  EXPECT_EQ(surfaces.temperature(), 0);
}

// Rosin that slides at a steady speed is as hot as its own friction makes it.
TEST(FrictionTemperature, SettlesWhereSlipIsSteady) {
  constexpr double kRate = 96000, kNormal = 1, kWidth = 0.01, kSpeed = 0.2;
  Friction<double> friction(kRosin.bristles, kRate);
  FrictionTemperature<double> surfaces(kRosin.heat, kWidth, kRate);
  FrictionStep<double> step{};
  for (int n = 0; n < 96000; ++n) {
    step = friction.tick({kNormal, surfaces.coefficient()}, kSpeed / kRate, 1e-12);
    surfaces.advance(kNormal, step.increment, friction.slip_heat());
  }
  const auto& heat = kRosin.heat;
  const auto excess = [&](double temperature) {  // power beyond what flows away
    const double q = std::pow(temperature / heat.softening_k, 2);
    const double mu = (heat.cold_coefficient + heat.hot_coefficient * q) / (1 + q);
    return mu * kNormal * kSpeed -
           (std::sqrt(heat.renewal_w_per_m_k2 * kWidth * kNormal * kSpeed) + heat.conduction_w_per_n_k * kNormal) *
               temperature;
  };
  double low = 0, high = 1e3;
  for (int i = 0; i < 100; ++i) (excess((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
  EXPECT_TRUE(relatively_within(surfaces.temperature(), low, 1e-6));
  Measured() << "rosin at 1 N and 0.2 m/s: " << low << " K, coefficient " << surfaces.coefficient();
}

}  // namespace
}  // namespace contactspline::testing
