// SPDX-License-Identifier: MIT
// Notes of MIDI files whose bytes and times are worked out by hand.
#include "generator/player/midi_reader.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "generator/player/voice_tracks.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

std::string chunk(const std::string& kind, const std::string& content) {
  const auto size = static_cast<int>(content.size());
  return kind + bytes({0, 0, size >> 8, size & 255}) + content;
}

// Division: two bytes.
std::string file_of(std::initializer_list<int> division, const std::vector<std::string>& tracks) {
  std::string file =
      chunk("MThd", bytes({0, tracks.size() > 1, 0, static_cast<int>(tracks.size())}) + bytes(division));
  for (const std::string& track : tracks) file += chunk("MTrk", track + bytes({0, 0xff, 0x2f, 0}));
  return file;
}

struct Expected {
  double time_s, hold_s;
  int key, velocity;
};

void expect_notes(const std::string& file, const std::vector<Expected>& expected) {
  const auto notes = parse_midi(file, "probe.mid").notes;
  ASSERT_EQ(notes.size(), expected.size());
  for (std::size_t i = 0; i < notes.size(); ++i) {
    EXPECT_TRUE(within(notes[i].time_s, expected[i].time_s, 1e-12)) << i;
    EXPECT_TRUE(within(notes[i].hold_s, expected[i].hold_s, 1e-12)) << i;
    EXPECT_EQ(notes[i].key, expected[i].key) << i;
    EXPECT_EQ(notes[i].velocity, expected[i].velocity / 127.0) << i;
  }
}

// 100 ticks a quarter of 0.5 s where no tempo is given; running status, and a velocity of 0 lets go.
TEST(Midi, BeginsWithAHundredAndTwentyQuartersAMinute) {
  expect_notes(file_of({0, 100}, {bytes({0, 0x90, 60, 64, 50, 64, 70, 50, 60, 0, 0x81, 0x48, 0x80, 64, 1})}),
               {{0, 0.5, 60, 64}, {0.25, 0.25 + 1, 64, 70}});
}

// The first track makes a quarter 1 s after 100 ticks, which the second one's notes follow, one of them halfway.
TEST(Midi, FollowsTheTempoOfAnotherTrack) {
  const std::string tempo = bytes({100, 0xff, 0x51, 3, 0x0f, 0x42, 0x40});
  expect_notes(file_of({0, 100}, {tempo, bytes({50, 0x90, 60, 64, 100, 0x80, 60, 0, 50, 0x90, 62, 1, 50, 62, 0})}),
               {{0.25, 0.25 + 0.5, 60, 64}, {0.5 + 1, 0.5, 62, 1}});
}

// 25 frames a second of 40 ticks are milliseconds, whatever the tempo; 29 stands for 29.97.
TEST(Midi, CountsFramesOfFilm) {
  const std::string track = bytes({0, 0xff, 0x51, 3, 0x0f, 0x42, 0x40, 100, 0x90, 60, 64, 100, 60, 0});
  expect_notes(file_of({256 - 25, 40}, {track}), {{0.1, 0.1, 60, 64}});
  expect_notes(file_of({256 - 29, 100}, {track}), {{1 / 29.97, 1 / 29.97, 60, 64}});
}

// The pedal, down from 64 on, holds what is let go meanwhile, and what it holds ends with it; on its own channel
// only.
TEST(Midi, HoldsByThePedal) {
  expect_notes(file_of({0, 100}, {bytes({0,  0x90, 60, 64,   0,  0x91, 72, 64,   10, 0xb0, 64, 64,   10, 0x80,
                                         60, 0,    0,  0x81, 72, 0,    20, 0x90, 64, 50,   20, 0x80, 64, 0,
                                         20, 0xb0, 64, 63,   10, 0x90, 65, 9,    10, 0x80, 65, 0})}),
               {{0, 0.4, 60, 64}, {0, 0.1, 72, 64}, {0.2, 0.2, 64, 50}, {0.45, 0.05, 65, 9}});
}

// Pedals are where the channel is that presses them farthest, from 64 on all the way down, and go up at the end;
// beside them stands how long the key itself was down.
TEST(Midi, FollowsThePedals) {
  const auto song =
      parse_midi(file_of({0, 100}, {bytes({0,  0xb0, 64, 40,  0,  0x90, 60, 64, 10, 0xb1, 64, 100, 0, 0xb0, 64, 90,
                                           10, 0xb1, 64, 0,   10, 0x80, 60, 0,  10, 0xb0, 67, 127, 0, 0xb0, 65, 127,
                                           10, 0xb0, 66, 127, 10, 0xb0, 64, 63, 0,  0xb0, 64, 63})}),
                 "probe.mid");
  const std::vector<MidiPedal> expected = {{0, 64, 40},   {0.05, 64, 64}, {0.2, 67, 64}, {0.25, 66, 64},
                                           {0.3, 64, 63}, {0.3, 64, 0},   {0.3, 66, 0},  {0.3, 67, 0}};
  ASSERT_EQ(song.pedals.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_TRUE(within(song.pedals[i].time_s, expected[i].time_s, 1e-12)) << i;
    EXPECT_EQ(song.pedals[i].controller, expected[i].controller) << i;
    EXPECT_EQ(song.pedals[i].position, expected[i].position / 64) << i;
  }
  ASSERT_EQ(song.notes.size(), 1u);
  EXPECT_TRUE(within(song.notes[0].hold_s, 0.3, 1e-12));
  EXPECT_TRUE(within(song.notes[0].key_hold_s, 0.15, 1e-12));
}

// A key struck again holds both notes; what nobody lets go ends with the file.
TEST(Midi, EndsWhatIsForgotten) {
  expect_notes(file_of({0, 100}, {bytes({0, 0x90, 60, 64, 20, 60, 65, 40, 62, 66, 40, 62, 0})}),
               {{0, 0.5, 60, 64}, {0.1, 0.4, 60, 65}, {0.3, 0.2, 62, 66}});
}

// Where one note ends as another begins, a bow goes on if the other begins first, and is lifted if not.
TEST(Midi, KeepsTheOrderOfMessagesAtOneTime) {
  const std::string on = bytes({20, 0x90, 62, 64}), off = bytes({20, 0x80, 60, 0});
  const auto now = [](std::string message) { return message.replace(0, 1, 1, '\0'); };
  for (const bool is_legato : {true, false}) {
    const std::string middle = is_legato ? on + now(off) : off + now(on);
    const auto song =
        parse_midi(file_of({0, 100}, {bytes({0, 0x90, 60, 64}) + middle + bytes({20, 0x80, 62, 0})}), "a");
    std::vector<Note> notes;
    for (const MidiNote& note : song.notes)
      notes.push_back({note.time_s, note.key, note.velocity, note.key_hold_s, 0, note.begins, note.ends});
    NoteTrack track(notes, 44100);
    std::vector<std::pair<int, bool>> played;
    while (const auto* change = track.next_until(44100)) played.emplace_back(change->strike->key, change->is_end);
    const std::pair begins{62, false}, ends{60, true};
    EXPECT_EQ(played, (std::vector<std::pair<int, bool>>{
                          {60, false}, is_legato ? begins : ends, is_legato ? ends : begins, {62, true}}));
  }
}

TEST(Midi, LeavesOutDrumsAndAllThatIsNoNote) {
  expect_notes(file_of({0, 100}, {bytes({0,   0x99, 36,   99,   0,    0xc0, 5, 0,    0xe0, 0,  64,  0,    0xf0, 3,
                                         1,   2,    0xf7, 0,    0xd0, 5,    0, 0xa0, 60,   1,  0,   0xff, 1,    2,
                                         'h', 'i',  0,    0xb0, 7,    100,  0, 0x90, 60,   64, 100, 60,   0})}),
               {{0, 0.5, 60, 64}});
}

TEST(Midi, PlaysTheChannelsThatAreChosen) {
  const std::string file = file_of(
      {0, 100},
      {bytes({0, 0x90, 60, 64, 0, 0x99, 36, 65, 0, 0x91, 62, 66, 50, 0x80, 60, 0, 0, 0x89, 36, 0, 0, 0x81, 62, 0})});
  const auto keys_of = [&](std::vector<int> channels) {
    std::vector<int> keys;
    for (const MidiNote& note : parse_midi(file, "probe.mid", channels).notes) keys.push_back(note.key);
    return keys;
  };
  EXPECT_EQ(keys_of({}), (std::vector{60, 62}));
  EXPECT_EQ(keys_of({2}), (std::vector{62}));
  EXPECT_EQ(keys_of({10, 1}), (std::vector{60, 36}));
}

// The wheel bends by 2 semitones to either side, on its own channel, or by the range that parameter 0 sets; a place
// where it already is changes nothing.
TEST(Midi, FollowsThePitchWheel) {
  const auto song = parse_midi(
      file_of({0, 100},
              {bytes({0, 0xe0, 0,   0x60, 0,  0x90, 60, 64, 10, 60,   0,  0,    0xe0, 0,    0x60,  // half up
                      0, 0xe0, 0,   0,    20, 0x91, 61, 64, 10, 0xe1, 0,  0,                       // in a note
                      0, 0xb0, 101, 0,    0,  100,  0,  0,  6,  12,   10, 0xe0, 0,    0x40, 0,    0x81, 61, 0})}),
      "probe.mid");
  const std::vector<MidiBend> expected = {
      {0, 0, 100, false}, {0.05, 0, -200, false}, {0.2, 1, -200, true}, {0.2, 0, -1200, false}, {0.25, 0, 0, false}};
  ASSERT_EQ(song.bends.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_TRUE(within(song.bends[i].time_s, expected[i].time_s, 1e-12)) << i;
    EXPECT_EQ(song.bends[i].channel, expected[i].channel) << i;
    EXPECT_EQ(song.bends[i].cents, expected[i].cents) << i;
    EXPECT_EQ(song.bends[i].in_note, expected[i].in_note) << i;
  }
  ASSERT_EQ(song.notes.size(), 2u);
  EXPECT_EQ(song.notes[0].channel, 0);
  EXPECT_EQ(song.notes[1].channel, 1);
}

// The name (type 3) that comes first in the first track: not another text, nor a later name, nor that of another
// track.
TEST(Midi, IsCalledAsItsFirstTrack) {
  const auto text = [](int type, const std::string& words) {
    return bytes({0, 0xff, type, static_cast<int>(words.size())}) + words;
  };
  const std::string note = bytes({0, 0x90, 60, 64, 100, 60, 0});
  const auto title_of = [](const std::vector<std::string>& tracks) {
    return parse_midi(file_of({0, 100}, tracks), "probe").title;
  };
  EXPECT_EQ(title_of({text(1, "by") +
                          text(3,
                               "a\7\xff"
                               "b") +
                          text(3, "later"),
                      text(3, "other") + note}),
            "a??b");
  EXPECT_EQ(title_of({text(1, "by"), text(3, "other") + note}), "");
  EXPECT_EQ(title_of({note + text(3, "late")}), "late");
}

}  // namespace
}  // namespace contactspline::testing
