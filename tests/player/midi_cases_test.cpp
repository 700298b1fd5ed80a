// SPDX-License-Identifier: MIT
// Small files of kinds that other programs write: what notes, bends and pedals they are, and how long.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "generator/player/midi_reader.hpp"
#include "generator/support/error.hpp"
#include "support/compare.hpp"
#include "support/midi_files.hpp"

namespace contactspline::testing {
namespace {

using namespace midi;

constexpr MidiSettings kPiano{.first_key = 21, .last_key = 108, .max_cents = 1200};

MidiSong song_of(const std::string& bytes) {
  return parse_midi(bytes, "probe.mid", {}, kPiano);
}

struct Holds {
  std::string test, bytes;
  std::vector<double> begin_s, key_hold_s, hold_s;
};
void PrintTo(const Holds& holds, std::ostream* stream) {
  *stream << holds.test;
}

class MidiHolds : public ::testing::TestWithParam<Holds> {};

TEST_P(MidiHolds, AreThoseOfTheFile) {
  const auto& [test, bytes, begin_s, key_hold_s, hold_s] = GetParam();
  const MidiSong song = song_of(bytes);
  ASSERT_EQ(song.notes.size(), begin_s.size());
  for (std::size_t n = 0; n < begin_s.size(); ++n) {
    EXPECT_TRUE(within(song.notes[n].time_s, begin_s[n], 1e-12)) << n;
    EXPECT_TRUE(within(song.notes[n].key_hold_s, key_hold_s[n], 1e-12)) << n;
    EXPECT_TRUE(within(song.notes[n].hold_s, hold_s[n], 1e-12)) << n;
  }
}

const Events kNext = {{4 * kSecond, on(96, 1)}, {4 * kSecond + 96, off(96)}};

const Holds kHolds[] = {
    {"HandoverBetweenTracks",
     file(track({{kSecond, on(60)}, {3 * kSecond, off(60)}}) + track({{0, on(60)}, {kSecond, off(60)}}), 2),
     {0, 1},
     {1, 2},
     {1, 2}},
    {"HandoverWithTheOnFirst",
     file(track({{0, on(60)}, {kSecond, on(60)}, {kSecond, off(60)}, {3 * kSecond, off(60)}}), 1, 0),
     {0, 1},
     {1, 2},
     {1, 2}},
    {"OverlapOnOneChannel",
     file(track({{0, on(60)}, {kSecond / 2, on(60)}, {kSecond, off(60)}, {3 * kSecond, off(60)}})),
     {0, 0.5},
     {1, 2.5},
     {1, 2.5}},
    {"PedalUntilTheEndOfTheTrack",
     file(track({{0, controller(64, 127)}, {0, on(48)}, {0, on(55)}, {240, off(48)}, {240, off(55)}}, 4 * kSecond)),
     {0, 0},
     {0.25, 0.25},
     {4, 4}},
    {"AllNotesOff",
     file(track(followed_by({{0, on(60)}, {kSecond, controller(123, 0)}}, kNext))),
     {0, 4},
     {1, 0.1},
     {1, 0.1}},
    {"AllSoundOff",
     file(track(followed_by({{0, on(60)}, {kSecond, controller(120, 0)}}, kNext))),
     {0, 4},
     {1, 0.1},
     {1, 0.1}},
    {"ResetOfControllers",
     file(track(followed_by(
         {{0, controller(64, 127)}, {0, on(60)}, {kSecond / 2, off(60)}, {kSecond, controller(121, 0)}}, kNext))),
     {0, 4},
     {0.5, 0.1},
     {1, 0.1}},
    {"EmptyTrack", file(chunk("MTrk", "") + track(kNote), 2), {0}, {1}, {1}},
    {"AlienChunkBetween",
     file(track(kNote) + chunk("XFKM", "abc") + track({{0, on(72, 40, 1)}, {kSecond, off(72, 1)}}), 2),
     {0, 0},
     {1, 1},
     {1, 1}},
    {"Riff", "RIFF\x3c" + bytes({0, 0, 0}) + "RMIDdata" + bytes({0x30, 0, 0, 0}) + file(track(kNote)), {0}, {1}, {1}},
    {"FormatTwo", file(track(kNote) + track(kNote), 2, 2), {0, 1}, {1, 1}, {1, 1}},
};
INSTANTIATE_TEST_SUITE_P(All, MidiHolds, ::testing::ValuesIn(kHolds),
                         [](const auto& holds) { return holds.param.test; });

struct Tuned {
  std::string test, bytes;
  std::vector<double> cents;  // of the notes above their keys of equal temperament
  std::vector<int> keys = {60};
};
void PrintTo(const Tuned& tuned, std::ostream* stream) {
  *stream << tuned.test;
}

class MidiTunes : public ::testing::TestWithParam<Tuned> {};

// The bend of the channel when the note begins, and its own tuning. The wheel goes up to 8191/8192 of its range.
TEST_P(MidiTunes, AreThoseOfTheFile) {
  const auto& [test, bytes, cents, keys] = GetParam();
  const MidiSong song = song_of(bytes);
  ASSERT_EQ(song.notes.size(), cents.size());
  for (std::size_t n = 0; n < cents.size(); ++n) {
    double bend = 0;
    for (const MidiBend& b : song.bends)
      if (b.channel == song.notes[n].channel && b.time_s <= song.notes[n].time_s) bend = b.cents;
    const double pitch = bend + song.notes[n].cents + 100.0 * (song.notes[n].key - keys[n]);
    EXPECT_TRUE(within(pitch, cents[n], 1e-9)) << n;
    EXPECT_LE(std::abs(bend + song.notes[n].cents), 1200);
  }
}

constexpr double kUp = 8191.0 / 8192;

const Tuned kTuned[] = {
    {"BendRangeOfTwoSemitones", file(track(kBentNote)), {200 * kUp}},
    {"BendRangeThenAnUnregisteredParameter",
     set_by(0, {{0, controller(6, 2)}, {0, controller(99, 1)}, {0, controller(98, 32)}, {0, controller(6, 64)}},
            kBentNote),
     {200 * kUp}},
    {"BendRangeOfFiftyCents", set_by(0, {{0, controller(6, 0)}, {0, controller(38, 50)}}, kBentNote), {50 * kUp}},
    {"BendRangeIncremented", set_by(0, Events(50, {0, controller(96, 0)}), kBentNote), {250 * kUp}},
    {"BendRangeDecrementedPastASemitone", set_by(0, Events(150, {0, controller(97, 127)}), kBentNote), {50 * kUp}},
    {"ChoiceEndedByNone",
     set_by(0, {{0, controller(101, 127)}, {0, controller(100, 127)}, {0, controller(6, 12)}}, kBentNote),
     {200 * kUp}},
    {"FineTuning", set_by(1, {{0, controller(6, 96)}, {0, controller(38, 0)}}, kNote), {50}},
    {"CoarseTuning", set_by(2, {{0, controller(6, 66)}}, kNote), {200}},
    {"CoarseTuningIncremented", set_by(2, {{0, controller(96, 0)}}, kNote), {100}},
    {"MasterTuning",
     file(track(followed_by({{0, exclusive("\x7f\x7f\4\3\3\x45")}}, kNote))),
     {100.0 * (0x45 * 128 + 3 - 8192) / 8192}},
    {"MasterCoarseTuning",
     file(track(followed_by({{0, exclusive(std::string("\x7f\x7f\4\4\0\x3e", 6))}}, kNote))),
     {-200}},
    {"TunedKey",
     file(track(followed_by({{0, exclusive(std::string("\x7f\x7f\x08\2\0\1\x3c\x3c\x40\0", 10))}}, kNote))),
     {50}},
    {"TunedKeyWithABank",
     file(track(followed_by({{0, exclusive(std::string("\x7e\x7f\x08\7\0\0\1\x3c\x3b\x40\0", 11))}}, kNote))),
     {-50}},
    {"TwoBendsOfMpe",
     file(track(followed_by(registered(6), {{0, controller(6, 5)},
                                            {0, wheel(16383, 1)},
                                            {0, wheel(0, 2)},
                                            {0, on(60, 90, 1)},
                                            {0, on(67, 90, 2)},
                                            {kSecond, off(60, 1)},
                                            {kSecond, off(67, 2)}}))),
     {4800 * kUp, -4800},
     {60, 67}},
    {"MpeBendsBesideTheFirstChannel",
     file(track(followed_by(registered(6), {{0, controller(6, 3)},
                                            {0, wheel(0)},
                                            {0, wheel(8192 + 128, 1)},
                                            {0, on(60, 90, 1)},
                                            {kSecond, off(60, 1)}}))),
     {-200 + 75},
     {60}},
};
INSTANTIATE_TEST_SUITE_P(All, MidiTunes, ::testing::ValuesIn(kTuned),
                         [](const auto& tuned) { return tuned.param.test; });

// 64 and more is all the way down, whoever writes it; below is a half pedal.
TEST(MidiPedals, AreDownFromSixtyFourOn) {
  for (const auto& [value, position] :
       {std::pair{20, 20 / 64.0}, {40, 40 / 64.0}, {63, 63 / 64.0}, {64, 1.0}, {100, 1.0}, {127, 1.0}}) {
    const MidiSong song = song_of(
        file(track({{0, controller(64, value)}, {0, on(60)}, {kSecond, off(60)}, {3 * kSecond, controller(64, 0)}})));
    ASSERT_EQ(song.pedals.size(), 2u) << value;
    EXPECT_EQ(song.pedals[0].position, position);
    EXPECT_TRUE(within(song.pedals[1].time_s, 3, 1e-12));
    EXPECT_EQ(song.pedals[1].position, 0);
  }
}

TEST(MidiVelocities, HaveALowByteAndARelease) {
  const MidiSong fine = song_of(file(track({{0, controller(88, 64)},
                                            {0, on(60, 40)},
                                            {kSecond, off(60)},
                                            {kSecond, on(60, 40)},
                                            {2 * kSecond, off(60, 0, 127)}})));
  ASSERT_EQ(fine.notes.size(), 2u);
  EXPECT_EQ(fine.notes[0].velocity, 40.5 / 127);
  EXPECT_EQ(fine.notes[1].velocity, 40.0 / 127);
  EXPECT_EQ(fine.notes[0].release, 64.0 / 127);
  EXPECT_EQ(fine.notes[1].release, 1);
}

TEST(MidiSilence, IsThatOfTheChannelWhereNoOtherSounds) {
  const auto silences = [](int channel) {
    return song_of(file(track({{0, on(60)},
                               {0, on(64, 90, 1)},
                               {480, off(64, 1)},
                               {kSecond, controller(120, 0, channel)},
                               {2 * kSecond, off(60)}})))
        .silences_s;
  };
  EXPECT_EQ(silences(0).size(), 1u);
  EXPECT_EQ(silences(1).size(), 0u);
}

struct Damaged {
  std::string test, bytes, remark;
};
void PrintTo(const Damaged& damaged, std::ostream* stream) {
  *stream << damaged.test;
}
class DamagedMidi : public ::testing::TestWithParam<Damaged> {};

// One note plays, and one line says what was left out, with track and byte, counted from the beginning of the file.
TEST_P(DamagedMidi, PlaysTheRestAndSaysWhere) {
  const auto& [test, bytes, remark] = GetParam();
  const MidiSong song = song_of(bytes);
  ASSERT_EQ(song.notes.size(), 1u);
  ASSERT_EQ(song.remarks.size(), 1u);
  EXPECT_EQ(song.remarks[0], remark);
}

const std::string kRest = number(kSecond) + bytes({60, 0}), kEnd = bytes({0, 0xff, 0x2f, 0});
const std::string kOn = bytes({0}) + on(60);

const Damaged kDamaged[] = {
    {"RunningStatusAfterMeta", file(chunk("MTrk", kOn + bytes({0, 0xff, 1, 1, 'x'}) + kRest + kEnd)),
     "track 1, byte 33: running status goes on after another event"},
    {"DataByteAbove127", file(chunk("MTrk", bytes({0, 0x90, 0xbc, 64, 0, 0x90, 61, 0xc0}) + kOn + kRest + kEnd)),
     "track 1, byte 23: left out: an event with a data byte above 127 (2 times)"},
    {"NoEnd", file(chunk("MTrk", kOn + kRest)), "track 1, byte 30: the track has no end"},
    {"BrokenOff", file(chunk("MTrk", kOn + kRest + kEnd)).substr(0, 27), "track 1, byte 27: the track breaks off"},
    {"NoStatus", file(chunk("MTrk", bytes({0, 60, 64}) + on(60) + kRest + kEnd)),
     "track 1, byte 23: left out: data without a status"},
    {"SystemMessage", file(chunk("MTrk", bytes({0, 0xf5}) + kOn + kRest + kEnd)),
     "track 1, byte 23: left out: a message that has no place in a file"},
    {"NoTempo", file(chunk("MTrk", bytes({0, 0xff, 0x51, 3, 0, 0, 0}) + kOn + kRest + kEnd)),
     "track 1, byte 23: left out: a tempo that is none"},
    {"LongNumber", file(chunk("MTrk", bytes({0x80, 0x80, 0x80, 0x80}) + on(60) + kRest + kEnd)),
     "track 1, byte 25: a number is longer than four bytes"},
    {"MissingTrack", file(track(kNote), 2), "it has 1 of 2 tracks"},
};
INSTANTIATE_TEST_SUITE_P(All, DamagedMidi, ::testing::ValuesIn(kDamaged),
                         [](const auto& damaged) { return damaged.param.test; });

}  // namespace
}  // namespace contactspline::testing
