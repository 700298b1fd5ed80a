// SPDX-License-Identifier: MIT
// What a score may do to a model, and what a sound that is not finite leads to.
#include "generator/player/score_player.hpp"

#include <limits>
#include <sstream>

#include "generator/player/score_reader.hpp"
#include "generator/support/error.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

// A slide of 50 g that a hand presses on a string with 2 N.
Score slide_score(const std::string& events) {
  return parse_score(R"({
    "instrument": { "name": "slide",
      "bodies": [ { "name": "string", "resonator": "guitar_g3" }, { "name": "slide", "mass_kg": 0.05 } ],
      "places": [ { "name": "under_slide", "body": "string", "position_m": 0.2 },
                  { "name": "plucked", "body": "string", "position_m": 0.5 } ],
      "contacts": [ { "name": "wire", "between": ["slide", "under_slide"], "material": "steel_on_steel" } ],
      "springs": [ { "name": "hand", "between": ["slide", "ground"], "stiffness_n_per_m": 200, "resistance_n_s_per_m": 2 } ],
      "controls": [ { "name": "press", "force_n": "slide", "initial": 2, "min": -2, "max": 10 },
                    { "name": "slide", "stiffness_ratio": "wire", "min": 1e-6, "max": 1e6 },
                    { "name": "pick", "force_n": "plucked", "min": -5, "max": 5, "release_n": 4 } ],
      "outputs": [ { "name": "plucked", "velocity_m_per_s": "plucked" } ] },
    "duration_s": 1, "events": [ { "time_s": 0.05, "pick_release_n": 4 })" +
                         events + "] }",
                     "probe.json", shipped_file);
}

Performance played(const Score& score, Precision precision) {
  return play(score, {.sample_rate_hz = 44100, .precision = precision}, [](double) {});
}

// A stiffness that jumps by 1e12 under a pressed slide, each way a hundred times: its rises do 1 W of work at most,
// so the slide hits no harder than a note or two.
TEST(ScorePlayer, IsBoundedWhereTheStiffnessJumps) {
  std::ostringstream events;
  for (int i = 0; i < 200; ++i)
    events << R"(, { "time_s": )" << 0.1 + 0.004 * i << R"(, "slide_stiffness_ratio": )"
           << (i % 2 == 0 ? "1e-6" : "1e6") << " }";
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

// The second key has a mode whose mass is no number, or one beyond what a sound file holds, and is struck at 0.1 s.
TEST(ScorePlayer, SaysWhereASoundIsNotFinite) {
  Score score = parse_score(R"({ "instrument": "piano", "duration_s": 0.3, "events": [
    { "time_s": 0, "key": 55, "speed_m_per_s": 2 }, { "time_s": 0.1, "key": 60, "speed_m_per_s": 2 } ] })",
                            "probe.json", shipped_file);
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
      EXPECT_TRUE(message.starts_with("probe.json: voice 60: its sound is not finite from 0.1")) << message;
      EXPECT_NE(message.find(" s on; allowed: "), std::string::npos) << message;
    }
}

// Strings so light that single precision cannot hold what a force does to them: the keyboard comes to rest at one of
// its checks, within 88 times 32 samples, which would be a silence that nobody explains. A board whose motion is no
// number is found at once.
TEST(ScorePlayer, SaysWhereAKeyboardIsNotFinite) {
  const Score good = parse_score(R"({ "instrument": "piano", "duration_s": 0.3,
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

}  // namespace
}  // namespace contactspline::testing
