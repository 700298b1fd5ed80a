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

const std::string kHammer = R"({
  "instrument": "hammer-string",
  "description": "a probe",
  "duration_s": 0.05,
  "voices": [
    { "name": "a", "resonator": "string_c4", "material": "felt_c4", "tuning_cents": 3, "hammer_mass_kg": 0.003,
      "damper_per_s": 40, "pan": 0.1 }
  ],
  "events": [
    { "time_s": 0.01, "voice": "a", "speed_m_per_s": 2.5, "hold_s": 0.02, "over_s": 0.015, "stiffness_ratio": 1.5,
      "loss_s_per_m": 0.3, "damping_per_s": 4, "strike_m": 0.08, "bend_cents": 5 }
  ]
})";
const std::string kKeys = R"({
  "instrument": "hammer-string",
  "duration_s": 0.05,
  "keyboard": "piano",
  "events": [ { "time_s": 0.01, "key": 60, "speed_m_per_s": 2.5 },
              { "time_s": 0, "over_s": 0.02, "sustain": 0.75, "sostenuto": 1, "una_corda": 0.4 } ]
})";
const std::string kSlide = R"({
  "instrument": "slide-string",
  "duration_s": 0.05,
  "voices": [
    { "name": "a", "resonator": "guitar_d3", "material": "steel_on_steel", "pluck_m": 0.5, "pickup_m": 0.61,
      "height_m": 0.001 }
  ],
  "events": [
    { "time_s": 0, "place_m": 0.3, "slide_mass_kg": 0.05, "hand_force_n": 2, "hand_stiffness_n_per_m": 300,
      "hand_resistance_n_s_per_m": 3, "rest_resistance_n_s_per_m": 1.5, "pluck_force_n": 0.7, "vibrato_m": 0.002,
      "vibrato_hz": 5.5 },
    { "time_s": 0.01, "pluck_n": 4 }
  ]
})";
const std::string kFret = R"({
  "instrument": "fret-string",
  "duration_s": 0.05,
  "voices": [
    { "name": "a", "resonator": "guitar_d3", "material": "steel_on_steel", "pluck_m": 0.5, "pickup_m": 0.61 }
  ],
  "events": [ { "time_s": 0, "place_m": 0.3, "gap_m": 0.0005, "damping_per_s": 0.25, "pluck_n": 4 } ]
})";

std::string range(const std::string& min, const std::string& max) {
  return fmt::format("a number from {} to {}", min, max);
}

std::vector<BadFile> all_number_cases() {
  const std::vector<NumberKey> hammer = {
      {"", "duration_s", "0.05", range("0.001", "3600"), {"0", "-1", "3601"}},
      {"voices[0].", "tuning_cents", "3", range("-1200", "1200"), {"-1201", "1201"}},
      {"voices[0].", "hammer_mass_kg", "0.003", range("1e-06", "100"), {"0", "-1", "101"}},
      {"voices[0].", "damper_per_s", "40", range("0", "100000"), {"-1", "1e6"}},
      {"voices[0].", "pan", "0.1", range("-1", "1"), {"-1.1", "1.1"}},
      {"events[0].", "time_s", "0.01", range("0", "0.05"), {"-1", "0.051"}},
      {"events[0].", "speed_m_per_s", "2.5", range("0.001", "100"), {"0", "-1", "101"}},
      {"events[0].", "hold_s", "0.02", range("0", "3600"), {"-1", "3601"}},
      {"events[0].", "over_s", "0.015", range("0", "3600"), {"-1", "3601"}},
      {"events[0].", "stiffness_ratio", "1.5", range("1e-06", "1000000"), {"0", "-1", "1.1e6"}},
      {"events[0].", "loss_s_per_m", "0.3", range("0", "1000"), {"-1", "1001"}},
      {"events[0].", "damping_per_s", "4", range("0", "100000"), {"-1", "1e6"}},
      {"events[0].", "strike_m", "0.08", range("0", "100"), {"-1", "101"}},
      {"events[0].", "bend_cents", "5", range("-1200", "1200"), {"-1201", "1201"}}};
  const std::vector<NumberKey> keys = {
      {"events[0].", "key", "60", "an integer from 21 to 108", {"20", "109", "-1", "4294967356"}, true},
      {"events[1].", "over_s", "0.02", range("0", "3600"), {"-1", "3601"}},
      {"events[1].", "sustain", "0.75", range("0", "1"), {"-0.1", "1.1"}},
      {"events[1].", "sostenuto", "1", range("0", "1"), {"-0.1", "1.1"}},
      {"events[1].", "una_corda", "0.4", range("0", "1"), {"-0.1", "1.1"}}};
  const std::vector<NumberKey> slide = {
      {"voices[0].", "pluck_m", "0.5", range("0", "0.648"), {"-1", "0.649"}},
      {"voices[0].", "pickup_m", "0.61", range("0", "0.648"), {"-1", "0.649"}},
      {"voices[0].", "height_m", "0.001", range("-0.1", "0.1"), {"-0.2", "0.2"}},
      {"events[0].", "place_m", "0.3", range("0", "100"), {"-1", "101"}},
      {"events[0].", "slide_mass_kg", "0.05", range("1e-06", "100"), {"0", "-1", "101"}},
      {"events[0].", "hand_force_n", "2", range("-1000", "1000"), {"-1001", "1001"}},
      {"events[0].", "hand_stiffness_n_per_m", "300", range("0", "1000000000"), {"-1", "1e10"}},
      {"events[0].", "hand_resistance_n_s_per_m", "3", range("0", "1000000"), {"-1", "1e7"}},
      {"events[0].", "rest_resistance_n_s_per_m", "1.5", range("0", "1000000"), {"-1", "1e7"}},
      {"events[0].", "pluck_force_n", "0.7", range("-1000", "1000"), {"-1001", "1001"}},
      {"events[0].", "vibrato_m", "0.002", range("0", "0.1"), {"-1", "0.2"}},
      {"events[0].", "vibrato_hz", "5.5", range("0", "100"), {"-1", "101"}},
      {"events[1].", "pluck_n", "4", range("-1000", "1000"), {"-1001", "1001"}}};
  const std::vector<NumberKey> fret = {{"voices[0].", "pluck_m", "0.5", range("0", "0.648"), {"-1", "0.649"}},
                                       {"events[0].", "gap_m", "0.0005", range("-0.1", "0.1"), {"-0.2", "0.2"}},
                                       {"events[0].", "damping_per_s", "0.25", range("0", "100000"), {"-1", "1e6"}}};
  std::vector<BadFile> cases;
  for (const auto& [name, text, numbers] : {std::tuple("hammer", kHammer, hammer), std::tuple("keys", kKeys, keys),
                                            std::tuple("slide", kSlide, slide), std::tuple("fret", kFret, fret)})
    for (const NumberKey& number : numbers)
      std::ranges::move(number_cases(name, text, number), std::back_inserter(cases));
  return cases;
}

std::vector<BadFile> key_cases() {
  const std::string instruments = "allowed: hammer-string, slide-string, fret-string";
  const std::string note = R"("speed_m_per_s": 2.5)";
  return {
      {"instrument_missing", changed(kHammer, R"("instrument": "hammer-string",)", ""), "instrument",
       "missing; " + instruments},
      {"instrument_unknown", changed(kHammer, R"("hammer-string")", R"("organ")"), "instrument",
       "'organ' is unknown; " + instruments},
      {"instrument_is_number", changed(kHammer, R"("hammer-string")", "1"), "instrument",
       "is not a string; " + instruments},
      {"instrument_is_another", kSlide, "instrument",
       "the score is for a slide-string; allowed: render slide-string"},
      {"description_with_quote", changed(kHammer, "a probe", R"(a \" probe)"), "description", "allowed: one line"},
      {"duration_missing", changed(kHammer, R"("duration_s": 0.05,)", ""), "duration_s",
       "missing; allowed: a number"},
      {"unknown_at_root", changed(kHammer, R"("voices")", R"("tempo": 1, "voices")"), "tempo",
       "unknown key; allowed: instrument, description, duration_s, keyboard, body, voices, events"},
      {"body_of_a_hammer", changed(kHammer, R"("voices")", R"("body": "guitar_body", "voices")"), "body",
       "has no place here; allowed: in a score for slide-string or fret-string"},
      {"body_of_a_keyboard", changed(kKeys, R"("keyboard")", R"("body": "guitar_body", "keyboard")"), "body",
       "has no place here; allowed: in a score for slide-string or fret-string"},
      {"unknown_in_voice", changed(kHammer, R"("pan")", R"("pluck_m": 1, "pan")"), "voices[0].pluck_m",
       "unknown key; allowed: name, resonator, material, tuning_cents, pan, hammer_mass_kg, damper_per_s"},
      {"unknown_in_event", changed(kHammer, R"("over_s")", R"("vibrato_m": 1, "over_s")"), "events[0].vibrato_m",
       "unknown key; allowed: time_s, voice, speed_m_per_s, hold_s, over_s, hammer_mass_kg"},
      {"key_without_keyboard", changed(kHammer, R"("over_s")", R"("key": 60, "over_s")"), "events[0].key",
       "unknown key; allowed: time_s, voice"},
      {"voice_with_keyboard", changed(kKeys, R"("key": 60)", R"("voice": "a")"), "events[0].voice",
       "unknown key; allowed: time_s, key"},
      {"no_key_is_played", changed(kKeys, R"("key": 60, )", ""), "events",
       "play no key; allowed: key, an integer from 21 to 108"},
      {"keyboard_and_voices", changed(kHammer, R"("voices")", R"("keyboard": "piano", "voices")"), "keyboard",
       "has no place here; allowed: in a score for hammer-string, instead of voices"},
      {"keyboard_unknown", changed(kKeys, R"("piano")", R"("organ")"), "keyboard",
       "'organ' does not ship; allowed: a .json file, piano"},
      {"keyboard_file_missing", changed(kKeys, R"("piano")", R"("organ.json")"), "keyboard",
       "organ.json: file: does not exist"},
      {"voices_missing",
       R"({ "instrument": "hammer-string", "duration_s": 1, "events": [ { "time_s": 0, "speed_m_per_s": 1 } ] })",
       "voices", "missing; allowed: an array of 1 to 128 objects"},
      {"voices_empty",
       R"({ "instrument": "hammer-string", "duration_s": 1, "voices": [], "events": [ { "time_s": 0, "speed_m_per_s": 1 } ] })",
       "voices", "has 0 entries"},
      {"voice_is_text", changed(kHammer, R"("voices": [)", R"("voices": [ "x",)"), "voices[0]", "is not an object"},
      {"events_missing", R"({ "instrument": "hammer-string", "duration_s": 1, "keyboard": "piano" })", "events",
       "missing; allowed: an array of 1 to 65536 objects"},
      {"events_empty", R"({ "instrument": "hammer-string", "duration_s": 1, "keyboard": "piano", "events": [] })",
       "events", "has 0 entries"},
      {"event_is_number", changed(kHammer, R"("events": [)", R"("events": [ 1,)"), "events[0]", "is not an object"},
      {"name_missing", changed(kHammer, R"("name": "a", )", ""), "voices[0].name",
       "missing; allowed: 1 to 64 characters"},
      {"name_empty", changed(kHammer, R"("name": "a")", R"("name": "")"), "voices[0].name", "has 0 characters"},
      {"name_twice",
       changed(kHammer, R"("voices": [)",
               R"("voices": [ { "name": "a", "resonator": "string_c4", "material": "felt_c4" },)"),
       "voices[1].name", "'a' is the name of two voices; allowed: once"},
      {"resonator_missing", changed(kHammer, R"("resonator": "string_c4", )", ""), "voices[0].resonator",
       "missing; allowed: a .json file, drum_head"},
      {"resonator_unknown", changed(kHammer, R"("string_c4")", R"("string_c9")"), "voices[0].resonator",
       "'string_c9' does not ship; allowed: a .json file, string_c2"},
      {"resonator_file_missing", changed(kHammer, R"("string_c4")", R"("x.json")"), "voices[0].resonator",
       "x.json: file: does not exist"},
      {"resonator_is_score", changed(kHammer, R"("string_c4")", R"("probe.json")"), "voices[0].resonator",
       "'probe.json' is a score; allowed: a .json file, drum_head"},
      {"material_missing", changed(kHammer, R"("material": "felt_c4", )", ""), "voices[0].material",
       "missing; allowed: a .json file, felt_c2"},
      {"material_unknown", changed(kHammer, R"("felt_c4")", R"("felt")"), "voices[0].material",
       "'felt' does not ship; allowed: a .json file, felt_c2"},
      {"tuning_of_bar", changed(kHammer, R"("string_c4")", R"("marimba_c4")"), "voices[0].tuning_cents",
       "is not for this resonator; allowed: beside strings"},
      {"slide_on_bar",
       changed(changed(kSlide, R"("guitar_d3")", R"("marimba_c4")"), R"("instrument": "slide)",
               R"("instrument": "slide)"),
       "voices[0].resonator", "is not a single string; allowed: a resonator of one string"},
      {"slide_on_course", changed(kSlide, R"("guitar_d3")", R"("dulcimer_g4")"), "voices[0].resonator",
       "is not a single string"},
      {"pluck_place_missing", changed(kSlide, R"("pluck_m": 0.5, )", ""), "voices[0].pluck_m",
       "missing; allowed: a number from 0 to 0.648"},
      {"pickup_missing", changed(kFret, R"(, "pickup_m": 0.61)", ""), "voices[0].pickup_m",
       "missing; allowed: a number from 0 to 0.648"},
      {"height_missing",
       changed(kSlide, R"(,
      "height_m": 0.001)",
               ""),
       "voices[0].height_m", "missing; allowed: a number"},
      {"time_missing", changed(kHammer, R"("time_s": 0.01, )", ""), "events[0].time_s",
       "missing; allowed: a number from 0 to 0.05"},
      {"voice_unknown", changed(kHammer, R"("voice": "a")", R"("voice": "b")"), "events[0].voice",
       "'b' is no voice; allowed: a"},
      {"voice_is_number", changed(kHammer, R"("voice": "a")", R"("voice": 1)"), "events[0].voice",
       "is not a string; allowed: a"},
      {"hold_without_note", changed(kHammer, note + ", ", ""), "events[0].hold_s",
       "holds nothing; allowed: beside speed_m_per_s or key"},
      {"glide_without_control", changed(kKeys, note, note + R"(, "over_s": 1)"), "events[0].over_s",
       "glides to nothing; allowed: beside a control"},
      {"pedal_of_a_key", changed(kKeys, note, R"("sustain": 1)"), "events[0].sustain",
       "is for all keys; allowed: without key"},
      {"pedal_of_a_voice", changed(kHammer, R"("over_s")", R"("una_corda": 1, "over_s")"), "events[0].una_corda",
       "unknown key; allowed: time_s, voice"},
      {"nothing_happens", changed(kKeys, ", " + note, ""), "events[0].time_s",
       "nothing happens; allowed: beside speed_m_per_s or a control"},
      {"bend_of_bar",
       changed(changed(changed(kHammer, "string_c4", "marimba_c4"), R"("tuning_cents": 3, )", ""),
               R"("strike_m": 0.08, )", ""),
       "events[0].bend_cents", "marimba_c4 is no string; allowed: for strings"},
      {"strike_beyond_string", changed(kHammer, R"("strike_m": 0.08)", R"("strike_m": 0.63)"), "events[0].strike_m",
       "0.63 is beyond string_c4; allowed: a number from 0 to 0.62"},
      {"slide_beyond_string", changed(kSlide, R"("place_m": 0.3)", R"("place_m": 0.65)"), "events[0].place_m",
       "0.65 is beyond guitar_d3; allowed: a number from 0 to 0.648"},
      {"place_never_set", changed(kSlide, R"("place_m": 0.3, )", ""), "events",
       "place_m of a is not set; allowed: an event at time_s 0 that sets it at once"},
      {"mass_set_too_late", changed(kSlide, R"("slide_mass_kg": 0.05, )", ""), "events",
       "slide_mass_kg of a is not set"},
      {"gap_never_set", changed(kFret, R"("gap_m": 0.0005, )", ""), "events", "gap_m of a is not set"},
      {"empty", "", "line 1, column 1", "the file ends; allowed: a value"},
      {"array", "[]", "score", "is not an object; allowed: instrument"},
      {"truncated", kHammer.substr(0, kHammer.size() / 2), "line ", "; allowed: "},
      {"trailing_garbage", kKeys + "x", "line ", "; allowed: "},
      {"large", kKeys + std::string(1 << 20, ' '), "file", "is larger than 1 MiB"}};
}

// The instrument that a text names, where it names one that there is.
std::string instrument_in(const std::string& text) {
  for (const std::string name : {"slide-string", "fret-string"})
    if (text.find("\"instrument\": \"" + name) != std::string::npos) return name;
  return "hammer-string";
}

Outcome render(const Sandbox& box, const std::string& instrument, const std::string& score) {
  return run({.arguments = {"render", instrument, "--score", score, "-o", "out/probe.wav"}, .folder = box.path()});
}

class BadScoreFile : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadScoreFile, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [test, text, key, says] = GetParam();
  const Sandbox box;
  write_file(box / "probe.json", text);
  const auto before = box.listing();
  expect_refused(render(box, test == "instrument_is_another" ? "hammer-string" : instrument_in(text), "probe.json"),
                 "probe.json: " + key, says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

CONTACTSPLINE_CASES(Number, BadScoreFile, all_number_cases());
CONTACTSPLINE_CASES(Key, BadScoreFile, key_cases());

// What the tables above are made of is good itself.
TEST(GoodScoreFile, IsAccepted) {
  for (const std::string& text : {kHammer, kKeys, kSlide, kFret}) {
    const Sandbox box;
    write_file(box / "probe.json", text);
    EXPECT_EQ(render(box, instrument_in(text), "probe.json").exit_code, 0) << text;
    EXPECT_TRUE(fs::exists(box / "out/probe.wav"));
  }
}

TEST(BadScore, IsNoNameThatShips) {
  const Sandbox box;
  expect_refused(render(box, "hammer-string", "waltz"), "waltz: SCORE: no such score ships",
                 "allowed: a .json or .mid file, bach_prelude, buzz_line, dulcimer");
  expect_refused(render(box, "hammer-string", "dulcima"), "dulcima: SCORE: no such score ships",
                 "allowed: a .json or .mid file, dulcimer, bach_prelude");
}

TEST(BadScore, MayBeTooFineForMemory) {
  const Sandbox box;
  write_file(box / "probe.json", changed(kKeys, "0.05", "3600"));
  expect_refused(
      run({.arguments = {"render", "hammer-string", "--score", "probe.json", "--rate", "48000", "-o", "a.wav"},
           .folder = box.path()}),
      "probe.json: duration_s: 3600 s at 48000 Hz", "allowed: at most 3308 s at this rate");
}

TEST(BadScore, MayLeaveNoSound) {
  const Sandbox box;
  write_file(box / "probe.json", changed(kKeys, "60", "108"));
  expect_refused(
      run({.arguments = {"render", "hammer-string", "--score", "probe.json", "--rate", "8000", "-o", "a.wav"},
           .folder = box.path()}),
      "--rate: no mode of voice 108 (piano) lies below 4000 Hz", "allowed: a higher rate");
  write_file(box / "drum.json",
             changed(changed(changed(kHammer, "string_c4", "drum_head"), R"("tuning_cents": 3, )", ""),
                     R"(, "bend_cents": 5)", ""));
  expect_refused(
      run({.arguments = {"render", "hammer-string", "--score", "drum.json", "--signal", "bridge", "-o", "a.wav"},
           .folder = box.path()}),
      "--signal: bridge: drum_head has none", "allowed: displacement, velocity, force");
}

// It is written, with one line: nothing is thrown, or the pickup stands at the end of the string.
TEST(SilentScore, IsPlayedWithAWarning) {
  const Sandbox box;
  write_file(box / "still.json", R"({ "instrument": "hammer-string", "duration_s": 0.1, "keyboard": "piano",
    "events": [ { "time_s": 0, "key": 60, "damping_per_s": 1 } ] })");
  write_file(box / "node.json", R"({ "instrument": "fret-string", "duration_s": 0.1,
    "voices": [ { "name": "a", "resonator": "guitar_d3", "material": "steel_on_steel", "pluck_m": 0.1, "pickup_m": 0 } ],
    "events": [ { "time_s": 0, "place_m": 0.3, "gap_m": 0.0001 }, { "time_s": 0.01, "pluck_n": 2 } ] })");
  for (const auto& [instrument, file, why] :
       {std::tuple{"hammer-string", "still.json", "nothing is struck or plucked so that it sounds"},
        std::tuple{"fret-string", "node.json", "the contact or the pickup is where no mode moves"}}) {
    const Outcome outcome = run(
        {.arguments = {"render", instrument, "--score", file, "--no-figure", "-o", "a.wav"}, .folder = box.path()});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, std::string("contactspline: ") + file + ": the sound is silent: " + why + "\n");
  }
}

TEST(BadScore, IsAFileTheOutputWouldReplace) {
  const Sandbox box;
  write_file(box / "probe.svg", kKeys);
  expect_refused(
      run({.arguments = {"render", "hammer-string", "--score", "./probe.svg", "-o", "a.wav", "--figure", "probe.svg"},
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
  expect_refused(render(box, "hammer-string", "probe.mid"), "probe.mid: ", GetParam().says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

std::vector<BadMidi> midi_cases() {
  const std::string allowed = "; allowed: a standard MIDI file of format 0 or 1";
  const auto header = [](const char* bytes) { return std::string("\0\0\0\6", 4) + std::string(bytes, 6); };
  const auto bytes = [](const char* data, std::size_t size) { return std::string(data, size); };
  return {
      {"empty", "", "EOF while expecting MThd" + allowed},
      {"json", kKeys, "expecting MThd" + allowed},
      {"only_a_header", "MThd" + header("\0\1\0\1\0\x60"), "EOF while expecting MTrk" + allowed},
      {"no_track", "MThd" + header("\0\1\0\0\0\x60"), "No tracks!" + allowed},
      {"format_2", midi(kNote + kEnd, header("\0\2\0\1\0\x60")), "it has format 2" + allowed},
      {"no_unit_of_time", midi(kNote + kEnd, header("\0\0\0\1\0\0")), "its unit of time is 0" + allowed},
      {"one_track_missing", midi(kNote + kEnd, header("\0\1\0\2\0\x60")), "EOF while expecting MTrk" + allowed},
      {"truncated", midi(kNote + kEnd).substr(0, 26), "premature EOF" + allowed},
      {"no_end_of_track", midi(kNote), "a track has no end" + allowed},
      {"no_note", midi(kEnd), "it has no note" + allowed},
      {"only_drums", midi(bytes("\0\x99\x3c\x40", 4) + kEnd),
       "MIDI: all its notes are on channel 10, which is for drums; allowed: --channel 10 to play them as keys"},
      {"only_note_offs", midi(bytes("\0\x80\x3c\x40", 4) + kEnd), "it has no note" + allowed},
      {"key_above_127", midi(bytes("\0\x90\xbc\x40", 4) + kEnd), "a data byte of channel 1 is above 127" + allowed},
      {"velocity_above_127", midi(bytes("\0\x90\x3c\xc0", 4) + kEnd),
       "a data byte of channel 1 is above 127" + allowed},
      {"running_status_of_nothing", midi(bytes("\0\x3c\x40", 3) + kEnd), "unexpected running status" + allowed},
      {"unknown_status", midi(bytes("\0\xf5", 2) + kNote + kEnd), "unexpected byte: 0xf5" + allowed},
      {"tempo_of_0", midi(bytes("\0\xff\x51\x03\0\0\0", 7) + kNote + kEnd), "a tempo is 0" + allowed},
      {"tempo_without_bytes", midi(bytes("\0\xff\x51\0", 4) + kNote + kEnd), "a tempo is 0" + allowed},
      {"endless_time", midi(bytes("\xff\xff\xff\xff\xff\xff\xff\x7f\x90\x3c\x40", 11) + kEnd),
       "a time is damaged" + allowed},
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
    return run({.arguments = {"render", "hammer-string", "--score", score, "--channel", channel, "-o", "a.wav"},
                .folder = box.path()});
  };
  const auto before = box.listing();
  expect_refused(play("probe.mid", "0"), "--channel: '0' is refused", "allowed: an integer from 1 to 16");
  expect_refused(play("probe.mid", "2"), "probe.mid: MIDI: no note is on a chosen channel", "allowed: --channel 1");
  expect_refused(play("probe.json", "1"), "probe.json: --channel: the score is not a MIDI file", "a .mid file");
  expect_refused(play("dulcimer", "1"), "dulcimer: --channel: the score is not a MIDI file", "a .mid file");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

// One line counts what is left out, and bends that are played as an octave; the rest sounds.
TEST(GoodMidiFile, IsPlayedWithoutWhatIsBeyondThePiano) {
  const auto bytes = [](const char* data, std::size_t size) { return std::string(data, size); };
  const std::string low = bytes("\0\x90\x14\x40\0\x90\x7f\x40", 8);
  // Another channel with the wheel at the low end of a range of so many semitones.
  const auto far = [&](char semitones) {
    return bytes("\0\xb1\x65\0\0\xb1\x64\0\0\xb1\x06", 11) + semitones + bytes("\0\xe1\0\0\0\x91\x3c\x40", 8);
  };
  const Sandbox box;
  write_file(box / "clean.mid", midi(far(12) + kNote + kEnd));
  write_file(box / "probe.mid", midi(low + low + far(24) + kNote + kEnd));
  const Outcome outcome =
      run({.arguments = {"render", "hammer-string", "--score", "probe.mid", "-o", "a.wav"}, .folder = box.path()});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err,
            "contactspline: probe.mid: MIDI: left out: notes beyond the keys 21 to 108 (4); played as an octave: "
            "bends by more "
            "than an octave (1)\n");
  succeed({.arguments = {"render", "hammer-string", "--score", "clean.mid", "-o", "b.wav"}, .folder = box.path()});
  EXPECT_TRUE(read_file(box / "a.wav") == read_file(box / "b.wav"));
}

TEST(GoodMidiFile, IsAccepted) {
  for (const std::string& bytes : {midi(kNote + kEnd), midi(kNote + kEnd) + "garbage behind"}) {
    const Sandbox box;
    write_file(box / "probe.mid", bytes);
    EXPECT_EQ(render(box, "hammer-string", "probe.mid").exit_code, 0);
  }
}

}  // namespace
}  // namespace contactspline::testing
