// SPDX-License-Identifier: MIT
// contactspline render hammer-string, slide-string, fret-string: the sound is the motion of the models under the
// score.
#include "render_score.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/models/slide_string.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

/// A damper that covers a constant fraction of its remaining distance with each sample, held for 16 samples at its
/// mean.
class SinkingDamper {
 public:
  explicit SinkingDamper(double full_per_s) : full_per_s_(full_per_s) {}

  /// Damping over the next sample [1/s].
  double next() {
    if (sample_++ % 16 == 0) {
      mean_ = 0;
      for (int i = 0; i < 16; ++i) mean_ += (value_ += kFraction * (full_per_s_ - value_)) / 16;
    }
    return mean_;
  }

 private:
  const double kFraction = 1 - std::exp(-1 / (0.005 * kRate));

  double full_per_s_, value_ = 0, mean_ = 0;
  int sample_ = 0;
};

// Two throws at once held, a damper between, a third throw elsewhere with another hammer, a damping that glides in.
std::vector<double> hammer_motion(Parts& parts, double (*output)(const HammerString<double>&, const Parts&)) {
  HammerString<double> model(parts.table, parts.modes, parts.at(parts.resonator.strike.position_m), kRate);
  SinkingDamper damper(30);
  std::vector<double> motion;
  for (int n = 0; n < 17640; ++n) {
    if (n == 441) model.strike(2.5, 1e-4);
    if (n == 4410) model.strike(3.5, 1e-4);
    if (n == 13230) {
      model.strike_at(parts.at(0.2));
      model.strike(1.5, 1e-4);
    }
    const bool is_damped = n >= 8820 && n < 13230;
    HammerStringControls<double> controls{.hammer_mass_kg = 0.00297, .damping_per_s = is_damped ? damper.next() : 0};
    if (n >= 13230) controls = {.hammer_mass_kg = 0.004, .felt = {4, 0.2}, .damping_per_s = 0};
    controls.damping_per_s += glide(0, 20, n, 13671, 13671 + 2205);
    model.tick(controls);
    motion.push_back(output(model, parts));
  }
  return motion;
}

// What render takes away of the sound of a score: the Butterworth high-pass of sixth order, by the bilinear transform
// with its frequency kept, and a channel as if it were alone. After a second its poles have decayed to 1e-17.
TEST(RenderScore, TakesAwayWhatIsBelowTheHighPass) {
  for (const int rate : {8000, 44100, 192000}) {
    std::vector<double> left(static_cast<std::size_t>(rate)), both;
    left[0] = 1;
    for (const double sample : left) both.insert(both.end(), {sample, -2 * sample});
    high_pass(std::span(left), 1, rate);
    high_pass(std::span(both), 2, rate);
    for (const double frequency_hz : {0.0, 1.0, 5.0, 15.0, 25.0, 27.5, 100.0, 3000.0}) {
      std::complex<double> response = 0;
      for (std::size_t n = 0; n < left.size(); ++n)
        response += left[n] * std::polar(1.0, -2 * pi * frequency_hz * static_cast<double>(n) / rate);
      const double below = std::tan(pi * kHighPass_hz / rate), there = std::tan(pi * frequency_hz / rate);
      EXPECT_TRUE(within(std::abs(response), std::sqrt(1 / (1 + std::pow(below / there, 12))), 1e-9))
          << frequency_hz << ' ' << rate;
    }
    for (std::size_t n = 0; n < left.size(); ++n) {
      ASSERT_EQ(both[2 * n], left[n]);
      ASSERT_EQ(both[2 * n + 1], -2 * left[n]);
    }
  }
}

TEST(RenderScore, PlaysTheHammerString) {
  Parts parts("string_c4", "felt_c4");
  const auto bridge = [](const HammerString<double>& model, const Parts& p) {
    ModeShapes<double> shapes(p.modes.size());
    for (std::size_t i = 0; i < p.modes.size(); ++i)
      shapes[i] = bridge_shape(std::get<StiffString>(p.resonator.body), StringMode{p.modes[i], p.wavenumbers[i]});
    return model.string().displacement(model.string().sound_pickup(shapes));
  };
  const auto velocity = [](const HammerString<double>& model, const Parts& p) {
    return model.string().velocity(model.string().sound_pickup(p.at(0.248)));
  };
  const auto displacement = [](const HammerString<double>& model, const Parts& p) {
    return model.string().displacement(model.string().sound_pickup(p.at(0.248)));
  };
  const auto force = [](const HammerString<double>& model, const Parts&) { return model.force(); };
  expect_is(sound_of("hammer-string", kHammerScore), hammer_motion(parts, bridge));
  expect_is(sound_of("hammer-string", kHammerScore, {"--signal", "velocity"}), hammer_motion(parts, velocity));
  expect_is(sound_of("hammer-string", kHammerScore, {"--signal", "displacement"}),
            hammer_motion(parts, displacement));
  expect_is(sound_of("hammer-string", kHammerScore, {"--signal", "force"}), hammer_motion(parts, force));
}

// A slide-string or a fret-string placed before its first sample; controls(n): of a sample. Velocity at the pickup.
template <typename Model, typename Controls>
std::vector<double> velocity_of(Model& model, const ModeShapes<double>& shapes, int samples, Controls controls) {
  const auto pickup = model.string().sound_pickup(shapes);
  std::vector<double> motion;
  for (int n = 0; n < samples; ++n) {
    model.tick(controls(n));
    motion.push_back(model.string().velocity(pickup));
  }
  return motion;
}

TEST(RenderScore, PlaysTheSlideString) {
  Parts parts("guitar_g3", "steel_on_steel");
  SlideString<double> model(parts.table, parts.modes, StringShapes<double>(parts.wavenumbers), 0.5, kRate);
  model.place(0.2, 1e-3);
  const auto controls = [](int n) {
    // 0.05 s: a pluck of 4 ms; from 0.1 s on the slide glides, from 0.2 s on it trembles.
    const double pluck = n < 2205 + 176 ? glide(0, 4, n, 2205, 2205 + 176) : 0.0;
    const double vibrato_m = 0.002 * std::sin(2 * pi * 6 * (n - 8820 + 1) / kRate);
    return SlideStringControls<double>{.place_m = glide(0.2, 0.3, n, 4410, 8820) + (n >= 8820 ? vibrato_m : 0.0),
                                       .slide_mass_kg = 0.04,
                                       .hand_force_n = 2,
                                       .hand_stiffness_n_per_m = 200,
                                       .hand_resistance_n_s_per_m = 2,
                                       .rest_resistance_n_s_per_m = 1,
                                       .pluck_force_n = pluck,
                                       .contact = {0.5, 0.1}};
  };
  const auto motion = velocity_of(model, parts.at(0.6), 13230, controls);
  // rattling contacts amplify what vibrato's phase, summed up sample by sample, is rounded by
  expect_is(sound_of("slide-string", R"({
    "instrument": "slide-string", "duration_s": 0.3,
    "voices": [ { "name": "g", "resonator": "guitar_g3", "material": "steel_on_steel", "pluck_m": 0.5, "pickup_m": 0.6, "height_m": 0.001 } ],
    "events": [
      { "time_s": 0, "place_m": 0.2, "slide_mass_kg": 0.04, "hand_force_n": 2, "hand_stiffness_n_per_m": 200,
        "hand_resistance_n_s_per_m": 2, "rest_resistance_n_s_per_m": 1, "stiffness_ratio": 0.5, "loss_s_per_m": 0.1 },
      { "time_s": 0.05, "pluck_n": 4 },
      { "time_s": 0.1, "over_s": 0.1, "place_m": 0.3 },
      { "time_s": 0.2, "vibrato_m": 0.002, "vibrato_hz": 6 }
    ] })"),
            motion, 1e-5);
}

// A stiffness that jumps by twelve orders of magnitude in every sample does at most 1 W of work on a pressed slide:
// no force is far beyond those of the hand and of the pluck.
TEST(RenderScore, StaysCalmWhileAStiffnessJumps) {
  std::string events = R"({ "time_s": 0, "place_m": 0.2, "slide_mass_kg": 0.04, "hand_force_n": 2,
    "hand_stiffness_n_per_m": 200, "hand_resistance_n_s_per_m": 2, "rest_resistance_n_s_per_m": 1,
    "stiffness_ratio": 0.5, "loss_s_per_m": 0.1 }, { "time_s": 0.02, "pluck_n": 4 })";
  for (int n = 0; n < 4000; ++n)
    events += fmt::format(R"(, {{ "time_s": {}, "stiffness_ratio": {} }})", 0.01 + n / 44100.0, n % 2 ? 1e6 : 1e-6);
  const Sandbox box;
  write_file(box / "jumps.json", R"({ "instrument": "slide-string", "duration_s": 0.2, "voices": [ { "name": "g",
    "resonator": "guitar_g3", "material": "steel_on_steel", "pluck_m": 0.5, "pickup_m": 0.6, "height_m": 0.001 } ], "events": [ )" +
                                     events + " ] }");
  const std::string report =
      succeed({.arguments = {"render", "slide-string", "--score", "jumps.json", "--no-figure", "-o", "jumps.wav"},
               .folder = box.path()});
  const std::string before = "largest contact force ";
  ASSERT_NE(report.find(before), std::string::npos) << report;
  EXPECT_LT(std::stod(report.substr(report.find(before) + before.size())), 1000) << report;
}

TEST(RenderScore, PlaysTheFretString) {
  Parts parts("guitar_d3", "steel_on_steel");
  FretString<double> model(parts.table, parts.modes, StringShapes<double>(parts.wavenumbers), 0.3, kRate);
  model.place(0.6, 1e-3);
  const auto motion = velocity_of(model, parts.at(0.05), 8820, [](int n) {
    return FretStringControls<double>{.place_m = 0.6,
                                      .gap_m = glide(1e-3, 1e-4, n, 4410, 6615),
                                      .pluck_force_n = n < 2205 + 176 ? glide(0, 3, n, 2205, 2205 + 176) : 0.0,
                                      .damping_per_s = 3,
                                      .contact = {2, 0.3}};
  });
  expect_is(sound_of("fret-string", R"({
    "instrument": "fret-string", "duration_s": 0.2,
    "voices": [ { "name": "d", "resonator": "guitar_d3", "material": "steel_on_steel", "pluck_m": 0.3, "pickup_m": 0.05 } ],
    "events": [
      { "time_s": 0, "place_m": 0.6, "gap_m": 0.001, "stiffness_ratio": 2, "loss_s_per_m": 0.3, "damping_per_s": 3 },
      { "time_s": 0.05, "pluck_n": 3 },
      { "time_s": 0.1, "over_s": 0.05, "gap_m": 0.0001 }
    ] })"),
            motion);
}

TEST(RenderScore, FindsFilesBesideTheScore) {
  const Sandbox box;
  fs::create_directories(box / "music");
  write_file(box / "music/string.json", shipped(embedded_files(Shipped::kResonators), "string_c4"));
  write_file(box / "music/felt.json", shipped(embedded_files(Shipped::kMaterials), "felt_c4"));
  std::string score = kHammerScore;
  score.replace(score.find("\"string_c4\""), 11, "\"string.json\"");
  score.replace(score.find("\"felt_c4\""), 9, "\"./felt.json\"");
  write_file(box / "music/probe.json", score);
  succeed(
      {.arguments = {"render", "hammer-string", "--score", "music/probe.json", "-o", "a.wav"}, .folder = box.path()});
  EXPECT_EQ(read_sound(box / "a.wav").samples, sound_of("hammer-string", kHammerScore).samples);
}

TEST(RenderScore, HasTheRateAskedFor) {
  for (const int rate : {8000, 48000, 192000}) {
    const Sound sound = sound_of("hammer-string", kHammerScore, {"--rate", fmt::format("{}", rate)});
    EXPECT_EQ(sound.rate, rate);
    EXPECT_EQ(sound.samples.size(), static_cast<std::size_t>(0.4 * rate));
  }
}

}  // namespace
}  // namespace contactspline::testing
