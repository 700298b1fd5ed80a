// SPDX-License-Identifier: MIT
// A keyboard whose strings move along themselves, beside the same one without: strings, bridge and body do the same
// to the last bit, and only the sound of the keys that have this motion differs.
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "contactspline/instrument/keyboard_instrument.hpp"
#include "generator/player/instrument_parts.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;
constexpr std::size_t kLow = 0, kHigh = 24;  // keys, of which only the lower one has the motion

std::string keyboard_text(const std::string& longitudinal) {
  return R"({ "name": "along", "keyboard": { "first_key": 28, "last_key": 60, "first_double_key": 32,
    "first_triple_key": 44, "last_damped_key": 60, "concert_pitch_hz": 440, "min_speed_m_per_s": 0.2,
    "max_speed_m_per_s": 6, "felt_loss_s_per_m": 0.1, "damper_per_s": 60, "damper_time_s": 0.005, "segments": 24,
    "body": { "resonator": "soundboard", "double_hz": [-0.1, 0.1], "triple_hz": [-0.1, 0, 0.1],
      "una_corda_stiffness_ratio": 0.5, "mobility_m_per_n_s": 7e-4, "horizontal_strike_ratio": 0.39,
      "horizontal_bridge_ratio": 0.3, "horizontal_cents": 3.3)" +
         longitudinal + R"( },
    "notes": [ { "key": 28, "length_m": 1.875, "mass_kg": 0.0827, "bending_stiffness_n_m2": 0.0533,
      "strike_position_m": 0.2246, "constant_loss_per_s": 0.33, "quadratic_loss_m2_per_s": 2e-5,
      "hammer_mass_kg": 0.0094, "stiffness_n_per_m_alpha": 1.3e11, "exponent": 3.3 },
    { "key": 60, "length_m": 0.657, "mass_kg": 0.004051, "bending_stiffness_n_m2": 0.009288,
      "strike_position_m": 0.07574, "constant_loss_per_s": 0.33, "quadratic_loss_m2_per_s": 1e-4,
      "hammer_mass_kg": 0.00696, "stiffness_n_per_m_alpha": 2.347e9, "exponent": 2.418 } ] } })";
}

std::string longitudinal(const std::string& output_ratio) {
  return R"(, "longitudinal": { "frequency_ratio": 16, "constant_loss_per_s": 30,
    "quadratic_loss_m2_per_s": 0.01, "last_key": 45, "output_ratio": )" +
         output_ratio + " }";
}

template <typename T>
PedaledKeyboard<T> keyboard(const std::string& longitudinal) {
  const std::string text = keyboard_text(longitudinal);
  std::string events;
  for (int key = 28; key <= 60; ++key)
    events += R"({ "time_s": 0, "key": )" + std::to_string(key) + R"(, "hold_s": 0 })" + (key < 60 ? ", " : "");
  const auto score = R"({ "instrument": "along.json", "duration_s": 1, "events": [ )" + events + " ] }";
  return {
      std::make_shared<const KeyboardParts>(keyboard_parts(
          parse_keyboard(text, "along.json"),
          std::make_shared<const Score>(parse_score(score, "score.json", [=](const std::string&) { return text; })))),
      kRate};
}

/// Blows, pedals and a bend, sample by sample: the left ear. each(): after each sample.
template <typename T, typename Each>
std::vector<T> played(PedaledKeyboard<T>& piano, std::size_t key, Each each) {
  std::vector<T> sound;
  for (int n = 0; n < 22050; ++n) {
    if (n == 10 || n == 9000) piano.strike(key, T(5));
    if (n == 4000) piano.set(KeyboardParameter::kSustain, 1);
    if (n == 5000) piano.release(key);
    if (n == 7000) piano.set(KeyboardParameter::kBend, 40);
    if (n == 14000) piano.set(KeyboardParameter::kSustain, 0), piano.release(key);
    std::array<T, 1> left, right;
    piano.process(left, right);
    each(n);
    sound.push_back(left[0]);
  }
  return sound;
}

template <typename T>
class KeyboardLongitudinal : public ::testing::Test {};
TYPED_TEST_SUITE(KeyboardLongitudinal, Precisions);

// One way: energy, body and bridge are those without this motion, bit by bit. So the balance of energy is, too.
TYPED_TEST(KeyboardLongitudinal, ChangesNothingButTheSound) {
  auto with = keyboard<TypeParam>(longitudinal("0.5")), without = keyboard<TypeParam>("");
  std::vector<double> energy, displacement;
  const auto silent = played(without, kLow, [&](int) {
    energy.push_back(without.energy());
    displacement.push_back(double(without.body().displacement(0)));
  });
  bool is_same = true;
  double difference = 0, largest = 0;
  const auto sound = played(with, kLow, [&](int n) {
    is_same = is_same && with.energy() == energy[static_cast<std::size_t>(n)] &&
              double(with.body().displacement(0)) == displacement[static_cast<std::size_t>(n)];
  });
  EXPECT_TRUE(is_same);
  for (std::size_t n = 0; n < sound.size(); ++n) {
    difference = std::max(difference, std::abs(double(sound[n] - silent[n])));
    largest = std::max(largest, std::abs(double(silent[n])));
  }
  Measured() << "largest difference " << difference << " of " << largest << " m/s";
  EXPECT_GT(difference, 0.01 * largest);
  EXPECT_LT(difference, 10 * largest);
}

// A key above last_key has none, and the sound grows with output_ratio.
TEST(KeyboardLongitudinalSound, IsThatOfItsKeysAndItsRatio) {
  const auto sound = [](const std::string& motion, std::size_t key) {
    auto piano = keyboard<double>(motion);
    return played(piano, key, [](int) {});
  };
  EXPECT_EQ(sound(longitudinal("0.5"), kHigh), sound("", kHigh));
  const auto silent = sound("", kLow), soft = sound(longitudinal("0.5"), kLow), loud = sound(longitudinal("1"), kLow);
  std::vector<double> added, expected;
  for (std::size_t n = 0; n < silent.size(); ++n) {
    added.push_back(loud[n] - silent[n]);
    expected.push_back(2 * (soft[n] - silent[n]));
  }
  EXPECT_TRUE(sequences_within<double>(added, expected, 1e-12));
}

// Where blocks are cut has no effect, and a reset leaves nothing: neither then nor in the next note.
TYPED_TEST(KeyboardLongitudinal, SoundsTheSameInBlocksAndIsSilentAfterReset) {
  auto one = keyboard<TypeParam>(longitudinal("1")), other = keyboard<TypeParam>(longitudinal("1"));
  std::vector<TypeParam> left(2000), right(2000), by_one, unused(1);
  for (auto* piano : {&one, &other}) piano->strike(kLow, TypeParam(4));
  one.process(left, right);
  for (std::size_t n = 0; n < left.size(); ++n) {
    std::array<TypeParam, 1> sample;
    other.process(sample, std::span(unused));
    by_one.push_back(sample[0]);
  }
  EXPECT_EQ(by_one, left);
  one.reset();
  one.process(left, right);
  for (const TypeParam sample : left) ASSERT_EQ(sample, 0);
  one.strike(kLow, TypeParam(4));
  one.process(left, right);
  EXPECT_EQ(left, by_one);
}

// Extreme blows and numbers that are none: the sound is a number, and falls silent.
TYPED_TEST(KeyboardLongitudinal, StaysFinite) {
  auto piano = keyboard<TypeParam>(longitudinal("10"));
  std::vector<TypeParam> left(441), right(441);
  for (int n = 0; n < 200; ++n) {
    if (n < 100) {
      piano.set(KeyboardParameter::kMassRatio, n % 3 == 0 ? 1e6 : 1e-6);
      piano.set(KeyboardParameter::kHardness, n % 2 == 0 ? 1e6 : 1e-6);
      piano.strike(static_cast<std::size_t>(n % 20), TypeParam(n % 2 == 0 ? 1000 : -1000));
      piano.strike(kLow, std::numeric_limits<TypeParam>::quiet_NaN());
    }
    piano.process(left, right);
    for (std::size_t i = 0; i < left.size(); ++i) ASSERT_TRUE(is_finite(left[i]) && is_finite(right[i])) << n;
  }
  EXPECT_EQ(piano.failures(), 0u);
}

}  // namespace
}  // namespace contactspline::testing
