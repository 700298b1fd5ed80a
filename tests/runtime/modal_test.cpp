// SPDX-License-Identifier: MIT
// Poles, passivity and admittance of the modal bank.
#include "contactspline/modal.hpp"

#include <complex>
#include <numbers>
#include <random>

#include "strings.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRates[] = {22050, 44100, 96000, 192000};

// Frequency and decay of the recursion from its constants: the product of its poles is 1 - loss, and |1 - z|^2 is
// the stiffness, (1 - r)^2 + 4 r sin^2(w dt/2).
Mode mode_of(const detail::ModeConstants& constants, double rate) {
  const long double product = 1 - static_cast<long double>(constants.loss);
  const long double r = std::sqrt(product);
  const long double missing = static_cast<long double>(constants.loss) / (1 + r);
  const long double sine = std::sqrt((constants.stiffness - missing * missing) / (4 * r));
  return {static_cast<double>(2 * std::asin(sine) * rate),
          static_cast<double>(-std::log1p(-static_cast<long double>(constants.loss)) / 2 * rate), 0};
}

// The constants carry a few roundings of 2^-53; asin loses digits only near half the sample rate, where its slope is
// 1/cos(w dt/2): at most 1e4 for the modes here. 1e-9 is what is asked for.
TEST(ModalBank, HasTheFrequencyAndDecayOfEveryMode) {
  for (const auto& struck : {c2(), c4(), c7()})
    for (const double rate : kRates)
      for (const auto& [mode, wavenumber, strike, pickup] : audible_modes(struck)) {
        if (mode.angular_frequency_rad_per_s >= std::numbers::pi * rate) continue;
        const Mode found = mode_of(detail::mode_constants(mode, rate), rate);
        EXPECT_TRUE(relatively_within(found.angular_frequency_rad_per_s, mode.angular_frequency_rad_per_s, 1e-9));
        EXPECT_TRUE(relatively_within(found.decay_per_s, mode.decay_per_s, 1e-9));
      }
}

// After a push the displacement is C Im(z^n e^(j a)); two samples fix C and a, and a second later it must still
// agree. The phase is right to w t 2^-52 ~ 1e-11, rounding adds sqrt(44100) 2^-52 of the amplitude.
TEST(ModalBank, RingsForASecondAsTheClosedForm) {
  const Mode mode{2 * std::numbers::pi * 440.1, 1.5, 0.002};
  ModalBank<double> bank(std::vector{mode}, 44100);
  ModeShapes<double> at(1);
  at[0] = 1;
  std::vector<double> q;
  for (int n = 0; n < 44100; ++n) {
    bank.predict();
    if (n == 0) bank.push(at, 3.0);
    bank.commit();
    q.push_back(bank.displacement(at));
  }
  const auto z = std::exp(std::complex<double>(-mode.decay_per_s, mode.angular_frequency_rad_per_s) / 44100.0);
  // q_n = Re(A z^n), A from q_0 and q_1
  const double real = q[0];
  const double imaginary = (real * z.real() - q[1]) / z.imag();
  std::vector<double> expected;
  for (int n = 0; n < 44100; ++n) expected.push_back((std::complex<double>(real, imaginary) * std::pow(z, n)).real());
  EXPECT_TRUE(sequences_within<double>(q, expected, 1e-9));
}

// One push of force f moves the place by admittance f within the sample: nothing else acts. The sum over modes
// cancels; by Cauchy and Schwarz its terms add up to at most the mean of the two places' own admittances.
TEST(ModalBank, MovesByItsAdmittance) {
  const auto modes = audible_modes(c4());
  const auto strike = shapes<double>(modes, &ResonatorMode::strike_shape);
  const auto pickup = shapes<double>(modes, &ResonatorMode::pickup_shape);
  ModalBank<double> bank(bare(modes), 44100);
  bank.predict();
  bank.push(strike, 7.0);
  const double expected = 7.0 * bank.admittance(pickup, strike);
  const double terms = 7.0 * std::sqrt(bank.admittance(pickup, pickup) * bank.admittance(strike, strike));
  EXPECT_TRUE(within(bank.increment(pickup), expected, 1e-14 * terms));
  bank.commit();
  EXPECT_TRUE(within(bank.displacement(pickup), expected, 1e-14 * terms));
}

// Stored energy + dissipated = work of a random force, to rounding. Per sample the balance is a sum over modes of
// quantities of the size of the energy, so 1e-12 of the peak leaves room for 2e6 samples of random rounding.
TEST(ModalBank, BalancesItsEnergyUnderARandomForce) {
  for (const double rate : kRates) {
    const auto modes = audible_modes(c4());
    const auto strike = shapes<double>(modes, &ResonatorMode::strike_shape);
    ModalBank<double> bank(bare(modes), rate);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> force(-10, 10);
    double work = 0, dissipated = 0, peak = 0, worst = 0, before = 0;
    for (int n = 0; n < 10 * static_cast<int>(rate); ++n) {
      const double f = n % 1000 == 0 ? force(random) : 0;
      bank.predict();
      bank.push(strike, f);
      bank.commit();
      const double after = bank.displacement(strike);
      work += f * (after - before);
      before = after;
      dissipated += bank.dissipated();
      peak = std::max(peak, bank.energy());
      worst = std::max(worst, std::abs(bank.energy() + dissipated - work));
    }
    EXPECT_TRUE(within(worst, 0, 1e-12 * peak)) << rate << " Hz";
  }
}

/// The midpoint rule m v' + R v + K q = F of a mode, by its definition: the poles exp(p dt) and the static
/// compliance.
struct MidpointRule {
  long double mass, resistance, stiffness;

  MidpointRule(const Mode& mode, double rate) {
    using Complex = std::complex<long double>;
    const Complex pole(-mode.decay_per_s, mode.angular_frequency_rad_per_s);
    const Complex z = std::exp(pole / static_cast<long double>(rate));
    const Complex warped = 2.0L * static_cast<long double>(rate) * (z - 1.0L) / (z + 1.0L);
    stiffness = mode.mass_kg * std::norm(pole);
    mass = stiffness / std::norm(warped);
    resistance = -2 * mass * warped.real();
  }

  // Change of displacement from rest per newton: the force works against inertia, resistance and half the spring.
  [[nodiscard]] long double admittance(long double rate) const {
    return 1 / (2 * mass * rate * rate + resistance * rate + stiffness / 2);
  }
};

// Random modes at random rates, also so damped that they hardly oscillate. The admittance is a product of ten factors
// with one rounding each, and the sine counts twice: at most 18 times 2^-53, 2e-15. In the reference z - 1 loses up
// to 2^-64/(1e-4 pi), 2e-16.
TEST(ModalBank, IsPassiveForAnyDampingAndRate) {
  std::mt19937_64 random(1);
  const auto between = [&](double min, double max) {
    return min * std::pow(max / min, static_cast<double>(random() >> 11) * 0x1p-53);
  };
  for (int i = 0; i < 100'000; ++i) {
    const double rate = between(8000, 768000);
    const Mode mode{between(1e-4, 0.9999) * std::numbers::pi * rate, between(1e-3, 1e5), between(1e-6, 1e3)};
    const MidpointRule rule(mode, rate);
    ASSERT_GE(rule.resistance, 0);
    ASSERT_GT(rule.mass, 0);
    ASSERT_TRUE(relatively_within(detail::mode_constants(mode, rate).admittance,
                                  static_cast<double>(rule.admittance(rate)), 2e-15))
        << mode.angular_frequency_rad_per_s << " " << mode.decay_per_s << " " << rate;
  }
}

// Under a steady force a mode comes to rest at F/(m |p|^2), as the continuous one does, however near it is to half
// the rate.
TEST(ModalBank, HasTheStaticComplianceOfEveryMode) {
  for (const double rate : kRates)
    for (const double fraction : {0.01, 0.5, 0.9, 0.99}) {
      const Mode mode{fraction * std::numbers::pi * rate, 0.02 * rate, 0.002};
      ModalBank<double> bank(std::vector{mode}, rate);
      ModeShapes<double> at(1);
      at[0] = 1;
      for (int n = 0; n < 2000; ++n) {  // exp(-0.02 2000) is below 2^-53
        bank.predict();
        bank.push(at, 3.0);
        bank.commit();
      }
      const double w = mode.angular_frequency_rad_per_s, s = mode.decay_per_s;
      EXPECT_TRUE(relatively_within(bank.displacement(at), 3.0 / (mode.mass_kg * (w * w + s * s)), 1e-13));
    }
}

// A force that is constant over a sample leaves the amplitude of an impulse, F dt/(m w), times sin(theta)/theta. The
// contact's force is an average over the sample, which takes away that factor again: the shapes that are heard give
// both back.
TEST(ModalBank, AnswersAHeldForceAsTheContinuousMode) {
  for (const double fraction : {1e-3, 0.1, 0.5, 0.9, 0.99}) {
    const Mode mode{fraction * std::numbers::pi * 44100, 0, 0.002};
    ModalBank<double> bank(std::vector{mode}, 44100);
    ModeShapes<double> at(1);
    at[0] = 1;
    bank.predict();
    bank.push(at, 3.0);
    bank.commit();
    const double w = mode.angular_frequency_rad_per_s, theta = w / 44100 / 2;
    const double impulse_m = 3.0 / 44100 / (mode.mass_kg * w), held = std::sin(theta) / theta;
    const auto amplitude = [&](const ModeShapes<double>& shapes) {
      return std::hypot(bank.displacement(shapes), bank.velocity(shapes) / w);
    };
    EXPECT_TRUE(relatively_within(amplitude(at), impulse_m * held, 1e-12)) << fraction;
    EXPECT_TRUE(relatively_within(amplitude(bank.sound_pickup(at)), impulse_m / held, 1e-12)) << fraction;
  }
}

// A free mass, p = 0, is the limit: it moves by dt^2/(2 m) F in the sample of the force, then by dt^2/m F per sample.
TEST(ModalBank, HoldsAFreeMass) {
  for (const Mode mode : {Mode{0, 0, 0.003}, Mode{1e-3, 0, 0.003}}) {
    ModalBank<double> bank(std::vector{mode}, 44100);
    ModeShapes<double> at(1);
    at[0] = 1;
    const double unit_m = 5.0 / (44100.0 * 44100.0 * mode.mass_kg);
    for (int n = 0; n < 100; ++n) {
      bank.predict();
      bank.push(at, n == 0 ? 5.0 : 0.0);
      bank.commit();
      EXPECT_TRUE(relatively_within(bank.displacement(at), (n + 0.5) * unit_m, 1e-11)) << n;
      EXPECT_TRUE(relatively_within(bank.velocity(at), 44100 * unit_m, 1e-11)) << n;
      EXPECT_TRUE(relatively_within(bank.energy(), 0.5 * mode.mass_kg * std::pow(44100 * unit_m, 2), 1e-11)) << n;
    }
  }
}

TEST(ModalBank, DamperNeverAddsEnergy) {
  const auto modes = audible_modes(c4());
  const auto strike = shapes<double>(modes, &ResonatorMode::strike_shape);
  for (const double damping : {1e-5, 1e-2, 1.0, 100.0}) {
    ModalBank<double> bank(bare(modes), 44100);
    bank.predict(damping);
    bank.push(strike, 1.0);
    bank.commit();
    double energy = bank.energy();
    for (int n = 0; n < 1000; ++n) {
      bank.predict(damping);
      bank.commit();
      EXPECT_LE(bank.energy(), energy * (1 + 1e-14));
      energy = bank.energy();
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
