// SPDX-License-Identifier: MIT
// Keys and presets of instrument files: errors in one line, MIDI files that they play, what `inspect` says of them.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "bad_input.hpp"
#include "cases.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/midi_files.hpp"

namespace contactspline::testing {
namespace {

const std::string kGood = R"({
  "name": "probe",
  "bodies": [
    { "name": "string", "resonator": "string_c4", "max_modes": 20 },
    { "name": "hammer", "mass_kg": 0.003 }
  ],
  "places": [ { "name": "struck", "body": "string", "position_m": 0.07 } ],
  "contacts": [ { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4" } ],
  "controls": [
    { "name": "felt", "stiffness_ratio": "felt", "max": 50 },
    { "name": "finger", "force_n": "struck", "release_n": 0.5 }
  ],
  "strikes": ["hammer"],
  "keys": [
    { "first": 48, "last": 62, "event": "strike_hammer", "tuned_key": 60, "per_octave": 1.5 },
    { "key": 70, "event": "pluck_finger" }
  ],
  "polyphony": 4,
  "damper": { "bodies": "string", "damping_per_s": 55 },
  "presets": [ { "name": "bright", "felt_stiffness_ratio": 4, "hammer_speed_m_per_s": 5 } ],
  "outputs": [ { "name": "string", "end_force_n": "string" } ]
})";

CONTACTSPLINE_REFUSED_BY_GENERATE(BadKeys);
CONTACTSPLINE_CASES(Number, BadKeys, bad_numbers("instrument_keys", "Number", {{"", kGood}}));
CONTACTSPLINE_CASES(Key, BadKeys, bad_files("instrument_keys", "Key", {{"", kGood}}));

class KeysOnTheCommandLine : public ::testing::Test {
 protected:
  KeysOnTheCommandLine() {
    write_file(box_ / "probe.json", kGood);
    write_file(box_ / "song.mid", midi(0));
    write_file(box_ / "drums.mid", midi(9));
  }

  // A note of key 60 on a channel for half a second, at 120 beats per minute; then 20, which is on no instrument.
  static std::string midi(int channel) {
    const auto byte = [](int value) { return std::string(1, static_cast<char>(value)); };
    std::string track;
    for (const auto& [delta, status, key, velocity] : {std::array{0, 0x90, 60, 100}, std::array{96, 0x80, 60, 0},
                                                       std::array{0, 0x90, 20, 100}, std::array{96, 0x80, 20, 0}})
      track += byte(delta) + byte(status | channel) + byte(key) + byte(velocity);
    track += byte(0) + "\xff\x2f" + byte(0);
    return "MThd" + std::string("\0\0\0\6\0\0\0\1\0\x60", 10) + "MTrk" + std::string(3, '\0') +
           byte(static_cast<int>(track.size())) + track;
  }

  // The instrument without keys, damper and presets.
  static std::string without_keys() {
    const auto begin = kGood.find("  \"keys\""), end = kGood.find("  \"outputs\"");
    return kGood.substr(0, begin) + kGood.substr(end);
  }
  static std::string without_events() {
    return changed(changed(without_keys(), R"(, "release_n": 0.5)", ""), R"(  "strikes": ["hammer"],)", "");
  }

  [[nodiscard]] Outcome run_here(const Words& words) const {
    return run({.arguments = words, .folder = box_.path()});
  }
  [[nodiscard]] Outcome render(const std::string& score, const std::string& instrument,
                               const Words& options = {}) const {
    return run_here(
        followed_by({"render", score, "--instrument", instrument, "-o", "a.wav", "--no-figure"}, options));
  }

  Sandbox box_;
};

TEST_F(KeysOnTheCommandLine, PlayAMidiFile) {
  const Outcome outcome = render("song.mid", "probe.json", {"--tail", "1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "contactspline: song.mid: MIDI: left out: notes beyond keys 48 to 62, 70 (1)\n");
  EXPECT_NE(outcome.out.find("N (string end force)"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("1 contacts in 1.5 s"), std::string::npos) << outcome.out;
}

// A file sounds until it has rung out, or as long as it is told to; a sample has so many bits; several files are
// written by their names.
TEST_F(KeysOnTheCommandLine, RingOutAndHaveBits) {
  const auto seconds = [](const Outcome& outcome) {
    const auto at = outcome.out.find(" contacts in ");
    return at == std::string::npos ? 0 : std::stod(outcome.out.substr(at + 13));
  };
  EXPECT_GE(seconds(render("song.mid", "probe.json")), 1.5);
  EXPECT_EQ(seconds(render("song.mid", "probe.json", {"--tail", "2.25"})), 2.75);
  std::map<std::string, std::size_t> sizes;
  for (const char* bits : {"16", "24", "32"}) {
    EXPECT_EQ(seconds(render("song.mid", "probe.json", {"--tail", "0", "--bits", bits})), 0.5);
    sizes[bits] = fs::file_size(box_ / "a.wav");
  }
  EXPECT_EQ(sizes["24"] - sizes["16"], 22050u);
  EXPECT_EQ(sizes["32"] - sizes["24"], 22050u + 12);  // a chunk states the number of frames
  fs::copy_file(box_ / "song.mid", box_ / "again.mid");
  const Outcome both = run_here({"render", "song.mid", "again.mid", "--instrument", "probe.json", "--no-figure"});
  EXPECT_EQ(both.exit_code, 0) << both.err;
  EXPECT_TRUE(read_file(box_ / "song.wav") == read_file(box_ / "again.wav"));
}

// Keys that tune nothing are those of a drum, which plays the tenth channel.
TEST_F(KeysOnTheCommandLine, OfADrumPlayTheTenthChannel) {
  write_file(box_ / "drum.json", changed(changed(kGood, R"(, "tuned_key": 60, "per_octave": 1.5)", ""),
                                         R"("first": 48)", R"("first": 36)"));
  EXPECT_EQ(render("drums.mid", "drum.json").exit_code, 0);
  EXPECT_EQ(render("song.mid", "drum.json", {"--channel", "1"}).exit_code, 0);
  expect_refused(render("song.mid", "drum.json"),
                 "song.mid: MIDI: no note is on channel 10, that of drums and of keys without tuned_key",
                 "allowed: --channel 1");
}

// Without keys each key plays the one event of an instrument, as in hosts; of two events the keys from 60 on. All
// channels but the tenth play, whose keys alone are drums.
TEST_F(KeysOnTheCommandLine, OfHostsArePlayedWithoutKeys) {
  const auto contacts = [&](const std::string& file, const std::string& text) {
    write_file(box_ / file, text);
    const Outcome outcome = render("song.mid", file, {"--tail", "0.2"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out.substr(0, outcome.out.find(" in ")) + outcome.err;
  };
  const std::string two = without_keys(), one = changed(two, R"(, "release_n": 0.5)", "");
  EXPECT_EQ(contacts("one.json", one), "2 contacts");
  EXPECT_EQ(contacts("two.json", two),
            "1 contactscontactspline: song.mid: MIDI: left out, as probe has nothing to strike there: keys 20 (1)\n");
  using namespace contactspline::testing::midi;
  const auto left_out = [&](int channel) {
    write_file(box_ / "low.mid", file(track({{0, on(60, 90, channel)}, {9, on(42, 90, channel)}})));
    return render("low.mid", "two.json", {"--channel", std::to_string(channel + 1), "--tail", "0.2"}).err;
  };
  EXPECT_NE(left_out(0).find("nothing to strike there: keys 42 (1)\n"), std::string::npos) << left_out(0);
  EXPECT_NE(left_out(9).find("nothing to strike there: keys 42 closed hi-hat (1)\n"), std::string::npos);
}

// The keys that docs/how-to/midi.md changes are those of the tanpura.
TEST_F(KeysOnTheCommandLine, OfThePageArePlayed) {
  const std::string page = read_file(fs::path(SOURCE_FOLDER) / "docs/how-to/midi.md"), fence = "```jsonc\n";
  const auto begin = page.find(fence) + fence.size();
  const std::string keys = page.substr(begin, page.find("```", begin) - begin);
  const std::string tanpura = run_here({"show", "tanpura", "--name", "my_tanpura"}).out;
  write_file(box_ / "my_tanpura.json", changed(tanpura, keys, changed(keys, "36", "30")));
  const Outcome played = render("song.mid", "my_tanpura.json");
  EXPECT_EQ(played.exit_code, 0) << played.err;
}

TEST_F(KeysOnTheCommandLine, AreRefusedWhereTheyCannotPlay) {
  expect_refused(render("fur_elise", "probe.json"), "fur_elise: --instrument: the score is not a MIDI file",
                 "allowed: no --instrument, a .mid file, or an instrument that is a model of your own (.so)");
  write_file(box_ / "still.json", without_events());
  expect_refused(render("song.mid", "still.json"), "--instrument: probe has nothing that keys could play",
                 "allowed: an instrument file with strikes, plucks or bows");
  expect_refused(run_here({"render", "probe.json", "-o", "a.wav"}), "probe.json: file: is an instrument",
                 R"(allowed: a score with "instrument": "probe.json", or a MIDI file with --instrument probe.json)");
  expect_refused(
      render("song.mid", "felt_c4"), "--instrument: felt_c4: is a material",
      "allowed: a .json file of an instrument or a keyboard, a model of your own (.so), cello, classical_guitar, "
      "dulcimer, or another name of `contactspline list instruments`");
  expect_refused(render("song.mid", "probe"), "--instrument: probe: is no instrument and no keyboard",
                 "allowed: probe.json, which is a file here, a model of your own (.so), ");
  expect_refused(run_here({"render", "song"}), "song: SCORE: no such score ships",
                 "allowed: song.mid, which is a file here, ");
  expect_refused(run_here({"inspect", "probe"}), "probe: MATERIAL: no such material, ",
                 "allowed: probe.json, which is a file here, ");

  write_file(box_ / "text.so", "no library");
  for (const char* file : {"none.so", "text.so"})
    expect_refused(render("song.mid", file), std::string(file) + ": --instrument: cannot be loaded",
                   "allowed: a library of contactspline_model()");
}

// The program itself: a library keeps what it has read of the environment.
TEST_F(KeysOnTheCommandLine, BrokenModelsAreRefusedInOneLine) {
  fs::copy_file(BROKEN_MODEL, box_ / "broken.so");
  const auto play = [&](const std::string& how) {
    return run_program({.arguments = {"render", "song.mid", "--instrument", "broken.so", "-o", "broken.wav"},
                        .folder = box_.path(),
                        .environment = {{"BROKEN", how}}});
  };
  const auto expect_line = [&](const std::string& how, const std::string& wrong, const std::string& allowed) {
    const Outcome outcome = play(how);
    SCOPED_TRACE(how);
    expect_refused(outcome, "broken.so: --instrument: " + wrong, allowed);
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_FALSE(fs::exists(box_ / "broken.wav"));
  };
  expect_line("event", "events(): strike: its parameter is 7, and there are 1 parameters", "0 to 0");
  expect_line("outputs", "outputs(): is empty", "at least one output");
  expect_line("full_scale", "outputs(): displacement_m: full_scale is not above 0", "such as 1");
  for (const char* how : {"event_name", "unit", "name"})
    expect_line(how, "a name, unit or description is a null pointer", "a text for each");
  expect_line("constructor", "its class cannot be made (two lines)", "throw nothing");
  expect_line("prepare", "its class cannot be made (no memory for modes)", "throw nothing");
  expect_line("module", "gives no model", "a library of contactspline_model()");

  const std::string whole = read_file(box_ / "broken.so");
  for (const std::size_t size :
       {std::size_t(0), std::size_t(63), std::size_t(100), whole.size() / 4, whole.size() / 2}) {
    write_file(box_ / "broken.so", whole.substr(0, size));
    expect_line("not", size < 64 ? "cannot be loaded" : "is cut off", "a library of contactspline_model()");
  }
  fs::remove(box_ / "broken.so");
  ASSERT_EQ(::mkfifo((box_ / "broken.so").c_str(), 0600), 0);
  expect_line("not", "is no regular file", "a library of contactspline_model()");
  fs::remove(box_ / "broken.so");
  fs::copy_file(BROKEN_MODEL, box_ / "broken.so");
  EXPECT_EQ(play("not").exit_code, 0);
}

TEST_F(KeysOnTheCommandLine, AreInWhatInspectSays) {
  const Outcome outcome = run_here({"inspect", "probe.json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* line : {"keys, on 4 voices\n",
                           "  48 to 62                           strike_hammer, tuned: 60 has the pitch of the file, "
                           "1.5 times as strong per octave\n",
                           "  70                                 pluck_finger\n",
                           "  damper                             55 1/s on string\n",
                           "  bright                             felt_stiffness_ratio 4, hammer_speed_m_per_s 5\n"})
    EXPECT_NE(outcome.out.find(line), std::string::npos) << line << outcome.out;
}

// A heading without a row is left out.
TEST_F(KeysOnTheCommandLine, AndOtherPartsHaveNoHeadingWhereThereAreNone) {
  write_file(box_ / "bare.json", R"({ "name": "bare", "bodies": [ { "name": "string", "resonator": "string_c4" } ],
    "places": [ { "name": "middle", "body": "string", "position_m": 0.3 } ],
    "controls": [ { "name": "finger", "force_n": "middle" } ],
    "outputs": [ { "name": "string", "end_force_n": "string" } ] })");
  const Outcome outcome = run_here({"inspect", "bare.json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  std::vector<std::string> headings;
  std::istringstream lines(outcome.out);
  for (std::string before = "first", line; std::getline(lines, line); before = line)
    if (before.empty()) headings.push_back(line);
  EXPECT_EQ(fmt::format("{}", fmt::join(headings, "; ")), "bodies, at 44100 Hz; places; parameters; outputs");
}

// The text is that of the file without its keys, but for a line that says so.
TEST_F(KeysOnTheCommandLine, AreLeftOutOfFaustText) {
  fs::create_directory(box_ / "keyless");
  write_file(box_ / "keyless/probe.json", without_keys());
  const auto text = [&](const std::string& file, const std::string& folder) {
    const Outcome outcome = run_here({"generate", file, "-o", folder, "--emit", "faust"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string lib = read_file(box_ / folder / "probe.lib");
    return lib.substr(0, lib.find("// Written by")) + lib.substr(lib.find("// A program of its own"));
  };
  EXPECT_EQ(
      changed(text("probe.json", "a"), "\n// Keys are left out: buttons play it, at the pitch of its file.", ""),
      text("keyless/probe.json", "b"));
}

// Events of a score play keys as a MIDI file does.
TEST_F(KeysOnTheCommandLine, ArePlayedByAScore) {
  const std::string good = R"({ "instrument": "probe.json", "duration_s": 1.5,
    "events": [ { "time_s": 0, "key": 60, "velocity": 0.787401574803149607, "hold_s": 0.5 } ] })";
  const auto render_score = [&](const std::string& text, const std::string& sound) {
    write_file(box_ / "score.json", text);
    return run_here({"render", "score.json", "-o", sound, "--no-figure"});
  };
  EXPECT_EQ(render_score(good, "b.wav").exit_code, 0);
  EXPECT_EQ(render("song.mid", "probe.json", {"--tail", "1"}).exit_code, 0);
  EXPECT_EQ(read_file(box_ / "a.wav"), read_file(box_ / "b.wav"));
  expect_refused(render_score(changed(good, R"("key": 60)", R"("key": 63)"), "c.wav"),
                 "score.json: events[0].key: 63 plays nothing", "allowed: keys 48 to 62, 70");
  expect_refused(render_score(changed(good, R"("key": 60, )", ""), "c.wav"),
                 "score.json: events[0].velocity: has no key", "allowed: beside key");
}

// Notes 60 on channel 1 and 36 on channel 10.
std::string song_with_drums() {
  const std::string track("\0\x90\x3c\x64\0\x99\x24\x64\x60\x80\x3c\0\0\x89\x24\0\0\xff\x2f\0", 20);
  return "MThd" + std::string("\0\0\0\6\0\0\0\1\0\x60", 10) + "MTrk" + std::string("\0\0\0\x14", 4) + track;
}

TEST_F(KeysOnTheCommandLine, SayThatDrumsAreLeftOut) {
  write_file(box_ / "band.mid", song_with_drums());
  const std::string says =
      "contactspline: band.mid: MIDI: left out: drums, the notes of channel 10 (1), which --channel 10 plays as "
      "keys\n";
  for (const Words& player : std::vector<Words>{{}, {"--instrument", "probe.json"}}) {
    const Words words = followed_by({"render", "band.mid", "--no-figure", "-o", "a.wav"}, player);
    EXPECT_EQ(run_here(words).err, says);
    EXPECT_EQ(run_here(followed_by(words, {"--channel", "1"})).err, "");
  }
  write_file(box_ / "drum.json", changed(changed(kGood, R"(, "tuned_key": 60, "per_octave": 1.5)", ""),
                                         R"("first": 48)", R"("first": 36)"));
  EXPECT_NE(render("band.mid", "drum.json").err.find("notes of other channels than 10 (1)"), std::string::npos);
}

TEST_F(KeysOnTheCommandLine, MayBeThoseOfAKeyboard) {
  write_file(box_ / "one.mid", song_with_drums());
  const Words words = {"render", "one.mid", "--channel", "1", "--no-figure", "-o"};
  write_file(box_ / "my_piano.json", find_embedded(Shipped::kKeyboards, "piano.json")->content);
  succeed(run_here(followed_by(words, {"a.wav"})));
  for (const char* keyboard : {"piano", "my_piano.json"}) {
    succeed(run_here(followed_by(words, {"b.wav", "--instrument", keyboard})));
    EXPECT_EQ(read_file(box_ / "a.wav"), read_file(box_ / "b.wav")) << keyboard;
  }
  expect_refused(render("fur_elise", "piano"), "fur_elise: --instrument: a keyboard plays MIDI files", "a .mid file");
}

}  // namespace
}  // namespace contactspline::testing
