// SPDX-License-Identifier: MIT
// The library for C plays what the classes play, bit by bit, says what is wrong, and takes any value.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "c/handle.hpp"
#include "contactspline.h"
#include "contactspline/step/flush_denormals.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/player/instrument_maker.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "instrument/instrument_lists.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/random.hpp"
#include "support/real_time.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;  // the emitted classes have their modes below half of it
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Handle create(const char* name, int precision = CONTACTSPLINE_DOUBLE) {
  Handle handle(contactspline_create(name, kRate, precision));
  EXPECT_TRUE(handle) << contactspline_last_error();
  return handle;
}

void process(Handle& handle, const std::vector<float*>& outputs, float* force, std::size_t samples) {
  contactspline_process(handle.get(), outputs.data(), force, samples);
}
void process(Handle& handle, const std::vector<double*>& outputs, double* force, std::size_t samples) {
  contactspline_process_double(handle.get(), outputs.data(), force, samples);
}

/// Arrays for a block of each output and of the force.
template <typename T>
struct Block {
  explicit Block(std::size_t outputs) : sound(outputs, std::vector<T>(kLongest)), force(kLongest) {
    for (auto& array : sound) pointers.push_back(array.data());
  }
  std::vector<std::span<T>> spans(std::size_t samples) {
    std::vector<std::span<T>> parts;
    for (auto& array : sound) parts.push_back(std::span(array).first(samples));
    return parts;
  }
  static constexpr std::size_t kLongest = 700;  // samples
  std::vector<std::vector<T>> sound;
  std::vector<T> force;
  std::vector<T*> pointers;
};

template <typename I>
class CLibrary : public ::testing::Test {
 public:
  using T = typename I::value_type;
  static constexpr int kPrecision = sizeof(T) == sizeof(float) ? CONTACTSPLINE_FLOAT : CONTACTSPLINE_DOUBLE;
};

using All =
    Joined<NamedModelTypes<double>, ShippedInstruments<double>, NamedModelTypes<float>, ShippedInstruments<float>>;
TYPED_TEST_SUITE(CLibrary, All, InstrumentNames);

TYPED_TEST(CLibrary, HasTheListsOfTheClass) {
  const TypeParam expected;
  const Handle handle = create(expected.name(), this->kPrecision);
  const auto* const x = handle.get();
  EXPECT_STREQ(contactspline_name(x), expected.name());
  EXPECT_STREQ(contactspline_description(x), expected.description());
  EXPECT_STREQ(contactspline_license(x), license_of(expected));
  ASSERT_EQ(contactspline_parameter_count(x), expected.parameters().size());
  for (std::size_t i = 0; i < expected.parameters().size(); ++i) {
    const Parameter& p = expected.parameters()[i];
    const contactspline_parameter* const c = contactspline_parameter_at(x, i);
    EXPECT_STREQ(c->name, p.name);
    EXPECT_STREQ(c->unit, p.unit);
    EXPECT_EQ((std::array{c->min, c->max, c->slider_min, c->slider_max, c->initial, c->glide_s}),
              (std::array{p.allowed.min, p.allowed.max, p.slider.min, p.slider.max, p.initial, p.glide_s}))
        << p.name;
    EXPECT_EQ(c->is_logarithmic, p.scale == Scale::kLogarithmic) << p.name;
    EXPECT_EQ(c->acts_at_next_note, p.acts == Acts::kAtNextNote) << p.name;
    EXPECT_EQ(contactspline_get(x, i), expected.value(i)) << p.name;
  }
  ASSERT_EQ(contactspline_output_count(x), expected.outputs().size());
  for (std::size_t i = 0; i < expected.outputs().size(); ++i) {
    EXPECT_STREQ(contactspline_output_at(x, i)->name, expected.outputs()[i].name);
    EXPECT_STREQ(contactspline_output_at(x, i)->unit, expected.outputs()[i].unit);
    EXPECT_EQ(contactspline_output_at(x, i)->full_scale, expected.outputs()[i].full_scale);
  }
  ASSERT_EQ(contactspline_event_count(x), expected.events().size());
  for (std::size_t i = 0; i < expected.events().size(); ++i) {
    const Event& e = expected.events()[i];
    EXPECT_STREQ(contactspline_event_at(x, i)->name, e.name);
    EXPECT_EQ(contactspline_event_at(x, i)->action, static_cast<int>(action_of(e.kind)));
    EXPECT_EQ(contactspline_event_at(x, i)->number, e.number);
    EXPECT_EQ(contactspline_event_at(x, i)->parameter, e.parameter);
  }
  ASSERT_EQ(contactspline_preset_count(x), expected.presets().size());
  for (std::size_t i = 0; i < expected.presets().size(); ++i)
    EXPECT_STREQ(contactspline_preset_name(x, i), expected.presets()[i].name);
}

/// Plays the same random events on a class and on the library: notes, strikes, plucks, bows and sliders.
template <typename I>
void play_at_random(Random& random, I& expected, contactspline_instrument* actual) {
  using T = typename I::value_type;
  const auto parameter = random.below(expected.parameters().size());
  const auto [min, max] = expected.parameters()[parameter].slider;
  const double value = min + (max - min) * random.uniform();
  const int key = 40 + static_cast<int>(random.below(40));
  const double velocity = random.uniform();
  switch (random.below(6)) {
    case 0:
      expected.set(parameter, value);
      return contactspline_set(actual, parameter, value);
    case 1:
    case 2:
      expected.note_on(key, velocity);
      return contactspline_note_on(actual, key, velocity);
    case 3:
      expected.note_off(key);
      return contactspline_note_off(actual, key);
    default:
      break;
  }
  if (expected.events().empty()) return;
  const Event& event = expected.events()[random.below(expected.events().size())];
  const double strength = expected.value(event.parameter) * velocity;
  if (event.kind == EventKind::kBow) {
    play_event(expected, event, strength);
    const contactspline_timed_event bow{0, CONTACTSPLINE_BOW, event.number, strength, 0};
    contactspline_play(actual, &bow);
  } else if (event.kind == EventKind::kPluck) {
    expected.pluck(event.number, static_cast<T>(strength), 0.004);
    contactspline_pluck(actual, event.number, strength, 0.004);
  } else if (random.below(3) == 0) {
    expected.release(event.number);
    contactspline_release(actual, event.number);
  } else {
    expected.strike(event.number, static_cast<T>(strength));
    contactspline_strike(actual, event.number, strength);
  }
}

template <typename T>
bool same_bits(const T* a, const T* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(T)) == 0;
}

TYPED_TEST(CLibrary, PlaysTheSamplesOfTheClass) {
  using Number = typename TypeParam::value_type;
  TypeParam expected;
  expected.prepare(kRate);
  Handle actual = create(expected.name(), this->kPrecision);
  Random random(7);
  Block<Number> a(expected.outputs().size()), b(expected.outputs().size());
  double largest = 0;
  for (int block = 0; block < 60; ++block) {
    play_at_random(random, expected, actual.get());
    const std::size_t samples = 1 + random.below(Block<Number>::kLongest);
    {
      const FlushDenormals flushed;
      expected.process(a.spans(samples), std::span(a.force).first(samples));
    }
    expect_real_time([&] { process(actual, b.pointers, b.force.data(), samples); });
    for (std::size_t o = 0; o < a.sound.size(); ++o)
      ASSERT_TRUE(same_bits(a.sound[o].data(), b.sound[o].data(), samples)) << "output " << o << ", block " << block;
    ASSERT_TRUE(same_bits(a.force.data(), b.force.data(), samples)) << "force, block " << block;
    ASSERT_EQ(contactspline_energy(actual.get()), expected.energy());
    ASSERT_EQ(contactspline_is_silent(actual.get(), 1e-14), expected.is_silent(1e-14));
    for (std::size_t n = 0; n < samples; ++n) largest = std::max(largest, std::abs(double(b.sound[0][n])));
  }
  EXPECT_GT(largest, 1e-6);
}

// Any value and any index, at any time: no sample that is not finite, and no allocation.
TYPED_TEST(CLibrary, TakesAnyValue) {
  constexpr double kHostile[] = {kNaN, kInfinity, -kInfinity, 0, -0.0, 1e308, -1e308, 5e-324, 1, 60, -1, 0.5};
  using Number = typename TypeParam::value_type;
  Handle handle = create(TypeParam().name(), this->kPrecision);
  auto* const x = handle.get();
  const std::size_t outputs = contactspline_output_count(x);
  Block<Number> block(outputs);
  Random random(11);
  const auto any = [&] {
    return random.below(4) == 0 ? random.uniform() : kHostile[random.below(std::size(kHostile))];
  };
  const auto index = [&] {
    return random.below(8) == 0 ? std::numeric_limits<std::size_t>::max() : random.below(16);
  };
  for (int round = 0; round < 40; ++round) {
    const std::size_t samples = random.below(64);
    expect_real_time([&] {
      for (int call = 0; call < 40; ++call) {
        contactspline_set(x, index(), any());
        contactspline_note_on(x, static_cast<int>(random.bits()), any());
        contactspline_note_on(x, static_cast<int>(random.below(128)), any());
        contactspline_note_off(x, static_cast<int>(random.bits()));
        contactspline_strike(x, index(), any());
        contactspline_release(x, index());
        contactspline_pluck(x, index(), any(), any());
        contactspline_load_preset(x, index());
        const contactspline_timed_event event{index(), static_cast<int>(random.below(12)) - 1, index(), any(), any()};
        contactspline_play(x, &event);
      }
      process(handle, block.pointers, block.force.data(), samples);
    });
    for (const auto& sound : block.sound)
      for (std::size_t n = 0; n < samples; ++n) ASSERT_TRUE(std::isfinite(sound[n])) << round;
    ASSERT_TRUE(std::isfinite(contactspline_energy(x)));
    if (round % 10 == 9) expect_real_time([&] { contactspline_reset(x); });
  }
}

// The other kind of process function rounds or widens, once, whatever the block.
TEST(CLibraryBlocks, AreOfEitherPrecision) {
  for (const int precision : {CONTACTSPLINE_DOUBLE, CONTACTSPLINE_FLOAT}) {
    Handle single = create("trichord_c4", precision), twice = create("trichord_c4", precision);
    const std::size_t outputs = contactspline_output_count(single.get());
    Block<float> a(outputs);
    Block<double> b(outputs);
    for (const auto* handle : {&single, &twice}) contactspline_note_on(handle->get(), 60, 0.7);
    double largest = 0;
    for (int block = 0; block < 30; ++block) {
      process(single, a.pointers, a.force.data(), 600);
      process(twice, b.pointers, b.force.data(), 600);
      for (std::size_t n = 0; n < 600; ++n) {
        ASSERT_EQ(a.sound[0][n], static_cast<float>(b.sound[0][n])) << n;
        ASSERT_EQ(a.force[n], static_cast<float>(b.force[n])) << n;
        largest = std::max(largest, std::abs(b.sound[0][n]));
      }
    }
    EXPECT_GT(largest, 1e-3);
  }
}

// Time passes where nobody listens.
TEST(CLibraryBlocks, MayBeUnheard) {
  Handle heard = create("trichord_c4"), unheard = create("trichord_c4");
  Block<double> a(contactspline_output_count(heard.get())), b(contactspline_output_count(heard.get()));
  for (const auto* handle : {&heard, &unheard}) contactspline_note_on(handle->get(), 60, 0.7);
  process(heard, a.pointers, nullptr, 600);
  contactspline_process_double(unheard.get(), nullptr, nullptr, 300);
  const std::vector<double*> nowhere(a.pointers.size(), nullptr);
  process(unheard, nowhere, nullptr, 300);
  process(heard, a.pointers, nullptr, 600);
  process(unheard, b.pointers, nullptr, 600);
  EXPECT_TRUE(same_bits(a.sound[0].data(), b.sound[0].data(), 600));
  EXPECT_EQ(contactspline_energy(heard.get()), contactspline_energy(unheard.get()));
  EXPECT_GT(contactspline_energy(heard.get()), 0);
}

// Events happen at their samples, those behind the block behind it; arrays that are null have none.
TEST(CLibraryBlocks, PlayEventsAtTheirSamples) {
  Handle timed = create("fret_guitar"), split = create("fret_guitar");
  Block<double> a(contactspline_output_count(timed.get())), b(a.sound.size());
  const contactspline_timed_event events[] = {{100, CONTACTSPLINE_NOTE_ON, 60, 0.7, 0},
                                              {100, CONTACTSPLINE_NOTE_ON, 64, 0.5, 0},
                                              {450, CONTACTSPLINE_NOTE_OFF, 60, 0, 0},
                                              {900, CONTACTSPLINE_NOTE_OFF, 64, 0, 0}};
  contactspline_process_events_double(timed.get(), events, std::size(events), a.pointers.data(), nullptr, 600);
  contactspline_process_events_double(timed.get(), nullptr, 3, a.pointers.data(), nullptr, 0);
  std::size_t done = 0;
  for (const contactspline_timed_event& event : events) {
    const std::size_t next = std::min<std::size_t>(event.sample, 600);
    std::vector<double*> rest;
    for (double* const output : b.pointers) rest.push_back(output + done);
    process(split, rest, nullptr, next - done);
    contactspline_play(split.get(), &event);
    done = next;
  }
  for (std::size_t o = 0; o < a.sound.size(); ++o)
    EXPECT_TRUE(same_bits(a.sound[o].data(), b.sound[o].data(), 600)) << o;
  EXPECT_EQ(a.sound[0][99], 0);
  EXPECT_GT(contactspline_energy(timed.get()), 0);
  EXPECT_EQ(contactspline_energy(timed.get()), contactspline_energy(split.get()));
}

// An input pushes, also in the array of an output and in either precision, what the class plays in parts between
// events. What has no input ignores it.
TEST(CLibraryInput, PushesTheBody) {
  std::vector<double> input(600);
  for (std::size_t n = 0; n < input.size(); ++n) input[n] = 3 * std::sin(0.05 * static_cast<double>(n * n % 997));
  const contactspline_timed_event strike = {100, CONTACTSPLINE_STRIKE, 0, 1, 0};
  instruments::tom<double> tom(kRate);
  std::vector<std::vector<double>> expected(3, input);
  const auto play = [&](std::size_t begin, std::size_t end) {
    std::array<std::span<double>, 3> part;
    for (std::size_t o = 0; o < 3; ++o) part[o] = std::span(expected[o]).subspan(begin, end - begin);
    tom.process(part, {}, std::span<const double>(input).subspan(begin, end - begin));
  };
  play(0, 100);
  tom.strike(0, 1);
  play(100, 600);
  const Handle of_library = create("tom"), single = create("tom"), string = create("hammer_string");
  EXPECT_EQ(contactspline_input_scale(of_library.get()), tom.input_scale_n());
  EXPECT_EQ(contactspline_input_scale(string.get()), 0);
  Block<double> block(3);
  std::ranges::copy(input, block.sound[1].begin());
  contactspline_process_input_double(of_library.get(), &strike, 1, block.sound[1].data(), block.pointers.data(),
                                     nullptr, 600);
  for (std::size_t o = 0; o < 3; ++o) EXPECT_TRUE(same_bits(block.sound[o].data(), expected[o].data(), 600)) << o;
  const std::vector<float> input_in_single(input.begin(), input.end());
  Block<float> in_single(3);
  contactspline_process_input(single.get(), &strike, 1, input_in_single.data(), in_single.pointers.data(), nullptr,
                              600);
  EXPECT_TRUE(sequences_within(std::span<const float>(in_single.sound[0]).first(600),
                               std::span<const float>(std::vector<float>(expected[0].begin(), expected[0].end())),
                               1e-4));
  Block<double> silent(contactspline_output_count(string.get()));
  contactspline_process_input_double(string.get(), nullptr, 0, input.data(), silent.pointers.data(), nullptr, 600);
  EXPECT_EQ(contactspline_energy(string.get()), 0);
}

// An instrument that has fallen silent is exactly 0, until it is played again.
TEST(CLibraryBlocks, AreZeroWhileItSleeps) {
  Handle tube = create("marimba");
  Block<double> block(contactspline_output_count(tube.get()));
  const auto peak_after = [&](double seconds) {
    for (double rest = seconds * kRate; rest > 0; rest -= 600) process(tube, block.pointers, block.force.data(), 600);
    return std::abs(*std::ranges::max_element(block.sound[0], {}, [](double x) { return std::abs(x); }));
  };
  for (int note = 0; note < 2; ++note) {
    contactspline_strike(tube.get(), 0, 1);
    EXPECT_GT(peak_after(0.05), 0);
    contactspline_release(tube.get(), 0);
    EXPECT_EQ(peak_after(6), 0);
  }
}

std::size_t parameter_of(const Handle& handle, const char* name) {
  std::size_t index = 0;
  while (std::strcmp(contactspline_parameter_at(handle.get(), index)->name, name) != 0) ++index;
  return index;
}

/// Bows the violin that ships: in each block force, speed and place jump, and keys begin and end strokes.
class HostileBow {
 public:
  void play(double seconds) {
    for (double rest = seconds * kRate; rest > 0; rest -= kSamples) {
      for (const auto& [parameter, min, max] : moves_)
        contactspline_set(violin_.get(), parameter,
                          random_.below(4) == 0 ? max : min + (max - min) * random_.uniform());
      const int key = 55 + static_cast<int>(random_.below(37));
      random_.below(3) == 0 ? contactspline_note_off(violin_.get(), key)
                            : contactspline_note_on(violin_.get(), key, 1);
      next_block();
    }
  }
  void lift(double seconds) {
    for (int key = 55; key < 92; ++key) contactspline_note_off(violin_.get(), key);
    for (double rest = seconds * kRate; rest > 0; rest -= kSamples) next_block();
  }
  /// The largest force on the bridge in the last block, and in all [N].
  [[nodiscard]] double now() const { return now_; }
  [[nodiscard]] double largest() const { return largest_; }

 private:
  static constexpr std::size_t kSamples = 64;
  void next_block() {
    process(violin_, block_.pointers, block_.force.data(), kSamples);
    now_ = 0;
    for (std::size_t n = 0; n < kSamples; ++n) {
      ASSERT_TRUE(std::isfinite(block_.sound[0][n]));
      now_ = std::max(now_, std::abs(block_.sound[1][n]));
    }
    largest_ = std::max(largest_, now_);
  }

  struct Move {
    std::size_t parameter;
    double min, max;
  };
  Handle violin_ = create("violin");
  Block<double> block_{contactspline_output_count(violin_.get())};
  Random random_{12};
  std::vector<Move> moves_{{parameter_of(violin_, "bow_normal_force_n"), 0, 5},
                           {parameter_of(violin_, "bow_surface_speed_m_per_s"), 0, 1},
                           {parameter_of(violin_, "bow_place_m"), 0.195, 0.31525},
                           {parameter_of(violin_, "bow_acceleration_m_per_s2"), 0, 1000},
                           {parameter_of(violin_, "assistance"), 0, 1}};
  double now_ = 0, largest_ = 0;
};

// Four seconds, or with CONTACTSPLINE_FULL_TESTS a minute. No friction exceeds 5.3 N. After the bow is lifted, links
// creep for some seconds before all sleeps.
TEST(CLibraryBow, MayJump) {
  HostileBow bow;
  bow.play(std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr ? 60 : 4);
  EXPECT_GT(bow.largest(), 1);
  EXPECT_LT(bow.largest(), 100);
  bow.lift(12);
  EXPECT_EQ(bow.now(), 0) << "it has rung out";
  Measured() << bow.largest() << " N";
}

TEST(CLibraryBooks, HaveTheEnergyTheWorkAndTheLosses) {
  Handle guitar = create("fret_guitar");
  Block<double> block(contactspline_output_count(guitar.get()));
  contactspline_note_on(guitar.get(), 60, 0.7);
  const double before_j = contactspline_books_of(guitar.get()).stored_j;
  double work_j = 0, heat_j = 0, scale_j = before_j;
  for (int sample = 0; sample < 4410; ++sample) {
    process(guitar, block.pointers, nullptr, 1);
    const contactspline_books books = contactspline_books_of(guitar.get());
    work_j += books.work_j;
    heat_j += books.heat_j;
    scale_j = std::max(scale_j, books.stored_j);
  }
  const double after_j = contactspline_energy(guitar.get());
  EXPECT_GT(heat_j, 1e-3 * scale_j);
  EXPECT_NEAR(after_j - before_j, work_j - heat_j, 1e-10 * scale_j);
  EXPECT_EQ(contactspline_has_key(guitar.get(), 60), 1);
  EXPECT_EQ(contactspline_has_key(guitar.get(), -1), 0);
  EXPECT_EQ(contactspline_is_at_rest(guitar.get(), 1e-30), 0);
}

TEST(CLibraryText, GivesTheSameInstrumentAsItsName) {
  const std::string text(find_embedded(Shipped::kInstruments, "tanpura.json")->content);
  Handle named = create("tanpura");
  const std::clock_t began = std::clock();
  Handle told(contactspline_create_from_json(text.c_str(), "mine.json", kRate, CONTACTSPLINE_DOUBLE));
  Measured() << "created in " << 1e3 * static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC << " ms";
  ASSERT_TRUE(told) << contactspline_last_error();
  Block<double> a(contactspline_output_count(named.get())), b(contactspline_output_count(named.get()));
  for (const auto* handle : {&named, &told}) contactspline_pluck(handle->get(), 0, 2, 0.004);
  for (int block = 0; block < 10; ++block) {
    process(named, a.pointers, nullptr, 441);
    process(told, b.pointers, nullptr, 441);
    ASSERT_TRUE(same_bits(a.sound[0].data(), b.sound[0].data(), 441));
  }
  EXPECT_GT(contactspline_energy(named.get()), 0);
}

/// A string and a bar, which two fingers pluck. The bar's second mode lies 0.2 mHz below half of kRate, and its third
/// as far above, where it is left out.
constexpr const char* kTwoFingers = R"({
  "name": "two_fingers",
  "bodies": [ { "name": "string", "resonator": "guitar_d3" },
              { "name": "bar", "modes": [ { "frequency_hz": 440, "decay_per_s": 3, "mass_kg": 0.01 },
                                          { "frequency_hz": 22049.9998, "decay_per_s": 3, "mass_kg": 0.01 },
                                          { "frequency_hz": 22050.0002, "decay_per_s": 3, "mass_kg": 0.01 } ] } ],
  "places": [ { "name": "first", "body": "string", "position_m": 0.3 },
              { "name": "second", "body": "bar", "shapes": [1, 1, 1] } ],
  "controls": [ { "name": "thumb", "force_n": "first", "min": -5, "max": 5, "release_n": 2 },
                { "name": "finger", "force_n": "second", "min": -5, "max": 5, "release_n": 2 } ],
  "outputs": [ { "name": "string", "velocity_m_per_s": "first" }, { "name": "bar", "velocity_m_per_s": "second" } ]
})";

/// Both outputs of kTwoFingers after a pluck, from the class that the generator makes of the text.
std::vector<std::vector<double>> two_fingers(std::size_t pluck, double sample_rate_hz) {
  const auto instrument = maker_of_text(kTwoFingers, "two_fingers.json", [](const std::string&) {
                            return std::string();
                          }).make<double>(sample_rate_hz);
  instrument->prepare(sample_rate_hz);
  instrument->pluck(pluck, 2, 0.004);
  std::vector<std::vector<double>> sound(2, std::vector<double>(441));
  std::vector<std::span<double>> spans(sound.begin(), sound.end());
  const FlushDenormals flushed;
  instrument->process(spans, {});
  return sound;
}

Handle create_two_fingers() {
  Handle handle(contactspline_create_from_json(kTwoFingers, "two_fingers.json", kRate, CONTACTSPLINE_DOUBLE));
  EXPECT_TRUE(handle) << contactspline_last_error();
  return handle;
}

// Each pluck by its number, at the rate that was asked for: a rate that is 1 mHz lower or higher has one mode less or
// more.
TEST(CLibraryText, PlaysThePluckOfTheNumberAtTheRate) {
  for (const std::size_t pluck : {std::size_t{0}, std::size_t{1}}) {
    const auto expected = two_fingers(pluck, kRate);
    Handle actual = create_two_fingers();
    contactspline_pluck(actual.get(), pluck, 2, 0.004);
    Block<double> block(2);
    process(actual, block.pointers, nullptr, 441);
    for (std::size_t output = 0; output < 2; ++output) {
      EXPECT_TRUE(same_bits(expected[output].data(), block.sound[output].data(), 441)) << pluck << ", " << output;
      EXPECT_EQ(expected[output][440] != 0, output == pluck);
    }
  }
  const auto peak = [](const std::vector<double>& sound) {
    double largest = 0;
    for (const double x : sound) largest = std::max(largest, std::abs(x));
    return largest;
  };
  for (const double other_hz : {kRate - 0.001, kRate + 0.001})
    EXPECT_GT(std::abs(peak(two_fingers(1, kRate)[1]) / peak(two_fingers(1, other_hz)[1]) - 1), 1e-6) << other_hz;
}

TEST(CLibraryText, IsNotPluckedByWhatIsNoNumber) {
  Handle handle = create_two_fingers();
  Block<double> block(2);
  for (const auto& [force_n, rise_s] : {std::pair(2.0, kNaN), std::pair(kNaN, 0.004)}) {
    contactspline_pluck(handle.get(), 0, force_n, rise_s);
    process(handle, block.pointers, nullptr, 441);
    EXPECT_EQ(contactspline_energy(handle.get()), 0) << force_n << " N, " << rise_s << " s";
  }
}

std::string refusal(const char* text, const char* file) {
  EXPECT_EQ(contactspline_create_from_json(text, file, kRate, CONTACTSPLINE_DOUBLE), nullptr);
  return contactspline_last_error();
}

// A missing comma, an unknown key, a number that is out of range: what the program's reader says.
TEST(CLibraryText, IsRefusedInTheLineOfTheProgram) {
  const std::string good(find_embedded(Shipped::kInstruments, "tanpura.json")->content);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  for (const std::string& bad : {with("\"name\"", "\"nme\""), with("\"bodies\":", "\"bodies\""), std::string("{"),
                                 with("\"mass_kg\": 0.000555", "\"mass_kg\": -1"), std::string()}) {
    std::string expected;
    try {
      (void)parse_instrument(bad, "my folder/mine.json");
    } catch (const BadInput& error) {
      expected = error.what();
    }
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(refusal(bad.c_str(), "my folder/mine.json"), expected);
    EXPECT_EQ(expected.find('\n'), std::string::npos);
    EXPECT_TRUE(expected.starts_with("my folder/mine.json: ")) << expected;
  }
}

TEST(CLibraryText, OfAnotherKindIsRefused) {
  const std::string felt(find_embedded(Shipped::kMaterials, "felt_c4.json")->content);
  EXPECT_EQ(refusal(felt.c_str(), "felt.json"), "felt.json: file: is a material; allowed: an instrument");
  EXPECT_EQ(refusal(nullptr, "felt.json"), "contactspline: text: is null; allowed: text");
  EXPECT_EQ(refusal("{}", nullptr), "contactspline: file: is null; allowed: text");
}

TEST(CLibraryNames, AreAllPlayable) {
  std::size_t count = 0;
  for (const char* const* name = contactspline_names(); *name != nullptr; ++name, ++count)
    EXPECT_STREQ(contactspline_name(create(*name).get()), *name);
  EXPECT_EQ(count, 3 + shipped_names(Shipped::kInstruments).size());
}

TEST(CLibraryNames, ThatAreWrongAreRefused) {
  const auto refused = [](const char* name, double rate_hz, int precision) -> std::string {
    EXPECT_EQ(contactspline_create(name, rate_hz, precision), nullptr);
    return contactspline_last_error();
  };
  EXPECT_TRUE(
      refused("harpsichord", kRate, 0)
          .starts_with(
              "harpsichord: INSTRUMENT: no such instrument ships; allowed: a .json file, piano, hammer_string, "));
  EXPECT_TRUE(refused("hammer-string", kRate, 0).ends_with("; did you mean hammer_string?"));
  EXPECT_EQ(refused("absent.json", kRate, 0),
            "absent.json: file: does not exist; allowed: a file of at most 1 MiB that can be read");
  EXPECT_EQ(refused(nullptr, kRate, 0), "contactspline: name: is null; allowed: text");
  EXPECT_EQ(refused("piano", kNaN, 0),
            "contactspline: sample_rate_hz: nan is out of range; allowed: 1000 to 768000, such as 48000");
  for (const double rate_hz : {0.0, -44100.0, 999.0, 768001.0, kInfinity})
    EXPECT_NE(refused("piano", rate_hz, 0).find("is out of range; allowed: 1000 to 768000"), std::string::npos);
  EXPECT_EQ(refused("piano", kRate, 2), "contactspline: precision: 2 is unknown; allowed: 0 for double, 1 for float");
}

TEST(CLibraryNull, DoesNothing) {
  contactspline_destroy(nullptr);
  EXPECT_EQ(contactspline_name(nullptr), nullptr);
  EXPECT_EQ(contactspline_description(nullptr), nullptr);
  EXPECT_EQ(contactspline_license(nullptr), nullptr);
  EXPECT_EQ(contactspline_parameter_count(nullptr) + contactspline_output_count(nullptr) +
                contactspline_event_count(nullptr) + contactspline_preset_count(nullptr),
            0U);
  EXPECT_EQ(contactspline_parameter_at(nullptr, 0), nullptr);
  EXPECT_EQ(contactspline_output_at(nullptr, 0), nullptr);
  EXPECT_EQ(contactspline_event_at(nullptr, 0), nullptr);
  EXPECT_EQ(contactspline_preset_name(nullptr, 0), nullptr);
  EXPECT_TRUE(std::isnan(contactspline_get(nullptr, 0)));
  contactspline_set(nullptr, 0, 1);
  contactspline_load_preset(nullptr, 0);
  contactspline_note_on(nullptr, 60, 1);
  contactspline_note_off(nullptr, 60);
  contactspline_strike(nullptr, 0, 1);
  contactspline_release(nullptr, 0);
  contactspline_pluck(nullptr, 0, 1, 0.004);
  contactspline_process(nullptr, nullptr, nullptr, 64);
  contactspline_process_double(nullptr, nullptr, nullptr, 64);
  contactspline_process_events(nullptr, nullptr, 0, nullptr, nullptr, 64);
  contactspline_process_input(nullptr, nullptr, 0, nullptr, nullptr, nullptr, 64);
  contactspline_process_input_double(nullptr, nullptr, 0, nullptr, nullptr, nullptr, 64);
  EXPECT_EQ(contactspline_input_scale(nullptr), 0);
  contactspline_play(nullptr, nullptr);
  contactspline_reset(nullptr);
  EXPECT_EQ(contactspline_energy(nullptr), 0);
  EXPECT_EQ(contactspline_books_of(nullptr).stored_j, 0);
  EXPECT_EQ(contactspline_has_key(nullptr, 60), 0);
  EXPECT_EQ(contactspline_is_at_rest(nullptr, 1), 1);
  EXPECT_EQ(contactspline_is_silent(nullptr, 1), 1);
  const Handle piano = create("piano");
  EXPECT_EQ(contactspline_parameter_at(piano.get(), contactspline_parameter_count(piano.get())), nullptr);
  EXPECT_EQ(contactspline_preset_name(piano.get(), contactspline_preset_count(piano.get())), nullptr);
  EXPECT_TRUE(std::isnan(contactspline_get(piano.get(), contactspline_parameter_count(piano.get()))));
}

}  // namespace
}  // namespace contactspline::testing
