// SPDX-License-Identifier: MIT
// Levels of partials in recordings that are sums of decaying partials, and recordings that are refused.
#include "generator/fit/recorded_note.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "generator/support/error.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

StruckResonator resonator() {
  StruckResonator struck{{}, {}, true, {}};
  for (const auto& [hz, decay] : {std::pair{261.6, 2.6}, {1413.0, 11.0}, {3488.0, 24.0}, {23000.0, 90.0}}) {
    struck.modes.push_back({2 * std::numbers::pi * hz, decay, 0.1, 1});
    struck.output_per_m.push_back(1);
  }
  return struck;
}

// Partials of these amplitudes, 0.3 % sharp, from 20 ms on.
RecordedSound note(const std::vector<double>& amplitudes, double seconds = 0.4) {
  RecordedSound recording{kRate, std::vector<double>(static_cast<std::size_t>(seconds * kRate))};
  const StruckResonator struck = resonator();
  for (std::size_t n = 882; n < recording.samples.size(); ++n)
    for (std::size_t i = 0; i < amplitudes.size(); ++i) {
      const double t = static_cast<double>(n - 882) / kRate;
      recording.samples[n] += amplitudes[i] * std::exp(-struck.modes[i].decay_per_s * t) *
                              std::cos(1.003 * struck.modes[i].w_rad_per_s * t + static_cast<double>(i));
    }
  return recording;
}

using Partials = std::optional<std::vector<std::size_t>>;

Partials only(const std::vector<std::size_t>& partials) {
  return partials;
}

void expect_refused(const RecordedSound& recording, const std::string& says, const Partials& partials = {}) {
  try {
    (void)levels_of(recording, "note.wav", resonator(), partials);
    ADD_FAILURE() << "not refused: " << says;
  } catch (const BadInput& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("note.wav: " + says), std::string::npos) << refusal.what();
  }
}

// A parabola through the logarithms of a Hann window's lobe at quarters of a bin is right to 0.1 dB.
TEST(RecordedNote, HasTheLevelsOfItsPartials) {
  const std::vector<double> amplitudes = {0.3, 0.1, 0.02};
  const auto levels = levels_of(note(amplitudes), "note.wav", resonator(), {});
  ASSERT_EQ(levels.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(levels[i].mode, i);
    EXPECT_TRUE(within(levels[i].level_db, 20 * std::log10(amplitudes[i]), 0.15));
  }
  EXPECT_EQ(levels_of(note(amplitudes), "note.wav", resonator(), only({0, 2})).size(), 2u);
  EXPECT_EQ(levels_of(note({0.3, 0.1}), "note.wav", resonator(), {}).size(), 2u);
}

TEST(RecordedNote, IsRefusedIfItCannotBeMeasured) {
  expect_refused(note({}), "samples: the recording is silent");
  expect_refused(note({0.3}, 0.1), "samples: 0.08 s remain from the onset on");
  expect_refused(note({0.3, 0.1}), "partials: partial 3 of 3488 Hz does not stand out", only({2}));
  expect_refused(note({0.3}), "partials: partial 4 of 23000 Hz is above 0.45 of the sample rate", only({3}));
  RecordedSound loud = note({2.0});
  for (double& sample : loud.samples) sample = std::clamp(sample, -1.0, 1.0);
  expect_refused(loud, "samples: ");
}

}  // namespace
}  // namespace contactspline::testing
