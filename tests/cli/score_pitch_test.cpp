// SPDX-License-Identifier: MIT
// The pitch of what a score plays: in tune, and bent by scores and MIDI files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "program.hpp"
#include "render_score.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

// C4 with the wheel a quarter of its range up, and E4 of the second channel with it all the way down.
TEST(ScorePitch, BendsThePitchOfMidiNotes) {
  const std::string events("\0\xe0\0\x50\0\xe1\0\0\0\x90\x3c\x40\0\x91\x40\x40\x83\x60\x80\x3c\0\0\x81\x40\0", 25);
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  for (const auto& [channel, key, bend] : {std::tuple{"1", 60, 50.0}, std::tuple{"2", 64, -200.0}}) {
    const Sound sound = sound_of_midi(events, {"--channel", channel, "--signal", "bridge"});
    std::vector<double> left;
    for (std::size_t i = 0; i < sound.samples.size(); i += 2) left.push_back(sound.samples[i]);
    StiffString string = note_of(keyboard, key).string;
    string.tension_n *= std::exp2(bend / 600);  // frequency is proportional to its square root
    const Mode lowest = undamped_mode(string, 1, string.detuning_cents.front()).with(string.losses).value();
    const double expected = lowest.angular_frequency_rad_per_s / (2 * pi);
    EXPECT_TRUE(within(1200 * std::log2(frequency_near(left, expected + 0.2) / expected), 0, 0.1)) << key;
  }
}

// An octave up and down every millisecond: the blow stays the loudest. Bends that did any work would drown it.
TEST(ScorePitch, IsNotPumpedByBends) {
  std::string events = R"({ "time_s": 0, "key": 60, "speed_m_per_s": 5 })";
  for (int n = 0; n < 400; ++n)
    events += fmt::format(R"(, {{ "time_s": {}, "bend_cents": {} }})", 0.1 + 0.001 * n, n % 2 == 0 ? -1200 : 1200);
  const Sound sound = sound_of(R"({ "instrument": "piano", "duration_s": 0.55, "events": [ )" + events + " ] }",
                               {"--signal", "bridge"});
  double blow = 0;
  for (std::size_t n = 0; n < 4410; ++n) blow = std::max(blow, std::abs(sound.samples[n]));
  EXPECT_GT(blow, 0.5 * kPeak);
}

// In the middle of a note, by the pitch wheel of a MIDI file, and by a score: the string sounds at the pitch of its
// new tension, to which it glides.
TEST(ScorePitch, BendsASoundingString) {
  const Sandbox box;
  // C4 for 1.8 s of 96 ticks a quarter of 0.5 s; the wheel goes up by 2 semitones after 52 ms.
  write_file(box / "bend.mid", midi_file(std::string("\0\x90\x3c\x40\x0a\xe0\x7f\x7f\x82\x5a\x80\x3c\0", 13)));
  write_file(box / "bend.json",
             R"({ "instrument": "piano", "duration_s": 2.5, "events": [
      { "time_s": 0, "key": 60, "speed_m_per_s": 2.5, "hold_s": 1.8 },
      { "time_s": 0.05, "over_s": 0.1, "key": 60, "bend_cents": -1200 } ] })");
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  // At rest the bridge shifts no partial. The soundboard shifts it by at most 5 cents (docs/reference/keyboard.md),
  // and strings of one key are 0.9 cents apart.
  for (const auto& [signal, bound] : {std::pair{"bridge", 0.1}, {"body", 5.9}})
    for (const auto& [file, bend] : {std::pair{"bend.mid", 200.0 * 8191 / 8192}, std::pair{"bend.json", -1200.0}}) {
      succeed({.arguments = {"render", "--score", file, "--signal", signal, "--no-figure", "-o", "a.wav"},
               .folder = box.path()});
      const Sound sound = read_sound(box / "a.wav");
      std::vector<double> left;
      for (std::size_t i = 0; i < sound.samples.size(); i += 2) left.push_back(sound.samples[i]);
      StiffString string = note_of(keyboard, 60).string;
      string.tension_n *= std::exp2(bend / 600);
      const Mode lowest = undamped_mode(string, 1, string.detuning_cents.front()).with(string.losses).value();
      const double expected = lowest.angular_frequency_rad_per_s / (2 * pi);
      EXPECT_TRUE(within(1200 * std::log2(frequency_near(left, expected + 0.2) / expected), 0, bound))
          << file << signal;
    }
}

// The whole range of a wheel of MPE, in the middle of a soft note, on single strings: by a MIDI file whose channel
// has a range of 48 semitones, and by a score. The same bound as above; the length of the sound resolves 16 Hz to it.
TEST(ScorePitch, BendsAStringBy48Semitones) {
  const Sandbox box;
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  for (const auto& [wheel, bend] :
       {std::pair{0x3000, 2400.0}, {0x1000, -2400.0}, {0x3fff, 4800 * 8191 / 8192.0}, {0, -4800.0}}) {
    const std::string wheels = {static_cast<char>(wheel & 127), static_cast<char>(wheel >> 7)};
    // 12 s of 96 ticks a quarter of 0.5 s.
    write_file(box / "bend.mid", midi_file(std::string("\0\xb0\x65\0\0\x64\0\0\x06\x30\0\x90\x3c\x10\x0a\xe0", 16) +
                                           wheels + std::string("\x92\0\x80\x3c\0", 5)));
    write_file(box / "bend.json", fmt::format(R"({{ "instrument": "piano", "duration_s": 12,
      "events": [ {{ "time_s": 0, "key": 60, "speed_m_per_s": 0.3 }},
                  {{ "time_s": 0.05, "over_s": 0.1, "key": 60, "bend_cents": {} }} ] }})",
                                              bend));
    StiffString string = note_of(keyboard, 60).string;
    string.tension_n *= std::exp2(bend / 600);
    const Mode lowest = undamped_mode(string, 1, string.detuning_cents.front()).with(string.losses).value();
    const double expected = lowest.angular_frequency_rad_per_s / (2 * pi);
    for (const char* file : {"bend.mid", "bend.json"}) {
      succeed({.arguments = {"render", "--score", file, "--signal", "bridge", "--no-figure", "-o", "a.wav"},
               .folder = box.path()});
      const Sound sound = read_sound(box / "a.wav");
      std::vector<double> left;
      for (std::size_t i = 0; i < sound.samples.size(); i += 2) left.push_back(sound.samples[i]);
      EXPECT_TRUE(within(1200 * std::log2(frequency_near(left, expected) / expected), 0, 0.1)) << file << bend;
    }
  }
}

// Keys by files of Scala and a pitch of A4, each by the string that plays it and the tension of its pitch.
TEST(ScorePitch, IsThatOfAScale) {
  const Sandbox box;
  write_file(box / "just.scl",
             "\xef\xbb\xbf! just.scl\nJust\n12\n16/15\n9/8\n6/5\n5/4\n4/3\n45/32\n3/2\n8/5\n5/3\n9/5\n15/8\n2\n");
  write_file(box / "five.scl", "Five equal tones\n5\n240.0\n480.0\n720.0\n960.0\n1200.0\n");
  write_file(box / "low.kbm", "0\n0\n127\n60\n60\n250.0\n0\n");
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  for (const auto& [key, played, hz, words] :
       {std::tuple{64, 64, 415 * (5 / 4.0) / (5 / 3.0), Words{"--tuning", "just.scl", "--a4", "415"}},
        std::tuple{62, 65, 440 * std::exp2(-0.75 + 0.4), Words{"--tuning", "five.scl"}},
        std::tuple{59, 57, 250 * std::exp2(-0.2), Words{"--tuning", "five.scl", "--keymap", "low.kbm"}}}) {
    write_file(box / "a.mid", midi_file(std::string("\0\x90", 2) + static_cast<char>(key) + "\x40\x82\x5a\x80" +
                                        static_cast<char>(key) + std::string(1, '\0')));
    Words all = {"render", "a.mid", "--signal", "bridge", "--no-figure", "-o", "a.wav"};
    all.insert(all.end(), words.begin(), words.end());
    succeed({.arguments = all, .folder = box.path()});
    const Sound sound = read_sound(box / "a.wav");
    std::vector<double> left;
    for (std::size_t i = 0; i < sound.samples.size(); i += 2) left.push_back(sound.samples[i]);
    StiffString string = note_of(keyboard, played).string;
    string.tension_n *= std::exp2(2 * (std::log2(hz / 440) - (played - 69) / 12.0));
    const Mode lowest = undamped_mode(string, 1, string.detuning_cents.front()).with(string.losses).value();
    const double expected = lowest.angular_frequency_rad_per_s / (2 * pi);
    EXPECT_TRUE(within(1200 * std::log2(frequency_near(left, expected + 0.2) / expected), 0, 0.1)) << key;
  }
}

// C4's partials up to the 24th as written by the program, both precisions, against the formula of the stiff string.
TEST(ScorePitch, IsInTune) {
  const double length = 0.62, mass = 0.00393, tension = 670, bending = 0.00983833;
  std::vector<double> frequencies, decays;
  for (int i = 1; i <= 24; ++i) {
    const double beta = i * pi / length;
    const double square = beta * beta * (tension + bending * beta * beta) * length / mass;
    decays.push_back(0.5 + 1e-4 * beta * beta);
    frequencies.push_back(std::sqrt(square - decays.back() * decays.back()) / (2 * pi));
  }
  std::vector<double> known(66150);
  for (std::size_t n = 0; n < known.size(); ++n)
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      known[n] += std::exp(-decays[i] * static_cast<double>(n) / kRate) / static_cast<double>(1 + i) *
                  std::cos(2 * pi * frequencies[i] * static_cast<double>(n) / kRate);
  const auto cents = [](double found, double expected) { return 1200 * std::log2(found / expected); };
  for (std::size_t i = 0; i < frequencies.size(); ++i)
    EXPECT_TRUE(within(cents(frequency_near(known, frequencies[i] + 0.2), frequencies[i]), 0, 1e-3)) << i + 1;
  for (const std::string precision : {"double", "single"}) {
    const Sound sound = sound_of(hammer_score("string_c4", "felt_c4", 1.5), {"--precision", precision});
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      EXPECT_TRUE(within(cents(frequency_near(sound.samples, frequencies[i] + 0.2), frequencies[i]), 0, 0.1))
          << precision << ", partial " << i + 1;
  }
}

}  // namespace
}  // namespace contactspline::testing
