// SPDX-License-Identifier: MIT
// The keyboard that ships: its notes, what is emitted of them, and one voice in C++.
#include "contactspline/models/keyboard.hpp"

#include <fstream>
#include <iterator>
#include <map>
#include <random>

#include "contactspline/keyboards/piano.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/design.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using Piano = keyboards::piano;

Keyboard piano() {
  std::ifstream file(SOURCE_FOLDER "/data/keyboards/piano.json");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  return parse_keyboard(text, "piano.json");
}

double first_partial_hz(const StiffString& string) {
  return modes_below(string, 22050, 1).front().mode.angular_frequency_rad_per_s / (2 * std::numbers::pi);
}

TEST(Keyboard, IsInTune) {
  const Keyboard keyboard = piano();
  ASSERT_EQ(keyboard.last_key - keyboard.first_key + 1, 88);
  for (int key = 21; key <= 108; ++key) {
    const KeyboardNote note = note_of(keyboard, key);
    StiffString string = note.string;
    string.losses.constant_per_s -= note.bridge_loss_per_s;  // takes 0.002 cents of A0
    EXPECT_TRUE(relatively_within(first_partial_hz(string), 440 * std::exp2((key - 69) / 12.0), 1e-12)) << key;
  }
}

// At a key of the file the note is that of the file.
TEST(Keyboard, PassesThroughTheNotesOfItsFile) {
  const Keyboard keyboard = piano();
  for (const PublishedNote& published : keyboard.notes) {
    const KeyboardNote note = note_of(keyboard, published.key);
    EXPECT_TRUE(relatively_within(note.string.length_m, published.length_m, 1e-5));
    EXPECT_TRUE(relatively_within(note.string.mass_kg, published.mass_kg, 1e-5));
    EXPECT_TRUE(relatively_within(note.string.bending_stiffness_n_m2, published.bending_stiffness_n_m2, 1e-5));
    EXPECT_TRUE(relatively_within(note.strike_position_m, published.strike_position_m, 1e-5));
    EXPECT_TRUE(relatively_within(note.hammer_mass_kg * note.strings, published.hammer_mass_kg, 1e-5));
    EXPECT_TRUE(
        relatively_within(note.felt.contact.power_law()->stiffness * note.strings, published.felt.stiffness, 1e-5));
    EXPECT_TRUE(within(note.felt.contact.power_law()->exponent, published.felt.exponent, 1e-5));
    EXPECT_TRUE(relatively_within(note.output_ratio, published.output_ratio, 1e-5));
    EXPECT_TRUE(relatively_within(note.string.losses.constant_per_s - note.bridge_loss_per_s,
                                  published.losses.constant_per_s, 1e-4));
    EXPECT_TRUE(relatively_within(note.bridge_ratio, published.bridge_ratio, 1e-5));
  }
}

// At a published C the tension is near the published one, which was measured.
TEST(Keyboard, HasThePublishedTensions) {
  const std::map<int, double> published = {{36, 915}, {48, 759}, {60, 741}, {72, 696}, {84, 697}, {96, 670}};
  for (const auto& [key, tension_n] : published)
    EXPECT_TRUE(relatively_within(note_of(piano(), key).string.tension_n, tension_n, 0.04)) << key;
}

// Along the keyboard nothing leaps: strings grow shorter from key to key, and exponents change by a line below C4, by
// lines through the published ones above. They are those of felts taken from pianos (D. Hall and A. Askenfelt, JASA
// 83, 1988).
TEST(Keyboard, ChangesSteadily) {
  const Keyboard keyboard = piano();
  for (int key = 22; key <= 108; ++key) {
    const KeyboardNote below = note_of(keyboard, key - 1), note = note_of(keyboard, key);
    EXPECT_LT(note.string.length_m, below.string.length_m);
    const double exponent = note.felt.contact.power_law()->exponent;
    EXPECT_TRUE(within(exponent, below.felt.contact.power_law()->exponent, 0.4 / 12)) << key;
    EXPECT_TRUE(within(exponent, (2.2 + 3.5) / 2, (3.5 - 2.2) / 2)) << key;
    EXPECT_LT(std::abs(std::log(note.string.tension_n / below.string.tension_n)), 0.05);
    EXPECT_GE(note.strings, below.strings);
  }
}

TEST(Keyboard, IsEmittedAsItIs) {
  const Keyboard keyboard = piano();
  for (int key = 21; key <= 108; ++key) {
    const auto k = static_cast<std::size_t>(key - 21);
    const KeyboardNote note = note_of(keyboard, key);
    const StiffString string = string_of<Piano>(key);
    EXPECT_EQ(string.length_m, note.string.length_m);
    EXPECT_EQ(string.tension_n, note.string.tension_n);
    EXPECT_EQ(Piano::hammer_masses[k], note.hammer_mass_kg);
    EXPECT_EQ(Piano::strings[k], note.strings);
    EXPECT_EQ(Piano::bridge_losses[k], note.bridge_loss_per_s);
    EXPECT_EQ(Piano::output_ratios[k], note.output_ratio);
    EXPECT_EQ(Piano::horizontal_ratios[k], note.horizontal_ratio);
    EXPECT_EQ(Piano::bridge_ratios[k], note.bridge_ratio);
    Material design = note.felt;
    const auto felt = segment_table(design_spline(design, "piano"));
    ASSERT_EQ(felt.size(), Piano::segments + 1);
    for (std::size_t j = 0; j < felt.size(); ++j) {
      EXPECT_EQ((felts_of<Piano, double>[k][j].knot), felt[j].knot);
      EXPECT_EQ((felts_of<Piano, double>[k][j].half_curvature), felt[j].half_curvature);
    }
  }
}

/// A key struck, released while its damper still lifts from the blow before, struck again, in blocks of next_size().
template <typename T, typename NextSize>
std::vector<T> play_blocks(int key, NextSize next_size) {
  KeyboardVoice<Piano, T> voice(key, 44100, 80);
  std::vector<T> out(20000);
  const std::size_t strikes[] = {0, 5000, 9003}, releases[] = {4801, 5077, 12000};
  std::size_t event = 0;
  for (std::size_t done = 0; done < out.size();) {
    const bool is_strike = event % 2 == 0;
    const std::size_t next = event < 6 ? (is_strike ? strikes : releases)[event / 2] : out.size();
    if (done == next) {
      is_strike ? voice.strike(2) : voice.release();
      ++event;
      continue;
    }
    const std::size_t samples = std::min(next_size(), next - done);
    const auto block = std::span(out).subspan(done, samples);
    if (samples == 1)
      block[0] = voice.tick();
    else
      voice.process(block);
    done += samples;
  }
  return out;
}

// Blocks of any size play what ticks do, the gliding damper included, but for rounding: as the kernels against the
// plain model (kernels_test.cpp).
TEST(Keyboard, PlaysBlocksOfAnySizeAsItTicks) {
  const auto check = []<typename T>(T bound) {
    for (const int key : {30, 60, 100}) {
      const auto expected = play_blocks<T>(key, [] { return std::size_t(1); });
      for (const std::size_t size : {7u, 16u, 256u, 100000u})
        EXPECT_TRUE(sequences_within<T>(play_blocks<T>(key, [&] { return size; }), expected, bound)) << key;
      std::mt19937 random(5);
      EXPECT_TRUE(sequences_within<T>(play_blocks<T>(key, [&] { return 1 + random() % 50; }), expected, bound));
    }
  };
  check(1e-12);
  check(5.6e-5f);
}

// A strike lifts the damper at once. A release lowers it by a constant fraction of the remaining distance in each
// sample: the damping held for 16 samples is the mean of that. It ends 1e-5/s before its end.
TEST(Keyboard, LiftsItsDamperAtOnceAndLowersItGently) {
  KeyboardVoice<Piano, double> voice(60, 44100, 1);
  const double fraction = 1 - std::exp(-1 / (0.005 * 44100));
  double target = 0, damping = 0, mean = 0;
  std::size_t held = 0;
  for (int n = 0; n < 9000; ++n) {
    const bool is_release = n == 100 || n == 150 || n == 4503, is_strike = n == 0 || n == 137 || n == 4000;
    if (is_release) voice.release();
    if (is_strike) voice.strike(1);
    if (is_release || is_strike) {
      target = is_release ? 60 : 0;
      if (is_strike) damping = 0;
      held = 0;
    }
    if (held == 0) {
      double predicted = damping;
      mean = 0;
      for (int i = 0; i < 16; ++i) mean += (predicted += fraction * (target - predicted)) / 16;
    }
    ASSERT_TRUE(within(voice.damping_per_s(), mean, 1e-5)) << n;
    voice.tick();
    damping += fraction * (target - damping);
    held = (held + 1) % 16;
  }
  EXPECT_EQ(voice.damping_per_s(), 60);
}

// Released, a key's damper falls; the highest have none.
TEST(Keyboard, DampsWhatHasADamper) {
  for (const int key : {60, 100}) {
    KeyboardVoice<Piano, double> voice(key, 44100);
    voice.strike(2);
    for (int n = 0; n < 4410; ++n) voice.tick();
    const double before = voice.model().string().energy();
    voice.release();
    for (int n = 0; n < 4410; ++n) voice.tick();
    EXPECT_EQ(voice.model().string().energy() < 1e-4 * before, key == 60) << key;
  }
}

}  // namespace
}  // namespace contactspline::testing
