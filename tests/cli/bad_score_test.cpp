// SPDX-License-Identifier: MIT
// All the errors that a score or a MIDI file can have: one line that names file, key and what is allowed, and nothing
// written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "bad_input.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

const std::string kBlow = R"({
  "instrument": "piano",
  "description": "a probe",
  "duration_s": 0.05,
  "events": [
    { "time_s": 0.01, "key": 60, "speed_m_per_s": 2.5, "hold_s": 0.02, "over_s": 0.015, "hammer_mass_kg": 0.003,
      "stiffness_ratio": 1.5, "loss_s_per_m": 0.3, "damping_per_s": 4, "strike_m": 0.08, "bend_cents": 5 }
  ]
})";
const std::string kKeys = R"({
  "instrument": "piano",
  "duration_s": 0.05,
  "events": [ { "time_s": 0.01, "key": 60, "speed_m_per_s": 2.5 },
              { "time_s": 0, "over_s": 0.02, "sustain": 0.75, "sostenuto": 1, "una_corda": 0.4 } ]
})";
const Bases kBases = {{"blow", kBlow}, {"keys", kKeys}};

std::vector<BadFile> long_cases() {
  return {{"truncated", kBlow.substr(0, kBlow.size() / 2), "line ", "; allowed: "},
          {"large", kKeys + std::string(1 << 20, ' '), "file", "is larger than 1 MiB"}};
}

Outcome render(const Sandbox& box, const std::string& score) {
  return run({.arguments = {"render", score, "-o", "sound.wav"}, .folder = box.path()});
}

class BadScoreFile : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadScoreFile, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [test, text, key, says] = GetParam();
  const Sandbox box;
  write_file(box / "probe.json", text);
  const auto before = box.listing();
  expect_refused(render(box, "probe.json"), "probe.json: " + key, says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

CONTACTSPLINE_CASES(Number, BadScoreFile, bad_numbers("score", "Number", kBases));
CONTACTSPLINE_CASES(Key, BadScoreFile, bad_files("score", "Key", kBases));
CONTACTSPLINE_CASES(Long, BadScoreFile, long_cases());

// What the tables above are made of is good itself.
TEST(GoodScoreFile, IsAccepted) {
  for (const std::string& text : {kBlow, kKeys}) {
    const Sandbox box;
    write_file(box / "probe.json", text);
    EXPECT_EQ(render(box, "probe.json").exit_code, 0) << text;
    EXPECT_TRUE(fs::exists(box / "sound.wav"));
  }
}

TEST(BadScore, IsNoNameThatShips) {
  const Sandbox box;
  expect_refused(render(box, "waltz"), "waltz: SCORE: no such score ships",
                 "allowed: a .json or .mid file, bach_prelude, buzz_line, cello_prelude");
  expect_refused(render(box, "dulcimer_jog"), "dulcimer_jog: SCORE: no such score ships",
                 "allowed: a .json or .mid file, dulcimer_jig, bach_prelude");
}

TEST(BadScore, MayBeTooFineForMemory) {
  const Sandbox box;
  write_file(box / "probe.json", changed(kKeys, "0.05", "3600"));
  expect_refused(
      run({.arguments = {"render", "--score", "probe.json", "--rate", "48000", "-o", "a.wav"}, .folder = box.path()}),
      "probe.json: duration_s: 3600 s at 48000 Hz", "allowed: at most 3308 s at this rate");
}

TEST(BadScore, MayLeaveNoSound) {
  const Sandbox box;
  write_file(box / "probe.json", changed(kKeys, "60", "108"));
  expect_refused(
      run({.arguments = {"render", "--score", "probe.json", "--rate", "8000", "-o", "a.wav"}, .folder = box.path()}),
      "--rate: no mode of voice 108 (piano) lies below 4000 Hz", "allowed: a higher rate");
}

// It is written, with one line: nothing is thrown, or the pickup stands at the end of the string.
TEST(SilentScore, IsPlayedWithAWarning) {
  const Sandbox box;
  write_file(box / "still.json", R"({ "instrument": "piano", "duration_s": 0.1,
    "events": [ { "time_s": 0, "key": 60, "damping_per_s": 1 } ] })");
  write_file(box / "node.json", R"({ "instrument": { "name": "probe",
      "bodies": [ { "name": "string", "resonator": "guitar_d3" }, { "name": "hammer", "mass_kg": 0.003 } ],
      "places": [ { "name": "struck", "body": "string", "position_m": 0.1 },
                  { "name": "end", "body": "string", "position_m": 0 } ],
      "contacts": [ { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4", "gap_m": 1e-4 } ],
      "strikes": ["hammer"], "outputs": [ { "name": "end", "velocity_m_per_s": "end" } ] },
    "duration_s": 0.1, "events": [ { "time_s": 0, "hammer_speed_m_per_s": 2 } ] })");
  for (const auto& [file, why] : {std::pair{"still.json", "nothing is struck or plucked so that it sounds"},
                                  {"node.json", "the contact or the pickup is where no mode moves"}}) {
    const Outcome outcome = run({.arguments = {"render", file, "--no-figure", "-o", "a.wav"}, .folder = box.path()});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, std::string("contactspline: ") + file + ": the sound is silent: " + why + "\n");
  }
}

TEST(BadScore, IsAFileTheOutputWouldReplace) {
  const Sandbox box;
  write_file(box / "probe.svg", kKeys);
  expect_refused(run({.arguments = {"render", "--score", "./probe.svg", "-o", "a.wav", "--figure", "probe.svg"},
                      .folder = box.path()}),
                 "probe.svg: file: is already an input or another output", "allowed: another folder or file name");
}

// A MIDI file of one track.
std::string midi(const std::string& track, const std::string& header = std::string("\0\0\0\6\0\0\0\1\0\x60", 10)) {
  std::string length(4, '\0');
  length[3] = static_cast<char>(track.size());
  return "MThd" + header + "MTrk" + length + track;
}

const std::string kNote("\0\x90\x3c\x40\x60\x3c\0", 7);
const std::string kEnd("\0\xff\x2f\0", 4);

struct BadMidi {
  std::string test, bytes, says;
};

void PrintTo(const BadMidi& bad, std::ostream* stream) {
  *stream << bad.test;
}

class BadMidiFile : public ::testing::TestWithParam<BadMidi> {};

TEST_P(BadMidiFile, IsRefusedInOneLineAndNothingIsWritten) {
  const Sandbox box;
  write_file(box / "probe.mid", GetParam().bytes);
  const auto before = box.listing();
  expect_refused(render(box, "probe.mid"), "probe.mid: ", GetParam().says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

std::vector<BadMidi> midi_cases() {
  const std::string allowed = "; allowed: a standard MIDI file of format 0, 1 or 2";
  const std::string kAbove127 = "it has no note (track 1, byte 23: left out: an event with a data byte above 127)";
  const auto header = [](const char* bytes) { return std::string("\0\0\0\6", 4) + std::string(bytes, 6); };
  const auto bytes = [](const char* data, std::size_t size) { return std::string(data, size); };
  return {
      {"empty", "", "it has no MThd at its beginning" + allowed},
      {"json", kKeys, "it has no MThd at its beginning" + allowed},
      {"only_a_header", "MThd" + header("\0\1\0\1\0\x60"), "no track follows its header, from byte 14 on" + allowed},
      {"no_track", "MThd" + header("\0\1\0\0\0\x60"), "no track follows its header, from byte 14 on" + allowed},
      {"format_3", midi(kNote + kEnd, header("\0\3\0\1\0\x60")), "byte 8: it has format 3" + allowed},
      {"no_unit_of_time", midi(kNote + kEnd, header("\0\0\0\1\0\0")), "byte 12: its unit of time is 0" + allowed},
      {"no_note", midi(kEnd), "it has no note" + allowed},
      {"only_drums", midi(bytes("\0\x99\x3c\x40", 4) + kEnd),
       "MIDI: all its notes are on channel 10, which is for drums; allowed: --channel 10 to play them as keys"},
      {"only_note_offs", midi(bytes("\0\x80\x3c\x40", 4) + kEnd), "it has no note" + allowed},
      {"key_above_127", midi(bytes("\0\x90\xbc\x40", 4) + kEnd), kAbove127 + allowed},
      {"velocity_above_127", midi(bytes("\0\x90\x3c\xc0", 4) + kEnd), kAbove127 + allowed},
      {"running_status_of_nothing", midi(bytes("\0\x3c\x40", 3) + kEnd),
       "it has no note (track 1, byte 23: left out: data without a status)" + allowed},
      {"endless_time", midi(bytes("\xff\xff\xff\xff\xff\xff\xff\x7f\x90\x3c\x40", 11) + kEnd),
       "it has no note (track 1, byte 25: a number is longer than four bytes; track 1, byte 37: the track breaks "
       "off)" +
           allowed},
      {"too_long", midi(bytes("\xff\xff\xff\x7f\x90\x3c\x40\0\x3c\0", 10) + kEnd),
       "MIDI: it lasts 1.398e+06 s; allowed: at most 3599 s"},
      {"key_beyond_the_piano", midi(bytes("\0\x90\x14\x40\x60\x14\0", 7) + kEnd),
       "MIDI: no note is on the piano; allowed: keys 21 to 108"},
      {"large", std::string((1 << 20) + 1, 'M'), "file: is larger than 1 MiB"}};
}

CONTACTSPLINE_CASES(All, BadMidiFile, midi_cases());

TEST(BadMidiChannel, IsRefused) {
  const Sandbox box;
  write_file(box / "probe.mid", midi(kNote + kEnd));
  write_file(box / "probe.json", kKeys);
  const auto play = [&](const std::string& score, const std::string& channel) {
    return run(
        {.arguments = {"render", "--score", score, "--channel", channel, "-o", "a.wav"}, .folder = box.path()});
  };
  const auto before = box.listing();
  expect_refused(play("probe.mid", "0"), "--channel: '0' is refused", "allowed: an integer from 1 to 16");
  expect_refused(play("probe.mid", "2"), "probe.mid: MIDI: no note is on channel 2", "allowed: --channel 1");
  expect_refused(play("probe.json", "1"), "probe.json: --channel: the score is not a MIDI file", "a .mid file");
  expect_refused(play("dulcimer_jig", "1"), "dulcimer_jig: --channel: the score is not a MIDI file", "a .mid file");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

// One line counts what is left out, and bends that are played as 48 semitones; the rest sounds.
TEST(GoodMidiFile, IsPlayedWithoutWhatIsBeyondThePiano) {
  const auto bytes = [](const char* data, std::size_t size) { return std::string(data, size); };
  const std::string low = bytes("\0\x90\x14\x40\0\x90\x7f\x40", 8);
  // On another channel the wheel goes to the low end of a range of 49 semitones while a note sounds.
  const std::string far = bytes("\0\xb1\x65\0\0\xb1\x64\0\0\xb1\x06\x31\0\x91\x3c\x40\0\xe1\0\0", 20);
  const Sandbox box;
  write_file(box / "clean.mid", midi(far + kNote + kEnd));
  write_file(box / "probe.mid", midi(low + low + far + kNote + kEnd));
  const Outcome outcome = run({.arguments = {"render", "--score", "probe.mid", "-o", "a.wav"}, .folder = box.path()});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err,
            "contactspline: probe.mid: MIDI: left out: notes beyond the keys 21 to 108 (4); played as 48 semitones: "
            "bends by more than that (1)\n");
  const Outcome clean = run({.arguments = {"render", "--score", "clean.mid", "-o", "b.wav"}, .folder = box.path()});
  EXPECT_EQ(clean.err, "contactspline: clean.mid: MIDI: played as 48 semitones: bends by more than that (1)\n");
  EXPECT_TRUE(read_file(box / "a.wav") == read_file(box / "b.wav"));
}

TEST(GoodMidiFile, IsAccepted) {
  const auto says = [](const std::string& what) { return "contactspline: probe.mid: MIDI: " + what + "\n"; };
  const auto bytes = [](const char* data, std::size_t size) { return std::string(data, size); };
  const std::pair<std::string, std::string> files[] = {
      {midi(kNote + kEnd), ""},
      {midi(kNote + kEnd) + "garbage behind", ""},
      {midi(kNote + kEnd).substr(0, 26), says("track 1, byte 26: the track has no end")},
      {midi(bytes("\0\xf5", 2) + kNote + kEnd),
       says("track 1, byte 23: left out: a message that has no place in a file")}};
  for (const auto& [file, line] : files) {
    const Sandbox box;
    write_file(box / "probe.mid", file);
    const Outcome outcome = render(box, "probe.mid");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, line);
  }
}

}  // namespace
}  // namespace contactspline::testing
