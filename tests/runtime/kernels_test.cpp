// SPDX-License-Identifier: MIT
// The vectorised kernels of one voice against the plain model, on every instruction set of this machine.
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "kernel_targets.hpp"
#include "strings.hpp"
#include "support/compare.hpp"
#include "support/precisions.hpp"
#include "support/random.hpp"

namespace contactspline::testing {
namespace {

struct Scene {
  StruckString struck;
  int segments;
  std::size_t modes;  // largest number of modes
  ContactControls<double> felt;
  double distance_m = 1e-4;
  double mass_ratio = 1;  // the hammer's mass over its own
};

// Chords of modes that fill vectors and that leave rests; one, two and three levels of knots; with and without loss;
// a hammer thrown from the surface, on a knot of the felt, and heavy enough to stay in contact.
std::vector<Scene> scenes() {
  return {{c4(), 32, 1000, {}},  {c2(), 32, 1000, {}},      {c7(), 16, 1000, {1, 0.1}}, {c4(), 33, 17, {2, 0.05}},
          {c4(), 1024, 80, {}},  {c2(), 4096, 31, {10, 0}}, {c4(), 1, 1, {1, 0}},       {c2(), 64, 65, {0.01, 0.3}},
          {c4(), 32, 56, {}, 0}, {c4(), 1024, 56, {}, 0},   {c4(), 1024, 56, {}, 0, 30}};
}

template <typename T>
struct Sound {
  std::vector<T> displacement, force;
  std::vector<T> compression;  ///< before each strike, at most as far back as where the hammer is caught
};

/// By tick() where `block` is 0, else by process() in blocks of so many samples; by both in turn where it is kMixed.
constexpr std::size_t kMixed = 5;
template <typename T>
Sound<T> sound(const Scene& scene, std::size_t block) {
  const auto all = audible_modes(scene.struck);
  const std::vector<ResonatorMode> modes(
      all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), scene.modes)));
  const auto table = table_in<T>(felt_table(scene.struck, scene.segments));
  HammerString<T> model(table, bare(modes), shapes<T>(modes, &ResonatorMode::strike_shape), 44100);
  const auto pickup = shapes<T>(modes, &ResonatorMode::pickup_shape);
  HammerStringControls<T> controls{
      static_cast<T>(scene.struck.hammer_kg * scene.mass_ratio),
      {static_cast<T>(scene.felt.stiffness_ratio), static_cast<T>(scene.felt.loss_s_per_m)}};
  Sound<T> out{std::vector<T>(44100), std::vector<T>(44100), {}};
  std::size_t done = 0;
  for (int strike = 0; done < out.force.size(); ++strike) {
    model.strike(static_cast<T>(0.1 + strike % 5), static_cast<T>(scene.distance_m));
    controls.damping_per_s = static_cast<T>(strike % 3 == 2 ? 25 : 0);
    const std::size_t end = std::min(done + 60 + 700 * static_cast<std::size_t>(strike % 7), out.force.size());
    while (done < end) {
      const bool is_block = block > 0 && (block != kMixed || done % 2 == 0);
      const std::span<T> part =
          std::span(out.displacement).subspan(done, std::min(is_block ? block : std::size_t(1), end - done));
      if (is_block) {
        model.process(controls, pickup, part, &out.force[done]);
      } else {
        model.tick(controls);
        part[0] = model.string().displacement(pickup);
        out.force[done] = model.force();
      }
      done += part.size();
    }
    out.compression.push_back(std::max(model.compression(), detail::kHammerStop_m<T>));
  }
  return out;
}

CONTACTSPLINE_EACH_PRECISION(Kernels);

TYPED_TEST(Kernels, PlayWhatThePlainModelPlays) {
  ASSERT_GE(targets().size(), 2u);
  for (const Scene& scene : scenes()) {
    const auto expected = sound<TypeParam>(scene, 0);
    for (const std::int64_t target : targets()) {
      const OnlyTarget only(target);
      for (const std::size_t block : {std::size_t(1), std::size_t(2), kMixed, std::size_t(100), std::size_t(5000)}) {
        SCOPED_TRACE(std::string(hwy::TargetName(target)) + ' ' + scene.struck.name + ", " +
                     std::to_string(scene.segments) + " segments, blocks of " + std::to_string(block));
        const auto found = sound<TypeParam>(scene, block);
        EXPECT_TRUE(
            sequences_within<TypeParam>(found.displacement, expected.displacement, kernel_bound<TypeParam>()));
        EXPECT_TRUE(sequences_within<TypeParam>(found.compression, expected.compression, kernel_bound<TypeParam>()));
        // In single precision forces carry the rounding of the compression times the stiffness of the felt, which is
        // no error of a kernel: they are judged in double precision.
        if (sizeof(TypeParam) == sizeof(double)) {
          EXPECT_TRUE(sequences_within<TypeParam>(found.force, expected.force, kernel_bound<TypeParam>()));
        }
      }
    }
  }
}

// A string that loses nothing, struck a hundred times a second for 10 s: what is in it, in the felt and in the hammer
// is what the throws brought in. The bound is that of the plain model (hammer_string_test).
TEST(Kernels, BalanceTheEnergy) {
  for (const double rate : {22050.0, 44100.0, 192000.0})
    for (const double ratio : {1.0, 1000.0}) {
      auto modes = bare(audible_modes(c4()));
      for (Mode& mode : modes) mode.decay_per_s = 0;
      const auto table = felt_table(c4(), 32);
      const ModeShapes<double> shape = shapes<double>(audible_modes(c4()), &ResonatorMode::strike_shape);
      for (const std::int64_t target : targets()) {
        const OnlyTarget only(target);
        HammerString<double> model(table, modes, shape, rate);
        const HammerStringControls<double> controls{.hammer_mass_kg = c4().hammer_kg,
                                                    .felt = {.stiffness_ratio = ratio}};
        const auto of_hammer = [&] {
          const double v = model.hammer_velocity();
          return controls.hammer_mass_kg * v * v / 2 +
                 ratio * potential(SegmentTable<double>(table), model.compression());
        };
        std::vector<double> out(64);
        double expected = 0, worst = 0;
        for (std::size_t n = 0; n < static_cast<std::size_t>(10 * rate); n += out.size()) {
          if (n % (out.size() * static_cast<std::size_t>(rate / 6400)) == 0) {
            expected -= of_hammer();
            model.strike(2.5, 1e-4);
            expected += of_hammer();
          }
          model.process(controls, shape, out);
          const double error = std::abs(model.string().energy() + of_hammer() - expected);
          worst = std::isfinite(error) ? std::max(worst, error) : std::numeric_limits<double>::infinity();
        }
        EXPECT_LT(worst, 1e-12 * expected)
            << hwy::TargetName(target) << ' ' << rate << " Hz, stiffness times " << ratio;
      }
    }
}

// A soft blow crosses knots by steps far shorter than the distance between them: each sample from the same state by
// play() and by tick(). Both are within some 40 roundings of the exact force (contact_step_test.cpp).
TYPED_TEST(Kernels, CrossKnotsSlowly) {
  const auto modes = audible_modes(c4());
  const auto table = table_in<TypeParam>(felt_table(c4(), 32));
  const auto pickup = shapes<TypeParam>(modes, &ResonatorMode::pickup_shape);
  const HammerStringControls<TypeParam> controls{.hammer_mass_kg = TypeParam(0.00297)};
  for (const double rate : {44100.0, 192000.0}) {
    const HammerString<TypeParam> resting(table, bare(modes), shapes<TypeParam>(modes, &ResonatorMode::strike_shape),
                                          rate);
    for (const std::int64_t target : targets()) {
      const OnlyTarget only(target);
      for (const double speed : {0.01, 0.0145, 0.03, 0.1, 2.5}) {
        auto model = resting;
        model.strike(static_cast<TypeParam>(speed), 0);
        std::vector<TypeParam> expected, found;
        for (int n = 0; n < static_cast<int>(rate / 200); ++n) {
          auto copy = model;
          TypeParam out, force;
          copy.process(controls, pickup, std::span(&out, 1), &force);
          model.tick(controls);
          expected.push_back(model.force());
          found.push_back(force);
        }
        EXPECT_TRUE(sequences_within<TypeParam>(found, expected, 80 * std::numeric_limits<TypeParam>::epsilon()))
            << hwy::TargetName(target) << ' ' << rate << " Hz, " << speed << " m/s";
      }
    }
  }
}

// Whether a hammer is caught does not depend on the blocks: one thrown from just that far, and one that the string's
// swing takes there.
TEST(Kernels, CatchTheHammerAtTheSameSample) {
  const std::vector<Mode> modes = {{2 * std::numbers::pi * 261, 0, 0.002}};  // swings by millimetres, for ever
  const auto table = felt_table(c4(), 32);
  ModeShapes<double> shape(1);
  shape[0] = 1;
  const HammerStringControls<double> controls{.hammer_mass_kg = 0.00297};
  for (const double speed : {2.5, 0.2}) {
    std::vector<std::vector<double>> sounds;
    for (const std::size_t block : {1u, 2u, 100u, 1000u}) {
      HammerString<double> model(table, modes, shape, 44100);
      std::vector<double>& out = sounds.emplace_back(20000);
      model.strike(5, 0);
      model.process(controls, shape, std::span(out).first(400));
      model.strike(speed, speed > 1 ? 0.05 : 0.0495);
      for (std::size_t at = 400; at < out.size(); at += std::min(block, out.size() - at))
        model.process(controls, shape, std::span(out).subspan(at, std::min(block, out.size() - at)));
      EXPECT_TRUE(sequences_within<double>(out, sounds.front(), 1e-12)) << block << ", " << speed << " m/s";
    }
  }
}

// A mode that sounds goes on sounding when the hammer moves to one of its nodes, or next to it.
TYPED_TEST(Kernels, KeepModesThatAreNotStruck) {
  const std::vector<Mode> modes = {{1600, 1, 0.002}, {3300, 1, 0.002}, {5100, 1, 0.002}};
  const auto table = table_in<TypeParam>(felt_table(c4(), 32));
  const auto of = [](double a, double b, double c) { return ModeShapes<TypeParam>(std::array{a, b, c}); };
  const auto pickup = of(1, 1, 1);
  const HammerStringControls<TypeParam> controls{.hammer_mass_kg = TypeParam(0.00297)};
  const auto play = [&](std::size_t block) {
    HammerString<TypeParam> model(table, modes, of(0.1, 1, 1), 44100);
    std::vector<TypeParam> out(2000);
    for (std::size_t at = 0; at < out.size(); at += std::max<std::size_t>(block, 1)) {
      if (at % 500 == 0) {
        if (at == 500) model.strike_at(of(1, 0, 1e-20));
        model.strike(TypeParam(2.5), TypeParam(1e-4));
      }
      if (block > 0) {
        model.process(controls, pickup, std::span(out).subspan(at, block));
      } else {
        model.tick(controls);
        out[at] = model.string().displacement(pickup);
      }
    }
    return out;
  };
  const auto expected = play(0);
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    for (const std::size_t block : {1u, 50u, 500u})
      EXPECT_TRUE(sequences_within<TypeParam>(play(block), expected, kernel_bound<TypeParam>()))
          << hwy::TargetName(target) << ' ' << block;
  }
}

// A felt that changes in the midst of a contact, as LiveExponent does, changes at once.
TEST(Kernels, FollowALiveFelt) {
  const auto modes = audible_modes(c4());
  const auto shape = shapes<double>(modes, &ResonatorMode::strike_shape);
  const auto pickup = shapes<double>(modes, &ResonatorMode::pickup_shape);
  const auto play = [&](bool by_ticks) {
    auto table = felt_table(c4(), 32);
    HammerString<double> model(table, bare(modes), shape, 44100);
    const HammerStringControls<double> controls{.hammer_mass_kg = 0.00297};
    std::vector<double> out(300);
    model.strike(2.5, 1e-4);
    for (std::size_t at = 0; at < out.size(); at += 10) {
      for (double& sample : std::span(out).subspan(at, 10)) {
        if (!by_ticks) break;
        model.tick(controls);
        sample = model.string().displacement(pickup);
      }
      if (!by_ticks) model.process(controls, pickup, std::span(out).subspan(at, 10));
      for (auto& segment : table) {
        segment.energy *= 1.02;
        segment.force *= 1.02;
        segment.half_curvature *= 1.02;
      }
    }
    return out;
  };
  EXPECT_TRUE(sequences_within<double>(play(false), play(true), 1e-12));
}

// A throw that is no number leaves string and model as they were.
TEST(Kernels, OutliveWhatIsNoNumber) {
  const auto modes = audible_modes(c4());
  const auto table = felt_table(c4(), 32);
  const auto pickup = shapes<double>(modes, &ResonatorMode::pickup_shape);
  const HammerStringControls<double> controls{.hammer_mass_kg = 0.00297};
  for (const std::int64_t target : targets())
    for (const std::size_t block : {1u, 1000u}) {
      const OnlyTarget only(target);
      std::vector<double> expected(1000), found(1000);
      for (auto* const out : {&expected, &found}) {
        HammerString<double> model(table, bare(modes), shapes<double>(modes, &ResonatorMode::strike_shape), 44100);
        for (const double speed : {std::nan(""), 2.5}) {
          if (out == &expected && std::isnan(speed)) continue;
          model.strike(speed, 1e-4);
          for (std::size_t at = 0; at < out->size(); at += block)
            model.process(controls, pickup, std::span(*out).subspan(at, block));
        }
      }
      EXPECT_TRUE(sequences_within<double>(found, expected, 1e-15)) << hwy::TargetName(target) << ' ' << block;
    }
}

/// A string with a hammer in any state.
template <typename T>
struct Thrown {
  Thrown(SegmentTable<T> felt_table, std::span<const Mode> modes, const ModeShapes<T>& at,
         const ContactControls<T>& felt, T velocity, T compression, std::size_t block)
      : table(felt_table),
        string(modes, 44100),
        shape(at),
        constants(table, modes.size()),
        hammer{.mass_kg = T(0.003),
               .felt = felt,
               .compression_m = compression,
               .velocity_m_per_s = velocity,
               .segment = segment_index(table, compression)},
        out(block),
        force(block) {
    constants.strike_at(string, shape);
  }
  detail::StruckVoice<T> voice() {
    return {constants.view(string.arrays(), table, shape, T(1 / 44100.0), 1, shape), &hammer, out, force.data()};
  }

  SegmentTable<T> table;
  ModalBank<T> string;
  ModeShapes<T> shape;
  detail::StrikeConstantsStorage<T> constants;
  detail::HammerState<T> hammer;
  std::vector<T> out, force;
};

// Whatever the state of the hammer, a kernel stays within the table: in one, two and three levels of knots, with and
// without loss. HammerString keeps such numbers out (controls_test); this is the kernels' own door.
TYPED_TEST(Kernels, StayWithinTheTableForAnyLoad) {
  using T = TypeParam;
  constexpr T kInfinity = std::numeric_limits<T>::infinity(), kNan = std::numeric_limits<T>::quiet_NaN(),
              kMax = std::numeric_limits<T>::max();
  const T values[] = {kInfinity, -kInfinity, kNan, kMax, -kMax, kMax / 2, 1e30f, -1e30f, 2, -2, 0};
  const auto modes = bare(audible_modes(c4()));
  const auto shape = shapes<T>(audible_modes(c4()), &ResonatorMode::strike_shape);
  for (const int segments : {1, 32, 33, 64, 1500}) {
    const auto table = table_in<T>(felt_table(c4(), segments));
    for (const std::int64_t target : targets()) {
      const OnlyTarget only(target);
      for (const std::size_t block : {1u, 40u})
        for (const T velocity : values) {
          // Each alone, then all together.
          std::vector<std::unique_ptr<Thrown<T>>> all;
          std::vector<detail::StruckVoice<T>> voices;
          for (const T compression : {T(-1e-4), T(0), table.back().knot / 2, 2 * table.back().knot})
            for (const ContactControls<T>& felt : {ContactControls<T>{1, 0}, {1, 1}, {kMax, 0}, {kMax, kMax}})
              for (int twice = 0; twice < 2; ++twice)
                all.push_back(std::make_unique<Thrown<T>>(table, modes, shape, felt, velocity, compression, block));
          for (int again = 0; again < 3; ++again) {
            voices.clear();
            for (std::size_t i = 0; i < all.size(); ++i) {
              auto voice = all[i]->voice();
              if (i % 2 == 0) {
                detail::kernels<T>.process_struck(std::span(&voice, 1));
                EXPECT_LE(voice.written, block);
              } else {
                voices.push_back(voice);
              }
            }
            detail::kernels<T>.process_struck(std::span(voices));
            for (const auto& voice : voices) EXPECT_LE(voice.written, block);
            for (const auto& thrown : all)
              ASSERT_LT(thrown->hammer.segment, table.size())
                  << hwy::TargetName(target) << ' ' << segments << " segments, " << velocity << " m/s";
          }
        }
    }
  }
}

// The search begins where the last steps led. Wherever that is, the samples are the same to the bit: in steps within
// a segment, across the knots that are judged at once, next to them and far beyond.
TYPED_TEST(Kernels, StepTheSameWhereverTheSearchBegins) {
  using T = TypeParam;
  const auto modes = bare(audible_modes(c4()));
  const auto shape = shapes<T>(audible_modes(c4()), &ResonatorMode::strike_shape);
  for (const int segments : {1, 32, 48, 200, 1500}) {
    const auto table = table_in<T>(felt_table(c4(), segments));
    for (const std::int64_t target : targets()) {
      const OnlyTarget only(target);
      Random random(static_cast<unsigned>(segments));
      for (int trial = 0; trial < 100; ++trial) {
        const ContactControls<T> felt{T(random.log_between(0.01, 100)), T(random.below(2))};
        const T compression = T(random.between(-0.2, 1.2)) * table.back().knot;
        const T velocity = T(random.between(-1, 1) * random.log_between(0.1, 100));
        const std::size_t block = random.below(2) == 0 ? 1 : 8;
        const auto from = [&](std::ptrdiff_t last, std::ptrdiff_t before) {
          Thrown<T> thrown(table, modes, shape, felt, velocity, compression, block);
          thrown.hammer.crossed[0] = last, thrown.hammer.crossed[1] = before;
          auto voice = thrown.voice();
          detail::kernels<T>.process_struck(std::span(&voice, 1));
          auto sound = thrown.out;
          sound.insert(sound.end(), thrown.force.begin(), thrown.force.end());
          sound.push_back(thrown.hammer.compression_m);
          return sound;
        };
        const auto expected = from(0, 0);
        ASSERT_TRUE(all_finite<T>(expected));
        for (int start = 0; start < 5; ++start) {
          const auto any = [&] { return static_cast<std::ptrdiff_t>(random.below(61)) - 30; };
          const auto found = from(any(), any());
          ASSERT_EQ(found, expected) << hwy::TargetName(target) << ", " << segments << " segments, trial " << trial;
        }
      }
    }
  }
}

// A string that is retuned in contact and after it is retuned at once.
TYPED_TEST(Kernels, FollowARetunedString) {
  const auto modes = audible_modes(c4());
  const auto shape = shapes<TypeParam>(modes, &ResonatorMode::strike_shape);
  const auto pickup = shapes<TypeParam>(modes, &ResonatorMode::pickup_shape);
  const auto table = table_in<TypeParam>(felt_table(c4(), 32));
  const auto play = [&](bool by_ticks) {
    HammerString<TypeParam> model(table, bare(modes), shape, 44100);
    const HammerStringControls<TypeParam> controls{.hammer_mass_kg = TypeParam(0.00297)};
    std::vector<TypeParam> out(3000);
    for (std::size_t at = 0; at < out.size(); at += 20) {
      std::vector<Mode> other;
      for (const auto& row : modes) other.push_back(retuned(c4().string, row, static_cast<double>(at % 200)));
      model.retune(other);
      if (at % 1500 == 0) model.strike(TypeParam(2.5), TypeParam(1e-4));
      for (TypeParam& sample : std::span(out).subspan(at, 20)) {
        if (!by_ticks) break;
        model.tick(controls);
        sample = model.string().displacement(pickup);
      }
      if (!by_ticks) model.process(controls, pickup, std::span(out).subspan(at, 20));
    }
    return out;
  };
  const auto expected = play(true);
  for (const std::int64_t target : targets()) {
    const OnlyTarget only(target);
    EXPECT_TRUE(sequences_within<TypeParam>(play(false), expected, kernel_bound<TypeParam>()))
        << hwy::TargetName(target);
  }
}

// What has died away must not crawl on in the numbers below the smallest normal one, which are slow.
TEST(Kernels, LeaveNoDenormalsOfADyingSound) {
  const auto modes = audible_modes(c4());
  const auto table = table_in<float>(felt_table(c4(), 32));
  HammerString<float> model(table, bare(modes), shapes<float>(modes, &ResonatorMode::strike_shape), 44100);
  const auto pickup = shapes<float>(modes, &ResonatorMode::pickup_shape);
  model.strike(2.5f, 1e-4f);
  std::vector<float> out(44100);
  for (int second = 0; second < 20; ++second)
    model.process({.hammer_mass_kg = 0.00297f, .damping_per_s = second == 0 ? 0.0f : 10.0f}, pickup, out);
  for (const float sample : out) {
    ASSERT_LT(std::abs(sample), 1e-30f);
    ASSERT_NE(std::fpclassify(sample), FP_SUBNORMAL);
  }
}

}  // namespace
}  // namespace contactspline::testing
