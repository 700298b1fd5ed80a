// SPDX-License-Identifier: MIT
// Voices of a score: panned and summed in the mix, and alone in stems.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "contactspline/models/hammer_string.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "program.hpp"
#include "render_score.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

constexpr auto kTwoSteels = R"({ "instrument": "lap_steel", "duration_s": 0.3,
    "voices": [ { "name": "g", "pan": -0.3 }, { "name": "SECOND", "tuning_cents": 400 } ],
    "events": [ { "time_s": 0.05, "voice": "g", "pick_release_n": 4 },
                { "time_s": 0.1, "voice": "SECOND", "pick_release_n": 3 } ] })";

std::string two_steels(const std::string& second_name) {
  std::string score = kTwoSteels;
  for (auto at = score.find("SECOND"); at != std::string::npos; at = score.find("SECOND"))
    score.replace(at, 6, second_name);
  return score;
}

// A centred voice alone has the two channels of the mix. Each file rounds to 24 bits; voices are summed in single
// precision.
TEST(ScoreStems, WritesStemsThatAddUpToTheMix) {
  const Sandbox box;
  write_file(box / "probe.json", two_steels("b 2"));
  for (const Words& gain : {Words{}, Words{"--gain", "-40"}}) {
    const std::string report =
        succeed({.arguments = followed_by(
                     {"render", "probe.json", "-o", "mix.wav", "--no-figure", "--stems", "parts/of/it"}, gain),
                 .folder = box.path()});
    EXPECT_TRUE(report.ends_with("sound:  mix.wav\nstems:  2 in parts/of/it\n")) << report;
    const Sound mix = read_sound(box / "mix.wav"), g = read_sound(box / "parts/of/it/g.wav"),
                b = read_sound(box / "parts/of/it/b 2.wav");
    ASSERT_EQ(mix.channels, 2);
    ASSERT_EQ(g.samples.size(), mix.samples.size());
    ASSERT_EQ(b.samples.size(), mix.samples.size());
    EXPECT_GT(g.peak(), 0.1 * mix.peak());
    EXPECT_GT(b.peak(), 0.1 * mix.peak());
    double worst = 0;
    for (std::size_t i = 0; i < mix.samples.size(); ++i)
      worst = std::max(worst, std::abs(g.samples[i] + b.samples[i] - mix.samples[i]));
    EXPECT_LE(worst, 3 * kLevel);
  }
}

TEST(ScoreStems, RefusesStemsThatCannotBeWritten) {
  const auto refused = [](const std::string& name, const Words& more, const std::string& begins,
                          const std::string& says) {
    const Sandbox box;
    write_file(box / "probe.json", two_steels(name));
    fs::create_directories(box / "mine");
    write_file(box / "mine/g.wav", "my own file");
    const auto before = box.listing();
    expect_refused(
        run({.arguments = followed_by({"render", "probe.json", "-o", "mix.wav", "--no-figure", "--stems"}, more),
             .folder = box.path()}),
        begins, says);
    EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  };
  refused("../b", {"parts"}, "probe.json: --stems: the name of voice '../b' cannot name a file",
          "allowed: names without / and control characters");
  refused("b", {"mine"}, "mine/g.wav: file: ", "allowed: ");
  refused("mix", {"."}, "./mix.wav: file: is already an input or another output",
          "allowed: another folder or file name");
  refused("b", {""}, "--stems: '' is refused", "allowed: a folder");
}

// Left and right of two keys of the piano are the sums of both, by the law of equal power.
TEST(ScoreStems, SumsAndPansVoices) {
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  std::vector<double> expected(2 * 4410);
  for (const int key : {40, 88}) {
    KeyboardNote note = note_of(keyboard, key);
    const auto set = modes_of(note, kRate / 2);
    std::vector<Mode> modes;
    ModeShapes<double> strike(set.size()), bridge(set.size());
    for (std::size_t i = 0; i < set.size(); ++i) {
      modes.push_back(set[i].mode);
      strike[i] = set[i].strike_shape;
      bridge[i] = set[i].pickup_shape;
    }
    const auto felt = segment_table(design_spline(note.felt, "felt"));
    HammerString<double> model(felt, modes, strike, kRate);
    bridge = model.string().sound_pickup(bridge);
    const double angle = (0.6 * ((key - 21) / 43.5 - 1) + 1) * pi / 4;
    for (int n = 0; n < 4410; ++n) {
      if (n == 441) model.strike(key == 40 ? 2.0 : 3.0, 1e-4);
      model.tick({.hammer_mass_kg = note.hammer_mass_kg, .felt = {1, 0.1}, .damping_per_s = n < 441 ? 60.0 : 0.0});
      const double output = note.strings * model.string().displacement(bridge);
      expected[static_cast<std::size_t>(2 * n)] += std::cos(angle) * output;
      expected[static_cast<std::size_t>(2 * n + 1)] += std::sin(angle) * output;
    }
  }
  const Sound sound = sound_of(R"({
    "instrument": "piano", "duration_s": 0.1,
    "events": [ { "time_s": 0.01, "key": 88, "speed_m_per_s": 3 }, { "time_s": 0.01, "key": 40, "speed_m_per_s": 2 } ] })",
                               {"--signal", "bridge"});
  EXPECT_EQ(sound.channels, 2);
  expect_is(sound, expected, 3 * kLevel);  // each voice and their sum are rounded to single precision
}

// Stems of a keyboard on its body: the dampers of all keys move as in the whole, so that their sum lacks only what
// one hammer's contact changes in another. Keys 60 and 48 share a board; every partial of C3 that C4 has rings with
// it.
TEST(ScoreStems, StemsOfABodyAddUp) {
  const Sandbox box;
  write_file(box / "probe.json", R"({ "instrument": "piano", "duration_s": 1,
    "events": [ { "time_s": 0.01, "key": 60, "speed_m_per_s": 3, "hold_s": 0.5 },
                { "time_s": 0.01, "key": 48, "speed_m_per_s": 2, "hold_s": 0.8 } ] })");
  succeed({.arguments = {"render", "--score", "probe.json", "-o", "mix.wav", "--no-figure", "--gain", "0", "--stems",
                         "stems"},
           .folder = box.path()});
  const Sound mix = read_sound(box / "mix.wav"), low = read_sound(box / "stems/48.wav"),
              high = read_sound(box / "stems/60.wav");
  double rest = 0, whole = 0, of_one = 0;
  for (std::size_t i = 0; i < mix.samples.size(); ++i) {
    rest += std::pow(mix.samples[i] - low.samples[i] - high.samples[i], 2);
    whole += mix.samples[i] * mix.samples[i];
    of_one += low.samples[i] * low.samples[i];
  }
  const double level = 10 * std::log10(rest / whole);
  Measured() << "mix less stems: " << level << " dB";
  EXPECT_GT(of_one, 0.01 * whole);
  EXPECT_LT(level, -50);
}

}  // namespace
}  // namespace contactspline::testing
