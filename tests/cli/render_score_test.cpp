// SPDX-License-Identifier: MIT
// contactspline render: the sound of a key, without the body, is the motion of its hammer and its strings under the
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

#include "contactspline/models/hammer_string.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
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

/// C4 of the piano as its file has it, and the shapes of its modes.
struct KeyC4 {
  const Keyboard keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  const KeyboardNote note = note_of(keyboard, 60);
  const Resonator resonator{"c4", "", note.string, {note.strike_position_m}, {note.strike_position_m}, kMaxModes};
  const std::vector<NumberedMode> modes = numbered_modes_of(resonator, kRate / 2).modes;

  template <typename Shape>
  [[nodiscard]] ModeShapes<double> shapes(const Shape& shape) const {
    ModeShapes<double> of(modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i) of[i] = shape(modes[i]);
    return of;
  }
  [[nodiscard]] ModeShapes<double> struck_at(double place_m) const {
    Resonator at = resonator;
    at.strike.position_m = place_m;
    return shapes([&](const NumberedMode& mode) { return strike_shape(at, mode); });
  }
};

// output: of the sounding model.
template <typename Output>
std::vector<double> key_motion(const KeyC4& key, Output output) {
  Material material = key.note.felt;
  const auto felt = segment_table(design_spline(material, "felt"));
  HammerString<double> model(felt, bare(key.modes), key.struck_at(key.note.strike_position_m), kRate);
  SinkingDamper damper(key.keyboard.damper_per_s);
  std::vector<double> motion;
  for (int n = 0; n < 17640; ++n) {
    if (n == 441) model.strike(2.5, 1e-4);
    if (n == 4410) model.strike(3.5, 1e-4);
    if (n == 13230) {
      model.strike_at(key.struck_at(0.2));
      model.strike(1.5, 1e-4);
    }
    const bool is_damped = n >= 8820 && n < 13230;
    HammerStringControls<double> controls{.hammer_mass_kg = key.note.hammer_mass_kg,
                                          .felt = {1, key.keyboard.felt_loss_s_per_m},
                                          .damping_per_s = is_damped ? damper.next() : 0};
    if (n >= 13230) controls = {.hammer_mass_kg = 0.002, .felt = {4, 0.2}, .damping_per_s = 0};
    controls.damping_per_s += glide(0, 20, n, 13671, 13671 + 2205);
    model.tick(controls);
    motion.push_back(output(model.string(), model));
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

// Each channel has its part of equal power.
TEST(RenderScore, PlaysAKey) {
  const KeyC4 key;
  const auto pickup = key.shapes([&](const NumberedMode& mode) { return pickup_shape(key.resonator, mode); });
  const auto bridge =
      key.shapes([&](const NumberedMode& mode) { return key.note.strings * bridge_shape(key.note.string, mode); });
  const auto expect = [&](const Words& signal, const auto& output) {
    const double angle = (0.6 * ((60 - 21) / 43.5 - 1) + 1) * pi / 4;
    std::vector<double> both;
    for (const double sample : key_motion(key, output))
      both.insert(both.end(), {std::cos(angle) * sample, std::sin(angle) * sample});
    expect_is(sound_of(kKeyScore, followed_by({"--signal"}, signal)), both,
              3 * kLevel);  // panned in single precision
  };
  expect({"bridge"},
         [&](const auto& string, const auto&) { return string.displacement(string.sound_pickup(bridge)); });
  expect({"velocity"}, [&](const auto& string, const auto&) { return string.velocity(string.sound_pickup(pickup)); });
  expect({"displacement"},
         [&](const auto& string, const auto&) { return string.displacement(string.sound_pickup(pickup)); });
  expect({"force"}, [](const auto&, const auto& model) { return model.force(); });
}

// The outputs of the gong that begin with left_ and right_, as --signal gives each of them.
TEST(RenderScore, HasTheSidesOfAnInstrument) {
  const auto sound_of_gong = [](const std::string& voices, const Words& signal) {
    return sound_alone(
        R"({"instrument": "gong", "duration_s": 0.2, )" + voices + R"("events": [{"time_s": 0.01, "key": 52}]})", {},
        followed_by({"--gain", "-20"}, signal));
  };
  const Sound both = sound_of_gong("", {}), left = sound_of_gong("", {"--signal", "left"}),
              right = sound_of_gong("", {"--signal", "right"}),
              panned = sound_of_gong(R"("voices": [{"name": "v", "pan": 0.5}], )", {});
  ASSERT_EQ(both.channels, 2);
  ASSERT_EQ(left.channels, 1);
  ASSERT_EQ(panned.channels, 2);
  ASSERT_EQ(both.samples.size(), 2 * left.samples.size());
  EXPECT_GT(left.peak(), 1000 * kLevel);
  EXPECT_NE(left.samples, right.samples);
  const double angle = 0.75 * pi / 2;
  for (std::size_t n = 0; n < left.samples.size(); ++n) {
    ASSERT_TRUE(within(both.samples[2 * n], left.samples[n], 2.5 * kLevel)) << n;
    ASSERT_TRUE(within(both.samples[2 * n + 1], right.samples[n], 2.5 * kLevel)) << n;
    ASSERT_TRUE(within(panned.samples[2 * n], std::sqrt(2) * std::cos(angle) * left.samples[n], 4 * kLevel)) << n;
    ASSERT_TRUE(within(panned.samples[2 * n + 1], std::sqrt(2) * std::sin(angle) * right.samples[n], 4 * kLevel))
        << n;
  }
}

TEST(RenderScore, FindsFilesBesideTheScore) {
  const Sandbox box;
  fs::create_directories(box / "music");
  write_file(box / "music/string.json", shipped(embedded_files(Shipped::kResonators), "string_c4"));
  write_file(box / "music/felt.json", shipped(embedded_files(Shipped::kMaterials), "felt_c4"));
  write_file(box / "music/probe.json", hammer_score("string.json", "./felt.json"));
  succeed({.arguments = {"render", "music/probe.json", "-o", "a.wav"}, .folder = box.path()});
  EXPECT_EQ(read_sound(box / "a.wav").samples, sound_of(hammer_score("string_c4", "felt_c4")).samples);
}

TEST(RenderScore, HasTheRateAskedFor) {
  for (const int rate : {8000, 48000, 192000}) {
    const Sound sound = sound_of(kStroke, {"--rate", fmt::format("{}", rate)});
    EXPECT_EQ(sound.rate, rate);
    EXPECT_EQ(sound.samples.size(), static_cast<std::size_t>(0.05 * rate));
  }
}

}  // namespace
}  // namespace contactspline::testing
