// SPDX-License-Identifier: MIT
// Every instrument whose plug-in is built, in every format, in the hands of users and of careless hosts. With
// CONTACTSPLINE_FULL_TESTS set, 1,000 sets of hostile parameters each instead of 200.
#include <pthread.h>

#include <cstdlib>
#include <mutex>
#include <random>

#include "generator/player/midi_reader.hpp"
#include "generator/support/input_file.hpp"
#include "macros.hpp"
#include "plugins/open_plugin.hpp"
#include "plugins/reference.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/random.hpp"
#include "support/spectrum.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 48000;

std::vector<InFormat> every_plugin() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : Reference::makers()) names.push_back(name);
  return in_every_format(names);
}

class EveryPlugin : public PluginTest {
 protected:
  [[nodiscard]] static std::unique_ptr<Reference> reference() {
    return Reference::makers().at(GetParam().name)(kRate);
  }
  /// Those of the instrument: each that can move at least one of its parameters.
  [[nodiscard]] static std::vector<const Macro*> macros() {
    const auto of = reference();
    const AnyInstrument<float>& instrument = of->hosted().instrument();
    std::vector<const Macro*> macros;
    for (const Macro& macro : kMacros)
      for (std::size_t p = 0; p < instrument.parameters().size(); ++p)
        if (instrument.parameters()[p].slider.min < instrument.parameters()[p].slider.max &&
            is_moved(macro, p, instrument.parameters(), instrument.events()) &&
            std::ranges::find(macros, &macro) == macros.end())
          macros.push_back(&macro);
    return macros;
  }
};

INSTANTIATE_TEST_SUITE_P(InEveryFormat, EveryPlugin, ::testing::ValuesIn(every_plugin()), PluginTest::name_of);

TEST_P(EveryPlugin, ListsItsParametersWithUnits) {
  auto expected = reference()->parameters();
  expected.push_back({"volume", "", 0, 1, 0.5});
  for (const Macro* macro : macros()) expected.push_back({macro->parameter.name, "", -1, 1, 0});
  std::ranges::copy(kTuning, std::back_inserter(expected));
  expected.push_back(kOversampling);
  const auto plugin = open();
  expect_parameters(*plugin, expected);
  auto readings = reference()->readings();
  readings.push_back(kLatency);
  expect_list(plugin->readings(), readings);
}

struct TimedMessage {
  std::size_t time;  // samples
  std::array<std::uint8_t, 3> bytes;
};

// A chord, released after half a second, and the first two seconds of a MIDI file that ships.
std::vector<TimedMessage> chord_and_song() {
  std::vector<TimedMessage> messages;
  for (const std::uint8_t key : std::initializer_list<std::uint8_t>{60, 64, 67}) {
    messages.push_back({37, {0x90, key, 100}});
    messages.push_back({24001, {0x80, key, 64}});
  }
  const std::string file = SCORES "/bach_prelude.mid";
  for (const MidiNote& note : parse_midi(read_input(file), file).notes) {
    if (note.time_s > 2) break;
    const auto key = static_cast<std::uint8_t>(note.key),
               velocity = static_cast<std::uint8_t>(std::lround(127 * note.velocity));
    const auto at = [](double time_s) { return static_cast<std::size_t>(24500 + time_s * kRate); };
    messages.push_back({at(note.time_s), {0x90, key, velocity}});
    messages.push_back({at(note.time_s + note.key_hold_s), {0x80, key, 64}});
  }
  std::ranges::stable_sort(messages, {}, &TimedMessage::time);
  return messages;
}

void append(HostedPlugin::Sound& sound, const HostedPlugin::Sound& part) {
  for (const std::size_t side : {0u, 1u}) sound[side].insert(sound[side].end(), part[side].begin(), part[side].end());
}

// In blocks of all lengths. The samples are those of the class bit by bit, but for the hammer-string: where a block
// ends elsewhere, its kernel rounds in another order. 100 dB is 6 bits above single precision, for 110,000 samples.
TEST_P(EveryPlugin, PlaysAChordAndAMidiFileAsItsClassDoes) {
  const auto messages = chord_and_song();
  ASSERT_GT(messages.size(), 20u);
  const std::size_t end = messages.back().time + 1000;
  const auto plugin = open();
  const auto model = reference();
  HostedPlugin::Sound sound, expected;
  std::size_t begin = 0, next = 0;
  for (std::size_t block = 0; begin < end; ++block) {
    constexpr std::size_t kLengths[] = {1, 7, 256, 1024, 8192, 441};
    const std::size_t length = kLengths[block % std::size(kLengths)];
    for (; next < messages.size() && messages[next].time < begin + length; ++next) {
      plugin->send(static_cast<std::uint32_t>(messages[next].time - begin), messages[next].bytes);
      append(expected, model->run(messages[next].time - expected[0].size()));
      model->midi(messages[next].bytes);
    }
    append(sound, plugin->run(1, length));
    begin += length;
  }
  append(expected, model->run(begin - expected[0].size()));
  EXPECT_GT(rms(expected[0]), 1e-3);
  for (const std::size_t side : {0u, 1u})
    EXPECT_GE(agreement_db<float>(sound[side], expected[side]), 100);  // infinite where all are the same
  EXPECT_EQ(plugin->allocated(), 0u);
  EXPECT_EQ(plugin->locked(), 0u);
}

// An input under notes, in blocks in which notes begin and parameters change, some of them in place. Without an input
// there is none to hosts, either.
TEST_P(EveryPlugin, IsPushedAsItsClassIs) {
  const auto plugin = open();
  const auto model = reference();
  ASSERT_EQ(plugin->has_input(), model->hosted().instrument().input_scale_n() > 0);
  if (!plugin->has_input()) return;
  std::mt19937 random(11);
  std::uniform_real_distribution<float> force(-1, 1);
  HostedPlugin::Sound sound, expected;
  for (int block = 0; block < 60; ++block) {
    std::vector<float> input(std::array{256, 1, 1024, 77}[static_cast<std::size_t>(block) % 4]);
    if (block > 5 && block / 10 % 2 == 0) std::ranges::generate(input, [&] { return force(random); });
    const std::size_t note = std::min<std::size_t>(block % 5 == 3 ? 40 : 0, input.size());
    append(expected, model->run(note, input.data()));
    if (block % 5 == 3 && note == 40) {
      plugin->send(40, {0x90, 62, 70});
      model->midi(std::array<std::uint8_t, 3>{0x90, 62, 70});
    }
    if (GetParam().format != "lv2" && input.size() > 60) plugin->set("pitch of A4", 440, 60);  // a block of two parts
    append(expected, model->run(input.size() - note, input.data() + note));
    append(sound, plugin->run_under(input, block % 2 == 0));
  }
  EXPECT_GT(rms(expected[0]), 1e-3);
  EXPECT_EQ(sound, expected);
  EXPECT_EQ(plugin->allocated(), 0u);
  EXPECT_EQ(plugin->locked(), 0u);
}

TEST(Calls, AreCountedInEveryLibrary) {
  EXPECT_EQ(dlsym(RTLD_DEFAULT, "malloc"), reinterpret_cast<void*>(&std::malloc));
  EXPECT_EQ(dlsym(RTLD_DEFAULT, "pthread_mutex_lock"), reinterpret_cast<void*>(&pthread_mutex_lock));
  const std::size_t before = locks;
  std::mutex mutex;
  mutex.lock();
  EXPECT_EQ(locks, before + 1);
  mutex.unlock();
}

// Values with all digits of single precision.
void change_all(HostedPlugin& plugin, std::mt19937& random) {
  std::uniform_real_distribution<double> part(0.05, 0.95);
  for (const HostedParameter& parameter : prompt_parameters(plugin))
    plugin.set(parameter.name, parameter.min + part(random) * (parameter.max - parameter.min));
  (void)plugin.run(1);
}

/// A chord of a plug-in, and of the class. Returns how loud it is.
double expect_chord_of_class(HostedPlugin& plugin, Reference& model, double least_db) {
  HostedPlugin::Sound sound, expected;
  for (const std::uint8_t key : std::initializer_list<std::uint8_t>{60, 64, 67}) {
    plugin.send(0, {0x90, key, 100});
    model.midi(std::array<std::uint8_t, 3>{0x90, key, 100});
    for (int n = 0; n < 20; ++n) {
      append(sound, plugin.run(1));
      append(expected, model.run(HostedPlugin::kBlock));
    }
  }
  for (const std::size_t side : {0u, 1u})
    EXPECT_TRUE(sound[side] == expected[side] || agreement_db<float>(sound[side], expected[side]) >= least_db)
        << agreement_db<float>(sound[side], expected[side]);
  return rms(expected[0]);
}

// Bit by bit, at 0 a macro does nothing, and at 1 and -1 its parameters are at the ends of their sliders. Between
// them the values here are rounded otherwise, and the glides of a way back leave rounding, which rattling strings and
// bows make more of.
TEST_P(EveryPlugin, MovesParametersByMacros) {
  ASSERT_TRUE(!macros().empty() && macros().size() <= 4);
  for (const Macro* macro : macros()) {
    SCOPED_TRACE(macro->parameter.name);
    constexpr double kExact = std::numeric_limits<double>::infinity();
    for (const auto& [before, amount, least_db] : {std::tuple{0.0, 0.0, kExact},
                                                   {0.0, 1.0, kExact},
                                                   {0.0, -1.0, kExact},
                                                   {0.0, 0.5, 40.0},
                                                   {-0.7, 0.0, 80.0}}) {
      SCOPED_TRACE(amount);
      const auto plugin = open();
      const auto model = reference();
      const AnyInstrument<float>& instrument = model->hosted().instrument();
      const auto rest = [&] {  // until all glides have ended
        for (int n = 0; n < 400; ++n) (void)plugin->run(1), (void)model->run(HostedPlugin::kBlock);
      };
      plugin->set(macro->parameter.name, before);
      rest();
      plugin->set(macro->parameter.name, amount);
      for (std::size_t p = 0; amount != 0 && p < instrument.parameters().size(); ++p) {
        const Parameter& parameter = instrument.parameters()[p];
        const auto& [min, max] = parameter.slider;
        if (!is_moved(*macro, p, instrument.parameters(), instrument.events()) || min == max) continue;
        const bool is_last = macro->to == MacroTo::kFar       ? std::abs(max) >= std::abs(min)
                             : macro->to == MacroTo::kNearest ? 2 * parameter.initial >= min + max
                                                              : true;
        const double value = instrument.value(p), end = is_last == (amount > 0) ? max : min,
                     part = macro->most * std::pow(std::abs(amount), macro->taper);
        model->hosted().set(p, part == 1                                ? end
                               : parameter.scale == Scale::kLogarithmic ? value * std::pow(end / value, part)
                                                                        : value + part * (end - value));
      }
      rest();
      const double loudness = expect_chord_of_class(*plugin, *model, least_db);
      EXPECT_TRUE(loudness > 1e-6 || (macro->is_played && amount == -1)) << loudness;
      EXPECT_EQ(plugin->value(macro->parameter.name), amount);
    }
  }
}

// In the middle of a note, as hosts save.
TEST_P(EveryPlugin, RestoresWhatItSaved) {
  std::mt19937 random(7);
  const auto first = open(), second = open();
  first->send(0, {0x90, 60, 100});
  change_all(*first, random);
  const std::string saved = first->save();
  EXPECT_EQ(first->save(), saved);
  second->restore(saved);
  (void)second->run(1);
  for (const HostedParameter& parameter : prompt_parameters(*first)) {
    // Hosts of LV2 write 8 digits behind the point.
    EXPECT_TRUE(
        within(second->value(parameter.name), first->value(parameter.name), GetParam().format == "lv2" ? 5e-9 : 0))
        << parameter.name;
    EXPECT_NE(first->value(parameter.name), parameter.initial) << parameter.name;
  }
  EXPECT_EQ(second->save(), saved);
}

// A file that is cut off, or none at all, changes at most parameters, within their ranges.
TEST_P(EveryPlugin, TakesDamagedStates) {
  if (GetParam().format == "lv2") return;  // its host reads the state
  std::mt19937 random(3);
  const auto plugin = open();
  const std::string saved = plugin->save();
  std::vector<std::string> damaged = {"", std::string(4096, '\xff'), std::string(4096, '\0')};
  for (int cut = 0; cut < 30; ++cut) {
    damaged.push_back(saved.substr(0, random() % saved.size()));
    damaged.push_back(saved);
    for (int change = 0; change < 8; ++change) damaged.back()[random() % saved.size()] = static_cast<char>(random());
  }
  for (const std::string& state : damaged) {
    try {
      plugin->restore(state);
    } catch (const std::runtime_error&) {
      // It may refuse.
    }
    plugin->send(0, {0x90, 60, 100});
    for (const auto& side : plugin->run(1)) EXPECT_TRUE(all_finite(side));
    for (const HostedParameter& parameter : plugin->parameters()) {
      EXPECT_GE(plugin->value(parameter.name), parameter.min) << parameter.name;
      EXPECT_LE(plugin->value(parameter.name), parameter.max) << parameter.name;
    }
  }
}

// Hosts in one process load a library twice, and leave it one after the other.
TEST_P(EveryPlugin, LivesOnWhenAnotherIsClosed) {
  const auto plays = [](HostedPlugin& plugin) {
    plugin.set("volume", 0.75);
    plugin.send(0, {0x90, 60, 100});
    EXPECT_GT(rms(plugin.run(20)[0]), 1e-5);
  };
  auto first = open();
  const auto second = open();
  first.reset();
  plays(*second);
  EXPECT_FALSE(second->parameters().empty());
  plays(*open());
}

TEST_P(EveryPlugin, LoadsEachProgram) {
  const auto plugin = open();
  for (std::size_t program = plugin->programs().size(); program-- > 0;) {
    plugin->load_program(program);
    plugin->send(0, {0x90, 60, 100});
    for (const auto& side : plugin->run(4)) EXPECT_TRUE(all_finite(side)) << program;
  }
}

// Sets of all parameters, most of the values hostile, and bytes as a broken cable sends them, at any sample.
TEST_P(EveryPlugin, SurvivesHostileSetsAtAllRatesInAllBlocks) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  const int sets = std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr ? 1000 : 200;
  std::mt19937 random(32);
  const auto below = [&](std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(random); };
  const auto byte = [&](std::size_t end) { return static_cast<std::uint8_t>(below(end)); };
  constexpr double kRates_hz[] = {8000, 22050, 44100, 96000, 192000};
  for (const double rate_hz : kRates_hz) {
    const auto plugin = open(rate_hz);
    const auto parameters = prompt_parameters(*plugin);
    for (int set = 0; set < sets; set += static_cast<int>(std::size(kRates_hz))) {
      const std::size_t length = static_cast<std::size_t>(
          std::pow(double{HostedPlugin::kMaxBlock}, std::uniform_real_distribution<double>(0, 1)(random)));
      std::vector<std::uint32_t> times(parameters.size());
      for (std::uint32_t& time : times)
        time = GetParam().format == "lv2" ? 0 : static_cast<std::uint32_t>(below(length));
      std::ranges::sort(times);
      for (std::size_t p = 0; p < parameters.size(); ++p) {
        const auto& [name, unit, min, max, initial] = parameters[p];
        const double within = min + (max - min) * static_cast<double>(below(1001)) / 1000;
        const double values[] = {within,     within,      within, min,   max,   kInfinity,
                                 -kInfinity, kNotANumber, 1e38,   -1e38, 1e-310};
        plugin->set(name, values[below(std::size(values))], times[p]);
      }
      const auto last = static_cast<std::uint32_t>(length - 1);
      plugin->send(last, {0x90, byte(128), byte(128)});
      plugin->send(last, {static_cast<std::uint8_t>(0x80 + byte(0x80)), byte(128), byte(128)});
      plugin->send(last, {byte(256), byte(256), byte(256)});
      for (const auto& side : plugin->run(1, length))
        ASSERT_TRUE(all_finite(side)) << "set " << set << " at " << rate_hz << " Hz, block " << length;
    }
    EXPECT_EQ(plugin->allocated(), 0u);
    EXPECT_EQ(plugin->locked(), 0u);
    if (GetParam().format == "lv2") continue;  // its host keeps the values
    for (const HostedParameter& parameter : parameters) {
      EXPECT_GE(plugin->value(parameter.name), parameter.min) << parameter.name;
      EXPECT_LE(plugin->value(parameter.name), parameter.max) << parameter.name;
    }
  }
}

// For six seconds all parameters of a bow jump in each block over their ranges, while keys go down and up; six
// seconds after the last one the strings have rung out.
TEST_P(EveryPlugin, RingsOutAfterAnyBowing) {
  const auto plugin = open(kRate);
  auto bow = prompt_parameters(*plugin);
  std::erase_if(bow, [](const HostedParameter& p) { return !p.name.starts_with("bow ") && p.name != "assistance"; });
  if (bow.empty()) return;
  ASSERT_EQ(bow.size(), 5U);
  constexpr std::size_t kLength = 256;
  constexpr int kPlayed = int(6 * kRate / kLength);
  Random random(5);
  std::uint8_t key = 0;
  float now = 0, largest = 0;
  for (int block = 0; block < 2 * kPlayed; ++block) {
    for (const auto& [name, unit, min, max, initial] : bow)
      if (block < kPlayed) plugin->set(name, random.once_in(4) ? max : min + (max - min) * random.uniform(), 0);
    if (block == kPlayed || random.once_in(20)) {
      if (key > 0) plugin->send(0, {0x80, key, 64});
      key = key > 0 || block >= kPlayed ? std::uint8_t{0} : static_cast<std::uint8_t>(55 + random.below(18));
      if (key > 0) plugin->send(0, {0x90, key, 127});
    }
    now = 0;
    for (const auto& side : plugin->run(1, kLength)) {
      ASSERT_TRUE(all_finite(side)) << block;
      for (const float sample : side) now = std::max(now, std::abs(sample));
    }
    largest = std::max(largest, now);
  }
  EXPECT_GT(largest, 0.01F);
  EXPECT_LT(largest, 30.0F);
  EXPECT_LT(now, 1e-3F * largest);
}

}  // namespace
}  // namespace contactspline::testing
