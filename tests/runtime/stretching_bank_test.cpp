// SPDX-License-Identifier: MIT
// Bodies that stretch: their energy, their motion against closed forms and other paths, one contact on them.
#include "contactspline/modal/stretching_bank.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "stretching_balance.hpp"
#include "string_at_stop.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/random.hpp"
#include "support/relative_error.hpp"

namespace contactspline::testing {
namespace {

// A body with random modes and forms, and a motion of it. highest: the highest frequency, of half the sample rate.
struct RandomBody {
  explicit RandomBody(std::uint64_t seed, double decay_per_s = 0, double highest = 0.5) : random(seed) {
    rate = random.log_between(8000, 192000);
    const std::size_t count = 1 + random.below(24), forms_count = 1 + random.below(8);
    for (std::size_t i = 0; i < count; ++i)
      modes.push_back({random.log_between(2 * std::numbers::pi * 20, highest * std::numbers::pi * rate),
                       random.between(0, decay_per_s), random.log_between(1e-4, 1)});
    for (std::size_t k = 0; k < forms_count; ++k) forms.push_back(random_form());
    scale_motion(random.log_between(0.01, 20));
  }

  StretchForm random_form() {
    StretchForm form{random.log_between(0.1, 10), {}, {}};
    const double least = random.below(2) == 0 ? 0 : -1;
    for (std::size_t i = 0; i < modes.size(); ++i) form.squares_per_m2.push_back(random.between(least, 1));
    for (std::size_t i = 0; i < modes.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (random.below(3) == 0) form.products.push_back({i, j, random.between(-1, 1)});
    return form;
  }

  // A motion whose stretching stores about `ratio` times the energy of the modes.
  void scale_motion(double ratio) {
    for (const Mode& mode : modes) {
      displacements.push_back(random.between(-1, 1) / mode.angular_frequency_rad_per_s / std::sqrt(mode.mass_kg));
      velocities.push_back(random.between(-1, 1) / std::sqrt(mode.mass_kg));
    }
    double linear = 0, stretching = 0;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const auto& [w, s, m] = modes[i];
      linear += m / 2 * ((w * w + s * s) * displacements[i] * displacements[i] + velocities[i] * velocities[i]);
    }
    for (const StretchForm& form : forms) stretching += form.stiffness_j / 4 * mean_square(form);
    for (StretchForm& form : forms) form.stiffness_j *= ratio * linear / stretching;
  }

  // Of how much the form is stretched, at the amplitudes of the modes if their signs were random.
  [[nodiscard]] double mean_square(const StretchForm& form) const {
    double sum = 0, squares = 0;
    const auto amplitude = [&](std::size_t i) {
      return std::hypot(displacements[i], velocities[i] / modes[i].angular_frequency_rad_per_s);
    };
    for (std::size_t i = 0; i < modes.size(); ++i) sum += form.squares_per_m2[i] * std::pow(amplitude(i), 2);
    for (const auto& [i, j, factor] : form.products) squares += std::pow(2 * factor * amplitude(i) * amplitude(j), 2);
    return sum * sum + squares;
  }

  template <typename T>
  [[nodiscard]] StretchingBank<T> bank() const {
    StretchingBank<T> bank(modes, forms, rate);
    for (std::size_t i = 0; i < modes.size(); ++i)
      bank.set_motion(i, static_cast<T>(displacements[i]), static_cast<T>(velocities[i]));
    return bank;
  }

  Random random;
  double rate;
  std::vector<Mode> modes;
  std::vector<StretchForm> forms;
  std::vector<double> displacements, velocities;
};

template <typename T>
void advance(StretchingBank<T>& bank, T damping = 0) {
  bank.predict(damping);
  bank.commit();
}

template <typename T, typename Damping>
Balance balance_of_body(const RandomBody& body, int samples, Damping damping) {
  StretchingBank<T> bank = body.bank<T>();
  return balance_of(bank, std::span<const StretchForm>(body.forms), samples, damping);
}

// 1e-12 is what is asked for. Of 1,000 bodies few have forms whose terms cancel so far that rounding may add more.
TEST(StretchingBank, KeepsItsEnergy) {
  double worst = 0, stretching = 0;
  int cancelling = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const Balance balance = balance_of_body<double>(RandomBody(seed), 500, [](int) { return 0.0; });
    const bool cancels = balance.bound > 1e-12;
    ASSERT_TRUE(within(balance.error, 0, cancels ? balance.bound : 1e-12)) << "body " << seed;
    cancelling += cancels;
    if (!cancels) worst = std::max(worst, balance.error);
    stretching = std::max(stretching, balance.stretching);
  }
  Measured() << "largest error of the energy " << worst << ", largest part of it in stretching " << stretching << ", "
             << cancelling << " bodies whose terms cancel";
  EXPECT_GT(stretching, 0.9);
  EXPECT_LT(cancelling, 50);
}

// Losses of any size and a damper that changes in each sample: what they take is counted, and nothing rises.
TEST(StretchingBank, LosesWhatIsDissipated) {
  double worst = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const RandomBody body(seed, 1e4);
    Random random(seed);
    const Balance balance =
        balance_of_body<double>(body, 500, [&](int n) { return n % 3 == 0 ? random.log_between(1e-4, 10) : 0.0; });
    ASSERT_TRUE(within(balance.error, 0, 1e-12)) << "body " << seed;
    ASSERT_LE(balance.risen, 1e-13) << "body " << seed;
    worst = std::max(worst, balance.error);
  }
  Measured() << "largest error of the energy " << worst;
}

template <typename T>
class EitherPrecision : public ::testing::Test {};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(EitherPrecision, Precisions);

// Modes up to nine tenths of half the rate.
TYPED_TEST(EitherPrecision, ErrsByRoundingAlone) {
  double worst = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Balance balance =
        balance_of_body<TypeParam>(RandomBody(seed, 0, 0.9), 1000, [](int) { return TypeParam(0); });
    EXPECT_TRUE(within(balance.error, 0, balance.bound)) << "body " << seed;
    worst = std::max(worst, balance.error / balance.bound);
  }
  Measured() << "largest error of the energy over the bound " << worst;
}

// Duffing's mode q'' + w^2 q + b q^3 = 0 from rest at the amplitude a has the period 4 K(k)/sqrt(w^2 + b a^2), k^2 =
// b a^2/2/(w^2 + b a^2), and K(k) = pi/2 over the arithmetic-geometric mean of 1 and sqrt(1 - k^2).
double period_of_duffing(double w, double b_a_square) {
  const double square = w * w + b_a_square;
  double a = 1, g = std::sqrt(1 - b_a_square / 2 / square);
  for (int i = 0; i < 10; ++i) {
    const double mean = (a + g) / 2;
    g = std::sqrt(a * g);
    a = mean;
  }
  return 2 * std::numbers::pi / a / std::sqrt(square);
}

// Mean of so many periods. At its zeros the motion is straight up to the third order.
double period_of(StretchingBank<double>& bank, double rate, int periods) {
  double first = 0, before = bank.displacement(std::size_t{0});
  int zeros = 0;
  for (int n = 0;; ++n) {
    advance(bank);
    const double q = bank.displacement(std::size_t{0});
    if (before > 0 && q <= 0) {
      const double at = (n + before / (before - q)) / rate;
      if (zeros == 0) first = at;
      if (zeros++ == periods) return (at - first) / periods;
    }
    before = q;
  }
}

TEST(StretchingBank, HasDuffingsPeriod) {
  const double w = 2 * std::numbers::pi * 110, mass_kg = 0.002, amplitude_m = 1e-3, square_per_m2 = 1e4;
  // Half of the energy is in stretching: c (A a^2)^2/4 = m w^2 a^2/2.
  const double stiffness_j = 2 * mass_kg * std::pow(w / square_per_m2 / amplitude_m, 2);
  const auto error_at = [&](double rate) {
    StretchingBank<double> bank(std::vector{Mode{w, 0, mass_kg}},
                                std::vector{StretchForm{stiffness_j, {square_per_m2}}}, rate);
    bank.set_motion(0, amplitude_m, 0);
    EXPECT_TRUE(within(bank.stretching_energy() / bank.energy(), 0.5, 1e-3));
    return period_of(bank, rate, 100) / period_of_duffing(w, 2 * w * w) - 1;
  };
  const double at_96 = error_at(96000), at_192 = error_at(192000);
  Measured() << "error of the period at 192 kHz " << at_192 << ", order " << std::log2(at_96 / at_192);
  EXPECT_TRUE(within(at_192, 0, 1e-5));
  EXPECT_TRUE(within(std::log2(at_96 / at_192), 2, 0.1));
}

// A mode that fades loses its energy slowly, so each period is Duffing's at the amplitude of that time: the one at
// which E = m w^2 a^2/2 + c (A a^2)^2/4. What the middle of a period stands for differs from the mean over it by 1/24
// of the square of what a period loses, 2 decay/110 Hz; what the sample adds is below (w dt)^2.
TEST(StretchingBank, FallsInPitchAsItFades) {
  const double w = 2 * std::numbers::pi * 110, decay_per_s = 2, mass_kg = 0.002, amplitude_m = 1e-3, rate = 192000;
  const double square_per_m2 = 1e4, stiffness_j = 0.5 * mass_kg * std::pow(w / square_per_m2 / amplitude_m, 2);
  StretchingBank<double> bank(std::vector{Mode{w, decay_per_s, mass_kg}},
                              std::vector{StretchForm{stiffness_j, {square_per_m2}}}, rate);
  bank.set_motion(0, amplitude_m, 0);
  std::vector<double> at, energy;  // of the zeros
  double before = amplitude_m;
  for (int n = 0; n < static_cast<int>(2 * rate); ++n) {
    advance(bank);
    const double q = bank.displacement(std::size_t{0});
    if (before > 0 && q <= 0) at.push_back(n + before / (before - q)), energy.push_back(bank.energy());
    before = q;
  }
  const double c_a_square = stiffness_j * square_per_m2 * square_per_m2, k = mass_kg * w * w;
  double worst = 0;
  for (std::size_t i = 1; i < at.size(); ++i) {
    const double middle = std::sqrt(energy[i - 1] * energy[i]);
    const double square = (std::sqrt(k * k + 4 * c_a_square * middle) - k) / c_a_square;  // of the amplitude
    const double period = period_of_duffing(w, c_a_square * square / mass_kg);
    worst = std::max(worst, std::abs((at[i] - at[i - 1]) / rate / period - 1));
  }
  const double fall = 1200 * std::log2((at.back() - at[at.size() - 2]) / (at[1] - at[0]));
  Measured() << "falls by " << fall << " cents, largest error of a period " << worst;
  EXPECT_GT(fall, 200);
  EXPECT_TRUE(within(worst, 0, std::pow(2 * decay_per_s / 110, 2) / 24 + std::pow(w / rate, 2)));
}

// Six modes and three forms, as the equation of motion says: q'' + 2 s q' + (w^2 + s^2) q = -sum c (q' A q) A q/m.
struct ExactBody {
  std::vector<Mode> modes;
  std::vector<StretchForm> forms;
  std::vector<double> q, v;

  // The fourth-order rule of Runge and Kutta.
  void advance(double dt) {
    const auto q0 = q, v0 = v;
    auto q_sum = q, v_sum = v;
    constexpr double kWeights[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}, kNext[] = {0.5, 0.5, 1, 0};
    for (int stage = 0; stage < 4; ++stage) {
      const auto a = acceleration(), u = v;
      for (std::size_t i = 0; i < q.size(); ++i) {
        q_sum[i] += kWeights[stage] * dt * u[i];
        v_sum[i] += kWeights[stage] * dt * a[i];
        q[i] = q0[i] + kNext[stage] * dt * u[i];
        v[i] = v0[i] + kNext[stage] * dt * a[i];
      }
    }
    q = q_sum;
    v = v_sum;
  }

  [[nodiscard]] std::vector<double> acceleration() const {
    std::vector<double> a(q.size());
    for (const StretchForm& form : forms) {
      std::vector<double> gradient(q.size());
      for (std::size_t i = 0; i < q.size(); ++i) gradient[i] = form.squares_per_m2[i] * q[i];
      for (const auto& [i, j, factor] : form.products) gradient[i] += factor * q[j], gradient[j] += factor * q[i];
      double stretch = 0;
      for (std::size_t i = 0; i < q.size(); ++i) stretch += gradient[i] * q[i];
      for (std::size_t i = 0; i < q.size(); ++i) a[i] -= form.stiffness_j * stretch * gradient[i] / modes[i].mass_kg;
    }
    for (std::size_t i = 0; i < q.size(); ++i) {
      const double w = modes[i].angular_frequency_rad_per_s, s = modes[i].decay_per_s;
      a[i] -= 2 * s * v[i] + (w * w + s * s) * q[i];
    }
    return a;
  }
};

// Displacements, and velocities by the frequency of the first mode: root of the sum of squares over 20 ms, relative.
double error_of_motion(ExactBody exact, double rate) {
  StretchingBank<double> bank(exact.modes, exact.forms, rate);
  std::vector<ModalBank<double>::VelocityShapes> at;
  for (std::size_t i = 0; i < exact.q.size(); ++i) bank.set_motion(i, exact.q[i], exact.v[i]);
  for (std::size_t i = 0; i < exact.q.size(); ++i) {
    ModeShapes<double> shape(exact.q.size());
    shape[i] = 1;
    at.push_back(bank.bank().velocity_shapes(shape));
    EXPECT_TRUE(within(bank.bank().velocity(at[i]), exact.v[i], 1e-12 * std::abs(exact.v[0])));
  }
  const int fine = static_cast<int>(std::lround(64 * 44100 / rate));
  double error = 0, sum = 0;
  for (int n = 0; n < static_cast<int>(0.02 * rate); ++n) {
    for (int step = 0; step < fine; ++step) exact.advance(1 / rate / fine);
    advance(bank);
    for (std::size_t i = 0; i < exact.q.size(); ++i) {
      const double by_s = 1 / exact.modes[0].angular_frequency_rad_per_s;
      error += std::pow(bank.displacement(i) - exact.q[i], 2) +
               std::pow((bank.bank().velocity(at[i]) - exact.v[i]) * by_s, 2);
      sum += std::pow(exact.q[i], 2) + std::pow(exact.v[i] * by_s, 2);
    }
  }
  return std::sqrt(error / sum);
}

TEST(StretchingBank, MovesAsTheEquationOfMotion) {
  ExactBody body;
  Random random(1);
  for (std::size_t i = 0; i < 6; ++i) {
    body.modes.push_back({2 * std::numbers::pi * random.between(100, 800), random.between(0, 30), 0.01});
    body.q.push_back(random.between(-1e-3, 1e-3));
    body.v.push_back(random.between(-1, 1));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    StretchForm form{random.between(1e5, 2e5), {}, {{0, 1 + k, random.between(-300, 300)}, {2, 4, 200}}};
    for (std::size_t i = 0; i < 6; ++i) form.squares_per_m2.push_back(random.between(0, 300));
    body.forms.push_back(form);
  }
  const double coarse = error_of_motion(body, 88200), fine = error_of_motion(body, 176400);
  Measured() << "error at 176.4 kHz " << fine << ", order " << std::log2(coarse / fine);
  EXPECT_TRUE(within(std::log2(coarse / fine), 2, 0.1));
}

// Forms without stiffness add 0 to each change, and nothing else is computed differently.
TYPED_TEST(EitherPrecision, MovesFreelyAsTheModalBankWithoutStiffness) {
  RandomBody body(1, 10);
  for (StretchForm& form : body.forms) form.stiffness_j = 0;
  auto bank = body.bank<TypeParam>();
  ModalBank<TypeParam> linear(body.modes, body.rate);
  for (std::size_t i = 0; i < linear.size(); ++i)
    linear.set_motion(i, static_cast<TypeParam>(body.displacements[i]), static_cast<TypeParam>(body.velocities[i]));
  for (int n = 0; n < 1000; ++n) {
    advance(bank);
    linear.advance(0);
    for (std::size_t i = 0; i < linear.size(); ++i) ASSERT_EQ(bank.displacement(i), linear.displacement(i)) << n;
  }
}

// A force at a sample is half of it in the sample of ModalBank that ends there and half in the one that begins.
// 1e-13: a few roundings in each of 1,000 samples, of random sign.
TEST(StretchingBank, AnswersAForceAsTheModalBankAnswersItsHalves) {
  RandomBody body(2, 10);
  ModeShapes<double> at(body.modes.size());
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = body.random.between(-1, 1);
  StretchingBank<double> bank(body.modes, {}, body.rate);
  ModalBank<double> linear(body.modes, body.rate);
  std::vector<double> found, expected;
  double before = 0;
  for (int n = 0; n < 1000; ++n) {
    const double force = n < 100 ? body.random.between(-1, 1) : 0;
    bank.predict();
    bank.push(at, (force + std::exchange(before, force)) / 2);
    bank.commit();
    linear.predict();
    linear.push(at, force);
    linear.commit();
    found.push_back(bank.displacement(at));
    expected.push_back(linear.displacement(at));
  }
  EXPECT_TRUE(sequences_within<double>(found, expected, 1e-13));
}

TEST(StretchingBank, KeepsItsEnergyAtAStop) {
  StringAtStop<double> string(44100);
  const double first = string.energy();
  double worst = 0;
  for (int n = 0; n < 44100; ++n) {
    string.tick();
    worst = std::max(worst, std::abs(string.energy() / first - 1));
  }
  Measured() << "largest error of the energy over a second " << worst << ", largest force " << string.max_force();
  EXPECT_TRUE(within(worst, 0, 1e-12));
  EXPECT_GT(string.max_force(), 1);
}

// Errors over 20 ms beside 64 times 44.1 kHz, at 1, 2 and 4 times that rate.
std::vector<double> errors_at_stop(double exponent) {
  const auto sound_at = [exponent](int factor) {
    StringAtStop<double> string(44100 * factor, exponent);
    std::vector<double> sound;
    for (int n = 0; n < 882 * factor; ++n) {
      string.tick();
      if (n % factor == factor - 1) sound.push_back(string.sound());
    }
    return sound;
  };
  const auto exact = sound_at(64);
  std::vector<double> errors;
  for (const int factor : {1, 2, 4}) {
    errors.push_back(relative_error(sound_at(factor), exact));
    Measured() << "exponent " << exponent << ", error at " << factor << " times 44.1 kHz: " << errors.back();
  }
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], errors[i - 1] / 3);
  return errors;
}

// Soft stops are met by many samples, hard ones by few.
TEST(StretchingBank, ConvergesAtAStop) {
  EXPECT_LT(errors_at_stop(2.5)[0], 0.01);
  EXPECT_LT(errors_at_stop(1.5)[1], 0.01);
}

}  // namespace
}  // namespace contactspline::testing
