// SPDX-License-Identifier: MIT
// The plug-ins in a host: what they say of themselves, how they sound, that they are played by notes.
#include <set>
#include <sstream>

#include "contactspline/hammer_string.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "lv2_host.hpp"
#include "spectrum.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 48000;

/// One world for all tests: reading the descriptions takes most of a host's time.
const Lv2World& world() {
  static const Lv2World world;
  return world;
}

std::vector<std::string> names() {
  std::istringstream list(CONTACTSPLINE_PLUGINS);
  return {std::istream_iterator<std::string>(list), {}};
}

std::string uri_of(const std::string& name) { return "urn:contactspline:" + name; }

bool is_finite(std::span<const float> sound) {
  return std::all_of(sound.begin(), sound.end(), [](float x) { return std::isfinite(x); });
}

float peak(std::span<const float> sound) {
  float most = 0;
  for (const float x : sound) most = std::max(most, std::abs(x));
  return most;
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
  LILV_FOREACH(nodes, i, features) { EXPECT_STREQ(lilv_node_as_uri(lilv_nodes_get(features, i)), LV2_URID__map); }
  lilv_nodes_free(features);

  std::set<std::string> symbols;
  for (const Lv2Port& port : ports_of(world(), plugin)) {
    SCOPED_TRACE(port.symbol);
    EXPECT_TRUE(symbols.insert(port.symbol).second);
    EXPECT_NE(port.name, "");
    EXPECT_NE(port.is_input, port.is_output);
    EXPECT_EQ(port.is_control + port.is_audio + port.is_midi, 1);
    if (port.is_control && port.is_input) {
      EXPECT_LE(port.least, port.initial);
      EXPECT_LE(port.initial, port.most);
      EXPECT_LT(port.least, port.most);
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
TEST(HammerStringPlugin, SoundsAsTheRuntime) {
  using Felt = materials::felt_c4;
  using String = resonators::string_c4;
  constexpr std::size_t kBlocks = 187;  // a second
  constexpr std::size_t kSamples = kBlocks * Lv2Instance::kBlock;
  Lv2Instance plugin(world(), uri_of("hammer_string"), kRate);
  plugin.set("strike", 1);
  const auto sound = plugin.run(kBlocks);

  const ModeShapes<double> pickup(std::span<const double>(String::pickup_shapes));
  HammerString<double> model(std::span<const Segment<double>>(segments_of<Felt, double>), modes_in<String>,
                             ModeShapes<double>(std::span<const double>(String::strike_shapes)), kRate);
  model.strike(2.5, 1e-4);
  double error = 0, power = 0;
  for (std::size_t n = 0; n + 1 < kSamples; ++n) {
    model.tick({.hammer_mass_kg = 0.00297});
    const double expected_mm = 1000 * model.string().displacement(pickup);
    const double difference = sound[0][n + 1] - expected_mm;  // in Faust it comes a sample later
    error += difference * difference;
    power += expected_mm * expected_mm;
  }
  const double decibels = 10 * std::log10(power / error);
  RecordProperty("decibels", std::to_string(decibels));
  EXPECT_GE(decibels, 70);
}

/// What the string of keys.dsp has for its lowest partial when a note is played.
double pitch_hz(int note) {
  return 440 * std::exp2((note - 69) / 12.0) * resonators::string_c4::angular_frequencies[0] /
         (2 * std::numbers::pi * 262.24);
}

constexpr std::size_t kSecond = static_cast<std::size_t>(kRate) / Lv2Instance::kBlock;

/// keys.dsp with all of its voices.
class Keys : public Lv2Instance {
 public:
  Keys() : Lv2Instance(world(), uri_of("keys"), kRate) { set("polyphony", 8); }
  std::vector<float> listen(std::size_t blocks) { return run(blocks)[0]; }
};

TEST(PolyphonicPlugin, IsAnInstrumentPlayedByMidi) {
  const LilvPlugin* plugin = world().plugin(uri_of("keys"));
  EXPECT_STREQ(lilv_node_as_uri(lilv_plugin_class_get_uri(lilv_plugin_get_class(plugin))), LV2_CORE__InstrumentPlugin);
  int midi_inputs = 0;
  for (const Lv2Port& port : ports_of(world(), plugin)) {
    midi_inputs += port.is_midi && port.is_input;
    if (port.name == "polyphony") {
      EXPECT_EQ(port.most, 8);
    }
    EXPECT_NE(port.name, "freq");  // belongs to the notes
  }
  EXPECT_EQ(midi_inputs, 1);
}

TEST(PolyphonicPlugin, IsSilentUntilANoteComes) {
  Keys keys;
  EXPECT_EQ(peak(keys.listen(20)), 0);
  keys.note_on(60, 100);
  EXPECT_GT(peak(keys.listen(20)), 0.01f);
}

// An octave and a half about C4. The peak is within 0.02 of a bin of 0.73 Hz, or 0.2 cent at 130 Hz.
TEST(PolyphonicPlugin, PlaysInTune) {
  for (const int note : {48, 55, 60, 64, 67}) {
    Keys keys;
    keys.note_on(note, 100);
    const auto sound = keys.listen(256);
    const auto partial = strongest_partial(sound, kRate, 0.8 * pitch_hz(note), 1.2 * pitch_hz(note));
    EXPECT_TRUE(within(1200 * std::log2(partial.frequency_hz / pitch_hz(note)), 0, 0.3)) << "note " << note;
  }
}

// Voices add: a chord is the sum of its notes, to rounding of a few numbers of 24 bits.
TEST(PolyphonicPlugin, AChordIsTheSumOfItsNotes) {
  const std::vector<int> chord = {60, 64, 67, 72};
  Keys together;
  for (const int note : chord) together.note_on(note, 90);
  const auto sound = together.listen(kSecond);
  std::vector<float> sum(sound.size());
  for (const int note : chord) {
    Keys alone;
    alone.note_on(note, 90);
    const auto one = alone.listen(kSecond);
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += one[n];
  }
  EXPECT_TRUE(sequences_within<float>(sound, sum, 1e-6));
  for (const int note : chord) {
    const auto partial = strongest_partial(sound, kRate, 0.99 * pitch_hz(note), 1.01 * pitch_hz(note));
    EXPECT_TRUE(within(1200 * std::log2(partial.frequency_hz / pitch_hz(note)), 0, 2)) << "note " << note;
    EXPECT_GT(partial.amplitude, 0.01);
  }
}

// keys.dsp damps by 60/s once the key is up, beside the string's own 0.5/s: in half a second 260 dB.
TEST(PolyphonicPlugin, AReleasedNoteDecaysAndAHeldOneStays) {
  Keys keys;
  keys.note_on(60, 100);
  keys.note_on(67, 100);
  (void)keys.listen(kSecond / 4);
  keys.note_off(67);
  (void)keys.listen(kSecond / 2);
  const auto sound = keys.listen(kSecond / 2);
  const double held = strongest_partial(sound, kRate, 0.98 * pitch_hz(60), 1.02 * pitch_hz(60)).amplitude;
  const double released = strongest_partial(sound, kRate, 0.98 * pitch_hz(67), 1.02 * pitch_hz(67)).amplitude;
  EXPECT_GT(held, 0.01);
  EXPECT_LT(released, 1e-3 * held);
}

TEST(PolyphonicPlugin, PlaysLouderWhenStruckHarder) {
  double before = 0;
  for (const int velocity : {20, 50, 80, 127}) {
    Keys keys;
    keys.note_on(60, velocity);
    const double level = rms(keys.listen(kSecond / 4));
    EXPECT_GT(level, 1.2 * before) << "velocity " << velocity;
    before = level;
  }
}

// More notes than voices: the oldest gives way.
TEST(PolyphonicPlugin, StealsTheOldestNote) {
  Keys keys;
  for (int i = 0; i <= 8; ++i) {
    keys.note_on(60 + i, 100);
    (void)keys.listen(4);
  }
  (void)keys.listen(kSecond / 2);
  const auto sound = keys.listen(256);
  EXPECT_TRUE(is_finite(sound));
  const auto level = [&](int note) {
    return strongest_partial(sound, kRate, 0.99 * pitch_hz(note), 1.01 * pitch_hz(note)).amplitude;
  };
  EXPECT_LT(level(60), 0.1 * level(61));
  EXPECT_GT(level(68), 0.3 * level(61));
}

TEST(PolyphonicPlugin, AllNotesOffSilencesAll) {
  Keys keys;
  for (const int note : {60, 64, 67}) keys.note_on(note, 100);
  const double before = rms(keys.listen(kSecond / 4));
  keys.send({0xb0, 123, 0});
  (void)keys.listen(kSecond / 2);
  EXPECT_LT(rms(keys.listen(kSecond / 4)), 1e-3 * before);
}

}  // namespace
}  // namespace contactspline::testing
