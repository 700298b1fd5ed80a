// SPDX-License-Identifier: MIT
// Poles, passivity and receptance of the modal bank.
#include "contactspline/modal/modal.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "contactspline/modal/bend.hpp"
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

// One push of force f moves the place by receptance f within the sample: nothing else acts. The sum over modes
// cancels; by Cauchy and Schwarz its terms add up to at most the mean of the two places' own receptances.
TEST(ModalBank, MovesByItsReceptance) {
  const auto modes = audible_modes(c4());
  const auto strike = shapes<double>(modes, &ResonatorMode::strike_shape);
  const auto pickup = shapes<double>(modes, &ResonatorMode::pickup_shape);
  ModalBank<double> bank(bare(modes), 44100);
  bank.predict();
  bank.push(strike, 7.0);
  const double expected = 7.0 * bank.receptance(pickup, strike);
  const double terms = 7.0 * std::sqrt(bank.receptance(pickup, pickup) * bank.receptance(strike, strike));
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
  [[nodiscard]] long double receptance(long double rate) const {
    return 1 / (2 * mass * rate * rate + resistance * rate + stiffness / 2);
  }
};

// Random modes at random rates, also so damped that they hardly oscillate. The receptance is a product of ten factors
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
    ASSERT_TRUE(relatively_within(detail::mode_constants(mode, rate).receptance,
                                  static_cast<double>(rule.receptance(rate)), 2e-15))
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

// The modes of C4 without losses after a blow, and at another tension.
struct RingingString {
  StiffString string = c4().string;
  std::vector<ResonatorMode> modes;
  ModeShapes<double> strike;
  ModalBank<double> bank;

  explicit RingingString(double rate, Losses losses = {0, 0})
      : modes([&] {
          StruckString struck = c4();
          struck.string.losses = string.losses = losses;
          return audible_modes(struck);
        }()),
        strike(shapes<double>(modes, &ResonatorMode::strike_shape)),
        bank(bare(modes), rate) {
    for (int n = 0; n < 100; ++n) {
      bank.predict();
      bank.push(strike, n < 50 ? 1 : 0);
      bank.commit();
    }
  }

  [[nodiscard]] std::vector<Mode> at(double cents) const {
    std::vector<Mode> other;
    for (const ResonatorMode& row : modes) other.push_back(retuned(string, row, cents));
    return other;
  }
  [[nodiscard]] double displacement(std::size_t mode) const {
    ModeShapes<double> only(modes.size());
    only[mode] = 1;
    return bank.displacement(only);
  }
};

// The first mode above a frequency, up to the largest index there is.
TEST(StiffString, FindsTheFirstModeAboveAFrequency) {
  constexpr int kLast = 1 << 30;
  for (const int from : {1, 2, 3, 1000, (1 << 29) + 7, kLast - 1, kLast}) {
    const auto first_above = [&](double w) {
      return detail::first_index_above(from, w, [](int i) { return double(i); });
    };
    for (const int n : {1, 2, 3, 4, 5, 100, 65536, (1 << 29) - 1, 1 << 29, (1 << 29) + 5, kLast - 2, kLast - 1})
      if (n >= from) {
        EXPECT_EQ(first_above(n), n + 1) << "from " << from;
      }
    EXPECT_EQ(first_above(kLast), kLast + 1) << "from " << from;
    EXPECT_EQ(first_above(1e12), kLast + 1) << "from " << from;
  }
}

// A tension that would store 1 J at 0 cents, bent up by an octave, to four times as much: 1 W takes 3 s for it. What
// is not used is saved up for 10 ms. A fall, or a rise that does no work, takes no time.
TEST(Bend, DoesTheWorkOfOneWatt) {
  detail::Bend bend;
  const auto tension = [&] { return std::exp2(bend.cents() / 600); };
  for (int n = 1; n <= 301; ++n) {
    const bool is_there = bend.cents() == 1200;
    EXPECT_EQ(bend.follow(1200, 1, 0.01 * n), !is_there) << n;
    EXPECT_TRUE(within(tension() - 1, std::min(3.0, 0.01 * n), 1e-12)) << n;
  }
  EXPECT_EQ(bend.cents(), 1200);
  EXPECT_FALSE(bend.follow(1200, 1, 4));
  EXPECT_TRUE(bend.follow(0, 1, 4));
  EXPECT_EQ(bend.cents(), 0);
  EXPECT_TRUE(bend.follow(1200, 1, 4));
  EXPECT_TRUE(within(tension() - 1, 0.01, 1e-12));
  EXPECT_FALSE(bend.follow(1200, 1, 4));
  EXPECT_FALSE(bend.follow(1200, std::numeric_limits<double>::quiet_NaN(), 5));
  EXPECT_TRUE(bend.follow(1200, 0, 5));
  EXPECT_EQ(bend.cents(), 1200);
}

// Against the formula of the string at another tension, with its losses. The difference w'^2 - w^2 carries the
// rounding of w^2, and the highest modes lie 100 times as high as what tension alone makes.
TEST(StiffString, RetunesItsModesByTension) {
  StruckString struck = c4();
  const auto modes = audible_modes(struck);
  for (const double cents : {-4800.0, -2400.0, -1200.0, -37.0, 0.0, 200.0, 1200.0, 2400.0, 4800.0}) {
    StiffString other = struck.string;
    other.tension_n *= std::exp2(cents / 600);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const Mode expected = undamped_mode(other, static_cast<int>(i) + 1).with(other.losses).value();
      const Mode found = retuned(struck.string, modes[i], cents);
      EXPECT_TRUE(relatively_within(found.angular_frequency_rad_per_s, expected.angular_frequency_rad_per_s, 1e-13));
      EXPECT_EQ(found.decay_per_s, modes[i].mode.decay_per_s);
      EXPECT_EQ(found.mass_kg, modes[i].mode.mass_kg);
    }
  }
  const Mode slow = retuned(StiffString{1, 1, 1, 0, {5, 0}}, StringMode{{3, 5, 0.5}, std::numbers::pi}, -1200);
  EXPECT_EQ(slow.angular_frequency_rad_per_s, 0);
}

// Each mode goes on from its displacement q and velocity v as e^(-s t) (q cos w t + (v + s q)/w sin w t) at its new
// w; q and v before are those of the closed form at the old w. Rounding grows with the phase, w t 2^-52 < 1e-10 in
// 0.1 s.
TEST(ModalBank, RingsOnAtItsNewPitchAsTheClosedForm) {
  for (const double cents : {130.0, 2400.0, -2400.0, 4800.0, -4800.0}) {
    RingingString ringing(96000, {0.5, 1e-4});
    const auto after = ringing.at(cents);
    std::vector<double> q, c;
    for (std::size_t i = 0; i < ringing.modes.size(); ++i) q.push_back(ringing.displacement(i));
    ModalBank<double> untouched = ringing.bank;
    untouched.advance(0);
    std::vector<double> v;
    for (std::size_t i = 0; i < q.size(); ++i) {
      ModeShapes<double> only(q.size());
      only[i] = 1;
      const auto& [w, s, mass] = ringing.modes[i].mode;
      const double next = untouched.displacement(only) * std::exp(s / 96000);
      v.push_back((next - q[i] * std::cos(w / 96000)) * w / std::sin(w / 96000) - s * q[i]);
    }
    ringing.bank.retune(after);
    for (int n = 0; n < 9600; ++n) ringing.bank.advance(0);
    for (std::size_t i = 0; i < q.size(); ++i) {
      const auto& [w, s, mass] = after[i];
      if (w >= std::numbers::pi * 96000) {
        EXPECT_EQ(ringing.displacement(i), 0) << i;
        continue;
      }
      const double expected =
          std::exp(-s * 0.1) * (q[i] * std::cos(w * 0.1) + (v[i] + s * q[i]) / w * std::sin(w * 0.1));
      EXPECT_TRUE(within(ringing.displacement(i), expected, 1e-9 * (std::abs(q[i]) + std::abs(v[i] / w))))
          << i << " at " << cents;
    }
  }
}

// The work of a change of tension at rest in time is (T' - T)/2 times the integral of the slope squared, for sines
// the sum of (T' - T) beta^2 L/4 q^2. Rounding is relative to the energies before and after. At 96 kHz every mode
// goes on sounding.
TEST(ModalBank, GainsTheWorkOfTheTensionWhenRetuned) {
  RingingString ringing(96000);
  for (const double cents : {200.0, -150.0, -700.0}) {
    const double gained = ringing.string.tension_n * (std::exp2(cents / 600) - 1);
    double work = 0;
    for (std::size_t i = 0; i < ringing.modes.size(); ++i)
      work += gained * std::pow(ringing.modes[i].wavenumber_per_m, 2) * ringing.string.length_m / 4 *
              std::pow(ringing.displacement(i), 2);
    ringing.bank.retune(ringing.at(0));
    const double before = ringing.bank.energy();
    ringing.bank.retune(ringing.at(cents));
    EXPECT_TRUE(within(ringing.bank.energy() - before, work, 1e-12 * (before + std::abs(work)))) << cents;
    ringing.bank.retune(ringing.at(0));
    for (int n = 0; n < 37; ++n) ringing.bank.advance(0);
  }
}

// A slow bend keeps the ratio of energy to frequency of each mode: an adiabatic invariant. The frequency rises by r =
// ln(w'/w)/0.5 s, which shakes the ratio by r/(2 w) at both ends, 1e-4 of the lowest mode.
TEST(ModalBank, KeepsTheAdiabaticInvariantInABend) {
  RingingString ringing(44100);
  const auto invariants = [&](const std::vector<Mode>& modes) {
    std::vector<double> values;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      ModalBank<double> only(std::vector{modes[i]}, 44100);
      const double q = ringing.displacement(i);
      ModeShapes<double> shape(modes.size());
      shape[i] = 1;
      only.set_motion(0, q, ringing.bank.velocity(shape));
      values.push_back(only.energy() / modes[i].angular_frequency_rad_per_s);
    }
    return values;
  };
  const auto before = invariants(ringing.at(0));
  for (int n = 0; n < 22050; ++n) {
    ringing.bank.retune(ringing.at(200.0 * n / 22050));
    ringing.bank.advance(0);
  }
  ringing.bank.retune(ringing.at(200));
  const auto after = invariants(ringing.at(200));
  for (std::size_t i = 0; i < 30; ++i) EXPECT_TRUE(relatively_within(after[i], before[i], 2e-4)) << i;
}

// Both precisions: no NaN, and silence above half the sample rate.
TEST(ModalBank, SilencesWhatIsRetunedAboveHalfTheSampleRate) {
  for (const double rate : {8000.0, 44100.0}) {
    RingingString ringing(rate);
    ringing.bank.retune(ringing.at(1200));
    for (std::size_t i = 0; i < ringing.modes.size(); ++i)
      if (ringing.at(1200)[i].angular_frequency_rad_per_s >= std::numbers::pi * rate) {
        EXPECT_EQ(ringing.displacement(i), 0) << i;
      }
    for (int n = 0; n < 100; ++n) ringing.bank.advance(0);
    ringing.bank.retune(ringing.at(-1200));
    for (int n = 0; n < 100; ++n) ringing.bank.advance(0);
    for (std::size_t i = 0; i < ringing.modes.size(); ++i) EXPECT_LT(std::abs(ringing.displacement(i)), 1e-2) << i;
  }
}

// A bend of two semitones in 10 ms, in steps of 16 samples and sample by sample; a step has the pitch of its middle.
// The steps shake each partial by less than 60 dB below the largest displacement.
TEST(ModalBank, BendsWithoutAClickInSteps) {
  const auto play = [](int step) {
    RingingString ringing(44100, {0.5, 1e-4});
    const auto pickup = shapes<double>(ringing.modes, &ResonatorMode::pickup_shape);
    std::vector<double> out;
    for (int n = 0; n < 2000; ++n) {
      const double part = std::clamp((n + (step - 1) / 2.0 - 200) / 441, 0.0, 1.0);
      if (n % step == 0) ringing.bank.retune(ringing.at(200 * part * part * (3 - 2 * part)));
      ringing.bank.advance(0);
      out.push_back(ringing.bank.displacement(pickup));
    }
    return out;
  };
  const auto smooth = play(1), stepped = play(16);
  EXPECT_TRUE(sequences_within<double>(stepped, smooth, 1e-3));
}

}  // namespace
}  // namespace contactspline::testing
