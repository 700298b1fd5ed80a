// SPDX-License-Identifier: MIT
// contactspline fit of whole instruments: numbers of known instruments come back from their rendered notes with noise
// and a room, what was not fitted comes nearer, and what cannot be fitted is refused in one line.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "cpu_time.hpp"
#include "recorded_instrument.hpp"

namespace contactspline::testing {
namespace {

const Known kKalimba{"Kalimba",
                     R"({ "name": "kalimba", "bodies": [
    { "name": "tine", "bar": { "length_m": 0.0385, "mass_kg": 0.000967, "bending_stiffness_n_m2": @0,
      "ends": ["clamped", "free"], "constant_loss_per_s": @1, "quadratic_loss_m2_per_s": 0.0003 }, "max_modes": 4 },
    { "name": "thumb", "mass_kg": 0.001 }],
  "places": [{ "name": "struck", "body": "tine", "position_m": 0.0385 }],
  "contacts": [{ "name": "tip", "between": ["thumb", "struck"], "material": "felt_c4", "weight": @2, "gap_m": 0.001 }],
  "strikes": ["thumb"], "outputs": [{ "name": "tine", "velocity_m_per_s": "struck" }],
  "keys": [{ "key": 69, "event": "strike_thumb" }] })",
                     {{"bodies[0].bar.bending_stiffness_n_m2", 0.0341, 0.025, 0.05, 1e-3},
                      {"bodies[0].bar.constant_loss_per_s", 5, 1, 20, 0.03},
                      {"contacts[0].weight", 0.5, 0.1, 2, 0.05}},
                     {{69, 0.3}, {69, 0.9}, {69, 0.6, true}}};

const Known kString{"String",
                    R"({ "name": "zither", "bodies": [
    { "name": "string", "string": { "length_m": 0.62, "mass_kg": 0.00393, "tension_n": @0,
      "bending_stiffness_n_m2": 0.0098, "constant_loss_per_s": 1, "quadratic_loss_m2_per_s": @1 }, "max_modes": 30 },
    { "name": "hammer", "mass_kg": 0.003 }],
  "places": [{ "name": "struck", "body": "string", "position_m": @2 }],
  "contacts": [{ "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4", "gap_m": 0.001 }],
  "strikes": ["hammer"], "outputs": [{ "name": "bridge", "end_force_n": "string" }],
  "keys": [{ "first": 55, "last": 65, "event": "strike_hammer", "tuned_key": 60 }] })",
                    {{"bodies[0].string.tension_n", 670, 550, 800, 1e-3},
                     {"bodies[0].string.quadratic_loss_m2_per_s", 3e-4, 5e-5, 1e-3, 0.05},
                     {"places[0].position_m", 0.074, 0.05, 0.11, 0.02}},
                    {{60, 0.3}, {60, 0.9}, {55, 0.6, true}}};

const Known kDrum{"Drum",
                  R"({ "name": "drum", "bodies": [
    { "name": "head", "membrane": { "radius_m": 0.16, "mass_per_area_kg_m2": 0.3, "tension_n_per_m": @0,
      "constant_loss_per_s": 6, "quadratic_loss_m2_per_s": @1 }, "max_modes": 40 },
    { "name": "stick", "mass_kg": 0.02 }],
  "places": [{ "name": "struck", "body": "head", "position_m": @2 }],
  "contacts": [{ "name": "tip", "between": ["stick", "struck"], "material": "felt_over_wood", "gap_m": 0.004 }],
  "strikes": ["stick"], "outputs": [{ "name": "microphone", "pressure_pa": "head", "distance_m": 0.5 }],
  "keys": [{ "key": 45, "event": "strike_stick" }] })",
                  {{"bodies[0].membrane.tension_n_per_m", 1500, 900, 2500, 1e-3},
                   {"bodies[0].membrane.quadratic_loss_m2_per_s", 3e-3, 1e-3, 1e-2, 0.05},
                   {"places[0].position_m", 0.05, 0.02, 0.1, 0.02}},
                  {{45, 0.3}, {45, 0.9}, {45, 0.6, true}}};

// Keys of a keyboard whose dampers keep the others quiet.
const Known kPiano{"Piano",
                   R"({ "name": "octave", "keyboard": {
    "first_key": 60, "last_key": 72, "first_double_key": 32, "first_triple_key": 44, "last_damped_key": 88,
    "concert_pitch_hz": 440, "min_speed_m_per_s": 0.2, "max_speed_m_per_s": 6, "felt_loss_s_per_m": 0.1,
    "damper_per_s": 60, "damper_time_s": 0.005, "segments": 48,
    "body": { "resonator": "soundboard", "double_hz": [-0.017, 0.017], "triple_hz": [-0.0226, 0.0057, 0.0283],
      "una_corda_stiffness_ratio": 0.5, "pickup_ratio": 0.25, "mobility_m_per_n_s": 7e-4 },
    "notes": [{ "key": 60, "length_m": 0.657, "mass_kg": 0.004051, "bending_stiffness_n_m2": @0,
      "strike_position_m": @1, "constant_loss_per_s": 0.33, "quadratic_loss_m2_per_s": 1e-4, "hammer_mass_kg": @2,
      "stiffness_n_per_m_alpha": 2.35e9, "exponent": 2.42, "bridge_ratio": 0.9, "output_ratio": 1 },
      { "key": 72, "length_m": 0.35, "mass_kg": 0.0020, "bending_stiffness_n_m2": 0.0075, "strike_position_m": 0.038,
      "constant_loss_per_s": 0.33, "quadratic_loss_m2_per_s": 6e-5, "hammer_mass_kg": 0.0061,
      "stiffness_n_per_m_alpha": 8e9, "exponent": 2.6, "bridge_ratio": 0.9, "output_ratio": 1 }] } })",
                   {{"keyboard.notes[0].bending_stiffness_n_m2", 0.00928, 0.007, 0.013, 0.02},
                    {"keyboard.notes[0].strike_position_m", 0.078, 0.07, 0.12, 0.02},
                    {"keyboard.notes[0].hammer_mass_kg", 0.007, 0.005, 0.02, 0.05}},
                   {{60, 0.3}, {60, 0.9}, {61, 0.6, true}}};

class FittedInstrument : public ::testing::TestWithParam<Known> {};

TEST_P(FittedInstrument, HasTheNumbersOfTheRecordedOne) {
  const Known& known = GetParam();
  const Sandbox box;
  record(box, known);
  const auto fit = nlohmann::json::parse(succeed(fitted(box, {"-o", "found.json"})));
  for (const Open& open : known.open) {
    const auto& found = fit.at("estimates").at(open.key);
    EXPECT_NEAR(found.at("value").get<double>() / open.truth, 1, open.error) << open.key;
    EXPECT_LE(found.at("low").get<double>(), open.truth) << open.key;
    EXPECT_GE(found.at("high").get<double>(), open.truth) << open.key;
    EXPECT_LT(found.at("high").get<double>() / found.at("low").get<double>(), 1 + 4 * open.error) << open.key;
  }
  for (const auto& note : fit.at("recordings")) {
    EXPECT_LT(note.at("after").at("level_db").get<double>(), 0.5 * note.at("before").at("level_db").get<double>())
        << note;
    EXPECT_LT(note.at("after").at("cents").get<double>(), 1) << note;
  }
  succeed(run({.arguments = {"inspect", "found.json"}, .folder = box.path()}));
}

INSTANTIATE_TEST_SUITE_P(Known, FittedInstrument, ::testing::Values(kKalimba, kString, kDrum, kPiano),
                         [](const auto& known) { return known.param.test; });

TEST(FitOfAnInstrument, WritesTheFileThatWasOpenWithItsCommentsAndDrawsAFigure) {
  const Sandbox box;
  record(box, kKalimba);
  write_file(box / "open.json", "// My kalimba.\n" + kKalimba.with(true));
  succeed(fitted(box, {"-o", "found.json", "--figure", "found.svg"}));
  const std::string found = read_file(box / "found.json");
  EXPECT_NE(found.find("contacts[0].weight"), found.npos);
  EXPECT_NE(found.find("// My kalimba.\n{ \"name\": \"kalimba\""), found.npos) << found;
  EXPECT_EQ(found.find("\"fit\""), found.npos) << found;
  const std::string figure = read_file(box / "found.svg");
  for (const char* word : {"note_0.wav", "note_2.wav, kept", "recorded", "before", "after"})
    EXPECT_NE(figure.find(word), figure.npos) << word;
}

// kKalimba with its weight alone open, and another way to the tine.
Known with_open_weight(double gap_m) {
  Known known = kKalimba;
  known.file = known.with(false);
  known.file.replace(known.file.find("\"weight\": 0.5"), 13, "\"weight\": @0");
  known.file.replace(known.file.find("0.001 }],\n  \"strikes\""), 5, fmt::format("{}", gap_m));
  known.open = {kKalimba.open.back()};
  return known;
}

// At 0.3 of the largest speed the thumb is there after more than 0.1 s.
TEST(FitOfAnInstrument, WaitsForASlowStriker) {
  const Sandbox box;
  record(box, with_open_weight(0.1));
  const auto fit = nlohmann::json::parse(succeed(fitted(box)));
  EXPECT_NEAR(fit.at("estimates").at("contacts[0].weight").at("value").get<double>(), 0.5, 0.02);
  EXPECT_EQ(fit.at("doubts"), nlohmann::json::array());
}

TEST(FitOfAnInstrument, RefusesAnOctave) {
  const Sandbox box;
  record(box, with_open_weight(0.001));
  const std::vector<double> low = read_sound(box / "note_0.wav").samples;
  std::vector<double> high;
  for (std::size_t i = 0; i < low.size(); i += 2) high.push_back(low[i]);
  write_sound(box / "note_0.wav", high, kRate);
  expect_refused(fitted(box), "note_0.wav: samples: the strong partials begin at 879.",
                 "of key 69 within the bounds at 439.");
}

// Hum of 50 Hz and its harmonics, 40 dB below the peak of 0.5, in a note that is soon as soft.
TEST(FitOfAnInstrument, LeavesHumOut) {
  const Sandbox box;
  Known known = with_open_weight(0.001);
  const std::string loss = "\"constant_loss_per_s\": 5";
  known.file.replace(known.file.find(loss), loss.size(), "\"constant_loss_per_s\": 40");
  known.notes.resize(1);
  record(box, known);
  std::vector<double> samples = read_sound(box / "note_0.wav").samples;
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (const int harmonic : {1, 2, 3, 5, 7})
      samples[i] += 0.005 / harmonic * std::sin(2 * std::numbers::pi * 50 * harmonic * double(i) / kRate);
  write_sound(box / "note_0.wav", samples, kRate);
  const auto fit = nlohmann::json::parse(succeed(fitted(box)));
  EXPECT_NEAR(fit.at("estimates").at("contacts[0].weight").at("value").get<double>(), 0.5, 0.02) << fit;
  EXPECT_EQ(fit.at("doubts"), nlohmann::json::array());
}

// The second channel is the first times a gain.
void write_channels(const fs::path& path, const std::vector<double>& samples, double gain) {
  SndfileHandle file(path.string(), SFM_WRITE, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 2, kRate);
  std::vector<double> frames;
  for (const double sample : samples) frames.insert(frames.end(), {sample, gain * sample});
  ASSERT_EQ(file.writef(frames.data(), std::ssize(samples)), std::ssize(samples));
}

// Of a recording that ends before the seconds that are asked for, too.
TEST(FitOfAnInstrument, HearsOneDeadChannel) {
  const Sandbox box;
  record(box, with_open_weight(0.001));
  write_channels(box / "note_0.wav", read_sound(box / "note_0.wav").samples, 0);
  std::string file = read_file(box / "my.fit.json");
  write_file(box / "my.fit.json", file.replace(file.find("\"seconds\": 0.5"), 14, "\"seconds\": 9"));
  const auto fit = nlohmann::json::parse(succeed(fitted(box)));
  EXPECT_NEAR(fit.at("estimates").at("contacts[0].weight").at("value").get<double>(), 0.5, 0.02);
  EXPECT_EQ(fit.at("doubts"), nlohmann::json::array());
}

// The same pluck, in one of them with another loss.
TEST(FitOfAnInstrument, DoubtsNotesThatContradict) {
  const Sandbox box;
  Known known = with_open_weight(0.001);
  known.notes = {{69, 0.5}, {69, 0.5}};
  record(box, known);
  std::vector<double> samples = read_sound(box / "note_0.wav").samples;
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] *= std::exp(-8 * double(i) / kRate);
  write_sound(box / "note_0.wav", samples, kRate);
  const auto fit = nlohmann::json::parse(succeed(fitted(box)));
  ASSERT_EQ(fit.at("doubts").size(), 2) << fit;
  for (const auto& doubt : fit.at("doubts"))
    EXPECT_NE(doubt.get<std::string>().find(".wav: the instrument does not explain it: "), std::string::npos);
}

TEST(FitOfAnInstrument, TellsWhatTheInstrumentDoesNotExplain) {
  const Sandbox box;
  record(box, with_open_weight(0.001));
  std::vector<double> two = read_sound(box / "note_0.wav").samples;
  for (std::size_t i = two.size() / 3; i < two.size(); ++i)
    two[i] = 0.8 * two[i] + 0.05 * std::sin(2 * std::numbers::pi * 700 * double(i) / kRate);
  write_sound(box / "note_0.wav", two, kRate);
  const auto fit = nlohmann::json::parse(succeed(fitted(box)));
  ASSERT_EQ(fit.at("doubts").size(), 2) << fit;
  EXPECT_NE(fit.at("doubts")[0].get<std::string>().find("note_0.wav: the instrument does not explain it: "),
            std::string::npos);
  EXPECT_NE(fit.at("doubts")[1].get<std::string>().find("no partial near 700"), std::string::npos) << fit;
  EXPECT_EQ(fit.at("estimates").at("contacts[0].weight").at("doubtful"), true);
  const std::string report =
      succeed(run({.arguments = {"fit", "my.fit.json", "-o", "out.json"}, .folder = box.path()}));
  for (const std::string& text : {report, read_file(box / "out.json")}) {
    EXPECT_NE(text.find("The intervals are doubtful: "), text.npos) << text;
    EXPECT_NE(text.find("; doubtful: 0."), text.npos) << text;
    EXPECT_EQ(text.find("95 %"), text.npos) << text;
  }
}

// The pitch is checked before the search: of three open numbers it would take ten times as long.
TEST(FitOfAnInstrument, RefusesAWrongPitchAtOnce) {
  const Sandbox box;
  Known known = kKalimba;
  known.notes.resize(1);
  record(box, known);
  const std::vector<double> low = read_sound(box / "note_0.wav").samples;
  std::vector<double> high;
  for (std::size_t i = 0; i < low.size(); i += 2) high.push_back(low[i]);
  const Call fit{.arguments = {"fit", "my.fit.json"}, .folder = box.path()};
  const double searched_s = cpu_time_s(fit, 1);
  write_sound(box / "note_0.wav", high, kRate);
  expect_refused(fitted(box), "note_0.wav: samples: the strong partials begin at 87", "within the bounds at ");
  EXPECT_LT(cpu_time_s(fit, 1), 0.2 * searched_s);
}

double cpu_time_of_children_s() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  return double(used.ru_utime.tv_sec) + 1e-6 * double(used.ru_utime.tv_usec);
}

// An interrupted fit that goes on writes what one without interruption writes, to the byte, in less time.
TEST(FitOfAnInstrument, GoesOnAfterItWasKilled) {
  const Sandbox box;
  record(box, kKalimba);
  const Call fit{.arguments = {"fit", "my.fit.json", "-o", "found.json"}, .folder = box.path()};
  const fs::path file = box / "found.json.part";
  double begin_s = cpu_time_of_children_s();
  const std::string report = succeed(run_program(fit));
  const double whole_s = cpu_time_of_children_s() - begin_s;
  const std::string whole = read_file(box / "found.json");
  EXPECT_FALSE(fs::exists(file));
  fs::remove(box / "found.json");
  {
    constexpr int kLines = 2 + 8;  // two above eight steps: all over the bounds, and the first way down
    Process killed(fit);
    while (!fs::exists(file) || std::ranges::count(read_file(file), '\n') < kLines)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    killed.kill();
    (void)killed.wait();
  }
  EXPECT_FALSE(fs::exists(box / "found.json"));

  // Of another fit nothing is taken, and what was found stays.
  const std::string part = read_file(file), text = read_file(box / "my.fit.json");
  std::string other = text;
  write_file(box / "my.fit.json", other.replace(other.find("0.9"), 3, "0.8"));
  expect_refused(run_program(fit), "found.json.part: inputs: an interrupted fit of other files left it", "--force");
  EXPECT_EQ(read_file(file), part);
  write_file(box / "my.fit.json", text);

  // A file that is cut off counts up to there.
  write_file(file, part.substr(0, part.size() - 3));
  begin_s = cpu_time_of_children_s();
  const Outcome second = run_program(fit);
  const double rest_s = cpu_time_of_children_s() - begin_s;
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_EQ(second.err,
            "contactspline: found.json.part: goes on from what an interrupted fit has found; to begin anew, remove "
            "it\n");
  EXPECT_EQ(second.out, report);
  EXPECT_EQ(read_file(box / "found.json"), whole);
  EXPECT_FALSE(fs::exists(file));
  EXPECT_LT(rest_s, 0.8 * whole_s);
}

TEST(FitOfAnInstrument, TellsARecordingOfTheNextKey) {
  const Sandbox box;
  Known known = with_open_weight(0.001);
  known.notes.resize(1);
  const auto key = known.file.find("\"key\": 69");
  known.file.replace(key, 9, "\"key\": 70");
  known.notes[0].key = 70;
  record(box, known);
  const auto fit = nlohmann::json::parse(succeed(fitted(box)));
  ASSERT_EQ(fit.at("doubts").size(), 1) << fit;
  EXPECT_TRUE(fit.at("doubts")[0].get<std::string>().starts_with("note_0.wav: sounds -10")) << fit;
}

// A mass that nothing touches.
TEST(FitOfAnInstrument, RefusesANumberThatChangesNothing) {
  const Sandbox box;
  Known known = with_open_weight(0.001);
  const std::string thumb = R"({ "name": "thumb", "mass_kg": 0.001 })";
  known.file.replace(known.file.find(thumb), thumb.size(), thumb + R"(, { "name": "idle", "mass_kg": @1 })");
  known.open.push_back({"bodies[2].mass_kg", 0.01, 0.001, 0.1, 1});
  record(box, known);
  expect_refused(fitted(box),
                 "open.json: bodies[2].mass_kg: the recorded notes do not depend on it from 0.001 to 0.1",
                 "a number in its place, such as 0.01");
}

/// What is refused: the fit file, an instrument file if it is not the one of kKalimba, and the line.
struct Bad {
  std::string test, fit, beginning, says, instrument = {};
};

void PrintTo(const Bad& bad, std::ostream* stream) {
  *stream << bad.test;
}

std::string fit_of(const std::string& recording, const std::string& more = "") {
  return fmt::format(R"({{ "instrument": "open.json", "recordings": [{{ {} }}]{} }})", recording, more);
}

std::string with_stiffness(const std::string& number) {
  Known known = kKalimba;
  const std::string mark = "@0";
  known.file.replace(known.file.find(mark), mark.size(), number);
  return known.with(true);
}

std::vector<Bad> bad_fits() {
  const std::string good = R"("file": "sine.wav", "key": 69, "velocity": 0.5)", fit = "my.fit.json: ";
  const std::string stiffness = "open.json: bodies[0].bar.bending_stiffness_n_m2: ";
  const auto of_file = [](const std::string& name) {
    return fit_of(fmt::format(R"("file": "{}", "key": 69, "velocity": 0.5)", name));
  };
  return {
      {"missing_file", of_file("none.wav"), fit + "recordings[0].file: none.wav: file: does not exist", ""},
      {"no_sound", of_file("open.json"), "open.json: file: is no sound", ".wav"},
      {"silent", of_file("silent.wav"), "silent.wav: samples: the recording is silent", "a struck note"},
      {"clipped", of_file("clipped.wav"), "clipped.wav: samples: ", "below full scale"},
      {"short", of_file("short.wav"), "short.wav: samples: end less than 0.05 s", "0.1 s or more"},
      {"wrong_pitch", of_file("sine.wav"),
       "sine.wav: samples: the strong partials begin at 1234 Hz, those of key 69 ", "wider bounds"},
      {"click_before", of_file("click.wav"), "click.wav: samples: something sounds 0.21 s before the note",
       "without what is before it"},
      {"no_number", of_file("nan.wav"), "nan.wav: samples: some of them are no numbers", "finite samples"},
      {"two_samples", of_file("two.wav"), "two.wav: samples: end less than 0.05 s", "0.1 s or more"},
      {"longer_than_allowed", fit_of(good, R"(, "seconds": 60)"), fit + "seconds: 60 is out of range", "0.1 to 10"},
      {"antiphase", of_file("antiphase.wav"), "antiphase.wav: channels: they cancel", "one of the channels"},
      {"constant", of_file("constant.wav"), "constant.wav: samples: the recording is silent", "a struck note"},
      {"no_velocity", fit_of(R"("file": "sine.wav", "key": 69)"),
       fit + "recordings: no fitted one states its velocity", "0.5"},
      {"no_bounds", fit_of(good), stiffness + "fit: is not two numbers", "[1, 2]", with_stiffness(R"({ "fit": 1 })")},
      {"three_bounds", fit_of(good), stiffness + "fit: has 3 entries", "[1, 2]",
       with_stiffness(R"({ "fit": [1, 2, 3] })")},
      {"huge_bounds", fit_of(good), stiffness + "fit[0]: -1e+300 is out of range", "1e+100",
       with_stiffness(R"({ "fit": [-1e300, 1e300] })")},
      {"fit_is_not_first", fit_of(good), stiffness + "note: unknown key", "fit, start",
       with_stiffness(R"({ "note": "mine", "fit": [0.02, 0.05] })")},
      {"start_alone", fit_of(good), stiffness, "number", with_stiffness(R"({ "start": 0.03 })")},
      {"unknown_key", fit_of(good, R"(, "rate": 1)"), fit + "rate: unknown key", "seconds"},
      {"unknown_key_of_a_note", fit_of(good + R"(, "pitch": 440)"), fit + "recordings[0].pitch: unknown key",
       "velocity"},
      {"no_recordings", R"({ "instrument": "open.json" })", fit + "recordings: missing", ""},
      {"no_instrument", fmt::format(R"({{ "recordings": [{{ {} }}] }})", good), fit + "instrument: missing", ".json"},
      {"all_kept", fit_of(good + R"(, "kept": true)"), fit + "recordings: all are kept", "one or more"},
      {"kept_is_a_number", fit_of(good + R"(, "kept": 1)"), fit + "recordings[0].kept: is not true or false", ""},
      {"kept_of_unknown_velocity", fit_of(R"("file": "sine.wav", "key": 69, "kept": true)"),
       fit + "recordings[0].velocity: is not stated, but the recording is kept", "0.7"},
      {"velocity_of_2", fit_of(R"("file": "sine.wav", "key": 69, "velocity": 2)"),
       fit + "recordings[0].velocity: 2 is out of range", "0.01 to 1"},
      {"velocity_up_to_2", fit_of(R"("file": "sine.wav", "key": 69, "velocity": { "fit": [0.1, 2] })"),
       fit + "recordings[0].velocity: leaves its range", "0.01 to 1"},
      {"slow_rate", fit_of(R"("file": "slow.wav", "key": 69, "velocity": 0.5)"), "slow.wav: sample_rate_hz: is 100",
       "8000 or more"},
      {"quote_in_a_key", fit_of(good), stiffness, "fit, start",
       with_stiffness(R"({ "fit": [0.02, 0.05], "a\"": 1 })")},
      {"three_channels", fit_of(R"("file": "three.wav", "key": 69, "velocity": 0.5)"), "three.wav: channels: has 3",
       "one or two channels"},
      {"silent_key", fit_of(R"("file": "sine.wav", "key": 70, "velocity": 0.5)"),
       "open.json: keys: key 70 of sine.wav plays nothing", "inspect"},
      {"unknown_output", fit_of(good, R"(, "output": "bridge")"), "open.json: outputs: 'bridge' is none of them",
       "tine_velocity_m_per_s"},
      {"unknown_gain", fit_of(good, R"(, "gain": "some")"), fit + "gain: 'some' is unknown", "each, common"},
      {"no_open_number", fit_of(good), "open.json: instrument: has 0 open numbers", R"({"fit": [1, 2]})",
       kKalimba.with(false)},
      {"falling_bounds", fit_of(good), stiffness + "fit: 0.05 and 0.02 do not rise", "[1, 2]",
       with_stiffness(R"({ "fit": [0.05, 0.02] })")},
      {"one_bound", fit_of(good), stiffness + "fit: has 1 entry", "[1, 2]", with_stiffness(R"({ "fit": [0.05] })")},
      {"start_beyond", fit_of(good), stiffness + "start: 1 is out of range", "0.02 to 0.05",
       with_stiffness(R"({ "fit": [0.02, 0.05], "start": 1 })")},
      {"unknown_key_of_a_number", fit_of(good), stiffness + "end: unknown key", "fit, start",
       with_stiffness(R"({ "fit": [0.02, 0.05], "end": 1 })")},
      {"start_out_of_reach", fit_of(good), "open.json: bodies[0].bar.bending_stiffness_n_m2: ", "",
       with_stiffness(R"({ "fit": [-2, -1] })")},
      {"instrument_is_no_json", fit_of(good), "open.json: ", "", "name"}};
}

void write_nan(const fs::path& path, std::vector<double> samples) {
  samples[100] = std::nan("");
  SndfileHandle file(path.string(), SFM_WRITE, SF_FORMAT_WAV | SF_FORMAT_FLOAT, 1, kRate);
  ASSERT_EQ(file.write(samples.data(), std::ssize(samples)), std::ssize(samples));
}

class BadFitOfAnInstrument : public ::testing::TestWithParam<Bad> {};

TEST_P(BadFitOfAnInstrument, IsRefusedInOneLineAndNothingIsWritten) {
  const Bad& bad = GetParam();
  const Sandbox box;
  std::vector<double> sine, clipped;
  for (int i = 0; i < kRate / 2; ++i) {
    const double time_s = i / double(kRate);
    sine.push_back(0.5 * std::exp(-6 * time_s) * std::sin(2 * std::numbers::pi * 1234 * time_s));
    clipped.push_back(std::clamp(4 * sine.back(), -0.9, 0.9));
  }
  write_sound(box / "sine.wav", sine, kRate);
  write_sound(box / "clipped.wav", clipped, kRate);
  std::vector<double> click(sine.size() / 2);
  click[click.size() - static_cast<std::size_t>(0.2 * kRate)] = 0.5;
  click.insert(click.end(), sine.begin(), sine.end());
  write_sound(box / "click.wav", click, kRate);
  write_sound(box / "constant.wav", std::vector<double>(sine.size(), 0.25), kRate);
  write_sound(box / "three.wav", sine, kRate, 3);
  write_channels(box / "antiphase.wav", sine, -1);
  write_sound(box / "two.wav", {0.1, 0.2}, kRate);
  write_nan(box / "nan.wav", sine);
  write_sound(box / "slow.wav", sine, 100);
  write_sound(box / "silent.wav", std::vector<double>(sine.size()), kRate);
  write_sound(box / "short.wav", std::vector<double>(sine.begin(), sine.begin() + 400), kRate);
  write_file(box / "open.json", bad.instrument.empty() ? kKalimba.with(true) : bad.instrument);
  write_file(box / "my.fit.json", bad.fit);
  const auto before = box.listing();
  expect_refused(fitted(box, {"-o", "found.json", "--figure", "found.svg"}), bad.beginning, bad.says);
  EXPECT_EQ(box.listing(), before);
}

INSTANTIATE_TEST_SUITE_P(Bad, BadFitOfAnInstrument, ::testing::ValuesIn(bad_fits()),
                         [](const auto& bad) { return bad.param.test; });

}  // namespace
}  // namespace contactspline::testing
