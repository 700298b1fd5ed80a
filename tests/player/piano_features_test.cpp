// SPDX-License-Identifier: MIT
// Middle C of the piano that ships, on its soundboard, against published features (docs/measurements/piano.md names
// the sources; the bounds are the ranges there), and what must not be in its sound.
#include "piano_features.hpp"

#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "support/compare.hpp"
#include "support/damped_treble.hpp"

namespace contactspline::testing {
namespace {

constexpr int kKey = 60;
constexpr std::array kSpeeds = {0.5, 1.5, 4.0};  // pp, mf, ff [m/s]

/// Eight seconds of each speed.
const std::vector<std::vector<double>>& sounds() {
  static const auto played = [] {
    std::vector<std::vector<double>> all;
    for (const double speed : kSpeeds) all.push_back(sound_of(one_note(kKey, speed, 100, 8)));
    return all;
  }();
  return played;
}

const StiffString& string() {
  static const StiffString middle_c = note_of(shipped_piano(), kKey).string;
  return middle_c;
}

/// The note alone: keys without dampers, which ring in sympathy with it at -60 dB, are damped.
std::vector<double> lone_sound(double speed_m_per_s, double hold_s, double duration_s) {
  const auto keyboard = shipped_piano();
  return sound_of(one_note(kKey, speed_m_per_s, hold_s, duration_s,
                           damped_treble(keyboard.last_damped_key + 1, keyboard.last_key)));
}

/// Passes where a number lies in a range.
::testing::AssertionResult is_from(double low, double high, double value) {
  if (value >= low && value <= high) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << value << " is not from " << low << " to " << high;
}

TEST(PianoFeatures, ContactIsShorterForALouderNote) {
  std::vector<double> times;
  for (const double speed : kSpeeds) times.push_back(contact_time_s(kKey, speed));
  for (const double time : times) EXPECT_TRUE(is_from(1e-3, 4e-3, time));
  EXPECT_TRUE(is_from(1.1, 2, times[0] / times[2]));
  EXPECT_GT(times[0], times[1]);
  EXPECT_GT(times[1], times[2]);
}

TEST(PianoFeatures, AttackTakesSomeHundredthsOfASecond) {
  for (const auto& sound : sounds()) EXPECT_TRUE(is_from(0.005, 0.05, attack_time_s(sound)));
}

TEST(PianoFeatures, ALouderNoteIsBrighter) {
  const double soft = spectral_centroid_hz(sounds()[0]), middle = spectral_centroid_hz(sounds()[1]),
               loud = spectral_centroid_hz(sounds()[2]);
  EXPECT_GT(middle, 1.05 * soft);
  EXPECT_GT(loud, 1.05 * middle);
  EXPECT_TRUE(is_from(1.2, 3, loud / soft));
}

// The range of published strings; and the string's own B, pi^2 EI/(T L^2), to what the soundboard shifts a partial
// by: 5 cents at the first is 0.6 % of (f/i)^2, which 20 partials spread over B i^2 = 0.13.
TEST(PianoFeatures, PartialsAreStretched) {
  const double b = inharmonicity(partials_hz(sounds()[2], string(), 20));
  const double own =
      std::pow(std::numbers::pi / string().length_m, 2) * string().bending_stiffness_n_m2 / string().tension_n;
  EXPECT_TRUE(is_from(2e-4, 6e-4, b));
  EXPECT_TRUE(relatively_within(b, own, 0.006 / 0.13));
}

// Two stages: the first ten partials decay at published rates, and more slowly from 3 s on than at first.
TEST(PianoFeatures, PartialsDecayInTwoStages) {
  const auto& sound = sounds()[1];
  double early_sum = 0, late_sum = 0;
  for (const double partial : partials_hz(sound, string(), 10)) {
    const double early = decay_db_per_s(sound, partial, 0.1, 1), late = decay_db_per_s(sound, partial, 3, 7);
    EXPECT_TRUE(is_from(1, 100, early)) << partial << " Hz";
    EXPECT_TRUE(is_from(1, 100, late)) << partial << " Hz";
    early_sum += early;
    late_sum += late;
  }
  EXPECT_TRUE(is_from(1.5, 5, early_sum / late_sum));
}

// Only the contact is nonlinear, and it ends after some milliseconds: a loud note decays as a soft one.
TEST(PianoFeatures, DecayDoesNotDependOnTheLoudness) {
  for (const double partial : partials_hz(sounds()[1], string(), 10))
    EXPECT_TRUE(
        within(decay_db_per_s(sounds()[0], partial, 0.1, 1), decay_db_per_s(sounds()[2], partial, 0.1, 1), 0.5))
        << partial << " Hz";
}

double peak_of(std::span<const double> sound) {
  double peak = 0;
  for (const double x : sound) peak = std::max(peak, std::abs(x));
  return peak;
}

/// Amplitude spectrum by the Blackman-Harris window of four terms, whose side lobes are 92 dB down; a tone of
/// amplitude 1 has height 1.
std::vector<double> spectrum_without_lobes(std::span<const double> sound) {
  constexpr std::array kTerms = {0.35875, 0.48829, 0.14128, 0.01168};
  std::vector<double> windowed(sound.begin(), sound.end());
  for (std::size_t n = 0; n < windowed.size(); ++n) {
    const double phase = 2 * std::numbers::pi * (static_cast<double>(n) + 0.5) / static_cast<double>(windowed.size());
    windowed[n] *=
        kTerms[0] - kTerms[1] * std::cos(phase) + kTerms[2] * std::cos(2 * phase) - kTerms[3] * std::cos(3 * phase);
  }
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double>().fwd(spectrum, windowed);
  std::vector<double> amplitude;
  for (std::size_t k = 0; k < sound.size() / 2; ++k)
    amplitude.push_back(2 / kTerms[0] / static_cast<double>(sound.size()) * std::abs(spectrum[k]));
  return amplitude;
}

// From 1 s on the modes of the board, which decay by at least 13/s, are 110 dB below what they were: only partials of
// the strings are left. Between them, 12 Hz and more away from each, nothing is above -80 dB of the strongest one; at
// 0 Hz nothing is above -100 dB of it.
TEST(PianoArtefacts, NoToneIsInANoteButItsPartials) {
  for (const double speed : kSpeeds) {
    const auto sound = lone_sound(speed, 100, 3);
    constexpr std::size_t kSize = 65536;
    const auto amplitude = spectrum_without_lobes(std::span(sound).subspan(44100, kSize));
    const double strongest = *std::ranges::max_element(amplitude);
    ASSERT_GT(strongest, 1e-6);
    std::vector<double> partials;
    for (int i = 1; i < 80; ++i)
      partials.push_back(undamped_mode(string(), i).angular_frequency_rad_per_s / (2 * std::numbers::pi));
    std::size_t checked = 0;
    double worst = 0, worst_hz = 0;
    for (std::size_t k = 0; k < amplitude.size(); ++k) {
      const double hz = static_cast<double>(k) * kFeatureRate / kSize;
      const auto is_near = [&](double partial) { return std::abs(partial - hz) < 12; };
      if (std::ranges::any_of(partials, is_near)) continue;
      ++checked;
      if (amplitude[k] > std::exchange(worst, std::max(worst, amplitude[k]))) worst_hz = hz;
    }
    EXPECT_GT(checked, amplitude.size() / 2);
    EXPECT_LT(20 * std::log10(worst / strongest), -80) << worst_hz << " Hz at " << speed << " m/s";
    EXPECT_LT(20 * std::log10(amplitude[0] / strongest), -100);
  }
}

// A key held for half a second: three seconds after its release the sound is 100 dB below its peak.
TEST(PianoArtefacts, AReleasedNoteEndsInSilence) {
  for (const double speed : kSpeeds) {
    const auto sound = lone_sound(speed, 0.5, 4);
    const double peak = peak_of(sound),
                 rest = peak_of(std::span(sound).subspan(static_cast<std::size_t>(3.5 * kFeatureRate)));
    ASSERT_GT(peak, 1e-4);
    EXPECT_LT(rest, 1e-5 * peak);
  }
}

/// Largest third difference of some samples, in which a kink or a step stands out from low partials.
double largest_kink(std::span<const double> x) {
  double largest = 0;
  for (std::size_t n = 3; n < x.size(); ++n)
    largest = std::max(largest, std::abs(x[n] - 3 * x[n - 1] + 3 * x[n - 2] - x[n - 3]));
  return largest;
}

// The damper makes no click. In its first 2 ms it takes exp(-60/s 2 ms) of each partial at most, so what it changes
// has no larger kinks than that part of those of the held note, and up to 50 ms no larger ones than the held note. A
// click of -60 dB of the note's peak would have.
TEST(PianoArtefacts, AReleaseDoesNotClick) {
  for (const double speed : kSpeeds) {
    auto released = sound_of(one_note(kKey, speed, 0.5, 1));
    const auto held = sound_of(one_note(kKey, speed, 100, 1));
    for (std::size_t n = 0; n < held.size(); ++n) released[n] -= held[n];
    const auto kinks = [](const std::vector<double>& sound, std::size_t samples) {
      return largest_kink(std::span(sound).subspan(22040, samples));
    };
    constexpr std::size_t kBegin = 98, kWhole = 2205;  // from 10 samples before the release on
    const double part = 1.2 * -std::expm1(-60 * 2e-3);
    EXPECT_GT(kinks(released, kWhole), 0);
    EXPECT_LT(kinks(released, kWhole), 1.2 * kinks(held, kWhole));
    EXPECT_LT(kinks(released, kBegin), part * kinks(held, kWhole));
    EXPECT_LT(part * kinks(held, kWhole), 3e-3 * peak_of(held)) << "a click of 1e-3, a kink of 3e-3, would hide";
  }
}

}  // namespace
}  // namespace contactspline::testing
