// SPDX-License-Identifier: MIT
// An ensemble as an instrument: each key plays its string as a hammer-string alone does, dampers and pedal included,
// and the sound is the sum.
#include "contactspline/instrument/ensemble_instrument.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/dulcimer_g4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;
using One = HammerStringParameter;
using All = EnsembleParameter;

// Three strings that differ in tuning, hammer and damper.
std::vector<HammerStringParts> strings() {
  std::vector<HammerStringParts> strings;
  for (int i = 0; i < 3; ++i) {
    ResonatorParts string = string_parts<resonators::string_c4>();
    for (Mode& mode : string.modes) mode.angular_frequency_rad_per_s *= 1 + 0.25 * i;
    strings.push_back({.resonator = std::move(string),
                       .felt = detail::table_of<materials::felt_c4>(),
                       .hammer_mass_kg = 0.003 - 0.0005 * i,
                       .loss_s_per_m = materials::felt_c4::loss_s_per_m,
                       .damper = {.damping_per_s = 40.0 + 20 * i, .time_s = 0.005}});
  }
  return strings;
}

using Sound = std::array<std::vector<double>, 2>;  // displacement, force

// The next samples, added to a sound.
template <typename I>
void play(I& instrument, std::size_t samples, Sound& sound) {
  std::array<std::vector<double>, 2> played = {std::vector<double>(samples), std::vector<double>(samples)};
  const std::array<std::span<double>, 2> outputs = {played[0], played[1]};
  instrument.process(outputs);
  for (std::size_t o = 0; o < 2; ++o) sound[o].insert(sound[o].end(), played[o].begin(), played[o].end());
}

// What one instrument plays: strikes, a released key under the pedal, the pedal lifted, a harder felt. strike(voice,
// velocity), release(voice) and set(parameter of a hammer-string, of an ensemble, value) act on all voices that it
// has.
template <typename I, typename Strike, typename Release, typename Set>
Sound piece(I& instrument, Strike strike, Release release, Set set) {
  Sound sound;
  strike(0, 0.9);
  play(instrument, 300, sound);
  strike(1, 0.5);
  play(instrument, 700, sound);
  set(One::kSustain, All::kSustain, 1);
  release(0);
  play(instrument, 500, sound);
  set(One::kSustain, All::kSustain, 0);  // the damper of string 0 falls, that of string 1 does not
  play(instrument, 1500, sound);
  set(One::kStiffnessRatio, All::kStiffnessRatio, 3);
  set(One::kDamping, All::kDamping, 4);
  strike(2, 1);
  release(1);
  strike(0, 0.3);
  play(instrument, 2000, sound);
  return sound;
}

Sound played_together() {
  EnsembleInstrument<double> ensemble({.strings = strings(), .first_key = 50});
  ensemble.prepare(kRate);
  return piece(
      ensemble, [&](int voice, double velocity) { ensemble.note_on(50 + voice, velocity); },
      [&](int voice) { ensemble.note_off(50 + voice); },
      [&](std::size_t, std::size_t parameter, double value) { ensemble.set(parameter, value); });
}

Sound played_alone(int voice) {
  HammerStringInstrument<double> alone(strings()[static_cast<std::size_t>(voice)]);
  alone.prepare(kRate);
  return piece(
      alone,
      [&](int struck, double velocity) {
        if (struck == voice) alone.note_on(60, velocity);
      },
      [&](int released) {
        if (released == voice) alone.note_off(60);
      },
      [&](std::size_t parameter, std::size_t, double value) { alone.set(parameter, value); });
}

// The kernels round voices side by side differently, by some 1e-16 of the largest sample at a time, 5,000 samples
// long; contacts amplify it a hundredfold.
TEST(EnsembleInstrument, SumsWhatItsStringsPlayAlone) {
  Sound expected = played_alone(0);
  for (const int voice : {1, 2}) {
    const Sound alone = played_alone(voice);
    for (std::size_t o = 0; o < 2; ++o)
      for (std::size_t n = 0; n < alone[o].size(); ++n) expected[o][n] += alone[o][n];
  }
  const Sound found = played_together();
  for (std::size_t o = 0; o < 2; ++o)
    EXPECT_TRUE(sequences_within(std::span<const double>(found[o]), std::span<const double>(expected[o]), 5e-11))
        << o;
}

TEST(EnsembleInstrument, PlaysOnlyKeysThatItHas) {
  EnsembleInstrument<double> ensemble({.strings = strings(), .first_key = 50});
  ensemble.prepare(kRate);
  for (const int key : {-1, 0, 49, 53, 127, 1000}) ensemble.note_on(key, 1), ensemble.note_off(key);
  EXPECT_EQ(ensemble.ensemble().awake(), 0U);
  EXPECT_TRUE(ensemble.is_silent(1e-14));
  ensemble.note_on(52, 1);
  EXPECT_EQ(ensemble.ensemble().awake(), 1U);
  EXPECT_FALSE(ensemble.is_silent(1e-14));
}

// The strings of EnsembleOf: key 72 sounds an octave above key 60, but for the stiffness that does not change. One
// string or a course of two.
template <typename String>
void expect_tuned_at_keys() {
  EnsembleOf<materials::felt_c4, String, double> ensemble;
  ensemble.prepare(kRate);
  ASSERT_EQ(ensemble.ensemble().voices(), 25U);
  // Of the first mode, but for a factor: all have the same mass.
  const auto frequency = [&](int key) {
    return 1 / std::sqrt(ensemble.ensemble().model(static_cast<std::size_t>(key - 48)).string().compliance(0));
  };
  for (const int key : {48, 55, 60, 67, 72})
    EXPECT_NEAR(frequency(key) / frequency(60), std::exp2((key - 60) / 12.0), 1e-3 * frequency(key) / frequency(60))
        << key;
}

TEST(EnsembleInstrument, TunesEmittedStringsAtTheirKeys) {
  expect_tuned_at_keys<resonators::string_c4>();
  expect_tuned_at_keys<resonators::dulcimer_g4>();
}

// Both strings of a course follow a bend of their tension, but for the stiffness, 1.3e-4 of the first mode's square.
TEST(EmittedStrings, BendAsACourse) {
  HammerStringOf<materials::felt_c4, resonators::dulcimer_g4, double> course;
  course.prepare(kRate);
  const auto frequency = [&](std::size_t mode) {
    return 1 / std::sqrt(course.voice().model().string().compliance(mode));
  };
  const std::array<double, 2> before = {frequency(0), frequency(1)};
  course.set(HammerStringParameter::kBend, 100);
  Sound sound;
  play(course, 64, sound);
  for (const std::size_t mode : {0, 1})
    EXPECT_NEAR(frequency(mode) / before[mode], std::exp2(1 / 12.0), 1.3e-4) << mode;
}

// Emitted numbers have 13 digits: errors of 1e-12 in squares of frequencies. Between the first and the last mode,
// tension and bending stiffness are of the size of each other.
TEST(EmittedStrings, KnowTheNumbersOfTheirFiles) {
  const auto expect_string = [](const StiffString& found, const StiffString& file) {
    EXPECT_NEAR(found.length_m, file.length_m, 1e-12 * file.length_m);
    EXPECT_NEAR(found.mass_kg, file.mass_kg, 1e-12 * file.mass_kg);
    EXPECT_NEAR(found.tension_n, file.tension_n, 1e-11 * file.tension_n);
    EXPECT_NEAR(found.bending_stiffness_n_m2, file.bending_stiffness_n_m2, 1e-10 * file.bending_stiffness_n_m2);
    EXPECT_NEAR(found.losses.constant_per_s, file.losses.constant_per_s, 1e-11 * file.losses.constant_per_s);
    EXPECT_NEAR(found.losses.quadratic_m2_per_s, file.losses.quadratic_m2_per_s,
                1e-11 * file.losses.quadratic_m2_per_s);
    ASSERT_EQ(found.detuning_cents.size(), file.detuning_cents.size());
    for (std::size_t i = 0; i < file.detuning_cents.size(); ++i)
      EXPECT_NEAR(found.detuning_cents[i], file.detuning_cents[i], 600 / std::numbers::ln2 * 1e-11);
  };
  // data/resonators/dulcimer_g4.json, string_c4.json
  expect_string(string_parts<resonators::dulcimer_g4>().string.value(),
                {0.45, 0.00056182, 155.384, 0.00067, {2.73, 4.83e-4}, {0, 1.2}});
  expect_string(string_parts<resonators::string_c4>().string.value(),
                {0.62, 0.00393, 670, 0.00983833, {0.5, 1e-4}, {0}});
}

}  // namespace
}  // namespace contactspline::testing
