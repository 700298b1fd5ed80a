// SPDX-License-Identifier: MIT
// The longitudinal motion of a key that sounds, against the modes by themselves: it begins while the strings ring and
// ends with the key, without a step in the sound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "contactspline/modal/longitudinal.hpp"
#include "contactspline/models/keys_on_bridge.hpp"
#include "contactspline/step/high_pass.hpp"
#include "strings_on_body.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;
constexpr Listening kListening{.pickup_ratio = 0, .mobility_m_per_n_s = 0.7, .above_hz = 2};
constexpr double kOutput = 1.3, kLongitudinalOutput = 0.4;
/// Sound per newton of longitudinal force.
constexpr double kWeight = kListening.mobility_m_per_n_s * kOutput * kLongitudinalOutput;
constexpr int kBegins = 1500, kEnds = 4000, kBeginsAgain = 4200, kSamples = 6000;

/// C4 on a board that is heard by the force on its bridge alone.
struct Piano {
  Piano() {
    for (const auto& mode : modes) {
      bare_modes.push_back(mode.mode);
      bridge.push_back(mode.strike_shape);
    }
  }

  [[nodiscard]] detail::KeysOnBridge<double> on_bridge(const LongitudinalMotion& motion) const {
    const KeyOnBody<double> keys[] = {{.strings = struck.string,
                                       .strike_position_m = struck.strike_m,
                                       .felt = SegmentTable<double>(felt),
                                       .hammer = {.hammer_mass_kg = struck.hammer_kg / 3},
                                       .damper = {60, 0.005},
                                       .output_ratio = kOutput,
                                       .longitudinal = motion}};
    return {keys, {bare_modes, bridge, bridge, bridge, kListening}, kRate, 40};
  }

  StruckString struck = c4();
  std::vector<ResonatorMode> modes = board(40, 3);
  std::vector<Mode> bare_modes;
  std::vector<double> bridge;
  std::vector<Segment<double>> felt = felt_table(c4(), 32);
};

/// Two blows; the longitudinal motion begins while the strings ring, ends early with the key, and begins again with
/// the second blow. each(keys, n) after each sample; the left ear.
template <typename Each>
std::vector<double> played(detail::KeysOnBridge<double>& keys, Each each) {
  std::vector<double> sound(kSamples), right(1);
  auto& key = keys.key(0);
  for (int n = 0; n < kSamples; ++n) {
    if (n == 0 || n == kBeginsAgain) {
      keys.set_modes(0, key.model.string().size());
      key.prepare_strike(0, 1, 1, {});
      key.model.strike(3, 1e-4);
      key.is_struck = true;
    }
    if (n == kBegins || n == kBeginsAgain) keys.move_longitudinally(0);
    if (n == kEnds) {
      key.is_struck = false;
      keys.set_modes(0, 0);
    }
    keys.process(std::span(sound).subspan(static_cast<std::size_t>(n), 1), right, {}, {});
    each(n);
  }
  return sound;
}

// Both ways round sums of fewer than 1,000 terms. The steps that are taken out are larger by far than this bound.
TEST(LongitudinalOnBridge, BeginsAndEndsWithoutAStep) {
  const Piano piano;
  const LongitudinalMotion motion{axial_stiffness(piano.struck.string.tension_n, 8), {30, 0.02}, kLongitudinalOutput};
  auto without = piano.on_bridge({});
  auto with = piano.on_bridge(motion);

  // The modes by themselves follow the strings of the keyboard that has no such motion.
  const auto& key = without.key(0);
  ModeShapes<double> displacements(key.rows.size());
  const std::span<const double> all(displacements.data(), displacements.size());
  std::optional<LongitudinalModes<double>> modes;
  HighPass<double> high_pass(kListening.above_hz, kRate, kListening.quality);
  std::vector<double> expected;
  double step = 0, at_begin = 0, at_end = 0;
  const auto silent = played(without, [&](int n) {
    if (n == kBegins || n == kBeginsAgain) {
      modes.emplace(piano.struck.string, motion, std::span<const detail::SoundingKey<double>::Row>(key.rows), kRate);
      const double begins = modes->begin(all);
      if (n == kBegins) at_begin = std::abs(begins);
      step -= begins;
    }
    if (n == kEnds) {
      at_end = std::abs(modes->force());
      step += modes->force();
      modes.reset();
      for (std::size_t i = 0; i < displacements.size(); ++i) displacements[i] = 0;
    }
    for (std::size_t i = 0; i < key.modes; ++i) displacements[i] = key.model.string().displacements()[i];
    const double force = modes ? modes->tick(all) : 0;
    expected.push_back(kWeight * high_pass.tick(force + step));
    step *= std::exp(-1 / (0.01 * kRate));
  });

  auto difference = played(with, [](int) {});
  double peak = 0;
  for (std::size_t n = 0; n < difference.size(); ++n) {
    difference[n] -= silent[n];
    peak = std::max(peak, std::abs(expected[n]));
  }
  Measured() << "largest difference " << peak << " m/s, steps of " << kWeight * at_begin << " and "
             << kWeight * at_end << " m/s taken out";
  EXPECT_GT(kWeight * at_begin, 1e-3 * peak);
  EXPECT_GT(kWeight * at_end, 1e-4 * peak);
  EXPECT_TRUE(sequences_within<double>(difference, expected, 1e-9));
}

}  // namespace
}  // namespace contactspline::testing
