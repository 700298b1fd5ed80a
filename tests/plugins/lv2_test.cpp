// SPDX-License-Identifier: MIT
// The plug-ins in a host: what they say of themselves, how they sound, that they are played by notes.
#include <algorithm>
#include <set>
#include <sstream>

#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/models/hammer_string.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/step/high_pass.hpp"
#include "lv2_host.hpp"
#include "support/compare.hpp"
#include "support/spectrum.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 48000;
constexpr std::size_t kSecond = static_cast<std::size_t>(kRate) / Lv2Instance::kBlock;  // blocks

/// One world for all tests: reading the descriptions takes most of a host's time.
const Lv2World& world() {
  static const Lv2World world;
  return world;
}

std::vector<std::string> names() {
  std::istringstream list(CONTACTSPLINE_PLUGINS);
  return {std::istream_iterator<std::string>(list), {}};
}

std::string uri_of(const std::string& name) {
  return "urn:contactspline:" + name;
}

bool is_finite(std::span<const float> sound) {
  return std::all_of(sound.begin(), sound.end(), [](float x) { return std::isfinite(x); });
}

float peak(std::span<const float> sound) {
  float max = 0;
  for (const float x : sound) max = std::max(max, std::abs(x));
  return max;
}

/// Signal over error in decibels; not a number where the lengths differ, so that no bound holds.
double agreement_db(std::span<const float> actual, std::span<const double> expected) {
  if (actual.size() != expected.size()) return std::numeric_limits<double>::quiet_NaN();
  double error = 0, power = 0;
  for (std::size_t n = 0; n < expected.size(); ++n) {
    const double difference = static_cast<double>(actual[n]) - expected[n];
    error += difference * difference;
    power += expected[n] * expected[n];
  }
  return 10 * std::log10(power / error);
}

class EveryPlugin : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ThatShips, EveryPlugin, ::testing::ValuesIn(names()),
                         [](const auto& test) { return test.param; });

TEST_P(EveryPlugin, DescribesItself) {
  const LilvPlugin* plugin = world().plugin(uri_of(GetParam()));
  EXPECT_TRUE(lilv_plugin_verify(plugin));
  const Lv2World::Node name(lilv_plugin_get_name(plugin), lilv_node_free);
  EXPECT_EQ(lilv_node_as_string(name.get()), GetParam());
  // A host that offers urid:map, as all do, can load it.
  LilvNodes* features = lilv_plugin_get_required_features(plugin);
  LILV_FOREACH(nodes, i, features) {
    EXPECT_STREQ(lilv_node_as_uri(lilv_nodes_get(features, i)), LV2_URID__map);
  }
  lilv_nodes_free(features);

  std::set<std::string> symbols;
  for (const Lv2Port& port : ports_of(world(), plugin)) {
    SCOPED_TRACE(port.symbol);
    EXPECT_TRUE(symbols.insert(port.symbol).second);
    EXPECT_NE(port.name, "");
    EXPECT_NE(port.is_input, port.is_output);
    EXPECT_EQ(port.is_control + port.is_audio + port.is_midi, 1);
    if (port.is_control && port.is_input) {
      EXPECT_LE(port.min, port.initial);
      EXPECT_LE(port.initial, port.max);
      EXPECT_LT(port.min, port.max);
    }
  }
}

// Every button pressed and let go, and a note where it takes notes: it sounds, and stays finite.
TEST_P(EveryPlugin, Sounds) {
  for (const double rate_hz : {44100.0, 96000.0}) {
    Lv2Instance plugin(world(), uri_of(GetParam()), rate_hz);
    const auto press = [&](float value) {
      for (const Lv2Port& port : plugin.ports())
        if (port.is_button) plugin.set(port.name, value);
    };
    (void)plugin.run(4);
    press(1);
    plugin.note_on(60, 100);
    auto sound = plugin.run(200);
    press(0);
    plugin.note_off(60);
    for (const auto& rest = plugin.run(200); auto& channel : sound) {
      const auto& more = rest[static_cast<std::size_t>(&channel - sound.data())];
      channel.insert(channel.end(), more.begin(), more.end());
    }
    ASSERT_FALSE(sound.empty());
    for (const auto& channel : sound) EXPECT_TRUE(is_finite(channel));
    EXPECT_GT(peak(sound[0]), 1e-4f);
  }
}

// The plug-in, in single precision and compiled by -Ofast, against the C++ model in double. 70 dB: see
// faust_hammer_string_test.cpp.
// `delay`: samples by which its displacement comes later.
void expect_the_sound_of_the_runtime(const std::string& name, std::size_t delay) {
  using Felt = materials::felt_c4;
  using String = resonators::string_c4;
  constexpr std::size_t kBlocks = 187;  // a second
  constexpr std::size_t kSamples = kBlocks * Lv2Instance::kBlock;
  Lv2Instance plugin(world(), uri_of(name), kRate);
  plugin.set("strike", 1);
  const auto sound = plugin.run(kBlocks);

  HammerString<double> model(std::span<const Segment<double>>(segments_of<Felt, double>), modes_in<String>,
                             ModeShapes<double>(String::strike_shapes), kRate);
  const auto pickup = model.string().sound_pickup(String::pickup_shapes);
  model.strike(2.5, 1e-4);
  std::vector<double> expected_mm;
  for (std::size_t n = delay; n < kSamples; ++n) {
    model.tick({.hammer_mass_kg = 0.00297});
    expected_mm.push_back(1000 * model.string().displacement(pickup));
  }
  const double decibels = agreement_db(std::span(sound[0]).subspan(delay), expected_mm);
  ::testing::Test::RecordProperty("decibels", std::to_string(decibels));
  EXPECT_GE(decibels, 70);
}

TEST(HammerStringPlugin, SoundsAsTheRuntime) {
  expect_the_sound_of_the_runtime("hammer_string", 1);
}

// The runtime itself, in the architecture file of Faust: examples/fast_hammer_string.cpp.
TEST(FastHammerStringPlugin, SoundsAsTheRuntime) {
  if (std::ranges::count(names(), "fast_hammer_string") == 0) GTEST_SKIP() << "built without examples";
  expect_the_sound_of_the_runtime("fast_hammer_string", 0);
}

double pitch_hz(int note) {
  return 440 * std::exp2((note - 69) / 12.0);
}

/// The right output of the piano. Voices cost time even while silent.
class Piano : public Lv2Instance {
 public:
  explicit Piano(int voices = 4) : Lv2Instance(world(), uri_of("piano"), kRate) {
    set("polyphony", static_cast<float>(voices));
    (void)run(1);
  }
  std::vector<float> listen(std::size_t blocks) { return run(blocks)[1]; }

  static constexpr int kVoices = 16;
};

/// First partial of a note in a sound, wherever it is within 2 semitones.
Partial first_partial(std::span<const float> sound, int note) {
  return strongest_partial(sound, kRate, pitch_hz(note - 2), pitch_hz(note + 2));
}

double cents_off(std::span<const float> sound, int note) {
  return 1200 * std::log2(first_partial(sound, note).frequency_hz / pitch_hz(note));
}

TEST(PianoPlugin, IsAnInstrumentPlayedByMidi) {
  const LilvPlugin* plugin = world().plugin(uri_of("piano"));
  EXPECT_STREQ(lilv_node_as_uri(lilv_plugin_class_get_uri(lilv_plugin_get_class(plugin))),
               LV2_CORE__InstrumentPlugin);
  int midi_inputs = 0;
  float max_voices = 0;
  for (const Lv2Port& port : ports_of(world(), plugin)) {
    midi_inputs += port.is_midi && port.is_input;
    if (port.name == "polyphony") max_voices = port.max;
    EXPECT_NE(port.name, "freq");  // belongs to the notes
  }
  EXPECT_EQ(midi_inputs, 1);
  EXPECT_EQ(max_voices, Piano::kVoices);
}

TEST(PianoPlugin, IsSilentUntilANoteComes) {
  Piano piano;
  EXPECT_EQ(peak(piano.listen(20)), 0);
  piano.note_on(60, 100);
  EXPECT_GT(peak(piano.listen(20)), 0.01f);
}

// A note of one string against the C++ voice and the bank of the soundboard's modes in double. The plug-in computes
// the pitch from `freq` in single precision, to two roundings of 6e-8: after a second a partial at 1 kHz, where the
// board moves as strongly as anywhere, is late by 2 pi 1000 1.2e-7 rad, which is 62 dB below it.
TEST(PianoPlugin, SoundsAsTheRuntime) {
  using Keyboard = keyboards::piano;
  using Board = Keyboard::body;
  for (const int note : {22, 31}) {
    constexpr int kVelocity = 90;
    constexpr std::size_t kRest = 30;    // blocks, until the damper lies on the string
    constexpr std::size_t kLatency = 4;  // samples: the loop's one, and 3 of the strings' interpolation
    Piano piano;
    (void)piano.listen(kRest);
    piano.note_on(note, kVelocity);
    const auto sound = piano.listen(kSecond);
    KeyboardVoice<Keyboard, double> voice(note, kRate, 80);
    voice.release();
    for (std::size_t n = 0; n < kRest * Lv2Instance::kBlock; ++n) voice.tick();
    voice.strike(0.2 * std::pow(30.0, kVelocity / 127.0));
    std::vector<Mode> modes;
    for (std::size_t i = 0; i < Board::modes; ++i)
      modes.push_back({Board::angular_frequencies[i], Board::decays[i], Board::masses[i]});
    ModalBank<double> board(modes, kRate);
    const ModeShapes<double> bridge(Board::bridge_shapes);
    const auto right = board.sound_pickup(ModeShapes<double>(Board::right_shapes));
    HighPass<double> high_pass(Board::output_above_hz, kRate, Board::output_quality);
    std::vector<double> expected;
    for (std::size_t n = 0; n + kLatency < sound.size(); ++n) {
      const double force =
          Keyboard::output_ratios[static_cast<std::size_t>(note - Keyboard::first_key)] * voice.tick();
      board.predict();
      board.push(bridge, force);
      board.commit();
      const double heard =
          Board::pickup_ratio * board.velocity(right) + Board::mobility_m_per_n_s * high_pass.tick(force);
      expected.push_back(0.5 / 0.1 * heard);
    }
    const double decibels = agreement_db(std::span(sound).subspan(kLatency), expected);
    RecordProperty("decibels_" + std::to_string(note), std::to_string(decibels));
    EXPECT_GE(decibels, 60) << "note " << note;
  }
}

// A chord at the first value of the volume.
TEST(PianoPlugin, IsLoudEnoughAndDoesNotClip) {
  for (const int velocity : {60, 127}) {
    Piano piano;
    for (const int note : {48, 60, 64, 67}) piano.note_on(note, velocity);
    const double decibels = 20 * std::log10(static_cast<double>(peak(piano.listen(kSecond))));
    RecordProperty("peak_db_" + std::to_string(velocity), std::to_string(decibels));
    EXPECT_GT(decibels, -30);
    EXPECT_LT(decibels, 0);
  }
}

// The first partial is at the pitch of the note. The peak of the spectrum is within 0.02 of a bin of 0.73 Hz: 0.2
// cent at the lowest of these.
TEST(PianoPlugin, PlaysInTune) {
  for (const int note : {48, 55, 60, 67, 72, 84}) {
    Piano piano;
    piano.note_on(note, 100);
    EXPECT_TRUE(within(cents_off(piano.listen(256), note), 0, 0.2)) << "note " << note;
  }
}

// Voices add, and the soundboard is linear: a chord is the sum of its notes. Each sample of a mode of the board
// rounds by up to 6e-8 of it, and its decay of at least 13/s keeps 3700 samples: 6e-8 sqrt(3700) = 3.6e-6.
TEST(PianoPlugin, AChordIsTheSumOfItsNotes) {
  const std::vector<int> chord = {60, 64, 67, 72};
  Piano together;
  for (const int note : chord) together.note_on(note, 90);
  const auto sound = together.listen(kSecond);
  std::vector<float> sum(sound.size());
  for (const int note : chord) {
    Piano alone;
    alone.note_on(note, 90);
    const auto one = alone.listen(kSecond);
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += one[n];
  }
  EXPECT_TRUE(sequences_within<float>(sound, sum, 3.6e-6));
  for (const int note : chord) EXPECT_TRUE(within(cents_off(sound, note), 0, 2)) << "note " << note;
}

// The damper adds 60/s to a string's decay once the key is up: in half a second 260 dB.
TEST(PianoPlugin, AReleasedNoteDecaysAndAHeldOneStays) {
  Piano piano;
  piano.note_on(60, 100);
  piano.note_on(67, 100);
  (void)piano.listen(kSecond / 4);
  piano.note_off(67);
  (void)piano.listen(kSecond / 2);
  const auto sound = piano.listen(kSecond / 2);
  EXPECT_LT(first_partial(sound, 67).amplitude, 1e-2 * first_partial(sound, 60).amplitude);
  EXPECT_TRUE(within(cents_off(sound, 60), 0, 2));
}

TEST(PianoPlugin, ThePedalHoldsWhatIsReleased) {
  const auto left_after_release = [](std::uint8_t pedal) {
    Piano piano;
    piano.send({0xb0, 64, pedal});
    piano.note_on(60, 100);
    (void)piano.listen(kSecond / 4);
    piano.note_off(60);
    (void)piano.listen(kSecond / 2);  // in which the board rings out, too
    return rms(piano.listen(kSecond / 4));
  };
  EXPECT_LT(left_after_release(0), 1e-3 * left_after_release(127));
}

// Midway between the keys above and below: by half a semitone and by one and a half.
TEST(PianoPlugin, FollowsThePitchWheel) {
  for (const double semitones : {-1.5, -0.25, 0.25, 0.5, 1.5}) {
    Piano piano;
    piano.note_on(60, 100);
    (void)piano.listen(kSecond / 4);
    const auto wheel = static_cast<unsigned>(0x2000 + 0x1000 * semitones);  // two semitones in both directions
    piano.send({0xe0, static_cast<std::uint8_t>(wheel & 0x7f), static_cast<std::uint8_t>(wheel >> 7)});
    (void)piano.listen(4);
    EXPECT_TRUE(within(cents_off(piano.listen(256), 60), 100 * semitones, 1)) << semitones;
  }
}

TEST(PianoPlugin, PlaysLouderWhenStruckHarder) {
  double before = 0;
  for (const int velocity : {20, 50, 80, 127}) {
    Piano piano;
    piano.note_on(60, velocity);
    const double level = rms(piano.listen(kSecond / 4));
    EXPECT_GT(level, 1.2 * before) << "velocity " << velocity;
    before = level;
  }
}

// More notes than voices: the oldest is stolen.
TEST(PianoPlugin, StealsTheOldestNote) {
  Piano piano(Piano::kVoices);
  for (int i = 0; i <= Piano::kVoices; ++i) {
    piano.note_on(50 + 2 * i, 100);
    (void)piano.listen(4);
  }
  const auto sound = piano.listen(256);
  EXPECT_TRUE(is_finite(sound));
  const auto level = [&](int note) {
    return strongest_partial(sound, kRate, 0.99 * pitch_hz(note), 1.01 * pitch_hz(note)).amplitude;
  };
  EXPECT_LT(level(50), 0.1 * level(52));
  EXPECT_GT(level(82), 0.1 * level(52));
}

TEST(PianoPlugin, AllNotesOffSilencesAll) {
  Piano piano;
  for (const int note : {60, 64, 67}) piano.note_on(note, 100);
  const double before = rms(piano.listen(kSecond / 4));
  piano.send({0xb0, 123, 0});
  (void)piano.listen(kSecond / 2);
  EXPECT_LT(rms(piano.listen(kSecond / 4)), 1e-3 * before);
}

}  // namespace
}  // namespace contactspline::testing
