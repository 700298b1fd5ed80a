// SPDX-License-Identifier: MIT
// What every instrument does, whatever its model: its lists, wrong values, extremes, allocations, blocks of any
// length, reset, damaged MIDI. CONTACTSPLINE_LIST: the header with the instruments: Precisions, the types of samples,
// and kInstruments<T>, an array of functions that make one (handle_of, or compiled of engine.hpp).
#include CONTACTSPLINE_LIST

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "contactspline/host/hosted.hpp"
#include "runtime/random_controls.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/real_time.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;
constexpr std::size_t kSamples = 4410;

template <typename T>
class EveryInstrument : public ::testing::Test {
 public:
  using Instrument = AnyInstrument<T>;

  /// Calls check(make) for each instrument of the list. make() returns a new one.
  template <typename Check>
  static void for_each(const Check& check) {
    for (const auto make : kInstruments<T>) {
      SCOPED_TRACE(make()->name());
      check(make);
    }
  }

  /// All outputs, [output][sample], and the contact force. before(n) is called before the sample n, a multiple of the
  /// block.
  template <typename Before>
  static std::vector<std::vector<T>> play(Instrument& instrument, std::size_t samples, std::size_t block,
                                          Before before, std::span<const T> input = {}) {
    const std::size_t count = instrument.outputs().size();
    std::vector<std::vector<T>> sound(count + 1, std::vector<T>(samples));
    std::vector<std::span<T>> part(count);
    for (std::size_t n = 0; n < samples; n += block) {
      before(n);
      const std::size_t length = std::min(block, samples - n);
      for (std::size_t o = 0; o < count; ++o) part[o] = std::span(sound[o]).subspan(n, length);
      const auto pushed = input.empty() ? input : input.subspan(n, length);
      expect_real_time([&] { instrument.process(part, std::span(sound[count]).subspan(n, length), pushed); });
    }
    return sound;
  }

  /// A note of the key 60, or of the next one that plays.
  static std::vector<std::vector<T>> note(Instrument& instrument, std::size_t block = 441) {
    int key = 60;
    while (!instrument.has_key(key)) key = (key + 1) % 128;
    return play(instrument, kSamples, block, [&](std::size_t n) {
      if (n == 0) instrument.note_on(key, 0.7);
    });
  }

  static double peak(const std::vector<T>& sound) {
    double peak = 0;
    for (const T x : sound) peak = std::max(peak, std::abs(double(x)));
    return peak;
  }
};

TYPED_TEST_SUITE(EveryInstrument, Precisions);

bool is_identifier(const std::string& name) {
  return !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

TYPED_TEST(EveryInstrument, HasListsThatFitEachOther) {
  TestFixture::for_each([](const auto make) {
    const auto made = make();
    const auto& instrument = *made;
    std::set<std::string> names;
    for (const Parameter& p : instrument.parameters()) {
      EXPECT_TRUE(is_identifier(p.name) && names.insert(p.name).second) << p.name;
      EXPECT_EQ(unit_of(p.name), p.unit) << p.name;
      EXPECT_LT(p.allowed.min, p.allowed.max) << p.name;
      EXPECT_GE(p.slider.min, p.allowed.min) << p.name;
      EXPECT_LE(p.slider.max, p.allowed.max) << p.name;
      EXPECT_GE(p.initial, p.slider.min) << p.name;
      EXPECT_LE(p.initial, p.slider.max) << p.name;
      EXPECT_TRUE(p.scale == Scale::kLinear || p.slider.min > 0) << p.name;
      EXPECT_GE(p.step_samples, 1U) << p.name;
    }
    for (const Event& e : instrument.events()) {
      EXPECT_TRUE(is_identifier(e.name)) << e.name;
      ASSERT_LT(e.parameter, instrument.parameters().size()) << e.name;
      const Parameter& strength = instrument.parameters()[e.parameter];
      EXPECT_EQ(std::string(strength.unit), unit_of(event_kind(e.kind).value)) << e.name;
      EXPECT_LE(strength.slider.max - strength.slider.min, 200) << e.name;  // that a hand can play
    }
    EXPECT_FALSE(instrument.outputs().empty());
    for (const Output& o : instrument.outputs()) {
      EXPECT_TRUE(is_identifier(o.name) && names.insert(o.name).second) << o.name;
      EXPECT_EQ(unit_of(o.name), o.unit) << o.name;
      EXPECT_GT(o.full_scale, 0) << o.name;
    }
    expect_real_time([&] { (void)instrument.presets(); });  // also the first time
    for (const Preset& preset : instrument.presets())
      ASSERT_EQ(preset.values.size(), instrument.parameters().size()) << preset.name;
  });
}

// Before and after prepare().
TYPED_TEST(EveryInstrument, MovesWrongValuesIntoTheirRange) {
  TestFixture::for_each([](const auto make) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto made = make();
    auto& instrument = *made;
    for (const bool is_prepared : {false, true}) {
      if (is_prepared) instrument.prepare(kRate);
      for (std::size_t p = 0; p < instrument.parameters().size(); ++p) {
        const auto [min, max] = instrument.parameters()[p].allowed;
        instrument.set(p, kInfinity);
        EXPECT_EQ(instrument.value(p), max);
        instrument.set(p, std::numeric_limits<double>::quiet_NaN());
        EXPECT_EQ(instrument.value(p), max);
        instrument.set(p, -kInfinity);
        EXPECT_EQ(instrument.value(p), min);
        instrument.set(p, instrument.parameters()[p].initial);
        EXPECT_EQ(instrument.value(p), instrument.parameters()[p].initial);
      }
    }
  });
}

TYPED_TEST(EveryInstrument, SoundsAndIsAsNewAfterAReset) {
  TestFixture::for_each([](const auto make) {
    const auto made = make();
    auto& instrument = *made;
    instrument.prepare(kRate);
    // An instrument on which a weight or a tension acts is not silent at rest.
    const bool is_silent_at_rest = instrument.is_silent(1e-14);
    const auto first = TestFixture::note(instrument);
    EXPECT_FALSE(instrument.is_silent(1e-14));
    EXPECT_GT(instrument.energy(), 1e-9);
    EXPECT_GT(TestFixture::peak(first[0]), 1e-3 * instrument.outputs()[0].full_scale);
    expect_real_time([&] { instrument.reset(); });
    EXPECT_EQ(instrument.is_silent(1e-14), is_silent_at_rest);
    EXPECT_EQ(TestFixture::note(instrument), first);
    const auto other = make();
    other->prepare(kRate);
    EXPECT_EQ(TestFixture::note(*other), first);
  });
}

// Before the first event, and after a reset, no output is above -100 dB of full scale, at any rate.
TYPED_TEST(EveryInstrument, IsSilentUntilItIsPlayed) {
  TestFixture::for_each([](const auto make) {
    const auto made = make();
    auto& instrument = *made;
    for (const double rate : {44100.0, 48000.0, 96000.0, 192000.0}) {
      instrument.prepare(rate);
      for (const bool is_reset : {false, true}) {
        if (is_reset) {
          (void)TestFixture::note(instrument);
          instrument.reset();
        }
        const auto sound = TestFixture::play(instrument, 1000, 250, [](std::size_t) {});
        for (std::size_t o = 0; o < instrument.outputs().size(); ++o)
          EXPECT_TRUE(within(TestFixture::peak(sound[o]), 0, 1e-5 * instrument.outputs()[o].full_scale))
              << instrument.outputs()[o].name << ' ' << rate << ' ' << is_reset;
      }
    }
  });
}

// A bend that has arrived holds for the new strings, too.
TYPED_TEST(EveryInstrument, KeepsItsBendWhereItIsPreparedAgain) {
  TestFixture::for_each([](const auto make) {
    const auto made = make();
    auto& instrument = *made;
    for (std::size_t p = 0; p < instrument.parameters().size(); ++p)
      if (std::string(instrument.parameters()[p].name) == "bend_cents") instrument.set(p, 100);
    instrument.prepare(kRate);
    const auto first = TestFixture::note(instrument);
    instrument.prepare(kRate);
    EXPECT_EQ(TestFixture::note(instrument), first);
  });
}

// The kernels of a hammer-string may round a sample differently where a block ends: by some roundings of the largest
// sample, which later contacts amplify a hundredfold.
TYPED_TEST(EveryInstrument, SoundsTheSameInBlocksOfAnyLength) {
  TestFixture::for_each([](const auto make) {
    const auto made = make();
    auto& instrument = *made;
    instrument.prepare(kRate);
    const auto expected = TestFixture::note(instrument, 1000);
    for (const std::size_t block : {1, 7, 64, 4410}) {
      instrument.reset();
      const auto found = TestFixture::note(instrument, block);
      for (std::size_t o = 0; o < expected.size(); ++o)
        EXPECT_TRUE(
            found[o] == expected[o] ||
            sequences_within<TypeParam>(found[o], expected[o], sizeof(TypeParam) == sizeof(float) ? 1e-5 : 1e-12))
            << o << " in blocks of " << block;
    }
  });
}

// A note under an input with gaps, in which there is also what is not a number. Where nothing can be pushed, it is
// ignored.
TYPED_TEST(EveryInstrument, IsPushedTheSameInBlocksOfAnyLength) {
  constexpr std::size_t kBegin = 50;
  TestFixture::for_each([](const auto make) {
    const auto made = make();
    auto& instrument = *made;
    instrument.prepare(kRate);
    std::vector<TypeParam> input(kSamples);
    for (std::size_t n = kBegin; n < kSamples; ++n)
      input[n] = n / 700 % 2 == 0 ? static_cast<TypeParam>(std::sin(0.2 * double(n) + 1e-5 * double(n * n))) : 0;
    input[kBegin + 20] = std::numeric_limits<TypeParam>::quiet_NaN();
    input[kBegin + 21] = -std::numeric_limits<TypeParam>::infinity();
    const auto pushed = [&](std::size_t block, std::span<const TypeParam> force_n) {
      instrument.reset();
      return TestFixture::play(
          instrument, kSamples, block, [](std::size_t) {}, force_n);
    };
    const auto silent = pushed(kSamples, {}), expected = pushed(kSamples, input);
    if (!(instrument.input_scale_n() > 0)) {
      EXPECT_EQ(expected, silent);
      return;
    }
    EXPECT_GT(TestFixture::peak(expected[0]), 0);
    for (std::size_t o = 0; o < expected.size(); ++o) {
      EXPECT_TRUE(all_finite(expected[o]));
      EXPECT_EQ(std::vector(expected[o].begin(), expected[o].begin() + kBegin),
                std::vector(silent[o].begin(), silent[o].begin() + kBegin));
    }
    for (const std::size_t block : {1, 7, 64}) EXPECT_EQ(pushed(block, input), expected) << block;
  });
}

// All parameters jump to anything, all events and keys are played, for a second; then it sounds as new.
TYPED_TEST(EveryInstrument, OutlivesAnything) {
  TestFixture::for_each([](const auto make) {
    const auto made = make();
    auto& instrument = *made;
    instrument.prepare(kRate);
    const auto expected = TestFixture::note(instrument);
    RandomControls<double> random;
    const auto change = [&](std::size_t) {
      for (std::size_t p = 0; p < instrument.parameters().size(); ++p)
        if (random.once_in(3)) instrument.set(p, random.any(instrument.parameters()[p].allowed));
      if (random.once_in(4)) instrument.note_on(static_cast<int>(random.below(160)) - 16, random.any({0, 1}));
      if (random.once_in(4)) instrument.note_off(static_cast<int>(random.below(160)) - 16);
      for (const Event& event : instrument.events())
        if (random.once_in(4))
          play_event(instrument, event, random.any(instrument.parameters()[event.parameter].allowed));
      if (random.once_in(5)) instrument.strike(random.below(100), static_cast<TypeParam>(random.any({-1e3, 1e3})));
      if (random.once_in(5))
        instrument.pluck(random.below(100), static_cast<TypeParam>(random.any({-1e3, 1e3})), 0.004);
      if (random.once_in(9)) instrument.release(random.below(100));
      if (random.once_in(99)) instrument.reset();
    };
    for (const std::size_t block : {1, 13, 128})
      for (const auto& sound : TestFixture::play(instrument, block * 300, block, change))
        ASSERT_TRUE(contactspline::all_finite(std::span<const TypeParam>(sound)));
    for (std::size_t p = 0; p < instrument.parameters().size(); ++p)
      instrument.set(p, instrument.parameters()[p].initial);
    instrument.prepare(kRate);
    EXPECT_EQ(TestFixture::note(instrument), expected);
  });
}

// A host may want no output for a while. Kernels round other outputs differently, as in blocks.
TYPED_TEST(EveryInstrument, AdvancesWhereNobodyWantsAnOutput) {
  TestFixture::for_each([](const auto make) {
    std::vector<std::vector<TypeParam>> ends;
    for (const bool is_wanted : {true, false}) {
      Hosted<TypeParam> hosted(make());
      hosted.prepare(kRate);
      hosted.midi(std::array<std::uint8_t, 3>{0x90, 60, 100});
      std::vector<TypeParam> sound(1000);
      std::vector<TypeParam*> outputs(hosted.instrument().outputs().size());
      if (is_wanted) outputs.front() = sound.data();
      hosted.process(std::span<TypeParam* const>(outputs), sound.size());
      outputs.front() = sound.data();
      hosted.process(std::span<TypeParam* const>(outputs), sound.size());
      ends.push_back(sound);
    }
    EXPECT_GT(TestFixture::peak(ends[0]), 0);
    EXPECT_TRUE(ends[0] == ends[1] ||
                sequences_within<TypeParam>(ends[1], ends[0], sizeof(TypeParam) == sizeof(float) ? 1e-5 : 1e-12));
  });
}

// Random bytes as MIDI, then silence on demand.
TYPED_TEST(EveryInstrument, IgnoresDamagedMidi) {
  TestFixture::for_each([](const auto make) {
    Hosted<TypeParam> hosted(make());
    hosted.prepare(kRate);
    const bool is_silent_at_rest = hosted.instrument().is_silent(1e-14);
    Random random(7);
    std::vector<std::vector<float>> sound(hosted.instrument().outputs().size(), std::vector<float>(64));
    std::vector<float*> outputs;
    for (auto& output : sound) outputs.push_back(output.data());
    for (int n = 0; n < 3000; ++n) {
      std::array<std::uint8_t, 4> bytes;
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
      if (n % 2 == 0) bytes[0] = static_cast<std::uint8_t>(0x80 + 16 * random.below(7));
      expect_real_time([&] { hosted.midi(std::span(bytes).first(random.below(5))); });
      if (n % 50 != 0) continue;
      expect_real_time([&] { hosted.process(std::span<float* const>(outputs), 64); });
      for (const auto& output : sound) ASSERT_TRUE(contactspline::all_finite(std::span<const float>(output)));
    }
    hosted.midi(std::array<std::uint8_t, 3>{0xb0, 120, 0});
    EXPECT_EQ(hosted.instrument().is_silent(1e-14), is_silent_at_rest);
  });
}

}  // namespace
}  // namespace contactspline::testing
