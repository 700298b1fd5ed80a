// SPDX-License-Identifier: MIT
// Every score that ships, and those of docs/reference/scores.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "render_score.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"
#include "support/loudness.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

// The mean over the last `length` samples, of each sample.
std::vector<double> moving_mean(const std::vector<double>& samples, std::size_t length) {
  std::vector<double> means(samples.size());
  double sum = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    sum += samples[n] - (n < length ? 0 : samples[n - length]);
    means[n] = sum / static_cast<double>(length);
  }
  return means;
}

// The part of a sound's energy below a frequency up to 20 Hz, by the Fourier sum of one sample in 147. Three moving
// means take 0.2 dB at 20 Hz, and 67 dB of what would fall there, at 280 Hz.
double part_below(const Sound& sound, double frequency_hz) {
  constexpr std::size_t kStep = 147;
  double low = 0, whole = 0;
  for (const double sample : sound.samples) whole += sample * sample;
  for (int channel = 0; channel < sound.channels; ++channel) {
    std::vector<double> samples, few;
    for (auto n = static_cast<std::size_t>(channel); n < sound.samples.size();
         n += static_cast<std::size_t>(sound.channels))
      samples.push_back(sound.samples[n]);
    for (int pass = 0; pass < 3; ++pass) samples = moving_mean(samples, kStep);
    for (std::size_t n = 0; n < samples.size(); n += kStep) few.push_back(samples[n]);
    const auto count = static_cast<double>(few.size()), few_hz = sound.rate / static_cast<double>(kStep);
    for (int k = 0; k * few_hz / count < frequency_hz; ++k) {
      std::complex<double> sum = 0;
      for (std::size_t n = 0; n < few.size(); ++n)
        sum += few[n] * std::polar(1.0, -2 * std::numbers::pi * k * static_cast<double>(n) / count);
      low += (k == 0 ? 1 : 2) * std::norm(sum) / count * static_cast<double>(kStep);
    }
  }
  return low / whole;
}

// The A-weighted level of a sound [dB of full scale]: the mean power of parts of 0.4 s, without those 10 dB below the
// mean.
double loudness_of(const Sound& sound) {
  const auto channels = static_cast<std::size_t>(sound.channels), frames = sound.samples.size() / channels;
  const auto size = static_cast<std::size_t>(0.4 * sound.rate);
  std::vector<double> parts((frames + size - 1) / size);
  for (std::size_t channel = 0; channel < channels; ++channel) {
    std::vector<double> samples;
    for (std::size_t n = channel; n < sound.samples.size(); n += channels) samples.push_back(sound.samples[n]);
    weigh(samples, sound.rate);
    for (std::size_t n = 0; n < frames; ++n) parts[n / size] += samples[n] * samples[n] / static_cast<double>(size);
  }
  const auto mean = [](const std::vector<double>& powers) {
    return std::reduce(powers.begin(), powers.end()) / static_cast<double>(powers.size());
  };
  std::erase_if(parts, [gate = 0.1 * mean(parts)](double power) { return power < gate; });
  return 10 * std::log10(mean(parts));
}

double loudest(std::span<const double> samples) {
  double loudest = 0;
  for (const double sample : samples) loudest = std::max(loudest, std::abs(sample));
  return loudest;
}

TEST(ShippedScore, PartsOfASoundAreThoseOfItsTones) {
  Sound sound{44100, 1, 0, {}};
  for (int n = 0; n < 441000; ++n)
    sound.samples.push_back(0.01 + 0.02 * std::sin(2 * std::numbers::pi * 12 * n / 44100) +
                            std::sin(2 * std::numbers::pi * 290 * n / 44100));
  EXPECT_TRUE(relatively_within(part_below(sound, 15), (1e-4 + 2e-4) / (0.5 + 3e-4), 0.03));
  EXPECT_TRUE(relatively_within(part_below(sound, 10), 1e-4 / (0.5 + 3e-4), 0.03));
}

// Every shipped score: about ten seconds of sound, in stereo if its voices are panned or its instrument has sides,
// never silent for half a second before the last two, no sample at full scale. Those with a level are equally loud,
// within 3 dB(A); that of a MIDI file is its peak's. It has nothing that only a membrane of a loudspeaker notices,
// below 15 Hz, or 12 Hz where a bass drum of 57 Hz or a tom of 91 Hz is struck, whose blows reach farther down; and
// has ended 60 dB below its peak before the program fades its last 10 ms.
class ShippedScore : public ::testing::TestWithParam<EmbeddedFile> {};

TEST_P(ShippedScore, Plays) {
  const Sandbox box;
  const auto& [file, text] = GetParam();
  const std::string name(file.substr(0, file.rfind('.')));
  const bool is_midi = file.ends_with(".mid");
  const std::string report = succeed({.arguments = {"render", name, "-o", name + ".wav"}, .folder = box.path()});
  const bool has_contacts = !report.starts_with("full scale");
  expect_drawn(box / (name + ".svg"), has_contacts ? 3 : 2);  // without them the force has no panel
  const Sound sound = read_sound(box / (name + ".wav"));
  const auto has = [&text](std::string_view word) { return text.find(word) != text.npos; };
  const bool has_sides = has("\"piano\"") || has("\"gong\"") || has("\"dulcimer\"");
  EXPECT_EQ(sound.channels, has_sides || has("\"pan\"") || is_midi ? 2 : 1);
  const double loudness = loudness_of(sound);
  Measured() << name << ": " << loudness << " dB(A)";
  if (is_midi) {
    EXPECT_TRUE(within(sound.peak(), kPeak, kLevel));
  } else {
    EXPECT_LT(sound.peak(), 1);
    EXPECT_TRUE(within(loudness, -30, 1.5));  // -29 is the goal of bench/levels.py, which peaks keep one score from
  }
  const std::ptrdiff_t half_second = std::ptrdiff_t{22050} * sound.channels;
  const std::ptrdiff_t stretches = std::ssize(sound.samples) / half_second;
  EXPECT_TRUE(within(static_cast<double>(stretches), 24, 5));
  for (std::ptrdiff_t i = 0; i < stretches; ++i) {
    const auto stretch =
        std::span(sound.samples)
            .subspan(static_cast<std::size_t>(i * half_second), static_cast<std::size_t>(half_second));
    EXPECT_TRUE(loudest(stretch) > 0.01 * sound.peak() || i + 4 >= stretches)
        << "at " << 0.5 * static_cast<double>(i) << " s";
  }
  EXPECT_LE(part_below(sound, name == "kit_groove" || name == "tom_pattern" ? 12 : 15), 1e-6);
  const std::size_t fade = 441 * static_cast<std::size_t>(sound.channels);
  EXPECT_LE(loudest(std::span(sound.samples).last(6 * fade)), 1e-3 * sound.peak());
}

INSTANTIATE_TEST_SUITE_P(Each, ShippedScore, ::testing::ValuesIn(embedded_files(Shipped::kScores)),
                         [](const auto& score) {
                           return std::string(score.param.name.substr(0, score.param.name.rfind('.')));
                         });

TEST(ShippedScore, AreFiveAtLeast) {
  EXPECT_GE(embedded_files(Shipped::kScores).size(), 5u);
}

TEST(ScoresOfTheDocs, Play) {
  const std::string page = read_file(fs::path(SOURCE_FOLDER) / "docs/reference/scores.md"), fence = "```json\n";
  int examples = 0;
  for (auto at = page.find(fence); at != std::string::npos; at = page.find(fence, at + 1), ++examples) {
    const auto begin = at + fence.size();
    const std::string score = page.substr(begin, page.find("```", begin) - begin);
    EXPECT_TRUE(within(sound_of(score).peak(), kPeak, kLevel)) << score;
  }
  EXPECT_EQ(examples, 2);
}

}  // namespace
}  // namespace contactspline::testing
