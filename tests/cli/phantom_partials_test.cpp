// SPDX-License-Identifier: MIT
// The example whose bass has longitudinal modes: its phantom partials in the sound of `render`, and the emitted
// struct.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "contactspline/instrument/keyboard_instrument.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "phantom_bass.hpp"
#include "program.hpp"
#include "render_score.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr int kKey = 28;  // E1, one string

std::string example() {
  return read_file(fs::path(SOURCE_FOLDER) / "examples/keyboards/phantom_bass.json");
}

/// The example without the motion of its strings along themselves.
std::string without_longitudinal() {
  std::string text = example();
  const std::size_t begin = text.rfind(',', text.find("\"longitudinal\"")), end = text.find('}', begin) + 1;
  return text.erase(begin, end - begin);
}

Sound sound_of_blow(const std::string& keyboard) {
  return sound_alone(R"({ "instrument": "bass.json", "duration_s": 2,
    "events": [ { "time_s": 0.01, "key": 28, "speed_m_per_s": 5, "hold_s": 1.9 } ] })",
                     {{"bass.json", keyboard}});
}

/// Level near a frequency in the left channel from 0.2 s to 1.7 s [dB]: the largest within 1 Hz, through a Hann
/// window.
double level_at(const Sound& sound, double hz) {
  const auto begin = static_cast<std::size_t>(0.2 * kRate), size = static_cast<std::size_t>(1.5 * kRate);
  double largest = 0;
  for (double off = -1; off <= 1; off += 0.25) {
    std::complex<double> sum = 0;
    for (std::size_t n = 0; n < size; ++n) {
      const double part = static_cast<double>(n) / static_cast<double>(size);
      sum += sound.samples[2 * (begin + n)] * (1 - std::cos(2 * std::numbers::pi * part)) *
             std::polar(1.0, -2 * std::numbers::pi * (hz + off) * static_cast<double>(n) / kRate);
    }
    largest = std::max(largest, std::abs(sum) / static_cast<double>(size));
  }
  return 20 * std::log10(largest);
}

// Sums of the frequencies of two partials m and n: the phantom partials of a bass string (H. A. Conklin, J. Acoust.
// Soc. Am. 105, 1999). The string is stiff, so partial m + n lies 11 to 33 Hz higher. Without the motion there is
// only the noise of 24 bits, 30 to 80 dB below. The partials themselves stay.
TEST(PhantomPartials, SoundInTheExampleOnly) {
  const Keyboard keyboard = parse_keyboard(example(), "phantom_bass.json");
  const StiffString string = note_of(keyboard, kKey).string;
  const auto hz = [&](int i) { return undamped_mode(string, i).angular_frequency_rad_per_s / 2 / std::numbers::pi; };
  const Sound with = sound_of_blow(example()), without = sound_of_blow(without_longitudinal());
  int heard = 0;
  for (const auto& [m, n] : {std::pair{8, 9}, {8, 10}, {9, 10}, {9, 11}, {10, 11}, {11, 12}, {12, 13}}) {
    const double phantom_hz = hz(m) + hz(n);
    ASSERT_GT(hz(m + n) - phantom_hz, 5) << m << " " << n;
    const double level = level_at(with, phantom_hz), before = level_at(without, phantom_hz);
    Measured() << m << " + " << n << ", " << phantom_hz << " Hz: " << level << " dB, without " << before;
    EXPECT_GT(level, before + 30) << m << " + " << n;
    EXPECT_LT(level, level_at(with, hz(m)));
    EXPECT_NEAR(level_at(with, hz(m)), level_at(without, hz(m)), 1);
    heard += level > level_at(with, hz(m + n)) - 30;
  }
  EXPECT_GE(heard, 4);
}

// The emitted struct plays what the score plays.
TEST(PhantomPartials, AreThoseOfTheEmittedKeyboard) {
  using Bass = KeyboardInstrument<keyboards::phantom_bass, double>;
  const auto samples = static_cast<std::size_t>(0.3 * kRate), begin = static_cast<std::size_t>(0.01 * kRate);
  Bass bass(kRate, 4096);
  std::vector<double> left(samples), right(samples), expected;
  bass.process(std::span(left).first(begin), std::span(right).first(begin));
  bass.strike(static_cast<std::size_t>(kKey - keyboards::phantom_bass::first_key), 5);
  bass.process(std::span(left).subspan(begin), std::span(right).subspan(begin));
  for (std::size_t n = 0; n < samples; ++n) expected.insert(expected.end(), {left[n], right[n]});
  const std::string text = R"({ "instrument": "bass.json", "duration_s": 0.3,
    "events": [ { "time_s": 0.01, "key": 28, "speed_m_per_s": 5, "hold_s": 0.5 } ] })";
  expect_is(sound_alone(text, {{"bass.json", example()}}), expected);
}

/// The emitted keyboard with the motion up to E1 only, and without it.
struct UpToE1 : keyboards::phantom_bass {
  struct body : phantom_bass::body {
    static constexpr int longitudinal_last_key = kKey;
  };
};
struct UpToNone : keyboards::phantom_bass {
  struct body : phantom_bass::body {
    static constexpr int longitudinal_last_key = first_key - 1;
  };
};

template <typename Keyboard>
std::vector<double> sound_of_key(int key) {
  KeyboardInstrument<Keyboard, double> bass(kRate, 4096);
  std::vector<double> left(4410), right(4410);
  bass.strike(static_cast<std::size_t>(key - Keyboard::first_key), 5);
  bass.process(left, right);
  return left;
}

TEST(PhantomPartials, EndWithTheLastKeyOfTheEmittedKeyboard) {
  EXPECT_EQ(sound_of_key<UpToE1>(kKey), sound_of_key<keyboards::phantom_bass>(kKey));
  EXPECT_NE(sound_of_key<UpToE1>(kKey), sound_of_key<UpToNone>(kKey));
  EXPECT_EQ(sound_of_key<UpToE1>(kKey + 1), sound_of_key<UpToNone>(kKey + 1));
  EXPECT_NE(sound_of_key<UpToE1>(kKey + 1), sound_of_key<keyboards::phantom_bass>(kKey + 1));
}

// Faust has none: the file is the one without the key. JSON holds it.
TEST(PhantomPartials, AreInTheEmittedFilesButInFaust) {
  const Sandbox box;
  for (const auto& [name, text] : {std::pair{"with", example()}, std::pair{"without", without_longitudinal()}}) {
    const fs::path folder = box / name;
    fs::create_directory(folder);
    write_file(folder / "bass.json", text);
    succeed({.arguments = {"generate", "bass.json", "-o", "."}, .folder = folder});
  }
  const auto emitted = [&](const char* folder, const std::string& ending) {
    return read_file(box / folder / ("phantom_bass" + ending));
  };
  EXPECT_EQ(emitted("with", ".lib"), emitted("without", ".lib"));
  for (const char* ending : {".hpp", ".json"}) {
    EXPECT_NE(emitted("with", ending).find("longitudinal_frequency_ratio"), std::string::npos);
    EXPECT_EQ(emitted("without", ending).find("longitudinal_"), std::string::npos);
  }
}

}  // namespace
}  // namespace contactspline::testing
