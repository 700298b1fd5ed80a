// SPDX-License-Identifier: MIT
// A MIDI file may bend a channel 300,000 times: its keys share the bends.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "generator/player/score_reader.hpp"

namespace contactspline::testing {
namespace {

std::string bytes_of(std::size_t number) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(number >> shift);
  return bytes;
}

// A note of each key of the piano on the first channel and one on the second; then the wheel of the first moves
// `steps` times, `ticks` after each other.
std::string song(int steps, char ticks) {
  std::string track;
  for (int key = 21; key <= 108; ++key) track += {'\0', '\x90', static_cast<char>(key), '\x50'};
  track += {'\0', '\x91', '\x40', '\x50', '\0', '\xe0', '\0', '\x40'};
  for (int i = 0; i < steps; ++i) track += {ticks, '\xe0', static_cast<char>(i % 128), '\x50'};
  for (int key = 21; key <= 108; ++key) track += {'\0', '\x80', static_cast<char>(key), '\0'};
  track += {'\0', '\x81', '\x40', '\0', '\0', '\xff', '\x2f', '\0'};
  return "MThd" + bytes_of(6) + std::string("\0\0\0\1\1\0", 6) + "MTrk" + bytes_of(track.size()) + track;
}

TEST(SharedBends, AreStoredOnceForAllKeysOfAChannel) {
  constexpr int kSteps = 1000;
  const Score score = parse_midi_score(song(kSteps, 1), "song.mid");
  ASSERT_EQ(score.voices.size(), 89u);
  SharedGlides shared;
  std::size_t bent = 0;
  for (const Voice& voice : score.voices) {
    EXPECT_TRUE(voice.glides.empty());
    if (!voice.bends) continue;
    ++bent;
    if (!shared) shared = voice.bends;
    EXPECT_EQ(voice.bends, shared) << voice.name;
  }
  EXPECT_EQ(bent, 88u);
  ASSERT_NE(shared, nullptr);
  EXPECT_EQ(shared->size(), kSteps);
}

TEST(SharedBends, CountOnceAtOneTime) {
  const Score score = parse_midi_score(song(1000, 0), "song.mid");
  for (const Voice& voice : score.voices)
    if (voice.bends) {
      ASSERT_EQ(voice.bends->size(), 1u);
      EXPECT_DOUBLE_EQ(voice.bends->front().to, 200.0 * (128 * 0x50 + 999 % 128 - 0x2000) / 0x2000);
    }
}

}  // namespace
}  // namespace contactspline::testing
