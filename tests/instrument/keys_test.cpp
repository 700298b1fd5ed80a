// SPDX-License-Identifier: MIT
// Keys of instrument files: tuning against a file with that pitch, voices, damper and pedal, energy, presets.
#include <fmt/format.h>

#include "contactspline/host/engine.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;
constexpr int kTunedKey = 60;

// An instrument of a file, prepared.
template <typename T = double>
Handle<T> played_by(const InstrumentData& data) {
  Handle<T> instrument = Engine<T>::network(data);
  instrument->prepare(kRate);
  return instrument;
}

// A hammered string. `tuning`: of the string in cents; `more`: keys of the file.
std::string zither(int tuning, const std::string& more) {
  return R"({ "name": "zither",
    "bodies": [ { "name": "string", "resonator": "string_c4", "tuning_cents": )" +
         std::to_string(tuning) + R"( }, { "name": "hammer", "mass_kg": 0.003 } ],
    "places": [ { "name": "struck", "body": "string", "position_m": 0.0744 } ],
    "contacts": [ { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4" } ],
    "controls": [ { "name": "felt", "stiffness_ratio": "felt" }, { "name": "felt", "loss_s_per_m": "felt" } ],
    "strikes": ["hammer"],
    )" + more +
         R"( "outputs": [ { "name": "end", "end_force_n": "string" },
                                 { "name": "struck", "velocity_m_per_s": "struck" } ] })";
}

constexpr auto kKeys = R"("keys": [ { "first": 48, "last": 72, "event": "strike_hammer", "tuned_key": 60 } ],)";
constexpr auto kPiano = R"("keys": [ { "first": 48, "last": 72, "event": "strike_hammer", "tuned_key": 60 } ],
  "polyphony": 2, "damper": { "bodies": "string", "damping_per_s": 60 },
  "presets": [ { "name": "plain" }, { "name": "bright", "felt_stiffness_ratio": 4, "hammer_speed_m_per_s": 5 } ],)";

InstrumentArrays arrays_of_text(const std::string& text) {
  return arrays_of(parse_instrument(text, "probe.json"), kRate / 2);
}

using Sound = std::array<std::vector<double>, 2>;

// The next samples of both outputs.
Sound played(AnyInstrument<double>& instrument, std::size_t samples) {
  Sound sound;
  const std::array<std::span<double>, 2> outputs = {sound[0] = std::vector<double>(samples),
                                                    sound[1] = std::vector<double>(samples)};
  instrument.process(outputs, {});
  return sound;
}

// The books of the next sample.
Books tick(AnyInstrument<double>& instrument) {
  double sample;
  instrument.process({}, {&sample, 1});
  return instrument.books();
}

void expect_alike(const Sound& actual, const Sound& expected, double bound) {
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE(sequences_within(std::span<const double>(actual[i]), std::span<const double>(expected[i]), bound))
        << i;
}

class Tuned : public ::testing::TestWithParam<int> {};

// A key plays the samples of a file whose string has the pitch of the key. Both have the same modes, but their
// numbers are rounded to 13 digits before and after tuning: after 0.2 s a mode of 20 kHz has a phase of 2.5e4 rad, so
// 1e-13 of it are 3e-9, and the felt multiplies differences by at most 10.
TEST_P(Tuned, KeyPlaysTheSamplesOfAFileWithItsPitch) {
  const int key = GetParam();
  const InstrumentArrays keyed = arrays_of_text(zither(0, kKeys));
  const InstrumentArrays by_file = arrays_of_text(zither(100 * (key - kTunedKey), ""));
  const auto instrument = played_by(keyed.view());
  const auto expected = played_by(without_keys(by_file.view()));
  instrument->note_on(key, 0.8);
  expected->strike(0, 0.8 * 2.5);
  expect_alike(played(*instrument, 8820), played(*expected, 8820), 3e-8);
}
INSTANTIATE_TEST_SUITE_P(Keys, Tuned, ::testing::Values(48, 55, 60, 61, 72));

// A bar over a tube, both of `ratio` times their pitch, on a box.
std::string xylophone(double ratio, const std::string& more, double of_box = 1) {
  return fmt::format(R"({{ "name": "xylophone",
    "bodies": [ {{ "name": "box", "modes": [ {{ "frequency_hz": {}, "decay_per_s": 40, "mass_kg": 1 }} ] }},
                {{ "name": "bar", "bar": {{ "length_m": 0.33, "mass_kg": 0.33, "bending_stiffness_n_m2": {}, "constant_loss_per_s": 0, "quadratic_loss_m2_per_s": 0 }}, "max_modes": 5 }},
                {{ "name": "tube", "modes": [ {{ "frequency_hz": {}, "decay_per_s": 30, "mass_kg": 4e-4 }} ] }},
                {{ "name": "mallet", "mass_kg": 0.02 }} ],
    "places": [ {{ "name": "struck", "body": "bar", "position_m": 0.13 }}, {{ "name": "over", "body": "bar", "position_m": 0.16 }},
                {{ "name": "mouth", "body": "tube", "shapes": [1] }}, {{ "name": "lid", "body": "box", "shapes": [1] }} ],
    "contacts": [ {{ "name": "head", "between": ["mallet", "struck"], "material": "felt_c4" }} ],
    "springs": [ {{ "name": "air", "between": ["over", "mouth"], "stiffness_n_per_m": 100 }},
                 {{ "name": "frame", "between": ["over", "lid"], "stiffness_n_per_m": 50 }} ],
    "strikes": ["mallet"], {}
    "outputs": [ {{ "name": "struck", "velocity_m_per_s": "struck" }}, {{ "name": "mouth", "velocity_m_per_s": "mouth" }} ] }})",
                     300 * of_box, 600 * ratio * ratio, 261.6 * ratio, more);
}

constexpr auto kBars =
    R"("keys": [ { "first": 48, "last": 72, "event": "strike_mallet", "tuned_key": 60, "bodies": ["bar", "tube"] } ],)";

// As above, of bodies that keys tune by name: w of the bar is proportional to the root of its bending stiffness.
TEST_P(Tuned, KeyPlaysTheSamplesOfBarAndTubeOfItsPitch) {
  const int key = GetParam();
  const InstrumentArrays keyed = arrays_of_text(xylophone(1, kBars));
  const InstrumentArrays by_file = arrays_of_text(xylophone(std::exp2((key - kTunedKey) / 12.0), ""));
  const auto instrument = played_by(keyed.view());
  const auto expected = played_by(without_keys(by_file.view()));
  instrument->note_on(key, 0.8);
  expected->strike(0, 0.8 * 2.5);
  expect_alike(played(*instrument, 8820), played(*expected, 8820), 3e-8);
}

// Keys tune the bodies of their row alone.
TEST(Tuning, IsOfTheBodiesOfItsKeys) {
  const InstrumentArrays keyed = arrays_of_text(xylophone(1, R"("keys": [
    { "first": 48, "last": 60, "event": "strike_mallet", "tuned_key": 60, "bodies": ["tube", "bar"] },
    { "first": 61, "last": 72, "event": "strike_mallet", "tuned_key": 60, "bodies": "box" } ], "polyphony": 1,)"));
  const InstrumentArrays by_file = arrays_of_text(xylophone(0.5, "", 2));
  const auto instrument = played_by(keyed.view());
  const auto expected = played_by(without_keys(by_file.view()));
  instrument->note_on(48, 0);  // all rest: it tunes at once
  instrument->note_on(72, 0.8);
  expected->strike(0, 0.8 * 2.5);
  expect_alike(played(*instrument, 8820), played(*expected, 8820), 3e-8);
}

// An octave above the key with the pitch of the file 1.5 times as hard, an octave below two thirds as hard, by equal
// ratios between. Rounding of the speed alone.
TEST(Keys, StrikeHarderByOctaves) {
  const InstrumentArrays even = arrays_of_text(zither(0, kKeys));
  std::string rising = kKeys;
  rising.replace(rising.find(" }"), 2, R"(, "per_octave": 1.5 })");
  const InstrumentArrays harder = arrays_of_text(zither(0, rising));
  for (const int key : {48, 55, 60, 66, 72}) {
    const auto instrument = played_by(harder.view()), expected = played_by(even.view());
    instrument->note_on(key, 0.6);
    expected->note_on(key, 0.6 * std::pow(1.5, (key - kTunedKey) / 12.0));
    expect_alike(played(*instrument, 4410), played(*expected, 4410), 1e-12);
  }
}

// The sum of two keys is that of two instruments.
TEST(Voices, SumTheirOutputs) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, kKeys));
  const auto both = played_by(arrays.view()), low = played_by(arrays.view()), high = played_by(arrays.view());
  for (AnyInstrument<double>* instrument : {both.get(), low.get()}) instrument->note_on(50, 0.5);
  for (AnyInstrument<double>* instrument : {both.get(), high.get()}) instrument->note_on(57, 0.9);
  const Sound actual = played(*both, 2000), of_low = played(*low, 2000), of_high = played(*high, 2000);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t n = 0; n < 2000; ++n) ASSERT_EQ(actual[i][n], of_low[i][n] + of_high[i][n]) << n;
}

TEST(Voices, BlocksOfAnyLengthSoundAlike) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, kPiano));
  const auto whole = played_by(arrays.view()), parts = played_by(arrays.view());
  Sound expected, actual;
  for (const bool is_whole : {true, false}) {
    const auto& instrument = is_whole ? whole : parts;
    Sound& sound = is_whole ? expected : actual;
    for (const int key : {60, 67, 48}) {  // the third takes a voice that sounds
      instrument->note_on(key, 0.7);
      for (std::size_t done = 0, length = 1; done < 3000; done += length, length = is_whole ? 3000 : done % 97 + 1) {
        if (is_whole) length = 3000;
        length = std::min<std::size_t>(length, 3000 - done);
        const Sound part = played(*instrument, length);
        for (std::size_t i = 0; i < 2; ++i) sound[i].insert(sound[i].end(), part[i].begin(), part[i].end());
      }
      instrument->note_off(key);
    }
  }
  EXPECT_EQ(actual, expected);
}

// What a key has alone is what an instrument has that is set so; the other key stays as it is.
TEST(Voices, AreMovedAlone) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, kPiano));
  const SeenVoices both(arrays.view(), kRate);
  const auto low = played_by(arrays.view()), high = played_by(arrays.view());
  const auto parameters = both->parameters();
  const auto number = [&](std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(parameters, name, &Parameter::name) - parameters.begin());
  };
  const std::size_t felt = number("felt_stiffness_ratio"), speed = number("hammer_speed_m_per_s");
  ASSERT_TRUE(both->moves_keys(felt) && both->moves_keys(speed) && !both->moves_keys(number("bend_cents")));
  both->play({0, Action::kMoveKey, 57, 3, 0, felt});
  both->play({0, Action::kMoveKey, 57, 1.5, 0, speed});
  high->set(felt, 4);
  high->set(speed, 4);
  for (AnyInstrument<double>* instrument : {&*both, low.get()}) instrument->note_on(50, 0.5);
  for (AnyInstrument<double>* instrument : {&*both, high.get()}) instrument->note_on(57, 0.5);
  EXPECT_EQ(both->value(felt), 1);
  EXPECT_EQ(both->value(speed), 2.5);
  const Sound actual = played(*both, 2000), of_low = played(*low, 2000), of_high = played(*high, 2000);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t n = 0; n < 2000; ++n) ASSERT_EQ(actual[i][n], of_low[i][n] + of_high[i][n]) << n;

  // All are set: the key stays beside them, and held to the range.
  both->set(felt, 2);
  EXPECT_EQ(both->value(felt), 2);
  EXPECT_EQ(both.value(0, felt), 2);
  EXPECT_EQ(both.value(1, felt), 5);
  both->set(felt, 1e9);
  EXPECT_EQ(both.value(1, felt), both->value(felt));
  both->play({0, Action::kMoveKey, 57, std::nan(""), 0, felt});
  both->play({0, Action::kMoveKey, 57, std::numeric_limits<double>::infinity(), 0, felt});
  (void)played(*both, 100);
  both->set(felt, 1);
  both->play({0, Action::kMoveKey, 57, 0, 0, felt});
  (void)played(*both, 100);
  EXPECT_EQ(both.value(1, felt), 1);
  both->play({0, Action::kMoveKey, 20, 1, 0, felt});
}

// A gain and a place of a key: nothing else changes, and a change while it sounds takes about 5 ms, whatever the
// blocks.
TEST(Voices, AreMixedAlone) {
  const auto stereo = [](std::string text) {
    const std::string name = R"("name": "end")", struck = R"("name": "struck", "velocity)";
    text.replace(text.find(name), name.size(), R"("name": "left_end")");
    text.replace(text.find(struck), struck.size(), R"("name": "right_struck", "velocity)");
    return text;
  };
  const InstrumentArrays arrays = arrays_of_text(stereo(zither(0, kPiano)));
  const auto plain = played_by(arrays.view()), mixed = played_by(arrays.view()), in_parts = played_by(arrays.view());
  for (AnyInstrument<double>* instrument : {plain.get(), mixed.get(), in_parts.get()}) {
    instrument->note_on(60, 0.8);
  }
  mixed->play({0, Action::kLevelKey, 60, 0.5});
  mixed->play({0, Action::kPanKey, 60, 1});
  const Sound as_played = played(*plain, 1000), at_once = played(*mixed, 1000);
  (void)played(*in_parts, 1000);
  for (std::size_t n = 0; n < 1000; ++n) {
    ASSERT_EQ(at_once[0][n], 0);
    ASSERT_EQ(at_once[1][n], 0.5 * as_played[1][n]);
  }
  for (AnyInstrument<double>* instrument : {mixed.get(), in_parts.get()}) {
    instrument->play({0, Action::kLevelKey, 60, 1});
    instrument->play({0, Action::kPanKey, 60, instrument == mixed.get() ? 0.0 : -1.0});
  }
  const Sound expected = played(*plain, 2000), returns = played(*mixed, 2000);
  for (std::size_t n = 0, done = 0, length = 1; done < 2000; done += length, length = n++ % 90 + 1) {
    length = std::min<std::size_t>(length, 2000 - done);
    const Sound part = played(*in_parts, length);
    for (std::size_t k = 0; k < length; ++k) {
      const double rest = std::exp(-static_cast<double>(done + k + 1) / (0.005 * kRate)), bound = 2e-6 + 1e-9;
      ASSERT_NEAR(part[1][k], rest * expected[1][done + k], bound * std::abs(expected[1][done + k])) << done;
      ASSERT_NEAR(returns[0][done + k], (1 - rest) * expected[0][done + k], bound * std::abs(expected[0][done + k]));
    }
  }
}

// A damping of a key that sounds follows with its time constant in steps of 16 samples, whatever the blocks. Another
// key that takes the voice, and a rest, have that of all.
TEST(Voices, GlideAloneToWhereTheyAreMoved) {
  std::string text = zither(0, kPiano);
  const std::string controls = R"("controls": [)";
  text.replace(text.find(controls), controls.size(), controls + R"( { "name": "hand", "damping_per_s": "string" },)");
  const InstrumentArrays arrays = arrays_of_text(text);
  SeenVoices whole(arrays.view(), kRate), parts(arrays.view(), kRate);
  const auto parameters = whole->parameters();
  const auto hand = static_cast<std::size_t>(
      std::ranges::find(parameters, std::string_view("hand_damping_per_s"), &Parameter::name) - parameters.begin());
  ASSERT_LT(hand, parameters.size());
  const double glide_s = parameters[hand].glide_s;
  ASSERT_GT(glide_s, 0);
  Sound sound, in_parts;
  for (const SeenVoices* voices : {&whole, &parts}) {
    const SeenVoices& instrument = *voices;
    instrument->note_on(60, 0.7);
    (void)played(*instrument, 500);
    instrument->play({0, Action::kMoveKey, 60, 100, 0, hand});
    EXPECT_EQ(instrument.value(0, hand), 0) << "not yet";
  }
  sound = played(*whole, 1600);
  for (std::size_t done = 0, length = 1; done < 1600; done += length, length = done % 37 + 1) {
    length = std::min<std::size_t>(length, 1600 - done);
    const Sound part = played(*parts, length);
    for (std::size_t i = 0; i < 2; ++i) in_parts[i].insert(in_parts[i].end(), part[i].begin(), part[i].end());
    const double steps = std::ceil(static_cast<double>(done + length) / 16);
    EXPECT_NEAR(parts.value(0, hand), 100 * -std::expm1(-16 * steps / (glide_s * kRate)), 1e-9) << done;
  }
  EXPECT_EQ(in_parts, sound);
  EXPECT_EQ(whole->value(hand), 0);
  EXPECT_EQ(whole.value(1, hand), 0);
  (void)played(*whole, static_cast<std::size_t>(20 * glide_s * kRate));
  EXPECT_EQ(whole.value(0, hand), 100) << "it arrives";

  whole->note_off(60);
  whole->note_on(64, 0.7);
  whole->note_on(67, 0.7);  // on the voice of the first key, which still sounds
  (void)played(*whole, static_cast<std::size_t>(60 * glide_s * kRate));
  EXPECT_EQ(whole.value(0, hand), 0);
  whole->play({0, Action::kMoveKey, 67, 50, 0, hand});
  whole->reset();
  EXPECT_EQ(whole.value(0, hand), 0);
  whole->prepare(2 * kRate);
  whole->note_on(67, 0.7);
  EXPECT_EQ(whole.value(0, hand), 50) << "at rest it jumps";
}

// The voice of a key that is struck again is its own; a new key takes the voice that was released first.
TEST(Voices, AreTakenInOrder) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, kPiano));
  const SeenVoices instrument(arrays.view(), kRate);
  const auto energies = [&] { return std::pair(instrument.energy(0), instrument.energy(1)); };
  instrument->note_on(60, 0.5);
  instrument->note_on(64, 0.5);
  (void)played(*instrument, 500);
  const auto before = energies();
  EXPECT_GT(before.first, 0);
  EXPECT_GT(before.second, 0);
  instrument->note_on(60, 1);  // again: the first voice
  EXPECT_GT(energies().first, before.first);
  EXPECT_EQ(energies().second, before.second);
  instrument->note_off(64);
  instrument->note_off(60);
  const auto released = energies();
  instrument->note_on(67, 1);  // the second one was released first
  EXPECT_EQ(energies().first, released.first);
  EXPECT_GT(energies().second, released.second);
}

// A free damper of 60 1/s takes all in 0.2 s but e^-12 of the amplitude; the pedal holds it up.
TEST(Damper, FallsWithTheKeyUnlessThePedalHoldsIt) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, kPiano));
  const std::size_t sustain = arrays.model->keys.sustain;
  const auto loudness = [&](bool is_held, double pedal) {
    const auto instrument = played_by(arrays.view());
    instrument->set(sustain, pedal);
    instrument->note_on(60, 1);
    (void)played(*instrument, 2000);
    if (!is_held) instrument->note_off(60);
    (void)played(*instrument, 8820);
    const Sound sound = played(*instrument, 2000);
    return std::ranges::max(sound[0]);
  };
  const double held = loudness(true, 0);
  EXPECT_GT(held, 0.1);
  EXPECT_LT(loudness(false, 0), 3e-5 * held);
  EXPECT_EQ(loudness(false, 1), held);
}

// Energy minus work plus dissipation stays, also while a key tunes a string that sounds, and while the wheel bends.
// The rounding of a thousandth of a million operations in each sample: 1e-12 of the energy.
class BooksOfTuning : public ::testing::TestWithParam<std::string> {};
TEST_P(BooksOfTuning, AreKept) {
  const InstrumentArrays arrays = arrays_of_text(GetParam());
  const auto instrument = played_by(arrays.view());
  double balance = 0, largest = 0, work_of_tuning = 0;
  const auto play = [&](std::size_t samples) {
    for (std::size_t n = 0; n < samples; ++n) {
      const Books books = tick(*instrument);
      balance += books.work_j - books.heat_j;
      work_of_tuning = std::max(work_of_tuning, std::abs(books.work_j));
      ASSERT_NEAR(books.stored_j, balance, 1e-11 * (largest = std::max(largest, books.stored_j))) << n;
    }
  };
  for (const int key : {60, 72, 48}) {
    instrument->note_on(key, 1);
    play(1500);
    instrument->set(arrays.model->keys.bend, key == 72 ? -180 : 150);
    play(1500);
  }
  EXPECT_GT(work_of_tuning, 1e-6);
  for (const double cents :
       {4800.0, -4800.0, 2400.0, 0.0}) {  // modes above half the rate rest, and their energy goes
    instrument->set(arrays.model->keys.bend, cents);
    play(3000);
    instrument->note_on(64, 0.5);
    play(3000);
  }
}

INSTANTIATE_TEST_SUITE_P(, BooksOfTuning,
                         ::testing::Values(zither(0, std::string(kKeys) + R"("polyphony": 1,)"),
                                           xylophone(1, std::string(kBars) + R"("polyphony": 1,)")));

// At most what may be worked in 10 ms at 1 W in one step, whatever the keys do.
TEST(Tuning, OfAStringThatSoundsDoesBoundedWork) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, std::string(kKeys) + R"("polyphony": 1,)"));
  const auto instrument = played_by(arrays.view());
  instrument->set(arrays.model->parameters.size() - 2, 100);  // m/s
  instrument->note_on(60, 1);
  (void)played(*instrument, 2000);
  double risen = 0;
  for (int n = 0; n < 4410; ++n) {
    instrument->set(arrays.model->keys.bend, n % 64 < 32 ? 4800 : -4800);
    risen += std::max(0.0, tick(*instrument).work_j);
  }
  EXPECT_GT(risen, 0.01);
  EXPECT_LE(risen, 0.1 + 0.01 + 1e-9);
}

// Whenever in the wait between two changes of tension it comes.
TEST(Tuning, BeginsAnewAtAReset) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, std::string(kKeys) + R"("polyphony": 1,)"));
  const auto after_reset = [&](std::size_t samples) {
    const auto instrument = played_by(arrays.view());
    instrument->note_on(60, 1);
    (void)played(*instrument, 500);
    instrument->set(arrays.model->keys.bend, 4800);
    (void)played(*instrument, samples);
    instrument->reset();
    instrument->note_on(60, 1);
    return played(*instrument, 1000);
  };
  EXPECT_EQ(after_reset(9), after_reset(2));
}

TEST(Presets, AreValuesOfAllParameters) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, kPiano));
  const auto instrument = Engine<float>::network(without_keys(arrays.view()));
  ASSERT_EQ(instrument->presets().size(), 2U);
  EXPECT_STREQ(instrument->presets()[1].name, "bright");
  const auto parameters = instrument->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const std::string_view name = parameters[p].name;
    EXPECT_EQ(instrument->presets()[0].values[p], parameters[p].initial);
    const double bright = name == "felt_stiffness_ratio"   ? 4
                          : name == "hammer_speed_m_per_s" ? 5
                                                           : parameters[p].initial;
    EXPECT_EQ(instrument->presets()[1].values[p], bright) << name;
  }
}

TEST(Voices, AllocateNothingWhileTheyPlay) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, kPiano));
  const auto instrument = played_by<float>(arrays.view());
  std::vector<float> end(2000), struck(2000);
  const std::array<std::span<float>, 2> outputs = {end, struck};
  const std::size_t before = allocations;
  for (const int key : {48, 60, 72, 61}) {
    instrument->note_on(key, 0.9);
    instrument->process(outputs, {});
    instrument->set(arrays.model->keys.bend, key);
    instrument->note_off(key);
    instrument->process(outputs, {});
  }
  EXPECT_TRUE(instrument->energy() > 0 && !instrument->is_silent(1e-14));
  instrument->reset();
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(all_finite(end));
  EXPECT_TRUE(instrument->is_silent(1e-14));
}

// What is no key and no number does nothing; a reset forgets all.
TEST(Voices, IgnoreWhatIsNoKey) {
  const InstrumentArrays arrays = arrays_of_text(zither(0, kPiano));
  const auto instrument = played_by(arrays.view());
  for (const int key : {-1, 0, 47, 73, 128, 1000}) instrument->note_on(key, 1), instrument->note_off(key);
  instrument->note_on(60, std::numeric_limits<double>::quiet_NaN());
  instrument->strike(1, 1);
  instrument->pluck(0, 1);
  instrument->release(7);
  EXPECT_TRUE(instrument->is_silent(1e-14));
  const auto note = [&] {
    instrument->note_on(65, 1);
    return played(*instrument, 1000);
  };
  const Sound first = note();
  instrument->note_on(50, 1);
  (void)played(*instrument, 700);
  instrument->reset();
  EXPECT_EQ(note(), first);
}

// Keys of a drum strike one and the same head.
TEST(Drum, HasOneVoiceForAllKeys) {
  const InstrumentArrays arrays = arrays_of_text(R"({ "name": "drum",
    "bodies": [ { "name": "head", "resonator": "drum_head", "max_modes": 30 }, { "name": "left", "mass_kg": 0.02 },
                { "name": "right", "mass_kg": 0.03 } ],
    "places": [ { "name": "here", "body": "head", "position_m": 0.05 }, { "name": "there", "body": "head", "position_m": 0.1 } ],
    "contacts": [ { "name": "one", "between": ["left", "here"], "material": "felt_over_wood" },
                  { "name": "two", "between": ["right", "there"], "material": "felt_over_wood" } ],
    "strikes": ["left", "right"],
    "keys": [ { "key": 40, "event": "strike_right" }, { "key": 38, "event": "strike_left" } ],
    "outputs": [ { "name": "here", "velocity_m_per_s": "here" }, { "name": "one", "force_n": "one" } ] })");
  ASSERT_EQ(arrays.model->keys.voices, 1U);
  const auto by_keys = played_by(arrays.view());
  const auto by_strikes = played_by(without_keys(arrays.view()));
  for (const auto& [key, strike] : {std::pair(38, 0), std::pair(40, 1)}) {
    by_keys->note_on(key, 0.5);
    by_strikes->strike(static_cast<std::size_t>(strike), 1.25);
    EXPECT_EQ(played(*by_keys, 1200), played(*by_strikes, 1200));
  }
}

}  // namespace
}  // namespace contactspline::testing
