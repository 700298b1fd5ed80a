// SPDX-License-Identifier: MIT
// The guitar strings under a bar and over a fret that keys tune: their pitch, their rest, and notes that do not
// depend on what was before.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/host/engine.hpp"
#include "contactspline/host/hosted.hpp"
#include "contactspline/instruments/fret_guitar.hpp"
#include "contactspline/instruments/lap_steel.hpp"
#include "support/compare.hpp"
#include "support/seen_network.hpp"
#include "support/spectrum.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 48000;

double pitch_hz(int key) {
  return 440 * std::exp2((key - 69) / 12.0);
}

double cents(double ratio) {
  return 1200 * std::log2(ratio);
}

template <typename T>
std::vector<T> next(AnyInstrument<T>& instrument, std::size_t samples, std::size_t output = 0) {
  std::vector<T> sound(samples);
  std::vector<std::span<T>> outputs(instrument.outputs().size());
  outputs[output] = sound;
  instrument.process(outputs, {});
  return sound;
}

// As the engine has compiled it, prepared.
template <typename I>
Handle<typename I::value_type> prepared() {
  auto instrument = compiled<I>();
  instrument->prepare(kRate);
  return instrument;
}

template <typename T>
std::size_t parameter(const AnyInstrument<T>& instrument, std::string_view name) {
  const auto all = instrument.parameters();
  return static_cast<std::size_t>(std::ranges::find(all, name, &Parameter::name) - all.begin());
}

// Frequency of a key over a second that begins half a second after the note.
double heard_hz(AnyInstrument<float>& instrument, int key) {
  instrument.reset();
  instrument.note_on(key, 0.5);
  (void)next(instrument, static_cast<std::size_t>(kRate / 2));
  const auto sound = next(instrument, static_cast<std::size_t>(kRate));
  return strongest_partial(sound, kRate, 0.95 * pitch_hz(key), 1.05 * pitch_hz(key)).frequency_hz;
}

// Between bar and bridge a string of tension T, mass per length m and bending stiffness E has the phase k l = pi +
// Z/(w M) in its first mode: Z = sqrt(T m) is its impedance, and the bar of mass M moves as much. So its
// frequency is k sqrt(T/m (1 + E k^2/T))/2 pi. Two things make it sharper, as if the string were shorter: it passes
// on below the bar, which bends it there, by less than sqrt(E/T), the length of a clamped end; and of its modes N are
// below half the sample rate, the others would add a compliance of L/(pi^2 N T). The contact, 1e7 N/m, moves by
// w Z/1e7 < 1e-3 rad, 0.5 cents. The bin of the spectrum, 1 Hz, is read to 0.02. Measured: 0.1 to 4.4 cents sharp of
// the key.
TEST(LapSteel, SoundsAtThePitchOfItsKeys) {
  const auto steel = prepared<instruments::lap_steel<float>>();
  constexpr double kString = 0.648, kMass = 0.00135577 / kString, kBending = 0.000251327, kBar = 0.1, kTuned = -3;
  for (const int key : {43, 48, 55, 60, 67, 72, 79}) {
    const double tension = 135 * std::exp2((100 * (key - 60) + kTuned) / 600), length = kString - 0.162;
    const double impedance = std::sqrt(tension * kMass), w = 2 * std::numbers::pi * pitch_hz(key);
    const double k = (std::numbers::pi + impedance / (w * kBar)) / length;
    const double hz = k * std::sqrt(tension / kMass * (1 + kBending * k * k / tension)) / (2 * std::numbers::pi);
    const double open_hz = std::sqrt(tension / kMass) / (2 * kString),
                 modes = std::min(90.0, kRate / 2 / open_hz / 1.2);
    const double shorter = std::sqrt(kBending / tension) + kString / (std::numbers::pi * std::numbers::pi * modes);
    const double heard = heard_hz(*steel, key), read = cents(1 + 0.02 / hz);
    EXPECT_GE(cents(heard / hz), -0.5 - read) << key;
    EXPECT_LE(cents(heard / hz), cents(1 / (1 - shorter / length)) + read) << key;
    EXPECT_TRUE(within(cents(heard / pitch_hz(key)), 0, 5)) << key;
  }
}

// Without the fret: the first mode of a string that is tuned by its tension.
TEST(FretGuitar, SoundsAtThePitchOfItsKeys) {
  const auto guitar = prepared<instruments::fret_guitar<float>>();
  guitar->set(parameter(*guitar, "fret_gap_shift_m"), double(0.005f));
  constexpr double kLength = 0.648, kMass = 0.00243374 / kLength, kBending = 0.000251327;
  for (const int key : {38, 50, 60, 74}) {
    const double tension = 136 * std::exp2((key - 50) / 6.0), k = std::numbers::pi / kLength;
    const double hz = k * std::sqrt(tension / kMass * (1 + kBending * k * k / tension)) / (2 * std::numbers::pi);
    const double heard = heard_hz(*guitar, key);
    EXPECT_TRUE(within(cents(heard / hz), 0, cents(1 + 0.02 / hz))) << key;
    EXPECT_TRUE(within(cents(heard / pitch_hz(key)), 0, 6)) << key;
  }
}

// The hand presses each of the three voices with 3 N, from which the output of the bar counts, and bar and string
// stay where they are, up to rounding: eps times 3 N moves the bar on its spring of 300 N/m by 2e-18 m, to which the
// steel answers with 1.05e7 N/m. In single precision, too: strained springs are computed in double precision.
template <typename T>
void expect_rest() {
  constexpr double kRounding_n = 3 * std::numeric_limits<double>::epsilon() / 300 * 1.05e7;
  const auto steel = prepared<instruments::lap_steel<T>>();
  for (const T force : next(*steel, 4800, 2)) ASSERT_TRUE(within(double(force), 0, kRounding_n));
  for (const T force : next(*steel, 48000)) ASSERT_TRUE(within(double(force), 0, kRounding_n));
  EXPECT_TRUE(steel->is_at_rest(1e-13));
}

TEST(LapSteel, RestsUntilItIsPlayed) {
  expect_rest<double>();
  expect_rest<float>();
}

// A hand that presses harder or less makes no edge in the force of the string that is sharper than a step of a
// thousandth of a pluck of 3 N: the promise of docs/how-to/slide-string.md.
TEST(LapSteel, IsPressedWithoutASound) {
  Hosted<float> steel(compiled<instruments::lap_steel<float>>());
  steel.prepare(kRate);
  std::vector<float> sound(48000);
  float* const outputs[] = {nullptr, sound.data(), nullptr};
  steel.process(std::span<float* const>(outputs), sound.size());
  for (const double press_m : {0.01, -0.008, 0.0, 0.02, -0.0095, 0.0}) {
    steel.set(2, press_m);
    steel.process(std::span<float* const>(outputs), sound.size());
    for (const float x : sound) ASSERT_LT(std::abs(x), 1e-3f * 3 / 5) << press_m;
  }
}

// A note is the same whenever it begins.
template <typename I>
void expect_same_note_at_any_time() {
  const auto early = prepared<I>(), late = prepared<I>();
  (void)next(*early, 1000);
  (void)next(*late, 31234);
  for (auto* const instrument : {early.get(), late.get()}) instrument->note_on(60, 0.8);
  const auto first = next(*early, 48000), second = next(*late, 48000);
  EXPECT_GT(std::ranges::max(first), 0.1);
  double power = 0, error = 0;
  for (std::size_t n = 0; n < first.size(); ++n) {
    power += std::pow(double(first[n]), 2);
    error += std::pow(double(first[n]) - double(second[n]), 2);
  }
  EXPECT_LE(error, 1e-10 * power);  // 100 dB
}

TEST(LapSteel, PlaysANoteTheSameAtAnyTime) {
  expect_same_note_at_any_time<instruments::lap_steel<float>>();
  expect_same_note_at_any_time<instruments::lap_steel<double>>();
}

TEST(FretGuitar, PlaysANoteTheSameAtAnyTime) {
  expect_same_note_at_any_time<instruments::fret_guitar<float>>();
}

// Under a light hand a loud note rattles: the contact opens. A soft one does not.
TEST(LapSteel, RattlesWhereAPluckIsStrongerThanTheHand) {
  const auto opens = [](double velocity) {
    const SeenVoices steel(instruments::lap_steel<double>::data::view(), kRate);
    (void)next(*steel, 4800);
    steel->set(parameter(*steel, "press_gap_shift_m"), -0.008);
    (void)next(*steel, 9600);
    steel->note_on(60, velocity);
    bool is_open = false;
    for (std::size_t n = 0; n < 9600; ++n) {
      (void)next(*steel, 1);
      is_open |= steel.force(0, 0) == 0;
    }
    return is_open;
  };
  EXPECT_TRUE(opens(1));
  EXPECT_FALSE(opens(0.2));
}

}  // namespace
}  // namespace contactspline::testing
