// SPDX-License-Identifier: MIT
// What every instrument does, whatever its model: its lists, wrong values, extremes, allocations, blocks of any
// length, reset, damaged MIDI. CONTACTSPLINE_LIST: the header with the instruments: Precisions, the types of samples,
// and kInstruments<T>, an array of functions that make one (handle_of, or compiled of engine.hpp).
#include CONTACTSPLINE_LIST

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "contactspline/host/hosted.hpp"
#include "hosts/plugin/macros.hpp"
#include "runtime/random_controls.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/hostile_midi.hpp"
#include "support/measured.hpp"
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

// Of its plug-in: at least one, each of parameters that it has.
TYPED_TEST(EveryInstrument, HasMacros) {
  TestFixture::for_each([](const auto make) {
    const auto instrument = make();
    std::vector<std::size_t> all(instrument->parameters().size());
    std::iota(all.begin(), all.end(), 0);
    std::string names;
    for (const MacroOf& macro : macros_of(instrument->parameters(), instrument->events(), all))
      names += std::string(" ") + macro.macro->parameter.name;
    EXPECT_NE(names, "");
    const std::string_view name = instrument->name();
    if (name == "piano") {
      EXPECT_EQ(names, " harder");
    }
    if (name == "trichord_c4") {
      EXPECT_EQ(names, " harder stronger shorter");
    }
    if (name == "lap_steel") {
      EXPECT_EQ(names, " stronger");
    }
    Measured() << instrument->name() << ":" << names;
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
      for (const std::uint8_t key : std::array<std::uint8_t, 3>{60, 52, 47})  // the gong has 52 alone, the tom 47
        hosted.midi(std::array<std::uint8_t, 3>{0x90, key, 100});
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

// An instrument in a host, sample by sample: finite, and in an instrument that tells its work and its heat the energy
// changes by these alone, but for the rounding of the sums of a sample.
template <typename T>
class Watched {
 public:
  Watched(Handle<T> instrument, double rate_hz) : hosted(std::move(instrument)) {
    hosted.prepare(rate_hz);
    stored_j_ = hosted.instrument().energy();
    for (T& x : sound_) outputs_.push_back(&x);
  }

  ~Watched() {
    EXPECT_LE(worst_j_, (sizeof(T) == sizeof(float) ? 5e-6 : 1e-13) * largest_j_);
    Measured() << hosted.instrument().name() << ": " << worst_j_ << " J of " << largest_j_ << " J";
  }
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

  void midi(std::span<const std::uint8_t> bytes) {
    expect_real_time([&] { hosted.midi(bytes); });
    is_played_ = true;
  }
  void play(std::size_t samples) {
    for (std::size_t n = 0; n < samples; ++n) {
      const double before_j = hosted.instrument().energy();
      expect_real_time([&] { hosted.process(std::span<T* const>(outputs_), 1); });
      ASSERT_TRUE(contactspline::all_finite(std::span<const T>(sound_)));
      const Books books = hosted.instrument().books();
      ASSERT_EQ(books.failures, 0u);
      ASSERT_TRUE(std::isfinite(books.stored_j));
      largest_j_ = std::max({largest_j_, books.stored_j, std::abs(books.work_j)});
      if (books.work_j != 0 || books.heat_j != 0) worst_j_ = std::max(worst_j_, error(books, before_j));
      stored_j_ = books.stored_j;
      is_played_ = false;
    }
  }

  Hosted<T> hosted;

 private:
  // What MIDI has silenced loses its energy: the sample begins with what is left, and the work is that of strikes
  // since then, or of the sample itself.
  [[nodiscard]] double error(const Books& books, double before_j) const {
    const double error_j = std::abs(books.stored_j - stored_j_ - books.work_j + books.heat_j);
    const double change_j = books.stored_j - before_j + books.heat_j;
    return is_played_ ? std::min({error_j, std::abs(change_j), std::abs(change_j - books.work_j)}) : error_j;
  }

  std::vector<T> sound_ = std::vector<T>(hosted.instrument().outputs().size());
  std::vector<T*> outputs_;
  double stored_j_, largest_j_ = 0, worst_j_ = 0;
  bool is_played_ = false;  // since the last sample
};

// A zone of MPE whose notes bend by 48 semitones up and down, at the lowest and the highest rate.
TYPED_TEST(EveryInstrument, BendsBy48SemitonesAtAnyRate) {
  TestFixture::for_each([](const auto make) {
    for (const double rate_hz : {8000.0, 192000.0}) {
      Watched<TypeParam> watched(make(), rate_hz);
      watched.midi(std::array<std::uint8_t, 9>{0xb0, 101, 0, 0xb0, 100, 6, 0xb0, 6, 15});
      int key = 57;
      for (std::uint8_t channel = 1; channel < 4; ++channel) {
        while (!watched.hosted.instrument().has_key(++key % 128)) {
        }
        watched.midi(std::array{std::uint8_t(0x90 | channel), std::uint8_t(key % 128), std::uint8_t(100)});
        watched.play(50);
      }
      for (int n = 0; n < 12; ++n) {
        const std::uint8_t to = n % 3 == 0 ? 127 : n % 3 == 1 ? 0 : 64;
        watched.midi(std::array{std::uint8_t(0xe1 + n % 4), std::uint8_t(to == 127 ? 127 : 0), to});
        watched.play(200);
      }
    }
  });
}

// Bytes as MIDI, then silence on demand: no NaN, no allocation. 10 million with CONTACTSPLINE_FULL_TESTS, shared by
// all instruments.
TYPED_TEST(EveryInstrument, IgnoresDamagedMidi) {
  const std::size_t all = hostile_bytes(20'000 * kInstruments<TypeParam>.size()) / kInstruments<TypeParam>.size();
  TestFixture::for_each([all](const auto make) {
    Watched<TypeParam> watched(make(), kRate);
    const bool is_silent_at_rest = watched.hosted.instrument().is_silent(1e-14);
    HostileMidi hostile(7);
    for (std::size_t taken = 0, n = 0; taken < all; ++n) {
      const auto bytes = hostile.next();
      taken += bytes.size();
      watched.midi(bytes);
      if (n % 50 == 0) watched.play(200);
    }
    watched.midi(std::array<std::uint8_t, 1>{0xff});
    watched.hosted.each_held([](int key, double) { ADD_FAILURE() << "holds the key " << key; });
    for (std::size_t p = 0; p < watched.hosted.instrument().parameters().size(); ++p)
      watched.hosted.set(p, watched.hosted.instrument().parameters()[p].initial);
    watched.midi(std::array<std::uint8_t, 3>{0xb0, 120, 0});
    watched.play(100);  // strings take their pitch
    EXPECT_EQ(watched.hosted.instrument().is_silent(1e-14), is_silent_at_rest);
  });
}

}  // namespace
}  // namespace contactspline::testing
