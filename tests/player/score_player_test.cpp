// SPDX-License-Identifier: MIT
// What a score may do to a model, and what a sound that is not finite leads to.
#include "generator/player/score_player.hpp"

#include <limits>
#include <sstream>

#include "contactspline/instrument/string_outputs.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

Score slide_score(const std::string& events) {
  return parse_score(R"({
    "instrument": "slide-string", "duration_s": 1,
    "voices": [ { "name": "g", "resonator": "guitar_g3", "material": "steel_on_steel", "pluck_m": 0.5,
                  "pickup_m": 0.6, "height_m": 0 } ],
    "events": [
      { "time_s": 0, "place_m": 0.2, "slide_mass_kg": 0.05, "hand_force_n": 2, "hand_stiffness_n_per_m": 200,
        "hand_resistance_n_s_per_m": 2, "rest_resistance_n_s_per_m": 1 },
      { "time_s": 0.05, "pluck_n": 4 })" +
                         events + "] }",
                     "probe.json", {});
}

Performance played(const Score& score, Precision precision) {
  return play(score, {.sample_rate_hz = 44100, .output = StringOutput::kVelocity, .precision = precision},
              [](double) {});
}

// A stiffness that jumps by 1e12 under a pressed slide, each way a hundred times: its rises do 1 W of work at most,
// so the slide hits no harder than a note or two.
TEST(ScorePlayer, IsBoundedWhereTheStiffnessJumps) {
  std::ostringstream events;
  for (int i = 0; i < 200; ++i)
    events << R"(, { "time_s": )" << 0.1 + 0.004 * i << R"(, "stiffness_ratio": )" << (i % 2 == 0 ? "1e-6" : "1e6")
           << " }";
  const std::string jumps = events.str();
  const auto still = played(slide_score(""), Precision::kDouble);
  for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
    const auto sound = played(slide_score(jumps), precision);
    EXPECT_TRUE(all_finite(sound.samples));
    EXPECT_NE(sound.samples, still.samples);
    EXPECT_GT(still.largest_force_n, 2);
    EXPECT_GT(sound.largest_force_n, 2);
    EXPECT_LT(sound.largest_force_n, 1e4);
    Measured() << "largest force " << sound.largest_force_n << " N, without jumps " << still.largest_force_n << " N";
  }
}

// Until the light hand of 6.7 s the slides stay on their strings: each meets its string once. A hand
// that is too light rattles thousands of times, which is heard as noise.
TEST(ScorePlayer, TheSlideOfSlideGuitarRattlesOnlyUnderALightHand) {
  const auto* file = find_embedded(Shipped::kScores, "slide_guitar.json");
  ASSERT_NE(file, nullptr);
  Score score = parse_score(file->content, file->name, shipped_file);
  const std::size_t all = played(score, Precision::kDouble).contacts;
  score.duration_s = 6.7;
  const std::size_t pressed = played(score, Precision::kDouble).contacts;
  EXPECT_EQ(pressed, 2u);
  EXPECT_GT(all, 200u);
}

// A key of an instrument file, struck again while it is down, is let go when the last of its notes ends.
TEST(ScorePlayer, LetsAKeyGoWhenTheLastOfItsNotesEnds) {
  const auto of_holds = [](const std::string& first_s, const std::string& second_s) {
    const std::string score = R"({ "instrument": "fret_guitar", "duration_s": 0.5, "events": [
      { "time_s": 0.05, "key": 52)" +
                              first_s + R"( }, { "time_s": 0.1, "key": 52, "hold_s": )" + second_s + " } ] }";
    return play(parse_score(score, "probe.json", shipped_file), {.sample_rate_hz = 44100}, [](double) {}).samples;
  };
  EXPECT_EQ(of_holds(", \"hold_s\": 0.1", "0.2"), of_holds(", \"hold_s\": 0.25", "0.2"));
  EXPECT_EQ(of_holds(", \"hold_s\": 0.25", "0.1"), of_holds(", \"hold_s\": 0.25", "0.2"));
  EXPECT_NE(of_holds(", \"hold_s\": 0.1", "0.05"), of_holds(", \"hold_s\": 0.1", "0.2"));
  EXPECT_EQ(of_holds("", "0.1"), of_holds("", "0.2"));  // which the first one holds for ever
}

// The second voice has a mode whose mass is no number, or one beyond what a sound file holds, and is struck at 0.1 s.
TEST(ScorePlayer, SaysWhereASoundIsNotFinite) {
  Score score = parse_score(R"({
    "instrument": "hammer-string", "duration_s": 0.3,
    "voices": [ { "name": "g", "resonator": "guitar_g3", "material": "felt_c4" },
                { "name": "h", "resonator": "guitar_g3", "material": "felt_c4" } ],
    "events": [ { "time_s": 0, "voice": "g", "speed_m_per_s": 2 }, { "time_s": 0.1, "voice": "h", "speed_m_per_s": 2 } ]
  })",
                            "probe.json", {});
  const Mode sound{1256, 1, 0.01}, broken{1256, 1, std::numeric_limits<double>::quiet_NaN()};
  for (const auto& [lowest, pickup] : {std::pair(broken, 1.0), std::pair(sound, 1e37)})
    for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
      score.voices[1].resonator.body = ModeTable{{{lowest, 1, pickup}, {{2600, 1, 0.01}, 1, 1}}};
      std::string message;
      try {
        played(score, precision);
      } catch (const BadInput& bad) {
        message = bad.what();
      }
      EXPECT_TRUE(message.starts_with("probe.json: voice h: its sound is not finite from 0.1")) << message;
      EXPECT_NE(message.find(" s on; allowed: "), std::string::npos) << message;
    }
}

// Strings so light that single precision cannot hold what a force does to them: the keyboard comes to rest at one of
// its checks, within 88 times 32 samples, which would be a silence that nobody explains. A board whose motion is no
// number is found at once.
TEST(ScorePlayer, SaysWhereAKeyboardIsNotFinite) {
  const Score good = parse_score(R"({ "instrument": "hammer-string", "duration_s": 0.3, "keyboard": "piano",
    "events": [ { "time_s": 0.1, "key": 60, "speed_m_per_s": 2 } ] })",
                                 "probe.json", shipped_file);
  Score light = good, board = good;
  StiffString& strings = light.keys[39].strings;
  for (double* value : {&strings.mass_kg, &strings.tension_n, &strings.bending_stiffness_n_m2}) *value *= 1e-46;
  board.body =
      Resonator{"probe", "", ModeTable{{{{600, 20, std::numeric_limits<double>::quiet_NaN()}, 1, 1}}}, {0}, {0}, 10};
  for (const Score* score : {&light, &board}) {
    std::string message;
    try {
      (void)play(*score, {.sample_rate_hz = 44100, .is_on_body = true, .precision = Precision::kSingle},
                 [](double) {});
    } catch (const BadInput& bad) {
      message = bad.what();
    }
    EXPECT_TRUE(message.starts_with("probe.json: keyboard: its sound is not finite from 0.1")) << message;
  }
}

// A plucked string on a body: the sound is that of the body's modes under the force on the bridge. The sound is
// stored in single precision, and so is the force that is played here: 6e-8 of the peak each, of which the force's is
// noise that the modes take up for some hundred samples.
TEST(ScorePlayer, DrivesABodyByTheForceOnTheBridge) {
  Score score = slide_score("");
  const auto silent = [](double) {};
  const auto force = play(score, {.sample_rate_hz = 44100, .output = StringOutput::kBridge}, silent);
  ASSERT_EQ(force.channels, 1);
  score.body =
      Resonator{"probe", "", ModeTable{{{{600, 20, 0.1}, 1.5, 0.5}, {{3000, 100, 0.2}, -1, 2}}}, {0}, {0}, 10};
  score.voices[0].pan = -0.5;  // the body has the ears, not the string
  PlayOptions best{44100};
  choose_best_output(score, best);
  ASSERT_TRUE(best.is_on_body);
  const auto sound = play(score, best, silent);
  ASSERT_EQ(sound.channels, 2);
  const std::vector<Mode> modes = {{600, 20, 0.1}, {3000, 100, 0.2}};
  const std::vector<double> strike = {1.5, -1}, pickup = {0.5, 2};
  ModalBank<double> bank(modes, 44100);
  const auto bridge = ModeShapes<double>(strike);
  const auto ear = bank.sound_pickup(ModeShapes<double>(pickup));
  std::vector<double> expected, left, right;
  for (std::size_t n = 0; n < force.samples.size(); ++n) {
    bank.predict();
    bank.push(bridge, static_cast<double>(force.samples[n]));
    bank.commit();
    expected.push_back(bank.velocity(ear));
    left.push_back(static_cast<double>(sound.samples[2 * n]));
    right.push_back(static_cast<double>(sound.samples[2 * n + 1]));
  }
  EXPECT_TRUE(sequences_within<double>(left, expected, 1e-6));
  EXPECT_EQ(left, right);
}

}  // namespace
}  // namespace contactspline::testing
