// SPDX-License-Identifier: MIT
// What hosts stumbled over: classes, features, units, hidden parameters, scales, values within a block, readings,
// state.
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "contactspline/host/hosted.hpp"
#include "contactspline/host/oversampled.hpp"
#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instruments/trichord_c4.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "generator/support/input_file.hpp"
#include "plugins/open_plugin.hpp"
#include "plugins/reference.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr std::size_t kBlock = HostedPlugin::kBlock;
constexpr double kRate = 48000;

const std::vector<std::string>& instruments() {
  static const std::vector<std::string> names = [] {
    std::istringstream list(CONTACTSPLINE_PLUGINS);
    return std::vector<std::string>{std::istream_iterator<std::string>(list), {}};
  }();
  return names;
}

// Hosts offer a MIDI track to instruments only, and small ones have no feature but the map of names.
TEST(Lv2, IsAnInstrumentForEveryHost) {
  ASSERT_FALSE(instruments().empty());
  for (const std::string& name : instruments()) {
    SCOPED_TRACE(name);
    const LilvPlugin* plugin = world().plugin("urn:contactspline:contactspline_" + name);
    EXPECT_STREQ(lilv_node_as_uri(lilv_plugin_class_get_uri(lilv_plugin_get_class(plugin))),
                 LV2_CORE__InstrumentPlugin);
    LilvNodes* features = lilv_plugin_get_required_features(plugin);
    EXPECT_EQ(lilv_nodes_size(features), 1u);
    LILV_FOREACH(nodes, i, features) {
      EXPECT_STREQ(lilv_node_as_uri(lilv_nodes_get(features, i)), LV2_URID__map);
    }
    lilv_nodes_free(features);
    const Lv2World::Node author(lilv_plugin_get_author_name(plugin), lilv_node_free);
    ASSERT_TRUE(author);
    EXPECT_STREQ(lilv_node_as_string(author.get()), "Contact Spline");
    EXPECT_TRUE(lilv_plugin_has_feature(plugin, world().uri(LV2_OPTIONS__options).get()));
    int midi_inputs = 0;
    for (const Lv2Port& port : ports_of(world(), plugin)) {
      midi_inputs += port.is_midi && port.is_input;
      EXPECT_EQ(port.name.find('_'), std::string::npos) << port.name;
    }
    EXPECT_EQ(midi_inputs, 1);
  }
}

// No name of a parameter holds its unit, in any format.
TEST(EveryFormat, HasPlainNamesAndUnits) {
  for (const char* format : {"clap", "vst3", "lv2"})
    for (const std::string& name : instruments()) {
      const auto plugin = open_plugin(format, name, kRate);
      auto all = plugin->parameters();
      const auto readings = plugin->readings();
      all.insert(all.end(), readings.begin(), readings.end());
      for (const HostedParameter& parameter : all) {
        SCOPED_TRACE(format + (" " + name) + ": " + parameter.name);
        EXPECT_EQ(parameter.name.find('_'), std::string::npos);
        EXPECT_FALSE(parameter.name.ends_with(" m") || parameter.name.ends_with(" n") ||
                     parameter.name.ends_with(" hz") || parameter.name.ends_with(" kg"));
        const bool is_force = parameter.name.ends_with("force"), is_mass = parameter.name.ends_with("mass");
        EXPECT_EQ(parameter.unit, is_force ? "N" : is_mass ? "g" : parameter.unit);
      }
    }
}

// A note plays each of them, and what reaches the loudspeakers is neither silent nor clipped.
TEST(EveryFormat, SoundsAtASaneLevel) {
  for (const std::string& name : instruments()) {
    const auto plugin = open_plugin("clap", name, kRate);
    plugin->send(0, {0x90, 60, 100});
    float peak = 0;
    for (const auto& side : plugin->run(static_cast<std::size_t>(2 * kRate) / kBlock))
      for (const float x : side) peak = std::isfinite(x) ? std::max(peak, std::abs(x)) : 1e30f;
    const double decibels = 20 * std::log10(static_cast<double>(peak));
    RecordProperty(name, std::to_string(decibels));
    EXPECT_GE(decibels, -36) << name;
    EXPECT_LE(decibels, 0) << name;
  }
}

// Programs, parameters, readings, and hidden ones: of all channels at most four, of each two (wheel, all notes off).
TEST(Vst3, HasNoParametersForControllers) {
  for (const std::string& name : instruments()) {
    const auto plugin = open_vst3(name);
    const std::size_t shown = plugin->parameters().size() + plugin->readings().size();
    EXPECT_LE(static_cast<std::size_t>(plugin->count()), shown + 1 + 4 + 2 * 16) << name;
    EXPECT_GE(static_cast<std::size_t>(plugin->count()), shown + 2) << name;
    EXPECT_EQ(plugin->tail(), UINT32_MAX);
  }
}

// Ardour sends to the processor what it reads: a wheel that reads 0 would bend all the way down.
TEST(Vst3, BeginsAtTheDefaultsOfAllParameters) {
  for (const std::string& name : instruments()) EXPECT_LE(open_vst3(name)->from_defaults(), 1e-6) << name;
}

TEST(Vst3, HasLogarithmicScales) {
  const auto plugin = open_vst3("hammer_string");
  EXPECT_TRUE(relatively_within(plugin->value_at("stiffness ratio", 0.5), 1, 1e-6));  // 0.001 to 1000
  EXPECT_TRUE(relatively_within(plugin->value_at("stiffness ratio", 0.75), std::sqrt(1000), 1e-6));
  EXPECT_TRUE(relatively_within(plugin->value_at("damping", 0.25), 250, 1e-6));  // linear, 0 to 1000
  for (const HostedParameter& parameter : plugin->parameters())
    for (const double part : {0.0, 0.125, 0.5, 0.9, 1.0})
      EXPECT_TRUE(within(plugin->part_of(parameter.name, plugin->value_at(parameter.name, part)), part, 2e-7))
          << parameter.name << " at " << part;
}

using Hammer = HammerStringOf<materials::felt_c4, resonators::string_c4, float>;

// While a note rings, the oversampling moves twice. The instrument at the higher rate plays what comes then; the note
// fades out by g, whose steps add at most |x| dg, and g falls by at most 1.5/480 in a sample.
TEST(EveryFormat, IsOversampledWhileItSounds) {
  for (const char* format : {"clap", "vst3", "lv2"}) {
    SCOPED_TRACE(format);
    const auto plugin = open_plugin(format, "hammer_string", kRate);
    EXPECT_EQ(plugin->latency(), 0u);
    std::size_t changes = 0;
    for (const auto& [factor, latency] : {std::pair{4, 37u}, {8, 38u}}) {
      plugin->send(0, {0x90, 60, 100});
      auto sound = plugin->run(20)[0];
      const std::vector<float> ringing(sound.end() - 2 * kBlock, sound.end());
      const auto largest_step = [](const std::vector<float>& x) {
        float step = 0;
        for (std::size_t n = 1; n < x.size(); ++n) step = std::max(step, std::abs(x[n] - x[n - 1]));
        return step;
      };
      plugin->set("oversampling", factor);
      sound = {ringing.back()};
      const std::vector<float> silence(kBlock);
      for (std::vector<float> block; block != silence && sound.size() < std::size_t(10 * kRate);) {
        block = plugin->run(1)[0];
        sound.insert(sound.end(), block.begin(), block.end());
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      ASSERT_EQ(std::vector<float>(sound.end() - kBlock, sound.end()), silence);
      EXPECT_LE(largest_step(sound), 1.02f * largest_step(ringing) + 1.5f / 480 * *std::ranges::max_element(ringing));
      if (auto* const vst3 = dynamic_cast<Vst3Plugin*>(plugin.get())) vst3->tell_controller("oversampling", factor);
      if (auto* const clap = dynamic_cast<ClapPlugin*>(plugin.get())) {
        EXPECT_TRUE(clap->wants_restart());
        clap->restart(kRate);
      }
      EXPECT_EQ(plugin->latency(), latency);
      EXPECT_EQ(plugin->latency_changes(), format == std::string("lv2") ? 0 : ++changes);

      ReferenceOf reference(std::make_unique<Oversampled<float>>(handle_of<Hammer>(), factor), kRate);
      reference.midi(std::array<std::uint8_t, 3>{0x90, 60, 100});
      plugin->send(0, {0x90, 60, 100});
      const auto expected = reference.run(40 * kBlock)[0], played = plugin->run(40)[0];
      EXPECT_GT(*std::ranges::max_element(expected), 1e-3f);
      EXPECT_GE(agreement_db<float>(played, expected), 100) << factor;
      plugin->send(0, {0x80, 60, 64});
    }
    EXPECT_EQ(plugin->allocated(), 0u);
    EXPECT_EQ(plugin->locked(), 0u);
    const auto restored = open_plugin(format, "hammer_string", kRate);
    restored->restore(plugin->save());
    (void)restored->run(1);
    EXPECT_EQ(restored->value("oversampling"), 8);
    EXPECT_EQ(restored->latency(), 38u);
    for (const double set : {3.0, 0.0, 1e30}) {
      restored->set("oversampling", set);
      (void)restored->run(1);
      if (format != std::string("lv2")) {  // its host keeps the values
        EXPECT_EQ(restored->value("oversampling"), set == 3 ? 4 : set == 0 ? 1 : 8) << set;
      }
    }
  }
}

// A file of the plug-in's instrument, in a folder that the environment names, is played in the place of what was
// built in, and follows each change while a note rings. A damaged file changes nothing.
TEST(EveryFormat, FollowsAWatchedFileWhileItSounds) {
  if (!HAS_C_LIBRARY) GTEST_SKIP() << "the library for C reads the file";
  constexpr double kRateOfFiles = 44100;  // below half of it are the modes that are built in
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("contactspline_watch_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::string text = read_input(INSTRUMENTS "/trichord_c4.json");
  const auto save = [&](const char* mass) {
    const std::string from = R"("name": "hammer", "mass_kg": 0.00891)";
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), R"("name": "hammer", "mass_kg": )" + std::string(mass));
    std::ofstream(folder / "new") << changed;
    std::filesystem::rename(folder / "new", folder / "trichord_c4.json");
  };
  const auto note = [](HostedPlugin& plugin) {
    plugin.send(0, {0x90, 60, 100});
    return plugin.run(20)[0];
  };
  const auto built_in = open_plugin("clap", "trichord_c4", kRateOfFiles);
  const std::vector<float> expected = note(*built_in);
  save("0.00891");
  ::setenv("CONTACTSPLINE_WATCH", folder.c_str(), 1);
  std::vector<double> milliseconds;
  for (const char* format : {"clap", "vst3", "lv2"}) {
    SCOPED_TRACE(format);
    const auto plugin = open_plugin(format, "trichord_c4", kRateOfFiles);
    for (int change = 0; change < 4; ++change) {
      const std::vector<float> played = note(*plugin);
      EXPECT_EQ(agreement_db<float>(played, expected) >= 100, change % 2 == 0)
          << agreement_db<float>(played, expected);
      save("-1");
      for (int block = 0; block < 20; ++block) {
        std::this_thread::sleep_for(std::chrono::milliseconds(4));
        EXPECT_NE(plugin->run(1)[0], std::vector<float>(kBlock)) << "it plays on beside a damaged file";
      }
      save(change % 2 == 0 ? "0.02" : "0.00891");
      const auto saved = std::chrono::steady_clock::now();
      const auto elapsed = [&] {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - saved).count();
      };
      while (plugin->run(1)[0] != std::vector<float>(kBlock) && elapsed() < 10000)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      milliseconds.push_back(elapsed());
    }
    EXPECT_EQ(plugin->allocated(), 0u);
    EXPECT_EQ(plugin->locked(), 0u);
  }
  std::ranges::sort(milliseconds);
  Measured() << "from the file to the sound " << milliseconds[6] << " ms, at most " << milliseconds.back() << " ms";
  EXPECT_LT(milliseconds[6], 100);
  ::unsetenv("CONTACTSPLINE_WATCH");
  std::filesystem::remove_all(folder);
}

// 8 times 192 kHz is no rate of an instrument, 4 times is.
TEST(EveryFormat, IsOversampledAsFarAsRatesGo) {
  const auto plugin = open_plugin("clap", "hammer_string", 192000);
  plugin->set("oversampling", 8);
  (void)plugin->run(1);
  EXPECT_EQ(plugin->latency(), 37u);
  EXPECT_EQ(plugin->value("oversampling"), 8);
}

// Hosts that keep a part of the slider in single precision give back what was set.
TEST(Vst3, RestoresShortNumbersFromPartsInSinglePrecision) {
  const auto piano = open_vst3("piano"), hammer = open_vst3("hammer_string");
  const auto restored = [](const Vst3Plugin& plugin, const char* parameter, double value) {
    return static_cast<float>(
        plugin.value_at(parameter, static_cast<double>(static_cast<float>(plugin.part_of(parameter, value)))));
  };
  for (const double value : {3.0, 0.1, 7.25, 12.5, 19.0})
    EXPECT_EQ(restored(*piano, "stiffness ratio", value), static_cast<float>(value)) << value;
  for (const double value : {3.0, -100.0, 0.5, 199.0})
    EXPECT_EQ(restored(*piano, "bend", value), static_cast<float>(value)) << value;
  for (const double value : {1.0, 3.0, 250.0, 999.0})
    EXPECT_EQ(restored(*hammer, "damping", value), static_cast<float>(value)) << value;
}

// The first output of the C++ class, one note of it and one parameter moved, at half the volume.
template <typename I>
std::vector<float> played(const char* moved, double value, std::uint32_t note, std::uint32_t moves,
                          std::size_t samples) {
  Hosted<float> hosted(handle_of<I>());
  hosted.prepare(kRate);
  std::vector<float> sound(samples);
  std::vector<float*> outputs(hosted.instrument().outputs().size());
  const auto play = [&](std::size_t begin, std::size_t end) {
    outputs[0] = sound.data() + begin;
    hosted.process(std::span<float* const>(outputs), end - begin);
  };
  const std::uint8_t message[] = {0x90, 60, 100};
  play(0, note);
  hosted.midi(message);
  play(note, moves);
  for (std::size_t p = 0; p < hosted.instrument().parameters().size(); ++p)
    if (std::string(hosted.instrument().parameters()[p].name) == moved) hosted.set(p, value);
  play(moves, samples);
  for (float& x : sound) x *= 0.5f;  // the first value of the volume
  return sound;
}

// A parameter that moves within a block acts at its sample, as in the C++ class. The vectorised kernels of the
// plug-in round in another order: 100 dB is 6 bits above single precision, for 38,000 samples.
TEST(EveryFormat, MovesParametersAtTheirSample) {
  constexpr std::uint32_t kNote = 5 * kBlock + 37, kMove = 20 * kBlock + 201;
  constexpr std::size_t kBlocks = 150;
  const auto hammer = played<Hammer>("damping_per_s", 40, kNote, kMove, kBlocks * kBlock);
  const auto trichord =
      played<instruments::trichord_c4<float>>("damper_damping_per_s", 40, kNote, kMove, kBlocks * kBlock);
  for (const char* format : {"clap", "vst3"})
    for (const bool is_hammer : {true, false}) {
      const auto plugin = open_plugin(format, is_hammer ? "hammer_string" : "trichord_c4", kRate);
      HostedPlugin::Sound sound;
      for (std::size_t block = 0; block < kBlocks; ++block) {
        if (block == kNote / kBlock) plugin->send(kNote % kBlock, {0x90, 60, 100});
        if (block == kMove / kBlock) plugin->set(is_hammer ? "damping" : "damper damping", 40, kMove % kBlock);
        const auto part = plugin->run(1);
        for (const std::size_t side : {0u, 1u})
          sound[side].insert(sound[side].end(), part[side].begin(), part[side].end());
      }
      EXPECT_GE(agreement_db<float>(sound[0], is_hammer ? hammer : trichord), 100) << format << is_hammer;
      EXPECT_EQ(sound[0], sound[1]);
      EXPECT_EQ(plugin->allocated(), 0u);
    }
}

// The peak of the output that is heard is what is heard, in its unit, and falls within 0.3 s.
TEST(EveryFormat, ReadsThePeaksOfItsOutputs) {
  for (const char* format : {"clap", "vst3", "lv2"}) {
    SCOPED_TRACE(format);
    const auto plugin = open_plugin(format, "hammer_string", kRate);
    const auto readings = plugin->readings();
    ASSERT_EQ(readings.size(), 3u);
    EXPECT_EQ(readings[0].name, "peak displacement");
    EXPECT_EQ(readings[0].unit, "mm");
    EXPECT_EQ(readings[1].name, "peak contact force");
    EXPECT_EQ(readings[1].unit, "N");
    (void)plugin->run(1);
    EXPECT_EQ(plugin->value("peak contact force"), 0);
    plugin->send(0, {0x90, 60, 100});
    const auto sound = plugin->run(2);
    float peak = 0;
    for (const float x : sound[0]) peak = std::max(peak, std::abs(x));
    // At half the volume, 1 mm at full scale. The peak falls by 2 % in a block.
    EXPECT_TRUE(relatively_within(plugin->value("peak displacement"), 2 * peak, 0.02));
    EXPECT_GT(plugin->value("peak contact force"), 1);
    const double force = plugin->value("peak contact force");
    (void)plugin->run(static_cast<std::size_t>(kRate) / kBlock);
    EXPECT_TRUE(relatively_within(plugin->value("peak contact force") / force, std::exp(-1 / 0.3), 0.05));
  }
}

// A state of another version: parameters that it does not know keep their values, those that are gone are passed
// over.
TEST(EveryFormat, TakesTheStateOfAnotherVersion) {
  for (const char* format : {"clap", "vst3", "lv2"}) {
    SCOPED_TRACE(format);
    const auto first = open_plugin(format, "hammer_string", kRate),
               second = open_plugin(format, "hammer_string", kRate);
    first->set("damping", 321);
    first->set("hammer mass", 7);
    (void)first->run(1);
    std::string saved = first->save();
    const std::size_t place = saved.find("hammer_mass_kg");
    ASSERT_NE(place, std::string::npos);
    saved.replace(place, 6, "anvils");  // of the same length
    second->restore(saved);
    (void)second->run(1);
    EXPECT_EQ(second->value("damping"), 321);
    EXPECT_TRUE(relatively_within(second->value("hammer mass"), 2.97, 1e-6));
  }
}

// What clap-validator asks of parameters.
TEST(Clap, RefusesParametersThatAreNotThere) {
  const auto plugin = open_clap("piano");
  EXPECT_EQ(plugin->text(10000, 1), "");
  EXPECT_EQ(plugin->text(2, 0.25), "0.25 s/m");
  const double before = plugin->value("loss");
  for (const clap_id id : {9u, 1000u, 0xffffffffu}) plugin->set(id, 1e9, 3);
  plugin->send(10, {0x90, 60, 100});
  for (const auto& side : plugin->run(4))
    for (const float x : side) EXPECT_TRUE(std::isfinite(x));
  EXPECT_EQ(plugin->value("loss"), before);
  struct Tail {
    std::uint32_t (*get)(const clap_plugin_t*);
  };
  ASSERT_NE(plugin->extension<Tail>("clap.tail"), nullptr);
  EXPECT_EQ(plugin->extension<Tail>("clap.tail")->get(nullptr), UINT32_MAX);
}

// More of what clap-validator asks (docs/reference/plugin-rules.md).
TEST(Clap, ObeysItsValidator) {
  for (const std::string& name : instruments()) {
    SCOPED_TRACE(name);
    const auto plugin = open_clap(name), flushed = open_clap(name);
    EXPECT_EQ(plugin->factory("no factory"), nullptr);
    EXPECT_TRUE(plugin->makes("contactspline." + name));
    EXPECT_FALSE(plugin->makes("contactspline." + name + "x"));
    std::set<std::string> features;
    for (const char* const* feature = plugin->descriptor().features; *feature != nullptr; ++feature)
      EXPECT_TRUE(features.insert(*feature).second) << *feature;
    EXPECT_TRUE(features.contains("instrument"));
    const std::string before = plugin->save();
    for (const HostedParameter& parameter : plugin->parameters()) {
      const clap_id id = plugin->id(parameter.name);
      for (const double value : {parameter.min, parameter.max, 0.3 * parameter.min + 0.7 * parameter.max}) {
        const std::string text = plugin->text(id, value);
        EXPECT_EQ(plugin->text(id, plugin->value_of(id, text)), text);
      }
      plugin->set(id, parameter.max, 0, 0x1234);  // of another space of events
    }
    (void)plugin->run(1);
    EXPECT_EQ(plugin->save(), before);
    for (const HostedParameter& parameter : plugin->parameters())
      for (ClapPlugin* const moved : {plugin.get(), flushed.get()})
        moved->set(parameter.name, 0.3 * parameter.min + 0.7 * parameter.max);
    (void)plugin->run(1);
    flushed->flush();
    EXPECT_EQ(flushed->save(), plugin->save());
    EXPECT_NE(plugin->save(), before);
  }
}

}  // namespace
}  // namespace contactspline::testing
