// SPDX-License-Identifier: MIT
// Instrument files with the key `stretch`: their forms, phantom partials, and the pitch of a drum that falls.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/input_file.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100, kPi = std::numbers::pi;

// The string of bass_string.json, with tension and force at its far support by the strain there: E S (u' + y'^2/2) is
// added to the tension. Without its longitudinal modes nothing would move its third mode, which has a node where the
// hammer is moved to; the first products of two of the others do.
TEST(StretchingFile, PlaysAStringThatMovesAlongItself) {
  constexpr double kLength = 1.9, kTension = 750, kBending = 0.0203062, kAxial = 2e11 * kPi / 4 * 9.6e-4 * 9.6e-4;
  constexpr std::size_t kAlong = 6;
  InstrumentModel model = parse_instrument(read_input(EXAMPLES_FOLDER "/bass_string.json"), "bass_string.json");
  model.places[1].points[0].position_m = kLength / 3;
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  SeenNetwork<double> instrument(arrays.view(), kRate);
  instrument.strike(0, 5);
  const auto displacement = [&](std::size_t mode) { return instrument.displacements(0)[mode]; };
  const std::size_t transverse = instrument.displacements(0).size() - kAlong;
  std::vector<double> actual[2], expected[2];
  double highest = 0, third = 0, fourth = 0;
  for (int n = 0; n < 8820; ++n) {
    instrument.tick();
    // The square of the slope is the sum of D_m cos(m pi x/L): the even tension by D_0, one more for each
    // longitudinal mode, with its own strain.
    const auto slope = [&](std::size_t number) {
      return number < 1 || number > transverse
                 ? 0
                 : static_cast<double>(number) * kPi / kLength * displacement(number - 1);
    };
    double strain = 0, end = 0;
    for (std::size_t m = 0; m <= kAlong; ++m) {
      double d = 0;
      for (std::size_t i = 1; i <= transverse; ++i) {
        d += slope(i) * slope(i + m) / (m == 0 ? 2 : 1);
        if (i < m) d += slope(i) * slope(m - i) / 2;
      }
      const double own = m == 0 ? 0 : static_cast<double>(m) * kPi / kLength * displacement(transverse + m - 1);
      strain += (m % 2 == 0 ? 1 : -1) * (own + d / 2);
    }
    const double rise = kAxial * strain;
    for (std::size_t i = 0; i < transverse; ++i) {
      const double wavenumber = static_cast<double>(i + 1) * kPi / kLength;
      end -= wavenumber * (kTension + rise + kBending * wavenumber * wavenumber) * (i % 2 == 0 ? -1 : 1) *
             instrument.sound_shape(0, i, displacement(i));
    }
    highest = std::max(highest, std::abs(rise) / kTension);
    third = std::max(third, std::abs(displacement(2)));
    fourth = std::max(fourth, std::abs(displacement(3)));
    for (std::size_t o = 0; o < 2; ++o) actual[o].push_back(instrument.output(o));
    expected[0].push_back(end);
    expected[1].push_back(rise);
  }
  Measured() << "the tension rises by " << 100 * highest << " %, the third mode moves by " << third / fourth
             << " of the fourth";
  EXPECT_GT(highest, 0.01);
  EXPECT_GT(third / fourth, 1e-3);
  for (std::size_t o = 0; o < 2; ++o)
    EXPECT_TRUE(sequences_within<double>(actual[o], expected[o], 1e-9)) << arrays.outputs[o].name;
}

// At 8 kHz four of its longitudinal modes act, and twelve more change nothing.
TEST(StretchingFile, HearsNothingOfLongitudinalModesThatStop) {
  const auto sounds = [](std::size_t modes) {
    InstrumentModel model = parse_instrument(read_input(EXAMPLES_FOLDER "/bass_string.json"), "bass_string.json");
    model.bodies[0].longitudinal = modes;
    const InstrumentArrays arrays = arrays_of(model, 4000);
    BySample<double> instrument(arrays.view(), 8000);
    instrument.strike(0, 5);
    std::array<std::vector<double>, 2> heard;
    for (int n = 0; n < 2000; ++n) {
      instrument.tick();
      for (std::size_t o = 0; o < 2; ++o) heard[o].push_back(instrument.output(o));
    }
    return heard;
  };
  const auto found = sounds(16), expected = sounds(4), fewer = sounds(3);
  for (std::size_t o = 0; o < 2; ++o) {
    EXPECT_TRUE(sequences_within<double>(found[o], expected[o], 1e-9)) << o;
    EXPECT_FALSE(sequences_within<double>(fewer[o], expected[o], 1e-5)) << o;
  }
}

// Level [dB] of a frequency [rad/sample] over the whole of a sound, in a Hann window.
double level_db(const std::vector<double>& sound, double frequency) {
  std::complex<double> sum = 0;
  for (std::size_t n = 0; n < sound.size(); ++n)
    sum += sound[n] * (1 - std::cos(2 * kPi * double(n) / double(sound.size()))) *
           std::polar(1.0, -frequency * double(n));
  return 20 * std::log10(std::abs(sum));
}

// Phantom partials both ways: products of neighbouring modes push the first longitudinal mode at the sums of their
// frequencies, which are odd multiples of the pitch, and it pulls the string. The even tension of a string that does
// not move along itself knows nothing of them. Beside these sums there are partials, 4 to 30 Hz higher.
TEST(StretchingFile, HasPhantomPartialsInTensionAndForce) {
  const auto levels = [](std::size_t longitudinal) {
    InstrumentModel model = parse_instrument(read_input(EXAMPLES_FOLDER "/bass_string.json"), "bass_string.json");
    model.bodies[0].longitudinal = longitudinal;
    const InstrumentArrays arrays = arrays_of(model, kRate / 2);
    BySample<double> instrument(arrays.view(), kRate);
    instrument.strike(0, 5);
    std::array<std::vector<double>, 2> sounds;
    for (int n = 0; n < 2 * int(kRate); ++n) {
      instrument.tick();
      if (n > kRate / 10)
        for (std::size_t o = 0; o < 2; ++o) sounds[o].push_back(instrument.output(o));
    }
    std::array<double, 2> found{-HUGE_VAL, -HUGE_VAL};  // the strongest of the sums
    for (std::size_t m = 5; m < 10; ++m)
      for (std::size_t o = 0; o < 2; ++o)
        found[o] = std::max(
            found[o],
            level_db(sounds[o], (arrays.angular_frequencies[m] + arrays.angular_frequencies[m + 1]) / kRate));
    return found;
  };
  const auto with = levels(6), without = levels(0);
  EXPECT_GT(with[1], without[1] + 30);
  EXPECT_GT(with[0], without[0] + 6);
  Measured() << "phantom partials, tension: " << with[1] << " dB, " << without[1] << " without; force: " << with[0]
             << " and " << without[0];
}

// The frequency of the lowest mode of the tom in periods from `from_s` on [Hz], and what the adiabatic law says of
// it.
struct Pitch {
  double measured_hz, expected_hz;
  double rise;  ///< twice the mean rise of the tension, in parts of it
};

// Tension of a membrane by Berger: T + dT, dT = E h/(2 (1 - nu^2)) times the mean of the squared slope. Mode i of the
// displacement q_i has the mean slope square beta_i^2 q_i^2 m_i/(sigma pi R^2).
//
// What the mode itself adds to dT swings at twice its frequency, which counts half of that once more: f = f0 sqrt(1 +
// (mean of dT + half of the part of the mode)/T).
Pitch pitch_of(const std::vector<std::vector<double>>& motion, const InstrumentArrays& arrays, double from_s) {
  constexpr double kRadius = 0.1524, kMass = 0.353, kTension = 900, kPoisson = 0.38;
  constexpr double kStiffness = 4.9e9 * 2.54e-4 / (2 * (1 - kPoisson * kPoisson));
  constexpr int kPeriods = 4;
  std::vector<double> crossings;  // in samples
  for (std::size_t n = static_cast<std::size_t>(from_s * kRate); crossings.size() <= kPeriods; ++n)
    if (const double before = motion[n][0], after = motion[n + 1][0]; before < 0 && after >= 0)
      crossings.push_back(static_cast<double>(n) - before / (after - before));
  const auto rise_by = [&](std::size_t i, double q) {
    const double w = arrays.angular_frequencies[i], s = arrays.decays[i];
    const double square = (w * w + s * s) * kMass / kTension;
    return kStiffness * square * q * q * arrays.masses[i] / (kMass * kPi * kRadius * kRadius) / kTension;
  };
  Pitch pitch{kPeriods * kRate / (crossings.back() - crossings.front()), 0, 0};
  const auto first = static_cast<std::size_t>(crossings.front()), last = static_cast<std::size_t>(crossings.back());
  double mean = 0;
  for (std::size_t n = first; n < last; ++n) {
    for (std::size_t i = 0; i < arrays.masses.size(); ++i)
      mean += (i == 0 ? 1.5 : 1) * rise_by(i, motion[n][i]) / static_cast<double>(last - first);
  }
  pitch.rise = 2 * mean;
  pitch.expected_hz = arrays.angular_frequencies[0] / (2 * kPi) * std::sqrt(1 + mean);
  return pitch;
}

double cents(double ratio) {
  return 1200 * std::log2(ratio);
}

// By how many cents the pitch falls within 300 ms of a stroke. Bounds of the law, with r = `rise`: the period of
// Duffing's oscillator differs by 3/256 r^2, 20 cents r^2. The other modes, from 1.59 f0 on, swing dT at twice their
// frequencies and by that the phase by up to r/4/(2 1.59) = 0.079 r: at both ends of four periods this is 11 cents r.
double fall_of_tom(const InstrumentModel& model, double speed_m_per_s) {
  const InstrumentArrays arrays = arrays_of(model, kRate / 2);
  SeenNetwork<double> tom(arrays.view(), kRate);
  tom.strike(0, speed_m_per_s);
  std::vector<std::vector<double>> motion;  // of the modes
  for (int n = 0; n < 0.35 * kRate; ++n) {
    tom.tick();
    const auto displacements = tom.displacements(0);
    motion.emplace_back(displacements.begin(), displacements.end());
  }
  const Pitch early = pitch_of(motion, arrays, 0.02), late = pitch_of(motion, arrays, 0.3);
  const double fall = cents(early.measured_hz / late.measured_hz);
  if (model.bodies[0].stretch_j == 0) return fall;
  const double expected = cents(early.expected_hz / late.expected_hz), r = early.rise;
  Measured() << speed_m_per_s << " m/s: " << early.measured_hz << " to " << late.measured_hz << " Hz, falls by "
             << fall << " cents, by the law " << expected << ", tension rises by " << 50 * r << " % on average";
  EXPECT_TRUE(within(fall, expected, 11 * r + 20 * r * r));
  return fall;
}

// Recorded toms fall by 80 to 231 cents where they are struck hard.
TEST(StretchingFile, LetsThePitchOfATomFall) {
  InstrumentModel tom = parse_instrument(read_input(EXAMPLES_FOLDER "/tom_that_falls.json"), "tom_that_falls.json");
  EXPECT_LT(fall_of_tom(tom, 0.5), 5);
  EXPECT_TRUE(within(fall_of_tom(tom, 6), (231 + 80) / 2.0, (231 - 80) / 2.0));
  tom.bodies[0].stretch_j = 0;
  EXPECT_TRUE(within(fall_of_tom(tom, 6), 0, 1e-3));
}

// The two even tensions of a plate between fixed edges, whose modes are found by their frequencies: kx^2 + ky^2 and
// kx^2
// - ky^2, however the arrays order them.
TEST(StretchingFile, HasTheFormsOfItsPlate) {
  constexpr double kLength = 0.5, kWidth = 0.31, kThickness = 1e-3, kDensity = 7800, kModulus = 2e11, kPoisson = 0.3;
  const InstrumentArrays arrays = arrays_of(parse_instrument(R"({
    "name": "sheet",
    "bodies": [ { "name": "sheet", "max_modes": 12, "stretch": { "airy_functions": 2, "edges": "fixed" },
      "plate": { "length_m": 0.5, "width_m": 0.31, "thickness_m": 0.001, "density_kg_m3": 7800,
                 "youngs_modulus_pa": 2e11, "poisson_ratio": 0.3, "constant_loss_per_s": 0,
                 "quadratic_loss_m2_per_s": 0 } } ],
    "places": [ { "name": "spot", "body": "sheet", "position_m": 0.1, "across_m": 0.1 } ],
    "outputs": [ { "name": "spot", "displacement_m": "spot" } ] })",
                                                             "sheet.json"),
                                            kRate / 2);
  const double area = kLength * kWidth, stiffness = kModulus * kThickness * area / 64;
  ASSERT_EQ(arrays.stretch_forms.size(), 2U);
  EXPECT_TRUE(relatively_within(arrays.stretch_forms[0].stiffness_j, stiffness / (1 - kPoisson), 1e-12));
  EXPECT_TRUE(relatively_within(arrays.stretch_forms[1].stiffness_j, stiffness / (1 + kPoisson), 1e-12));
  const double to_square = std::sqrt(12 * (1 - kPoisson * kPoisson) * kDensity / kModulus) / kThickness;
  int found = 0;
  for (std::size_t i = 0; i < 12; ++i)
    for (int m = 1; m < 12; ++m)
      for (int n = 1; n < 12; ++n) {
        const double x = std::pow(m * kPi / kLength, 2), y = std::pow(n * kPi / kWidth, 2);
        if (std::abs(arrays.angular_frequencies[i] * to_square / (x + y) - 1) > 1e-9) continue;
        ++found;
        EXPECT_TRUE(relatively_within(arrays.stretch_squares[i], x + y, 1e-9));
        EXPECT_TRUE(relatively_within(arrays.stretch_squares[12 + i], x - y, 1e-9));
      }
  EXPECT_EQ(found, 12);
}

// Of the forms of the first body.
double stretching_energy(const InstrumentArrays& arrays, const SeenNetwork<double>& instrument) {
  const auto q = instrument.displacements(0);
  double energy = 0;
  std::size_t square = 0, product = 0;
  for (const InstrumentForm& form : arrays.stretch_forms) {
    double stretch = 0;
    for (std::size_t i = 0; i < arrays.body_ends[0]; ++i) stretch += arrays.stretch_squares[square++] * q[i] * q[i];
    for (std::size_t i = 0; i < form.products; ++i, ++product) {
      const auto& [first, second, factor] = arrays.stretch_products[product];
      stretch += 2 * factor * q[first] * q[second];
    }
    energy += form.stiffness_j / 4 * stretch * stretch;
  }
  return energy;
}

// A gong of both symmetries with a beater on one diameter, a rattle on another and a listening place off the axis,
// all of them turned by an angle: its sound and the sum of its energies at all samples.
std::vector<double> turned_gong(double angle) {
  const std::string text = fmt::format(R"({{
    "name": "turned",
    "bodies": [
      {{ "name": "gong", "round_plate": {{ "radius_m": 0.15, "thickness_m": 0.0012, "density_kg_m3": 8700,
           "youngs_modulus_pa": 1.1e11, "poisson_ratio": 0.34, "constant_loss_per_s": 1.4,
           "quadratic_loss_m2_per_s": 2e-4, "symmetries": "both" }},
         "max_modes": 21, "stretch": {{ "airy_functions": 9 }} }},
      {{ "name": "beater", "mass_kg": 0.08 }}, {{ "name": "bolt", "mass_kg": 0.01 }} ],
    "places": [ {{ "name": "struck", "body": "gong", "position_m": 0.09, "angle_rad": {0} }},
                {{ "name": "held", "body": "gong", "position_m": 0.12, "angle_rad": {1} }} ],
    "contacts": [
      {{ "name": "cloth", "between": ["beater", "struck"], "material": "felt_c4", "gap_m": 0.001 }},
      {{ "name": "rattle", "between": ["held", "bolt"], "material": "felt_c4", "gap_m": 0.0005 }} ],
    "strikes": ["beater"],
    "outputs": [ {{ "name": "ear", "pressure_pa": "gong", "distance_m": 1, "angle_rad": 0.4, "around_rad": {2} }} ]
  }})",
                                       angle, 2 + angle, 0.5 + angle);
  const InstrumentArrays arrays = arrays_of(parse_instrument(text, "turned.json"), kRate / 2);
  SeenNetwork<double> gong(arrays.view(), kRate);
  gong.strike(0, 3);
  std::vector<double> heard;
  double highest_in_stretching = 0;
  for (int n = 0; n < 4000; ++n) {
    gong.tick();
    heard.push_back(gong.output(0));
    heard.push_back(100 * gong.energy());
    highest_in_stretching = std::max(highest_in_stretching, stretching_energy(arrays, gong) / gong.energy());
  }
  Measured() << "at " << angle << " rad: up to " << highest_in_stretching << " of the energy in stretching";
  EXPECT_GT(highest_in_stretching, 0.05);
  return heard;
}

// What is left are the digits of the arrays: 13 of shapes, 9 of the taps, 11 of the forms.
TEST(StretchingFile, SoundsAlikeWhereverTheBlowMeetsAGong) {
  const std::vector<double> expected = turned_gong(0);
  for (const double angle : {0.37, 1.9}) EXPECT_TRUE(sequences_within<double>(turned_gong(angle), expected, 1e-6));
}

}  // namespace
}  // namespace contactspline::testing
