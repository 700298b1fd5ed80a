// SPDX-License-Identifier: MIT
// The example: its audio callback alone, and the sound file of its program.
#include "examples/piano.hpp"

#include <sndfile.h>

#include <cstdlib>
#include <memory>
#include <numbers>
#include <random>

#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/spectrum.hpp"

namespace contactspline::testing {
namespace {

constexpr int kRate = 48000;

double pitch_hz(int key) {
  return 440 * std::exp2((key - 69) / 12.0);
}

/// Events at times since the beginning, played in blocks of sizes that next_size() gives.
template <typename NextSize>
std::vector<float> play(std::span<const KeyEvent> events, std::size_t samples, NextSize next_size) {
  ::Piano piano(kRate);
  std::vector<float> sound(samples);
  std::vector<KeyEvent> of_block;
  for (std::size_t begin = 0; begin < samples;) {
    const std::size_t size = std::min<std::size_t>(next_size(), samples - begin);
    of_block.clear();
    for (const KeyEvent& event : events)
      if (event.time >= begin && event.time < begin + size)
        of_block.push_back({event.time - begin, event.key, event.velocity});
    piano.process(of_block, std::span(sound).subspan(begin, size));
    begin += size;
  }
  return sound;
}

// Restrikes, keys no piano has, keys up that never went down.
constexpr KeyEvent kEvents[] = {{100, 60, 0.7f},   {100, 64, 0.6f},   {3000, 60, 0.9f},   {3001, 5, 0.9f},
                                {5000, 109, 0.5f}, {7000, 100, 0.0f}, {12345, 64, 0.0f},  {12345, 64, 0.3f},
                                {20000, 60, 0.0f}, {20000, 64, 0.0f}, {22000, 108, 1.0f}, {22000, 21, 1.0f}};

// Events are taken at their samples, wherever the host cuts.
TEST(PianoExample, SoundsTheSameInBlocksOfAnySize) {
  const auto in_one = play(kEvents, 30000, [] { return 30000; });
  std::mt19937 random(1);
  for (int trial = 0; trial < 3; ++trial)
    EXPECT_EQ(play(kEvents, 30000, [&] { return std::uniform_int_distribution(1, 700)(random); }), in_one);
  EXPECT_GT(rms(in_one), 1e-3);
}

// One key is that of the runtime in double precision, in mono.
TEST(PianoExample, PlaysTheInstrumentOfTheRuntime) {
  const KeyEvent event = {37, 60, 0.5f};
  const auto sound = play({&event, 1}, 24000, [] { return 512; });
  KeyboardInstrument<keyboards::piano, double> piano(kRate);
  piano.note_on(60, 0.5);
  std::vector<double> expected(24000 - 37);
  piano.process(expected);
  std::vector<float> scaled(37);
  for (const double x : expected) scaled.push_back(static_cast<float>(12 * x));
  // Single precision keeps 95 dB of the mean over a second (docs/how-it-works/body.md), some 25 dB less of a sample.
  EXPECT_TRUE(sequences_within<float>(sound, scaled, 1e-3));
}

TEST(PianoExample, TheAudioCallbackAllocatesNothing) {
  ::Piano piano(kRate);
  std::vector<float> block(30000);
  const std::size_t before = allocations;
  piano.process(kEvents, block);
  EXPECT_EQ(allocations, before);
  EXPECT_GT(rms(block), 1e-3);
  ::operator delete(::operator new(1));  // a call that compilers keep
  EXPECT_EQ(allocations, before + 1);    // the counter counts
}

// Released, it falls asleep: exact silence, and at once awake. The treble without dampers rings on for some 20 s,
// at the end 190 dB below the note.
TEST(PianoExample, SleepsWhenSilent) {
  const KeyEvent events[] = {{0, 60, 0.7f}, {10000, 60, 0}, {1340000, 60, 0.7f}};
  const auto sound = play(events, 1350000, [] { return 512; });
  EXPECT_EQ(rms(std::span(sound).subspan(1330000, 10000)), 0);
  EXPECT_GT(rms(std::span(sound).subspan(1340000)), 0.01);
}

// The program's file: whole, in tune, not clipped.
TEST(PianoExample, WritesAPhrase) {
  const std::string file = "piano_phrase.wav";
  ASSERT_EQ(std::system(std::string(PIANO_PHRASE " ").append(file).c_str()), 0);
  SF_INFO info = {};
  const std::unique_ptr<SNDFILE, decltype(&sf_close)> wav(sf_open(file.c_str(), SFM_READ, &info), sf_close);
  ASSERT_TRUE(wav) << sf_strerror(nullptr);
  EXPECT_EQ(info.samplerate, kRate);
  EXPECT_EQ(info.channels, 1);
  ASSERT_EQ(info.frames, 6 * kRate);
  std::vector<float> sound(static_cast<std::size_t>(info.frames));
  ASSERT_EQ(sf_readf_float(wav.get(), sound.data(), info.frames), info.frames);
  const auto part = [&](double from_s, double to_s) {
    return std::span(sound).subspan(static_cast<std::size_t>(from_s * kRate),
                                    static_cast<std::size_t>((to_s - from_s) * kRate));
  };
  for (const float x : sound) ASSERT_LT(std::abs(x), 0.95f);
  // Strings without dampers ring on: E7, whose partials the chord has, 38 dB below it.
  EXPECT_LT(rms(part(5.8, 6)), 0.02 * rms(part(4, 5)));
  // Lone notes. A peak is within 0.02 of a bin of 3 and 4 Hz: 0.7 and 0.2 cent. The soundboard and the tuning of the
  // unison move it by some cents.
  const auto expect_in_tune = [&](std::span<const float> what, int key, double cents) {
    const double found = strongest_partial(what, kRate, 0.97 * pitch_hz(key), 1.03 * pitch_hz(key)).frequency_hz;
    EXPECT_TRUE(within(1200 * std::log2(found / pitch_hz(key)), 0, cents)) << "key " << key;
  };
  expect_in_tune(part(0, 0.4), 48, 4);
  expect_in_tune(part(2.25, 2.5), 76, 4);
}

TEST(PianoExample, SaysWhereItCannotWrite) {
  EXPECT_NE(std::system(PIANO_PHRASE " /nowhere/at.wav 2>/dev/null"), 0);
  EXPECT_EQ(WEXITSTATUS(std::system(PIANO_PHRASE " 2>/dev/null")), 2);
}

}  // namespace
}  // namespace contactspline::testing
