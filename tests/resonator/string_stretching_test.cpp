// SPDX-License-Identifier: MIT
// Strings that stretch across and along themselves: their forms against the integral of the squared strain, their
// motion against that of the integral, their longitudinal modes against closed forms and against the one-way drive.
#include "generator/resonator/string_stretching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "../runtime/stretching_balance.hpp"
#include "contactspline/modal/longitudinal.hpp"
#include "contactspline/modal/stretching_bank.hpp"
#include "form_energy.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/random.hpp"
#include "support/relative_error.hpp"

namespace contactspline::testing {
namespace {

constexpr double kPi = std::numbers::pi;

// The string of E1 of a piano: steel core of 1 mm, wound with copper. Its longitudinal modes are multiples of 352 Hz.
StretchingString bass_string(std::size_t longitudinal, const Losses& losses = {30, 0}) {
  return {{1.9, 0.17, 700, 0.02, {0, 0}}, 1.6e5, longitudinal, losses};
}

std::vector<int> first_numbers(std::size_t count) {
  std::vector<int> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 1);
  return numbers;
}

std::vector<Mode> modes_of(const StretchingString& string, std::size_t transverse, double decay_per_s = 0) {
  std::vector<Mode> modes;
  for (std::size_t n = 1; n <= transverse; ++n)
    modes.push_back(*undamped_mode(string.string, static_cast<int>(n)).with({decay_per_s, 0}));
  const std::vector<Mode> along = longitudinal_modes(string);
  modes.insert(modes.end(), along.begin(), along.end());
  return modes;
}

// Calls visit(slope, strain along the string, wavenumber of mode n) at the points of a midpoint rule, which is exact
// for cosines up to twice as many.
struct Strain {
  double slope, along;
};
std::vector<Strain> strains(const StretchingString& string, const std::vector<double>& q, std::size_t transverse,
                            std::size_t points) {
  std::vector<Strain> all;
  for (std::size_t p = 0; p < points; ++p) {
    const double x = (static_cast<double>(p) + 0.5) / static_cast<double>(points);  // parts of the length
    Strain& here = all.emplace_back(Strain{0, 0});
    for (std::size_t i = 0; i < q.size(); ++i) {
      const double number = static_cast<double>(i < transverse ? i + 1 : i - transverse + 1);
      (i < transverse ? here.slope : here.along) +=
          number * kPi / string.string.length_m * std::cos(number * kPi * x) * q[i];
    }
  }
  return all;
}

// E S/2 times the integral of (u' + y'^2/2)^2 [J].
double energy_of_strain(const StretchingString& string, const std::vector<double>& q, std::size_t transverse,
                        std::size_t points) {
  double sum = 0;
  for (const auto& [slope, along] : strains(string, q, transverse, points))
    sum += std::pow(along + slope * slope / 2, 2);
  return string.axial_stiffness_n / 2 * sum * string.string.length_m / static_cast<double>(points);
}

// With twice as many longitudinal modes as transverse ones no strain is left out.
TEST(StringStretching, StoresTheIntegralOfTheSquaredStrain) {
  constexpr std::size_t kTransverse = 6, kLongitudinal = 12;
  const StretchingString string = bass_string(kLongitudinal);
  const auto forms = stretch_forms(string, first_numbers(kTransverse));
  ASSERT_EQ(forms.size(), kLongitudinal + 1);
  Random random(1);
  for (int motion = 0; motion < 20; ++motion) {
    std::vector<double> q;
    for (std::size_t i = 0; i < kTransverse + kLongitudinal; ++i)
      q.push_back(random.between(-1, 1) * (i < kTransverse ? 0.01 : 1e-4));
    const double exact = energy_of_strain(string, q, kTransverse, 64);
    EXPECT_TRUE(relatively_within(energy_of(forms, q), exact, 1e-12)) << motion;
    // And the tension at the far end is E S times the strain there.
    double tension = 0, slope = 0, along = 0;
    for (std::size_t i = 0; i < q.size(); ++i) {
      const std::size_t number = i < kTransverse ? i + 1 : i - kTransverse + 1;
      (i < kTransverse ? slope : along) +=
          (number % 2 == 0 ? 1 : -1) * static_cast<double>(number) * kPi / 1.9 * q[i];
    }
    for (std::size_t k = 0; k < forms.size(); ++k) {
      StretchForm alone = forms[k];
      alone.stiffness_j = 4;
      double stretch = alone.linear.factor_per_m * q[alone.linear.mode];
      for (std::size_t i = 0; i < q.size(); ++i) stretch += alone.squares_per_m2[i] * q[i] * q[i];
      for (const auto& [i, j, factor] : alone.products) stretch += 2 * factor * q[i] * q[j];
      tension += end_tension_n(string, k) * stretch;
    }
    EXPECT_TRUE(relatively_within(tension, string.axial_stiffness_n * (along + slope * slope / 2), 1e-11)) << motion;
  }
}

// The modes q under the forces of energy_of_strain, by Runge and Kutta's method of order 4 in steps of dt: an
// independent path to the motion.
class StrainedString {
 public:
  StrainedString(const StretchingString& string, std::vector<Mode> modes, std::size_t transverse,
                 std::vector<double> q)
      : string_(string), modes_(std::move(modes)), transverse_(transverse), q_(std::move(q)), v_(q_.size()) {}

  void step(double dt) {
    const auto [q1, v1] = slopes(q_, v_);
    const auto [q2, v2] = slopes(moved(q_, q1, dt / 2), moved(v_, v1, dt / 2));
    const auto [q3, v3] = slopes(moved(q_, q2, dt / 2), moved(v_, v2, dt / 2));
    const auto [q4, v4] = slopes(moved(q_, q3, dt), moved(v_, v3, dt));
    for (std::size_t i = 0; i < q_.size(); ++i) {
      q_[i] += dt / 6 * (q1[i] + 2 * q2[i] + 2 * q3[i] + q4[i]);
      v_[i] += dt / 6 * (v1[i] + 2 * v2[i] + 2 * v3[i] + v4[i]);
    }
  }
  [[nodiscard]] const std::vector<double>& q() const { return q_; }

 private:
  using Numbers = std::vector<double>;
  static Numbers moved(Numbers a, const Numbers& by, double dt) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += dt * by[i];
    return a;
  }
  // Of displacements and velocities. A longitudinal mode's own spring is part of the strain.
  [[nodiscard]] std::pair<Numbers, Numbers> slopes(const Numbers& q, const Numbers& v) const {
    constexpr std::size_t kPoints = 32;
    const std::vector<Strain> all = strains(string_, q, transverse_, kPoints);
    Numbers acceleration;
    for (std::size_t i = 0; i < q.size(); ++i) {
      const auto& [w, s, mass] = modes_[i];
      const bool is_transverse = i < transverse_;
      const double number = static_cast<double>(is_transverse ? i + 1 : i - transverse_ + 1);
      double force = is_transverse ? -mass * (w * w + s * s) * q[i] : 0;
      for (std::size_t p = 0; p < kPoints; ++p) {
        const double x = (static_cast<double>(p) + 0.5) / kPoints;
        const double shape = number * kPi / string_.string.length_m * std::cos(number * kPi * x);
        const double tension = string_.axial_stiffness_n * (all[p].along + all[p].slope * all[p].slope / 2);
        force -= tension * shape * (is_transverse ? all[p].slope : 1) * string_.string.length_m / kPoints;
      }
      acceleration.push_back(force / mass - 2 * s * v[i]);
    }
    return {v, acceleration};
  }

  StretchingString string_;
  std::vector<Mode> modes_;
  std::size_t transverse_;
  Numbers q_, v_;
};

// Three transverse modes, all six longitudinal ones that they drive, a tension that rises by half.
TEST(StringStretching, MovesAsTheStrainPulls) {
  constexpr std::size_t kTransverse = 3, kLongitudinal = 6;
  constexpr double kRate = 44100, kTime_s = 0.02;
  const StretchingString string = bass_string(kLongitudinal);
  const std::vector<Mode> modes = modes_of(string, kTransverse, 2);
  std::vector<double> start(modes.size());
  for (std::size_t i = 0; i < kTransverse; ++i) start[i] = 0.06 / static_cast<double>(i + 1);
  const auto sounds = [&](double rate) {
    StretchingBank<double> bank(modes, stretch_forms(string, first_numbers(kTransverse)), rate);
    for (std::size_t i = 0; i < start.size(); ++i) bank.set_motion(i, start[i], 0);
    std::array<std::vector<double>, 2> sounds;
    const auto stride = static_cast<int>(rate / kRate);
    for (int n = 1; n <= static_cast<int>(kTime_s * rate); ++n) {
      bank.predict();
      bank.commit();
      if (n % stride != 0) continue;
      sounds[0].push_back(bank.displacement(std::size_t{1}));
      sounds[1].push_back(bank.displacement(kTransverse + 1));
    }
    return sounds;
  };
  StrainedString exact(string, modes, kTransverse, start);
  std::array<std::vector<double>, 2> expected;
  for (int n = 1; n <= static_cast<int>(kTime_s * kRate); ++n) {
    for (int k = 0; k < 32; ++k) exact.step(1 / kRate / 32);
    expected[0].push_back(exact.q()[1]);
    expected[1].push_back(exact.q()[kTransverse + 1]);
  }
  const auto coarse = sounds(4 * kRate), fine = sounds(8 * kRate);
  for (std::size_t s = 0; s < 2; ++s) {
    const double error = relative_error(fine[s], expected[s]),
                 order = std::log2(relative_error(coarse[s], expected[s]) / error);
    Measured() << (s == 0 ? "transverse" : "longitudinal") << " motion at 352.8 kHz within " << error << ", order "
               << order;
    EXPECT_TRUE(within(error, 0, 1e-5));
    EXPECT_TRUE(within(order, 2, 0.1));
  }
}

// A bank that pushes one longitudinal mode alone has the poles and the compliance of the mode: its motion under a
// force that acts for one sample, and the rest under one that stays. rise: an exact mode moves by |1 - z|^2/(m |p|^2)
// in the first sample of an impulse.
TEST(StringStretching, KeepsPolesAndComplianceOfLongitudinalModes) {
  constexpr std::size_t kTransverse = 2, kLongitudinal = 8;
  const StretchingString string = bass_string(kLongitudinal, {60, 0.5});
  const std::vector<Mode> modes = modes_of(string, kTransverse);
  double largest_error = 0;
  for (const double rate : {12000.0, 44100.0, 192000.0})
    for (std::size_t m = kTransverse; m < modes.size(); ++m) {
      StretchingBank<double> bank(modes, stretch_forms(string, first_numbers(kTransverse)), rate);
      ModeShapes<double> at(modes.size());
      at[m] = 1;
      const auto& [w, s, mass] = modes[m];
      const double r = std::exp(-s / rate),
                   gain = (1 - 2 * r * std::cos(w / rate) + r * r) / (mass * (w * w + s * s));
      double worst = 0, largest = 0;
      for (int n = 1; n <= 400; ++n) {
        bank.predict();
        if (n == 1) bank.push(at, 1);
        bank.commit();
        const double expected = gain * std::pow(r, n - 1) * std::sin(w * n / rate) / std::sin(w / rate);
        worst = std::max(worst, std::abs(bank.displacement(m) - expected));
        largest = std::max(largest, std::abs(expected));
      }
      EXPECT_TRUE(within(worst / largest, 0, 1e-11)) << rate << " Hz, mode " << m;
      largest_error = std::max(largest_error, worst / largest);
      for (int n = 0; n < static_cast<int>(30 / s * rate); ++n) {
        bank.predict();
        bank.push(at, 1e-3);
        bank.commit();
      }
      EXPECT_TRUE(relatively_within(bank.displacement(m), 1e-3 / stiffness_of(modes[m]), 1e-10)) << rate << " Hz";
    }
  Measured() << "response to an impulse within " << largest_error;
}

// What moves little drives its longitudinal modes and feels nothing of them: the tension at the far end is that of
// LongitudinalModes, whose own error is (W dt)^2/6 of the response, here 6e-4, and which lacks the tension at rest,
// 0.4 % of E S.
TEST(StringStretching, DrivesLittleMotionOneWay) {
  constexpr std::size_t kTransverse = 6, kLongitudinal = 16;
  constexpr double kRate = 384000;
  const StretchingString string = bass_string(kLongitudinal);
  const std::vector<Mode> modes = modes_of(string, kTransverse);
  const auto forms = stretch_forms(string, first_numbers(kTransverse));
  StretchingBank<double> bank(modes, forms, kRate);
  struct Row {
    Mode mode;
    double wavenumber_per_m;
  };
  std::vector<Row> rows;
  for (std::size_t n = 0; n < kTransverse; ++n)
    rows.push_back({modes[n], static_cast<double>(n + 1) * kPi / string.string.length_m});
  LongitudinalModes<double> along(string.string, {string.axial_stiffness_n, string.longitudinal_losses},
                                  std::span<const Row>(rows), kRate);
  ASSERT_EQ(along.size(), kLongitudinal);
  std::vector<double> found, expected;
  std::vector<double> q(16);
  const ModeShapes<double> transverse(modes.size());
  for (std::size_t i = 0; i < kTransverse; ++i) bank.set_motion(i, 0, 1e-3 / static_cast<double>(i + 1));
  for (int n = 0; n < 20000; ++n) {
    bank.predict();
    bank.commit();
    ModeShapes<double> slow(16);
    for (std::size_t i = 0; i < kTransverse; ++i) slow[i] = bank.displacement(i);
    expected.push_back(along.tick(std::span<const double>(slow.data(), 16)));
    double tension = 0;
    for (std::size_t k = 0; k < forms.size(); ++k) {
      double stretch = forms[k].linear.factor_per_m * bank.displacement(forms[k].linear.mode);
      for (std::size_t i = 0; i < modes.size(); ++i)
        stretch += forms[k].squares_per_m2[i] * std::pow(bank.displacement(i), 2);
      for (const auto& [i, j, factor] : forms[k].products)
        stretch += 2 * factor * bank.displacement(i) * bank.displacement(j);
      tension += end_tension_n(string, k) * stretch;
    }
    found.push_back(tension);
  }
  const double difference = relative_error(found, expected);
  Measured() << "tension at the end within " << difference << " of the one-way drive";
  EXPECT_TRUE(within(difference, 0, 0.01));
}

// A random string of up to 24 transverse and 16 longitudinal modes, plucked so far that its tension rises by up to
// ten times; some longitudinal modes lie above half the rate.
template <typename T>
Balance balance_of_string(std::uint64_t seed, double loss, double farthest) {
  Random random(seed);
  const double length = random.log_between(0.2, 2), core = random.log_between(2e-4, 1.5e-3);
  const double mass = 7800 * 0.785 * core * core * length * random.log_between(1, 8);
  const StretchingString string{
      {length, mass, 4 * length * mass * std::pow(random.log_between(30, 400), 2), 0, {0, 0}},
      2e11 * 0.785 * core * core,
      random.below(17),
      {loss * random.log_between(10, 1000), 0}};
  const double rate = random.log_between(8000, 192000);
  const std::size_t transverse = 1 + random.below(24);
  const std::vector<Mode> modes = modes_of(string, transverse, loss * random.between(0, 10));
  if (modes.size() != transverse + string.longitudinal) return {};
  const auto forms = stretch_forms(string, first_numbers(transverse));
  StretchingBank<T> bank(modes, forms, rate);
  const double farthest_m = length * std::sqrt(string.string.tension_n / string.axial_stiffness_n) * farthest;
  for (std::size_t i = 0; i < transverse; ++i)
    bank.set_motion(i, static_cast<T>(random.between(-1, 1) * farthest_m / std::pow(i + 1, 2)), T(0));
  return balance_of(bank, std::span<const StretchForm>(forms), 500, [](int) { return T(0); });
}

TEST(StringStretching, KeepsItsEnergy) {
  double worst = 0, stretching = 0;
  int cancelling = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Balance balance = balance_of_string<double>(seed, 0, 4);
    const bool cancels = balance.bound > 1e-12;
    ASSERT_TRUE(within(balance.error, 0, cancels ? balance.bound : 1e-12)) << "string " << seed;
    cancelling += cancels;
    if (!cancels) worst = std::max(worst, balance.error);
    stretching = std::max(stretching, balance.stretching);
  }
  Measured() << "largest error of the energy " << worst << ", largest part of it in stretching " << stretching << ", "
             << cancelling << " strings whose terms cancel";
  EXPECT_GT(stretching, 0.9);
  EXPECT_LT(cancelling, 100);
}

TEST(StringStretching, NeverGainsEnergy) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Balance balance = balance_of_string<double>(seed, 1, 4);
    ASSERT_TRUE(within(balance.error, 0, std::max(1e-12, balance.bound))) << "string " << seed;
    ASSERT_TRUE(within(std::max(balance.risen, 0.0), 0, std::max(1e-13, balance.bound))) << "string " << seed;
  }
}

TEST(StringStretching, KeepsItsEnergyInSinglePrecision) {
  double worst = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Balance balance = balance_of_string<float>(seed, 0, 1);
    ASSERT_TRUE(within(balance.error, 0, balance.bound)) << "string " << seed;
    worst = std::max(worst, balance.error / balance.bound);
  }
  Measured() << "largest error in single precision, in parts of its bound " << worst;
}

// A longitudinal mode that a rate cannot have is in equilibrium at any time, as those above the last one are.
TEST(StringStretching, LeavesOutLongitudinalModesAboveHalfTheRate) {
  constexpr double kRate = 8000;  // ten modes of 352 m Hz below 3.6 kHz
  constexpr std::size_t kTransverse = 5;
  const auto sound_of = [&](std::size_t longitudinal) {
    const StretchingString string = bass_string(longitudinal);
    StretchingBank<double> bank(modes_of(string, kTransverse), stretch_forms(string, first_numbers(kTransverse)),
                                kRate);
    bank.set_motion(0, 0.02, 0);
    bank.set_motion(3, 0.01, 0);
    std::vector<double> sound;
    for (int n = 0; n < 2000; ++n) {
      bank.predict();
      bank.commit();
      sound.push_back(bank.displacement(std::size_t{2}));
    }
    return sound;
  };
  EXPECT_TRUE(sequences_within<double>(sound_of(14), sound_of(10), 1e-9));
  EXPECT_GT(relative_error(sound_of(10), sound_of(0)), 1e-3);
}

// A change of tension leaves longitudinal modes as they are, and books its work as energy.
TEST(StringStretching, RetunesTransverseModesAlone) {
  constexpr double kRate = 44100;
  constexpr std::size_t kTransverse = 8, kLongitudinal = 8;
  const StretchingString string = bass_string(kLongitudinal, {10, 0});
  std::vector<Mode> modes = modes_of(string, kTransverse);
  StretchingBank<double> bank(modes, stretch_forms(string, first_numbers(kTransverse)), kRate);
  bank.set_motion(0, 0.01, 0);
  std::vector<detail::ModeConstants> before;
  for (std::size_t i = 0; i < modes.size(); ++i) before.push_back(bank.bank().constants(i));
  for (int n = 0; n < 1000; ++n) {
    bank.predict();
    bank.commit();
    if (n % 100 == 99) {
      for (std::size_t i = 0; i < kTransverse; ++i) modes[i].angular_frequency_rad_per_s *= 1.002;
      bank.retune(modes);
    }
    ASSERT_TRUE(is_finite(bank.energy()));
  }
  for (std::size_t i = 0; i < modes.size(); ++i) {
    EXPECT_EQ(bank.bank().constants(i).stiffness == before[i].stiffness, i >= kTransverse) << i;
    EXPECT_EQ(bank.bank().constants(i).receptance == before[i].receptance, i >= kTransverse) << i;
  }
}

}  // namespace
}  // namespace contactspline::testing
