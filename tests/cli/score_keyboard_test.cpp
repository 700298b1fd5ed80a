// SPDX-License-Identifier: MIT
// render with a keyboard on its body: the piano of the runtime, with its pedals.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "program.hpp"
#include "render_score.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"
#include "support/damped_treble.hpp"
#include "support/measured.hpp"
#include "two_bridges.hpp"

namespace contactspline::testing {
namespace {

using Piano = KeyboardInstrument<keyboards::piano, double>;

/// A keyboard of the runtime in stereo, played to a sample before something happens.
template <typename Keyboard>
struct Played {
  void play_to(std::size_t sample) {
    std::vector<double> left(sample - sound.size() / 2), right(left.size());
    piano.process(left, right);
    for (std::size_t n = 0; n < left.size(); ++n) sound.insert(sound.end(), {left[n], right[n]});
  }

  Keyboard piano{kRate, 4096};
  std::vector<double> sound = {};
};

template <typename Keyboard>
using Acts = std::vector<std::pair<double, std::function<void(Keyboard&)>>>;

/// Its sound with acts at their times [s].
template <typename Keyboard>
std::vector<double> played(const Acts<Keyboard>& events, double end_s) {
  const auto at = [](double time_s) { return static_cast<std::size_t>(std::llround(time_s * kRate)); };
  Played<Keyboard> one;
  for (const auto& [time_s, act] : events) one.play_to(at(time_s)), act(one.piano);
  one.play_to(at(end_s));
  return one.sound;
}

// A score and a MIDI file on the piano's soundboard are what the piano of the runtime, as plug-ins play it, makes of
// the same events: every pedal, a half pedal, a string that is bent. The header holds the numbers of the board to 13
// digits.
TEST(ScoreKeyboard, PlaysTheKeyboardInstrument) {
  const auto at = [](double time_s) { return static_cast<std::size_t>(std::llround(time_s * kRate)); };
  const double tick_s = 0.5 / 96;
  Acts<Piano> events = {{0, [](Piano& p) { p.una_corda(1), p.note_on(60, 64 / 127.0); }},
                        {10 * tick_s, [](Piano& p) { p.una_corda(40 / 64.0), p.note_on(36, 90 / 127.0); }},
                        {20 * tick_s, [](Piano& p) { p.sustain(1), p.note_off(60); }},
                        {30 * tick_s, [](Piano& p) { p.sostenuto(true), p.note_on(60, 1); }},
                        {40 * tick_s, [](Piano& p) { p.note_off(36); }},
                        {60 * tick_s, [](Piano& p) { p.sustain(0); }}};
  for (double step_s = 0; step_s < 0.01; step_s += 16 / kRate)  // of the 10 ms in which the string follows the wheel
    events.emplace_back(70 * tick_s + step_s, [=](Piano& p) {
      const double part = step_s * kRate / 441;
      for (const unsigned key : {15u, 39u}) p.bend(key, 100 * part * part * (3 - 2 * part));
    });
  events.emplace_back((static_cast<double>(at(70 * tick_s)) + 448) / kRate,
                      [](Piano& p) { p.bend(15, 100), p.bend(39, 100); });
  events.emplace_back(120 * tick_s, [](Piano& p) { p.sostenuto(false), p.note_off(60); });
  const auto midi = played<Piano>(events, 120 * tick_s + 1);
  const std::string bytes(
      "\0\xb0\x43\x7f\0\x90\x3c\x40\x0a\xb0\x43\x28\0\x90\x24\x5a\x0a\xb0\x40\x64\0\x80\x3c\0\x0a\xb0\x42\x7f\0"
      "\x90\x3c\x7f\x0a\x80\x24\0\x14\xb0\x40\0\x0a\xe0\0\x60\x32\xb0\x42\0\0\x80\x3c\0",
      52);
  expect_is(sound_of_midi(bytes), midi);
  const auto score = played<Piano>({{0.01, [](Piano& p) { p.una_corda(0.5); }},
                                    {0.02,
                                     [](Piano& p) {
                                       p.strike_at(67, 0.004);
                                       p.set_hammers(2, {0.5, 0.2});
                                       p.strike(67, 3);
                                       p.set_hammers(1, {1, 0.1});
                                       p.press(12);
                                       p.strike(19, 2);
                                     }},
                                    {0.1, [](Piano& p) { p.release(67), p.damp(19, 30); }},
                                    {0.2, [](Piano& p) { p.sostenuto(true), p.release(12); }}},
                                   0.3);
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  const std::string text = fmt::format(
      R"({{ "instrument": "piano", "duration_s": 0.3, "events": [
    {{ "time_s": 0.1, "key": 40, "damping_per_s": 30 }}, {{ "time_s": 0.02, "key": 40, "speed_m_per_s": 2 }},
    {{ "time_s": 0.02, "key": 88, "speed_m_per_s": 3, "hold_s": 0.08, "strike_m": 0.004, "hammer_mass_kg": {},
      "stiffness_ratio": 0.5, "loss_s_per_m": 0.2 }},
    {{ "time_s": 0.01, "una_corda": 0.5 }}, {{ "time_s": 0.02, "key": 33, "hold_s": 0.18 }},
    {{ "time_s": 0.2, "sostenuto": 1 }} ] }})",
      2 * note_of(keyboard, 88).hammer_mass_kg);
  const Sound sound = sound_of(text);
  EXPECT_EQ(sound.channels, 2);
  expect_is(sound, score);
  expect_is(sound_of(text, {"--precision", "single"}), score, 1e-3);
}

// Keys that end along two bridges of a ribbed board: a score with the file of the example is what the emitted struct
// makes of the same events, with keys at both bridges and the pedal.
TEST(ScoreKeyboard, PlaysAlongTwoBridges) {
  using Bridges = KeyboardInstrument<keyboards::two_bridges, double>;
  EXPECT_EQ(keyboards::two_bridges::body::places, 8u);
  const auto expected = played<Bridges>(
      {{0.01, [](Bridges& p) { p.sustain(1); }},
       {0.02, [](Bridges& p) { p.strike(7, 3), p.strike(24, 2), p.strike(49, 2.5), p.strike(79, 3); }},
       {0.1, [](Bridges& p) { p.release(7), p.release(24), p.release(49), p.release(79); }},
       {0.2, [](Bridges& p) { p.sustain(0); }}},
      0.3);
  const fs::path folder = fs::path(SOURCE_FOLDER) / "examples/keyboards";
  const Files files = {{"two_bridges.json", read_file(folder / "two_bridges.json")},
                       {"ribbed_board.json", read_file(folder / "ribbed_board.json")}};
  const std::string text = R"({ "instrument": "two_bridges.json", "duration_s": 0.3,
    "events": [ { "time_s": 0.01, "sustain": 1 }, { "time_s": 0.2, "sustain": 0 },
      { "time_s": 0.02, "key": 28, "speed_m_per_s": 3, "hold_s": 0.08 },
      { "time_s": 0.02, "key": 45, "speed_m_per_s": 2, "hold_s": 0.08 },
      { "time_s": 0.02, "key": 70, "speed_m_per_s": 2.5, "hold_s": 0.08 },
      { "time_s": 0.02, "key": 100, "speed_m_per_s": 3, "hold_s": 0.08 } ] })";
  expect_is(sound_alone(text, files), expected);
}

// Energy of the left channel from one time to another.
double energy_of(const Sound& sound, double from_s, double to_s) {
  double energy = 0;
  for (auto n = static_cast<std::size_t>(from_s * kRate); n < static_cast<std::size_t>(to_s * kRate); ++n)
    energy += std::pow(sound.samples[2 * n], 2);
  return energy;
}

// C4 for 2.4 s, with the soft pedal up and down.
TEST(ScoreKeyboard, PlaysUnaCorda) {
  const auto sound = [](char soft) {
    std::string events("\0\xb0\x43\0\0\x90\x3c\x40\x83\x60\x80\x3c\0", 13);
    events[3] = soft;
    return sound_of_midi(events, {"--gain", "20"});
  };
  const Sound up = sound(0), half = sound(32), down = sound(127);
  const auto pitch_hz = [](const Sound& of) {
    std::vector<double> left;
    for (std::size_t i = 0; i < of.samples.size(); i += 2) left.push_back(of.samples[i]);
    return frequency_near(left, 261.8);
  };
  // The strings are within 0.9 cents of each other; the two that are struck beside the one that is not, too.
  EXPECT_TRUE(within(1200 * std::log2(pitch_hz(down) / pitch_hz(up)), 0, 0.9));
  const auto level_db = [&](const Sound& of) {
    return 10 * std::log10(energy_of(of, 0, 0.3) / energy_of(up, 0, 0.3));
  };
  Measured() << "half down " << level_db(half) << " dB, down " << level_db(down) << " dB";
  EXPECT_LT(level_db(down), level_db(half) - 1);
  EXPECT_LT(level_db(half), -0.2);
  EXPECT_GT(level_db(down), -6);
}

// C3 is held down without a sound while C4 is struck and damped: its second partial rings on. Half down, the sustain
// pedal lets C4 decay in between.
TEST(ScoreKeyboard, RingsInSympathyAndByHalfPedal) {
  const auto energy = [](const std::string& first_event) {
    return energy_of(sound_alone(R"({ "instrument": "piano", "duration_s": 1.1, "events": [
      { "time_s": 0.01, "key": 60, "speed_m_per_s": 3, "hold_s": 0.1 }, )" +
                                     first_event + damped_treble(keyboards::piano::last_damped_key + 1, 108) + " ] }",
                                 {}, {"--gain", "20"}),
                     0.6, 1);
  };
  const double damped = energy(R"({ "time_s": 0, "key": 48, "damping_per_s": 0 })"),
               sympathetic = energy(R"({ "time_s": 0, "key": 48, "hold_s": 1 })"),
               half = energy(R"({ "time_s": 0, "sustain": 0.9 })"), held = energy(R"({ "time_s": 0, "sustain": 1 })");
  Measured() << "damped " << 10 * std::log10(damped / held) << " dB, C3 in sympathy "
             << 10 * std::log10(sympathetic / held) << " dB, half pedal " << 10 * std::log10(half / held) << " dB";
  EXPECT_GT(sympathetic, 1000 * damped);
  EXPECT_LT(sympathetic, 0.5 * held);
  // The mean of exp(-2 (1 - 0.9) 60/s t) from 0.5 to 0.9 s after the release; the dampers take some ms to fall.
  EXPECT_TRUE(within(10 * std::log10(half / held), 10 * std::log10((std::exp(-6.0) - std::exp(-10.8)) / 4.8), 2));
}

// A score of 0.1.0 names the kind "hammer-string" and its keyboard.
TEST(ScoreKeyboard, PlaysScoresOfTheFirstVersion) {
  const Sandbox box;
  const std::string rest = R"("duration_s": 0.1, "events": [ { "time_s": 0, "key": 60, "speed_m_per_s": 2 } ] })";
  write_file(box / "now.json", R"({ "instrument": "piano", )" + rest);
  write_file(box / "before.json", R"({ "instrument": "hammer-string", "keyboard": "piano", )" + rest);
  const auto sound = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-o", "sound.wav", "--no-figure"});
    EXPECT_EQ(run({.arguments = arguments, .folder = box.path()}).exit_code, 0);
    return read_file(box / "sound.wav");
  };
  const std::string now = sound({"render", "now.json"});
  EXPECT_EQ(sound({"render", "before.json"}), now);
  EXPECT_EQ(sound({"render", "hammer-string", "--score", "before.json"}), now);
}

// Beside the body there are no pedals but the sustain pedal of MIDI files, which holds notes.
TEST(ScoreKeyboard, SaysWhichPedalsAreLeftOut) {
  const Sandbox box;
  const std::string note("\0\x90\x3c\x40\x60\x80\x3c\0", 8);
  write_file(box / "soft.mid", midi_file(std::string("\0\xb0\x43\x7f", 4) + note));
  write_file(box / "half.mid", midi_file(std::string("\0\xb0\x40\x20", 4) + note));
  write_file(box / "held.mid", midi_file(std::string("\0\xb0\x40\x7f", 4) + note));
  write_file(box / "score.json", R"({ "instrument": "piano", "duration_s": 0.1,
    "events": [ { "time_s": 0, "sustain": 1 }, { "time_s": 0, "key": 60, "speed_m_per_s": 1 } ] })");
  const std::string why = ": left out, because only the keys on their body have them: ";
  for (const auto& [file, says] : {std::pair{"soft.mid", "half pedal, sostenuto and soft pedal"},
                                   {"half.mid", "half pedal, sostenuto and soft pedal"},
                                   {"held.mid", ""},
                                   {"score.json", "pedals"}})
    for (const std::string signal : {"body", "bridge"}) {
      const auto outcome =
          run({.arguments = {"render", "--score", file, "--signal", signal, "--no-figure", "-o", "a.wav"},
               .folder = box.path()});
      EXPECT_EQ(outcome.exit_code, 0);
      EXPECT_EQ(outcome.err, signal == "body" || *says == 0 ? "" : "contactspline: " + (file + why) + says + "\n");
    }
}

// A body that is silent at this rate is named. Of a keyboard beside the score.
TEST(ScoreKeyboard, RefusesABodyThatCannotSound) {
  const Sandbox box;
  std::string keyboard = shipped(embedded_files(Shipped::kKeyboards), "piano");
  keyboard.replace(keyboard.find("\"soundboard\""), 12, "\"board.json\"");
  write_file(box / "piano.json", keyboard);
  write_file(box / "board.json", R"({ "name": "board", "modes": [
    { "frequency_hz": 30000, "decay_per_s": 5, "mass_kg": 1, "strike_shape": 1, "pickup_shape": 1 } ] })");
  write_file(box / "probe.json", R"({ "instrument": "piano.json", "duration_s": 0.1,
    "events": [ { "time_s": 0.01, "key": 60, "speed_m_per_s": 3 } ] })");
  const auto before = box.listing();
  expect_refused(run({.arguments = {"render", "--score", "probe.json", "-o", "a.wav"}, .folder = box.path()}),
                 "--rate: no mode of board lies below 22050 Hz", "allowed: a higher rate");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  for (const auto& [name, wrong] :
       {std::pair{"felt_c4", "'felt_c4' is a material"}, {"bord", "'bord' does not ship"}}) {
    std::string other = keyboard;
    other.replace(other.find("board.json"), 10, name);
    write_file(box / "piano.json", other);
    expect_refused(run({.arguments = {"render", "--score", "probe.json", "-o", "a.wav"}, .folder = box.path()}),
                   std::string("piano.json: keyboard.body.resonator: ") + wrong, "allowed: a .json file, drum_head");
  }
}

}  // namespace
}  // namespace contactspline::testing
