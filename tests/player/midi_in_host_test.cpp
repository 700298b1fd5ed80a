// SPDX-License-Identifier: MIT
// A MIDI file sounds as its messages do in a host.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "contactspline/host/engine.hpp"
#include "contactspline/host/hosted.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/player/instrument_parts.hpp"
#include "generator/player/instrument_score_reader.hpp"
#include "generator/player/score_player.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "support/compare.hpp"
#include "support/midi_files.hpp"

namespace contactspline::testing {
namespace {

using namespace midi;

constexpr double kRate_hz = 44100;

// The piano of a host, to which the messages are sent when their time has come.
std::vector<double> hosted_sound(const std::shared_ptr<const Score>& score, const Events& messages,
                                 std::size_t samples) {
  const NamedText piano = shipped_piano();
  KeyboardParts parts = keyboard_parts(parse_keyboard(piano.text, piano.file), score);
  parts.max_modes = 4096;
  Hosted<double> hosted(Engine<double>::keyboard(std::make_shared<const KeyboardParts>(std::move(parts))));
  hosted.prepare(kRate_hz);
  const double full_scale = hosted.instrument().outputs().front().full_scale;
  std::vector<double> sound;
  const auto play_to = [&](std::size_t sample) {
    std::vector<double> left(sample - sound.size() / 2), right(left.size());
    const std::array outputs = {left.data(), right.data()};
    hosted.process(std::span<double* const>(outputs), left.size());
    for (std::size_t n = 0; n < left.size(); ++n)
      sound.insert(sound.end(), {full_scale * left[n], full_scale * right[n]});
  };
  for (const auto& [tick, message] : messages) {
    play_to(static_cast<std::size_t>(std::llround(tick * kRate_hz / kSecond)));
    hosted.midi({reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
  }
  play_to(samples);
  return sound;
}

// Tunings, a bend, fine velocities, releases, pedals and silence. Samples of files are kept in single precision.
TEST(MidiInHost, SoundsAsItsFileDoes) {
  const std::string tuned_key = bytes({0x7f, 0x7f, 8, 2, 0, 1, 64, 64, 0x40, 0});
  const auto messages = [&](const std::string& tuning) {
    return followed_by(registered(0), {{0, controller(6, 0)},
                                       {0, controller(38, 50)},
                                       {0, wheel(16383)},
                                       {0, tuning},
                                       {0, controller(88, 64)},
                                       {0, on(60, 40)},
                                       {0, on(64)},
                                       {80, off(60, 0, 127)},
                                       {100, controller(64, 100)},
                                       {100, off(64, 0, 1)},
                                       {150, controller(64, 30)},
                                       {180, on(60)},
                                       {200, controller(120, 0)},
                                       {200, controller(64, 0)},
                                       {220, on(64)},
                                       {240, off(64, 0, 1)}});
  };
  const auto score =
      std::make_shared<const Score>(parse_midi_score(file(track(messages(exclusive(tuned_key)))), "probe.mid"));
  PlayOptions options{kRate_hz};
  choose_best_output(*score, options);
  const Performance performance = play(*score, options, [](double) {});
  const std::vector<double> sound(performance.samples.begin(), performance.samples.end());
  const std::vector<double> expected =
      hosted_sound(score, messages(bytes({0xf0}) + tuned_key + bytes({0xf7})), sound.size() / 2);
  EXPECT_TRUE(sequences_within<double>(sound, expected, 1e-6));
}

// Of their whole ranges, 0 to 5 N and 0 to 1 m/s.
TEST(MidiInHost, PressureAndBreathMoveABow) {
  const InstrumentModel violin =
      parse_instrument(find_embedded(Shipped::kInstruments, "violin.json")->content, "violin.json");
  // Bank select moves nothing; after a reset the pressure is as at first, 0.5 N.
  const Events messages = {
      {0, controller(0, 0)}, {0, bytes({0xd0, 32})}, {0, controller(2, 127)}, {0, on(62)}, {kSecond, off(62)}};
  const Score score = parse_midi_on_instrument(file(track(messages)), "song.mid", {}, violin);
  const InstrumentArrays arrays = arrays_of(violin, kRate_hz / 2);
  Hosted<double> hosted(Engine<double>::network(arrays.view()));
  hosted.prepare(kRate_hz);
  for (const auto& [tick, message] : messages)
    hosted.midi({reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
  const std::vector<Glide>& glides = score.voices.front().glides;
  ASSERT_EQ(glides.size(), 2U);
  for (const auto& [parameter, value] : {std::pair<std::size_t, double>(0, 5 * 32 / 127.0), {1, 1}}) {
    EXPECT_EQ(glides[parameter].control, parameter);
    EXPECT_DOUBLE_EQ(glides[parameter].to, value);
    EXPECT_DOUBLE_EQ(hosted.target(parameter), value);
  }
  const std::string reset = controller(121, 0);
  hosted.midi({reinterpret_cast<const std::uint8_t*>(reset.data()), reset.size()});
  EXPECT_EQ(hosted.target(0), 0.5);
  const Events with_reset = {{0, reset}, {0, on(62)}, {kSecond, off(62)}};
  const Score again = parse_midi_on_instrument(file(track(with_reset)), "song.mid", {}, violin);
  ASSERT_FALSE(again.voices.front().glides.empty());
  for (const Glide& glide : again.voices.front().glides)
    if (glide.control == 0) {
      EXPECT_EQ(glide.to, 0.5);
    }
}

// Counted from 0; a number without a preset changes nothing. Parameters that a preset does not name go back, but for
// the pedal, which stays down, and the bend.
TEST(MidiInHost, ProgramsArePresets) {
  const InstrumentModel guitar =
      parse_instrument(find_embedded(Shipped::kInstruments, "lap_steel.json")->content, "lap_steel.json");
  const InstrumentArrays arrays = arrays_of(guitar, kRate_hz / 2);
  Hosted<double> hosted(Engine<double>::network(arrays.view()));
  hosted.prepare(kRate_hz);
  Events messages = {{0, wheel(16383)}, {0, controller(64, 127)}};
  for (const int program : {2, 1, 3, 4, 127}) messages.emplace_back(0, bytes({0xc0, program}));
  for (const auto& [tick, message] : messages)
    hosted.midi({reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
  const Score score =
      parse_midi_on_instrument(file(track(followed_by(messages, midi::kNote))), "song.mid", {}, guitar);
  const std::size_t sustain = guitar.keys.sustain, bend = guitar.keys.bend;
  std::vector<double> ends(guitar.parameters.size());
  std::vector<std::size_t> moves(ends.size());
  for (const Glide& glide : score.voices.front().glides)
    if (glide.time_s == 0) ends[glide.control] = glide.to, ++moves[glide.control];
  for (std::size_t p = 0; p < ends.size(); ++p) {
    EXPECT_EQ(moves[p], p == sustain || p == bend ? 1u : 3u) << p;
    if (p == bend) continue;
    EXPECT_EQ(ends[p], p == sustain ? 1 : guitar.presets[3].values[p]) << p;
    EXPECT_EQ(hosted.target(p), ends[p]) << p;
  }
  EXPECT_NEAR(ends[bend], 200 * 8191 / 8192.0, 1e-9);
  EXPECT_NE(guitar.presets[3].values, guitar.presets[1].values);
}

// A channel that plays nothing chooses no preset, unless it is the first one of an MPE zone.
TEST(MidiInHost, ProgramsAreOfChannelsThatPlay) {
  const InstrumentModel guitar =
      parse_instrument(find_embedded(Shipped::kInstruments, "lap_steel.json")->content, "lap_steel.json");
  const auto moves = [&](const Events& before) {
    const Events note = {{0, on(60, 90, 1)}, {kSecond, off(60, 1)}};
    return parse_midi_on_instrument(file(track(followed_by(before, note))), "song.mid", {}, guitar)
        .voices.front()
        .glides.size();
  };
  const std::size_t all = guitar.parameters.size() - 2;
  EXPECT_EQ(moves({{0, bytes({0xc1, 1})}}), all);
  EXPECT_EQ(moves({{0, bytes({0xc0, 1})}, {0, bytes({0xc4, 2})}}), 0u);
  const Events zone = followed_by(registered(6), {{0, controller(6, 3)}});
  EXPECT_EQ(moves(followed_by(zone, {{0, bytes({0xc0, 1})}})), all);
  EXPECT_EQ(moves(followed_by(zone, {{0, bytes({0xc4, 1})}})), 0u);
}

// Channels that bend have voices of their own: one's pressure does not press the bow of the other.
TEST(MidiInHost, PressureIsOfItsChannel) {
  const InstrumentModel violin =
      parse_instrument(find_embedded(Shipped::kInstruments, "violin.json")->content, "violin.json");
  const Events messages = {{0, wheel(9000, 0)},     {0, wheel(9000, 1)},   {0, on(62, 90, 0)},   {0, on(69, 90, 1)},
                           {1, bytes({0xd1, 127})}, {kSecond, off(62, 0)}, {kSecond, off(69, 1)}};
  const Score score = parse_midi_on_instrument(file(track(messages)), "song.mid", {}, violin);
  ASSERT_EQ(score.voices.size(), 2U);
  const auto presses = [&](std::size_t voice) {
    return std::ranges::count(score.voices[voice].glides, 0U, &Glide::control);
  };
  EXPECT_EQ(presses(0), 0);
  EXPECT_EQ(presses(1), 1);
}

}  // namespace
}  // namespace contactspline::testing
