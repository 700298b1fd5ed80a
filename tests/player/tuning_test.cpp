// SPDX-License-Identifier: MIT
// Scales of Scala: the pitch of every key that a file of MIDI and a host play is that of the closed form.
#include "generator/player/tuning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "contactspline/host/tuned_keys.hpp"
#include "contactspline/midi/temperament.hpp"
#include "generator/player/midi_reader.hpp"
#include "player/tunings.hpp"
#include "support/compare.hpp"
#include "support/midi_files.hpp"

namespace contactspline::testing {
namespace {

using namespace midi;

constexpr MidiSettings kPiano{.first_key = 21, .last_key = 108, .max_cents = 1200};
constexpr double kPitch = 0.1;  // cents

Tuning tuning_of(const TuningCase& tuned) {
  const auto text = [](const std::string& of) {
    return of.empty() ? std::nullopt : std::optional(TuningText{of, "probe"});
  };
  return {text(tuned.scale), text(tuned.keymap), tuned.a4_hz};
}

// Cents above C, as books give them; just intonation by its ratios.
TEST(Temperaments, AreThePublishedOnes) {
  const auto just = [](double a, double b) { return 1200 * std::log2(a / b); };
  const std::map<std::string, std::array<double, 12>> published = {
      {"equal", {0, 100, 200, 300, 400, 500, 600, 700, 800, 900, 1000, 1100}},
      {"Pythagorean",
       {0, 113.685, 203.910, 294.135, 407.820, 498.045, 611.730, 701.955, 815.640, 905.865, 996.090, 1109.775}},
      {"meantone, a quarter of a comma",
       {0, 76.049, 193.157, 310.265, 386.314, 503.422, 579.471, 696.578, 772.627, 889.735, 1006.843, 1082.892}},
      {"just",
       {0, just(16, 15), just(9, 8), just(6, 5), just(5, 4), just(4, 3), just(45, 32), just(3, 2), just(8, 5),
        just(5, 3), just(9, 5), just(15, 8)}},
      {"Werckmeister III",
       {0, 90.225, 192.180, 294.135, 390.225, 498.045, 588.270, 696.090, 792.180, 888.270, 996.090, 1092.180}},
      {"Kirnberger III",
       {0, 90.225, 193.157, 294.135, 386.314, 498.045, 590.224, 696.578, 792.180, 889.735, 996.090, 1088.269}},
      {"Vallotti",
       {0, 94.135, 196.090, 298.045, 392.180, 501.955, 592.180, 698.045, 796.090, 894.135, 1000, 1090.225}},
      {"Young",
       {0, 90.225, 196.090, 294.135, 392.180, 498.045, 588.270, 698.045, 792.180, 894.135, 996.090, 1090.225}}};
  ASSERT_EQ(kTemperaments.size(), published.size());
  for (const Temperament& temperament : kTemperaments) {
    SCOPED_TRACE(temperament.name);
    const auto& expected = published.at(temperament.name);
    for (std::size_t tonic = 0; tonic < 12; ++tonic) {
      const KeyCents keys = tempered_keys(temperament, tonic, 415);
      EXPECT_TRUE(within(keys[69], 1200 * std::log2(415 / 440.0), 1e-9));
      for (std::size_t key = 60 + tonic; key < 72 + tonic; ++key) {
        const double above = 100.0 * static_cast<double>(key - 60 - tonic) + keys[key] - keys[60 + tonic];
        EXPECT_TRUE(within(above, expected[key - 60 - tonic], 6e-4)) << key;
      }
    }
    // The fifths close the circle.
    double sum = 0;
    for (std::size_t fifth = 0; fifth < 12; ++fifth)
      sum += kPythagoreanComma_cents * temperament.of_pythagorean[fifth] +
             kSyntonicComma_cents * temperament.of_syntonic[fifth];
    EXPECT_TRUE(within(sum, kPythagoreanComma_cents, 1e-9));
  }
}

double cents_between(double hz, double expected_hz) {
  return 1200 * std::log2(hz / expected_hz);
}
double hz_of(int key, double cents) {
  return 440 * std::exp2((key - 69) / 12.0 + cents / 1200);
}

class Tunings : public ::testing::TestWithParam<TuningCase> {};

TEST_P(Tunings, ArePitchesOfTheClosedForm) {
  const KeyCents cents = key_cents(tuning_of(GetParam()));
  for (int key = 0; key < 128; ++key) {
    const double expected = GetParam().hz(key), found = cents[static_cast<std::size_t>(key)];
    ASSERT_EQ(std::isnan(found), std::isnan(expected)) << key;
    if (std::isnan(found)) continue;
    EXPECT_TRUE(within(cents_between(hz_of(key, found), expected), 0, 1e-5)) << key;
  }
}

// Of each key: the key of the piano that plays it and the cents by which its strings are tuned.
TEST_P(Tunings, ReachTheStringsThatAFileOfMidiPlays) {
  Events events;
  std::vector<int> sounding;
  for (int key = 0; key < 128; ++key) {
    events.insert(events.end(), {{key * 10, on(key)}, {key * 10 + 5, off(key)}});
    if (!std::isnan(GetParam().hz(key))) sounding.push_back(key);
  }
  const MidiSong song =
      parse_midi(file(track(events)), "probe.mid", {}, tuned(kPiano, key_cents(tuning_of(GetParam()))));
  EXPECT_EQ(song.unmapped, 128 - sounding.size());
  ASSERT_EQ(song.notes.size(), sounding.size());
  for (std::size_t n = 0; n < sounding.size(); ++n) {
    const MidiNote& note = song.notes[n];
    EXPECT_TRUE(within(cents_between(hz_of(note.key, note.cents), GetParam().hz(sounding[n])), 0, kPitch))
        << sounding[n];
    const bool is_on_piano =
        GetParam().hz(sounding[n]) > hz_of(21, -50) && GetParam().hz(sounding[n]) < hz_of(108, 50);
    EXPECT_TRUE(!is_on_piano || std::abs(note.cents) <= 200) << sounding[n];
  }
}

// What a host without MIDI does at a note: it bends the key that plays it, then strikes it.
TEST_P(Tunings, ReachTheKeysOfAHost) {
  TunedKeys keys;
  keys.tune(tuned(kPiano, key_cents(tuning_of(GetParam()))));
  for (std::size_t key = 0; key < 128; ++key) {
    std::vector<TimedEvent> played;
    const auto keep = [&](const TimedEvent& event) { played.push_back(event); };
    const double expected = GetParam().hz(static_cast<int>(key));
    keys.take({0, Action::kNoteOn, key, 0.5}, keep);
    ASSERT_EQ(played.size(), std::isnan(expected) ? 0u : 2u);
    keys.take({0, Action::kNoteOff, key}, keep);
    if (std::isnan(expected)) continue;
    EXPECT_EQ(played[0].action, Action::kBendKey);
    EXPECT_TRUE(
        within(cents_between(hz_of(static_cast<int>(played[0].number), played[0].value), expected), 0, kPitch));
    for (const TimedEvent& event : played) EXPECT_EQ(event.number, played[0].number);
    EXPECT_EQ(played.back().action, Action::kNoteOff);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Tunings, ::testing::ValuesIn(tunings::all()),
                         [](const auto& tuned) { return tuned.param.test; });

// On an instrument with another pitch of its own, a stated pitch stays what it is, and a scale alone moves with it.
TEST(TuningOfInstruments, StartsAtTheirOwnPitchUnlessOneIsStated) {
  const double own_hz = 435, own = cents_between(own_hz, 440);
  const Tuning just{TuningText{tunings::kJustScale, "just.scl"}};
  EXPECT_TRUE(sequences_within<double>(key_cents(just, own_hz), key_cents(just), 0));
  const KeyCents stated = key_cents({.a4_hz = 442}, own_hz);
  for (const double cents : stated) EXPECT_TRUE(within(cents + own, cents_between(442, 440), 1e-9));
}

// Two keys that one string plays: it is damped when both are let go. A bend is added to the tuning.
TEST(TunedKeysOfHosts, ShareStringsAndBend) {
  TunedKeys keys;
  keys.tune(tuned(kPiano, key_cents({TuningText{tunings::equal(53, 1200, "2"), "probe"}})));
  std::vector<TimedEvent> played;
  const auto keep = [&](const TimedEvent& event) { played.push_back(event); };
  for (const std::size_t key : {100u, 101u}) keys.take({0, Action::kNoteOn, key, 0.5}, keep);
  ASSERT_EQ(played.size(), 4u);
  EXPECT_EQ(played[0].number, played[2].number);
  keys.take({0, Action::kBendKey, 101, 30}, keep);
  EXPECT_TRUE(within(played.back().value, played[2].value + 30, 1e-9));
  const std::size_t before = played.size();
  keys.take({0, Action::kNoteOff, 100}, keep);
  EXPECT_EQ(played.size(), before);
  keys.take({0, Action::kNoteOff, 101}, keep);
  EXPECT_EQ(played.size(), before + 1);
}

// A tuning message goes on from the table, and a reset brings the table back.
TEST(TunedMidi, GoesOnFromItsTable) {
  KeyCents table{};
  table[60] = 20, table[61] = tunings::kGap;
  MidiInterpreter midi(tuned(kPiano, table));
  std::vector<double> cents;
  const auto play = [&](const std::string& message) {
    midi.take({reinterpret_cast<const std::uint8_t*>(message.data()), message.size()}, [&](const MidiEvent& event) {
      if (event.kind == MidiEvent::Kind::kNoteOn) cents.push_back(event.cents);
    });
  };
  for (const std::string& message :
       {on(60), on(61), bytes({0xf0, 0x7f, 0x7f, 8, 2, 0, 2, 60, 60, 0x40, 0, 61, 61, 0x40, 0, 0xf7}), on(60), on(61),
        bytes({0xff}), on(60), on(61)})
    play(message);
  EXPECT_TRUE(sequences_within<double>(cents, std::vector<double>{20, 50, 50, 20}, 1e-9));
}

// What is held, above the pitch of its key: by a table, wheels and hosts that name notes, until it ends.
TEST(TunedMidi, TellsWhatIsHeld) {
  KeyCents table{};
  table[60] = 20, table[64] = 430;  // the keys of a piano play within a tone
  MidiInterpreter midi(tuned(kPiano, table));
  const auto nothing = [](const MidiEvent&) {};
  const auto take = [&](const std::vector<std::uint8_t>& message) { midi.take(message, nothing); };
  const auto held = [&] {
    std::vector<std::pair<int, double>> keys;
    midi.each_held([&](int key, double cents) { keys.emplace_back(key, std::round(1e6 * cents) / 1e6); });
    return keys;
  };
  using Keys = std::vector<std::pair<int, double>>;
  take({0x90, 60, 100, 64, 100});
  EXPECT_EQ(held(), (Keys{{60, 20}, {64, 430}}));
  take({0xe0, 0, 0x60});  // half of the bend range up
  EXPECT_EQ(held(), (Keys{{60, 120}, {64, 530}}));
  midi.begin({7, 3, 70}, 0.5, 10, nothing, [] {});
  midi.express({7, -1, -1}, NoteExpression::kTuning, -30, nothing);
  EXPECT_EQ(held(), (Keys{{60, 120}, {64, 530}, {70, -20}}));
  take({0x80, 60, 0});
  EXPECT_EQ(held(), (Keys{{64, 530}, {70, -20}}));
  take({0xb0, 123, 0});
  midi.end({7, -1, -1}, 0, false, nothing);
  EXPECT_EQ(held(), Keys{});
}

}  // namespace
}  // namespace contactspline::testing
