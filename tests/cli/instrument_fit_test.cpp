// SPDX-License-Identifier: MIT
// contactspline fit of whole instruments: numbers of known instruments come back from their rendered notes with noise
// and a room, what was not fitted comes nearer, and what cannot be fitted is refused in one line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"
#include "sound.hpp"

namespace contactspline::testing {
namespace {

/// A number of an instrument that is left open: its path, what it is, and how well the fit must find it.
struct Open {
  std::string key;
  double truth, min, max, error;
};

struct Note {
  int key;
  double velocity;
  bool is_kept = false;
};

/// An instrument file with @0, @1, ... in place of its open numbers.
struct Known {
  std::string test, file;
  std::vector<Open> open;
  std::vector<Note> notes;

  [[nodiscard]] std::string with(bool is_open) const {
    std::string text = file;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const std::string mark = fmt::format("@{}", i);
      const std::string number = is_open ? fmt::format(R"({{ "fit": [{}, {}] }})", open[i].min, open[i].max)
                                         : fmt::format("{}", open[i].truth);
      for (auto at = text.find(mark); at != text.npos; at = text.find(mark)) text.replace(at, mark.size(), number);
    }
    return text;
  }
};

void PrintTo(const Known& known, std::ostream* stream) {
  *stream << known.test;
}

const Known kKalimba{
    "Kalimba",
    R"({ "name": "kalimba", "bodies": [
    { "name": "tine", "bar": { "length_m": 0.0385, "mass_kg": 0.000967, "bending_stiffness_n_m2": @0,
      "ends": ["clamped", "free"], "constant_loss_per_s": @1, "quadratic_loss_m2_per_s": 0.001 }, "max_modes": 4 },
    { "name": "thumb", "mass_kg": 0.002 }],
  "places": [{ "name": "struck", "body": "tine", "position_m": 0.03 }],
  "contacts": [{ "name": "tip", "between": ["thumb", "struck"], "material": "felt_c4", "weight": @2, "gap_m": 0.001 }],
  "strikes": ["thumb"], "outputs": [{ "name": "tine", "velocity_m_per_s": "struck" }],
  "keys": [{ "key": 69, "event": "strike_thumb" }] })",
    {{"bodies[0].bar.bending_stiffness_n_m2", 0.0341, 0.025, 0.05, 1e-3},
     {"bodies[0].bar.constant_loss_per_s", 5, 1, 20, 0.03},
     {"contacts[0].weight", 0.2, 0.05, 1, 0.05}},
    {{69, 0.3}, {69, 0.9}, {69, 0.6, true}}};

const Known kString{
    "String",
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

const Known kDrum{
    "Drum",
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

// A room of 0.2 s, 50 dB softer than the note, and noise 60 dB below its peak.
std::vector<double> in_a_room(const std::vector<double>& dry, int rate, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto length = static_cast<std::size_t>(0.2 * rate);
  std::vector<double> room, wet = dry;
  double squares = 0, peak = 0;
  for (std::size_t i = 0; i < length; ++i) {
    room.push_back(i % 16 == 0 ? normal(random) * std::pow(10, -3.0 * double(i) / double(length)) : 0);
    squares += room.back() * room.back();
  }
  for (const double sample : dry) peak = std::max(peak, std::abs(sample));
  for (std::size_t k = 0; k < length; k += 16)
    for (std::size_t i = k; i < wet.size(); ++i) wet[i] += 0.0032 * room[k] / std::sqrt(squares) * dry[i - k];
  for (double& sample : wet) sample = 0.5 / peak * (sample + 1e-3 * peak * normal(random));
  return wet;
}

void write_sound(const fs::path& path, std::vector<double> samples, int rate) {
  SndfileHandle file(path.string(), SFM_WRITE, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 1, rate);
  ASSERT_EQ(file.write(samples.data(), static_cast<sf_count_t>(samples.size())), std::ssize(samples));
}

constexpr int kRate = 22050;

// The notes as they would be recorded, and a fit file that names them.
void record(const Sandbox& box, const Known& known, const std::string& more = "") {
  write_file(box / "true.json", known.with(false));
  write_file(box / "open.json", known.with(true));
  std::string recordings;
  for (std::size_t n = 0; n < known.notes.size(); ++n) {
    const auto& [key, velocity, is_kept] = known.notes[n];
    write_file(box / "score.json",
               fmt::format(R"({{ "instrument": "true.json", "duration_s": 0.9,
                                 "events": [{{ "time_s": 0.2, "key": {}, "velocity": {} }}] }})",
                           key, velocity));
    succeed(run({.arguments = {"render", "score.json", "--no-figure", "--rate", fmt::format("{}", kRate), "-o", "dry.wav"},
                 .folder = box.path()}));
    const std::string name = fmt::format("note_{}.wav", n);
    write_sound(box / name, in_a_room(read_sound(box / "dry.wav").samples, kRate, static_cast<unsigned>(n + 1)), kRate);
    recordings += fmt::format(R"({}{{ "file": "{}", "key": {}, "velocity": {}, "kept": {} }})", n > 0 ? ", " : "", name,
                              key, velocity, is_kept);
  }
  write_file(box / "my.fit.json", fmt::format(R"({{ "instrument": "open.json", "recordings": [{}], "seconds": 0.5{} }})",
                                              recordings, more));
}

Outcome fitted(const Sandbox& box, const Words& more = {}) {
  return run({.arguments = followed_by({"fit", "my.fit.json", "--json"}, more), .folder = box.path()});
}

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

INSTANTIATE_TEST_SUITE_P(Known, FittedInstrument, ::testing::Values(kKalimba, kString, kDrum),
                         [](const auto& info) { return info.param.test; });

}  // namespace
}  // namespace contactspline::testing
