// SPDX-License-Identifier: MIT
// The vectorised kernels for several voices at once against each voice alone, on every instruction set of this
// machine.
#include <gtest/gtest.h>

#include <numbers>

#include "kernel_targets.hpp"
#include "strings.hpp"
#include "support/compare.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

CONTACTSPLINE_EACH_PRECISION(KernelsTogether);

constexpr std::size_t kVoices = 20;

/// Voices that differ in everything: 1 to 300 modes, tables of one, two and three levels of knots, with loss, damper
/// and controls that are no numbers, two of them never struck. They are struck at different times.
template <typename T>
class DifferentVoices {
 public:
  static constexpr std::size_t kSamples = 2000;
  struct Played {
    std::vector<std::vector<T>> sound, force;  // of each voice
  };

  DifferentVoices() {
    constexpr std::size_t kModes[] = {1, 300, 17, 56, 4, 65, 5, 128};
    constexpr int kSegments[] = {32, 33, 8, 1024, 1, 64, 16};
    for (std::size_t i = 0; i < kVoices; ++i) add(kModes[i % std::size(kModes)], kSegments[i % std::size(kSegments)]);
  }

  static bool is_struck(std::size_t voice) { return voice % 9 != 5; }

  /// All voices by tick().
  [[nodiscard]] Played alone() const {
    return played(1, [&](auto& voices, const auto& controls, Played& out, std::size_t at, std::size_t) {
      for (std::size_t i = 0; i < kVoices; ++i) {
        voices[i].tick(controls[i]);
        out.sound[i][at] = voices[i].string().displacement(pickups_[i]);
        out.force[i][at] = voices[i].force();
      }
    });
  }

  /// All voices by process_together(), in blocks of so many samples and shorter ones before strikes.
  [[nodiscard]] Played together(std::size_t block) const {
    return played(block, [&](auto& voices, const auto& controls, Played& out, std::size_t at, std::size_t samples) {
      std::vector<typename HammerString<T>::Part> parts;
      for (std::size_t i = 0; i < kVoices; ++i)
        parts.push_back({&voices[i], &controls[i], &pickups_[i], std::span(out.sound[i]).subspan(at, samples),
                         &out.force[i][at]});
      HammerString<T>::process_together(parts);
    });
  }

 private:
  void add(std::size_t size, int segments) {
    std::vector<Mode> modes;
    ModeShapes<T> strike(size), pickup(size);
    for (std::size_t k = 0; k < size; ++k) {
      const double number = static_cast<double>(k + 1), end = static_cast<double>(size + models_.size());
      modes.push_back({2 * std::numbers::pi * 21000 * number / end, 2, 0.002});
      strike[k] = static_cast<T>(std::sin(0.12 * std::numbers::pi * number));
      pickup[k] = static_cast<T>(std::sin(0.4 * std::numbers::pi * number));
    }
    tables_.push_back(table_in<T>(felt_table(c4(), segments)));
    models_.emplace_back(tables_.back(), modes, strike, 44100);
    pickups_.push_back(pickup);
  }

  static HammerStringControls<T> first_controls(std::size_t voice) {
    return {.hammer_mass_kg = static_cast<T>(0.002 + 0.001 * static_cast<double>(voice % 3)),
            .felt = {static_cast<T>(1 + voice % 4), static_cast<T>(voice % 3 == 1 ? 0.1 : 0)},
            .damping_per_s = static_cast<T>(voice % 5 == 4 ? 20 : 0)};
  }

  /// Strikes a voice whose time has come. Returns when its next strike is due.
  static std::size_t strike(std::size_t voice, std::size_t at, HammerString<T>& model,
                            HammerStringControls<T>& controls) {
    const std::size_t between = 450 + 91 * voice, first = 17 * voice;
    if (!is_struck(voice)) return kSamples;
    if (at < first) return first;
    if ((at - first) % between == 0) {
      model.strike(static_cast<T>(0.3 + 0.2 * static_cast<double>(voice)), voice % 2 == 0 ? T(1e-4) : T(0));
      if (voice % 6 == 2 && at > first) {
        controls.hammer_mass_kg = controls.damping_per_s = std::numeric_limits<T>::quiet_NaN();
        controls.felt.loss_s_per_m = std::numeric_limits<T>::quiet_NaN();
      }
    }
    return at + between - (at - first) % between;
  }

  /// play(voices, controls, out, at, samples) plays so many samples of all voices.
  template <typename Play>
  Played played(std::size_t block, Play play) const {
    auto voices = models_;
    std::vector<HammerStringControls<T>> controls;
    for (std::size_t i = 0; i < kVoices; ++i) controls.push_back(first_controls(i));
    Played out;
    out.sound = out.force = std::vector<std::vector<T>>(kVoices, std::vector<T>(kSamples));
    for (std::size_t at = 0, samples = 0; at < kSamples; at += samples) {
      std::size_t until = kSamples;
      for (std::size_t i = 0; i < kVoices; ++i) until = std::min(until, strike(i, at, voices[i], controls[i]));
      samples = std::min(until - at, block);
      play(voices, controls, out, at, samples);
    }
    return out;
  }

  std::vector<std::vector<Segment<T>>> tables_;
  std::vector<HammerString<T>> models_;
  std::vector<ModeShapes<T>> pickups_;
};

// What tick() plays of each, within the bound of one voice, whose roundings a voice beside others also has, in
// another order.
TYPED_TEST(KernelsTogether, PlayVoicesTogetherAsAlone) {
  using T = TypeParam;
  using Voices = DifferentVoices<T>;
  const Voices voices;
  const auto expected = voices.alone();
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    for (const std::size_t block : {1u, 37u, 128u, 3000u}) {
      const auto found = voices.together(block);
      for (std::size_t i = 0; i < kVoices; ++i) {
        SCOPED_TRACE(std::string(hwy::TargetName(target)) + ", blocks of " + std::to_string(block) + ", voice " +
                     std::to_string(i));
        if (!Voices::is_struck(i)) {
          EXPECT_EQ(found.sound[i], std::vector<T>(Voices::kSamples));
          EXPECT_EQ(found.force[i], std::vector<T>(Voices::kSamples));
          continue;
        }
        EXPECT_TRUE(sequences_within<T>(found.sound[i], expected.sound[i], kernel_bound<T>()));
        if (sizeof(T) == sizeof(double)) {  // as in PlayWhatThePlainModelPlays
          EXPECT_TRUE(sequences_within<T>(found.force[i], expected.force[i], kernel_bound<T>()));
        }
      }
    }
  }
}

// Strings that swing by 0.1 m and more beside hammers that stand 0.05 m away: each hammer stops in the sample that
// takes it too far, and is no longer there when the string comes.
TYPED_TEST(KernelsTogether, StopHammersTogetherAsAlone) {
  using T = TypeParam;
  constexpr std::size_t kBlocks = 60;
  const Mode mode{2 * std::numbers::pi * 1000, 1, 0.001};
  const auto table = table_in<T>(felt_table(c4(), 32));
  ModeShapes<T> shape(1);
  shape[0] = 1;
  std::vector<HammerString<T>> models(kVoices, HammerString<T>(table, {&mode, 1}, shape, 44100));
  const HammerStringControls<T> controls{.hammer_mass_kg = T(0.003)};
  for (std::size_t i = 0; i < kVoices; ++i) {
    models[i].strike(static_cast<T>(400 + i), 0);
    for (std::size_t n = 0; n < 40 + 3 * i || models[i].is_hammer_flying(); ++n) models[i].tick(controls);
    models[i].strike(static_cast<T>(-1e-3), T(0.05) - T(1e-5));
  }
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    auto alone = models, together = models;
    std::vector<std::vector<T>> expected(kVoices), found(kVoices);
    std::size_t stopped = 0;
    for (std::size_t block = 0; block < kBlocks; ++block) {
      const std::size_t samples = 20 + block;
      std::vector<typename HammerString<T>::Part> parts;
      for (std::size_t i = 0; i < kVoices; ++i) {
        found[i].resize(found[i].size() + samples);
        parts.push_back({&together[i], &controls, &shape, std::span(found[i]).last(samples)});
        for (std::size_t n = 0; n < samples; ++n) {
          alone[i].tick(controls);
          expected[i].push_back(alone[i].string().displacement(shape));
        }
      }
      HammerString<T>::process_together(parts);
      for (std::size_t i = 0; i < kVoices; ++i) {
        ASSERT_EQ(together[i].is_hammer_flying(), alone[i].is_hammer_flying())
            << hwy::TargetName(target) << ", voice " << i << ", block " << block;
        stopped += !alone[i].is_hammer_flying();
      }
    }
    EXPECT_GT(stopped, kVoices * kBlocks / 4);
    for (std::size_t i = 0; i < kVoices; ++i)
      EXPECT_TRUE(sequences_within<T>(found[i], expected[i], kernel_bound<T>()))
          << hwy::TargetName(target) << ' ' << i;
  }
}

// The balance of BalanceTheEnergy for strings side by side, each struck at a speed of its own.
TEST(KernelsTogether, BalanceTheEnergyOfVoicesTogether) {
  auto modes = bare(audible_modes(c4()));
  for (Mode& mode : modes) mode.decay_per_s = 0;
  const auto table = felt_table(c4(), 32);
  const auto shape = shapes<double>(audible_modes(c4()), &ResonatorMode::strike_shape);
  const HammerStringControls<double> controls{.hammer_mass_kg = c4().hammer_kg};
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    std::vector<HammerString<double>> models(11, HammerString<double>(table, modes, shape, 44100));
    const auto of_hammer = [&](const HammerString<double>& model) {
      const double v = model.hammer_velocity();
      return controls.hammer_mass_kg * v * v / 2 + potential(SegmentTable<double>(table), model.compression());
    };
    std::vector<double> expected(models.size());
    std::vector<std::vector<double>> out(models.size(), std::vector<double>(64));
    std::vector<HammerString<double>::Part> parts;
    for (std::size_t i = 0; i < models.size(); ++i) parts.push_back({&models[i], &controls, &shape, out[i]});
    double worst = 0;
    for (int n = 0; n < 441000 / 64; ++n) {
      for (std::size_t i = 0; i < models.size(); ++i) {
        if (n % 7 != 0) continue;
        expected[i] -= of_hammer(models[i]);
        models[i].strike(2 + 0.1 * static_cast<double>(i), 1e-4);
        expected[i] += of_hammer(models[i]);
      }
      HammerString<double>::process_together(parts);
      for (std::size_t i = 0; i < models.size(); ++i) {
        const double error = std::abs(models[i].string().energy() + of_hammer(models[i]) - expected[i]) / expected[i];
        worst = std::isfinite(error) ? std::max(worst, error) : std::numeric_limits<double>::infinity();
      }
    }
    EXPECT_LT(worst, 1e-12) << hwy::TargetName(target);
  }
}

}  // namespace
}  // namespace contactspline::testing
