// SPDX-License-Identifier: MIT
// The spectrogram of tones of known pitch, level and time.
#include "generator/player/spectrogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr std::size_t kColumns = 20, kRows = 200;

std::vector<float> tone(double frequency_hz, double amplitude, double rate_hz, double from_s, double to_s) {
  std::vector<float> samples(static_cast<std::size_t>(2 * rate_hz));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double time = static_cast<double>(i) / rate_hz;
    if (time >= from_s && time < to_s)
      samples[i] = static_cast<float>(amplitude * std::sin(2 * std::numbers::pi * frequency_hz * time));
  }
  return samples;
}

double frequency_of(const Spectrogram& spectrogram, std::size_t row) {
  return spectrogram.lowest_hz *
         std::pow(spectrogram.highest_hz / spectrogram.lowest_hz, static_cast<double>(row) / (kRows - 1));
}

std::size_t loudest_row(const Spectrogram& spectrogram, std::size_t column) {
  const auto begin = spectrogram.level_db.begin() + static_cast<std::ptrdiff_t>(column * kRows);
  return static_cast<std::size_t>(std::max_element(begin, begin + kRows) - begin);
}

// To half a row, which is 3 %, or half a bin of the window.
TEST(Spectrogram, FindsThePitchOfATone) {
  for (const double rate : {22050.0, 44100.0, 96000.0})
    for (const double frequency : {110.0, 440.0, 3000.0, 9000.0}) {
      const auto spectrogram = spectrogram_of(tone(frequency, 0.5, rate, 0, 2), rate, kColumns, kRows);
      EXPECT_EQ(spectrogram.level_db.size(), kColumns * kRows);
      const double found = frequency_of(spectrogram, loudest_row(spectrogram, kColumns / 2));
      EXPECT_TRUE(within(found, frequency, std::max(0.016 * frequency, 6.0))) << rate << " " << frequency;
    }
}

// A tone of a tenth of the loudest lies 20 dB below it (less what a Hann window loses between two bins, 1.4 dB), and
// where it does not sound there is nothing.
TEST(Spectrogram, TellsLevelsAndTimes) {
  auto samples = tone(440, 1, 44100, 0, 1);
  const auto other = tone(3000, 0.1, 44100, 1, 2);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] += other[i];
  const auto spectrogram = spectrogram_of(samples, 44100, kColumns, kRows);
  const auto level = [&](std::size_t column, std::size_t row) { return spectrogram.level_db[column * kRows + row]; };
  const std::size_t low = loudest_row(spectrogram, 4), high = loudest_row(spectrogram, 14);
  EXPECT_TRUE(within(frequency_of(spectrogram, high), 3000, 50));
  EXPECT_TRUE(within(level(4, low), 0, 1e-6 + 1.4));
  EXPECT_TRUE(within(level(14, high), -20, 1.4));
  EXPECT_LT(level(4, high), -80);
  EXPECT_LT(level(14, low), -80);
}

TEST(Spectrogram, OfSilenceIsSilent) {
  const auto spectrogram = spectrogram_of(std::vector<float>(10), 44100, kColumns, kRows);
  EXPECT_EQ(std::ranges::max(spectrogram.level_db), std::ranges::min(spectrogram.level_db));
}

}  // namespace
}  // namespace contactspline::testing
