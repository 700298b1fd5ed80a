// SPDX-License-Identifier: MIT
// Notes that hosts of CLAP and VST3 name, tune, press, mix and modulate alone, against the instrument without a
// framework, to which the same is said.
#include "contactspline/midi/temperament.hpp"
#include "plugins/open_plugin.hpp"
#include "plugins/reference.hpp"
#include "plugins/vst3_host.hpp"
#include "support/compare.hpp"
#include "vst3_note_expression.h"

namespace contactspline::testing {
namespace {

// What a program that tunes the session would do, through the library that plug-ins find.
struct MtsStub {
  void (*has_master)(bool);
  void (*tune)(int key, double frequency_hz);
  void (*leave_out)(int key);
  int (*clients)();
};
MtsStub& mts_stub() {
  static Library library{"libMTS.so"};
  static MtsStub stub = {library.symbol<void(bool)>("stub_set_master"),
                         library.symbol<void(int, double)>("stub_tune"), library.symbol<void(int)>("stub_leave_out"),
                         library.symbol<int()>("stub_clients")};
  return stub;
}

constexpr std::size_t kBlock = HostedPlugin::kBlock, kBlocks = 60;
constexpr double kRate = 48000;
constexpr std::array<std::uint8_t, 12> kTuned = {0xf0, 0x7f, 0x7f, 8,    2, 0,
                                                 1,    60,   60,   0x40, 0, 0xf7};  // key 60 by 50 cents

std::unique_ptr<Reference> reference(const std::string& name) {
  return Reference::makers().at(name)(kRate);
}

// The plug-in's samples are those of its class but for the rounding of its volume.
void expect_same(const HostedPlugin::Sound& played, const HostedPlugin::Sound& expected) {
  for (const std::size_t side : {0u, 1u}) {
    EXPECT_GT(*std::ranges::max_element(expected[side]), 1e-3f);
    EXPECT_GE(agreement_db<float>(played[side], expected[side]), 110) << side;
  }
}
// What is said to a note must be heard: it is the sound without it no more.
void expect_differs(const HostedPlugin::Sound& played, const HostedPlugin::Sound& plain) {
  EXPECT_LT(agreement_db<float>(played[0], plain[0]), 40);
}

HostedPlugin::Sound plain_notes(const std::string& instrument) {
  const auto plain = reference(instrument);
  plain->hosted().begin_note({1, 0, 60}, 0.7);
  plain->hosted().begin_note({2, 0, 64}, 0.7);
  return plain->run(kBlocks * kBlock);
}

TEST(Clap, PlaysAndExpressesNotesByName) {
  const auto plugin = open_clap("lap_steel");
  const auto expected = reference("lap_steel");
  plugin->note_on({1, 0, 60}, 0.7);
  plugin->note_on({2, 0, 64}, 0.7);
  plugin->express(CLAP_NOTE_EXPRESSION_TUNING, {.id = 1}, 1.503);
  plugin->express(CLAP_NOTE_EXPRESSION_VOLUME, {.id = 2}, 0.25);
  plugin->express(CLAP_NOTE_EXPRESSION_VIBRATO, {}, 1);  // which the instrument does not have
  Hosted<float>& hosted = expected->hosted();
  hosted.begin_note({1, 0, 60}, 0.7);
  hosted.begin_note({2, 0, 64}, 0.7);
  hosted.express({.id = 1}, NoteExpression::kTuning, 150.3);
  hosted.express({.id = 2}, NoteExpression::kVolume, 0.25);
  const auto played = plugin->run(kBlocks);
  expect_same(played, expected->run(kBlocks * kBlock));
  expect_differs(played, plain_notes("lap_steel"));
  EXPECT_EQ(plugin->allocated() + plugin->locked(), 0u);

  plugin->note_off({1, 0, 60}, 0.5);
  (void)plugin->run(1);
  ASSERT_EQ(plugin->ended().size(), 1u);
  EXPECT_EQ(plugin->ended()[0].note_id, 1);
  EXPECT_EQ(plugin->ended()[0].key, 60);
}

// With a time constant of 5 ms, in place of the damper's 30 ms; the next note of the key is as loud as the first.
TEST(Clap, ChokesNotes) {
  const auto loudest = [](const HostedPlugin::Sound& sound) { return *std::ranges::max_element(sound[0]); };
  const auto plugin = open_clap("fret_guitar");
  plugin->note_on({1, 0, 60}, 0.7);
  const float first = loudest(plugin->run(20));
  plugin->choke({1, 0, 60});
  (void)plugin->run(8);  // 43 ms: exp(-8.5)
  EXPECT_LT(loudest(plugin->run(4)), 1e-3f * first);
  EXPECT_EQ(plugin->ended().size(), 1u);
  (void)plugin->run(400);
  plugin->note_on({2, 0, 60}, 0.7);
  EXPECT_TRUE(relatively_within(loudest(plugin->run(20)), first, 0.02));
}

TEST(Vst3, PlaysAndExpressesNotesByName) {
  const auto plugin = open_vst3("lap_steel");
  const auto expected = reference("lap_steel");
  plugin->note_on({1, 0, 60}, 0.71, 0, 12.5);
  plugin->note_on({2, 0, 64}, 0.7);
  plugin->express(2, 1, 0.5 + 150.3 / 24000);
  plugin->express(0, 2, 0.0625);
  plugin->express(7, 2, 1);  // a text
  Hosted<float>& hosted = expected->hosted();
  hosted.begin_note({1, 0, 60}, 0.71f, 12.5);
  hosted.begin_note({2, 0, 64}, 0.7f);
  hosted.express({.id = 1}, NoteExpression::kTuning, 150.3);
  hosted.express({.id = 2}, NoteExpression::kVolume, 0.25);
  const auto played = plugin->run(kBlocks);
  expect_same(played, expected->run(kBlocks * kBlock));
  expect_differs(played, plain_notes("lap_steel"));
  EXPECT_EQ(plugin->allocated() + plugin->locked(), 0u);
}

std::size_t number_of(const Hosted<float>& hosted, std::string_view parameter) {
  const auto listed = hosted.instrument().parameters();
  return static_cast<std::size_t>(std::ranges::find(listed, parameter, &Parameter::name) - listed.begin());
}

// A parameter of one note, by its value or beside it; and of all, which the value that the host sees does not show.
TEST(Clap, ModulatesParametersOfNotesAndOfAll) {
  constexpr auto kFingers = "fingers resistance";
  const auto plain = plain_notes("lap_steel");
  for (const bool is_value : {true, false}) {
    const auto plugin = open_clap("lap_steel");
    const auto expected = reference("lap_steel");
    const auto parameters = expected->parameters();
    const auto fingers = std::ranges::find(parameters, std::string(kFingers), &HostedParameter::name);
    ASSERT_NE(fingers, parameters.end());
    plugin->note_on({1, 0, 60}, 0.7);
    plugin->note_on({2, 0, 64}, 0.7);
    is_value ? plugin->set_of_note(kFingers, {.key = 64}, fingers->initial + 15)
             : plugin->modulate(kFingers, {.key = 64}, 15);
    Hosted<float>& hosted = expected->hosted();
    const std::size_t number = number_of(hosted, "fingers_resistance_n_s_per_m");
    hosted.begin_note({1, 0, 60}, 0.7);
    hosted.begin_note({2, 0, 64}, 0.7);
    hosted.move_note({.key = 64}, number, 15);
    const auto played = plugin->run(kBlocks);
    expect_same(played, expected->run(kBlocks * kBlock));
    expect_differs(played, plain);
  }

  const auto plugin = open_clap("lap_steel");
  const auto expected = reference("lap_steel");
  Hosted<float>& hosted = expected->hosted();
  const double value = plugin->value(kFingers);
  plugin->modulate(kFingers, {}, 15);
  plugin->note_on({1, 0, 60}, 0.7);
  plugin->note_on({2, 0, 64}, 0.7);
  hosted.set(number_of(hosted, "fingers_resistance_n_s_per_m"), value + 15);
  hosted.begin_note({1, 0, 60}, 0.7);
  hosted.begin_note({2, 0, 64}, 0.7);
  expect_same(plugin->run(kBlocks), expected->run(kBlocks * kBlock));
  EXPECT_EQ(plugin->value(kFingers), value);
  constexpr std::uint32_t kOfNotes =
      CLAP_PARAM_IS_MODULATABLE | CLAP_PARAM_IS_MODULATABLE_PER_NOTE_ID | CLAP_PARAM_IS_AUTOMATABLE_PER_NOTE_ID;
  EXPECT_EQ(plugin->flags(kFingers) & kOfNotes, kOfNotes);
  EXPECT_EQ(plugin->flags("bend") & kOfNotes, std::uint32_t(CLAP_PARAM_IS_MODULATABLE));
  EXPECT_EQ(plugin->flags("volume") & kOfNotes, 0u);
  plugin->modulate(kFingers, {}, std::nan(""));
  plugin->modulate("volume", {.key = 60}, 1);
  (void)plugin->run(1);
}

// The felt of one key of the piano, whose note begins at the same sample; by MPE the same, as MIDI has it.
TEST(Clap, BrightensOneKeyOfThePiano) {
  const double part = 100 / 127.0;
  const auto plugin = open_clap("piano");
  for (const int key : {60, 64}) plugin->note_on({key, 0, key}, 90 / 127.0);
  plugin->express(CLAP_NOTE_EXPRESSION_BRIGHTNESS, {.key = 64}, part);
  const auto by_mpe = open_clap("piano");
  const auto expected = reference("piano");
  for (const std::array<std::uint8_t, 3>& message : {std::array<std::uint8_t, 3>{0xb0, 101, 0},
                                                     {0xb0, 100, 6},
                                                     {0xb0, 6, 4},
                                                     {0xb1, 74, 100},
                                                     {0x92, 60, 90},
                                                     {0x91, 64, 90}}) {
    by_mpe->send(0, message);
    expected->midi(message);
  }
  const auto bright = expected->run(kBlocks * kBlock);
  expect_same(by_mpe->run(kBlocks), bright);
  expect_same(plugin->run(kBlocks), bright);
  const auto plain = reference("piano");
  for (const int key : {60, 64}) plain->hosted().begin_note({-1, 0, key}, 90 / 127.0);
  expect_differs(bright, plain->run(kBlocks * kBlock));
}

// Each at its sample, in parts of a block between changes of parameters, and what is sent with a block of no samples
// acts at once.
TEST(Clap, ExpressesNotesAtTheirSamples) {
  const auto plugin = open_clap("lap_steel");
  const auto expected = reference("lap_steel");
  Hosted<float>& hosted = expected->hosted();
  plugin->note_on({1, 0, 60}, 0.7, 30);
  plugin->set("bar loss", 1, 100);
  plugin->express(CLAP_NOTE_EXPRESSION_TUNING, {.id = 1}, 2, 150);
  plugin->note_off({1, 0, 60}, 0.5, 200);
  auto played = plugin->run(1);
  ASSERT_EQ(plugin->ended().size(), 1u);
  EXPECT_EQ(plugin->ended()[0].header.time, 255u) << "at the end of the block";
  std::vector<HostedPlugin::Sound> parts = {expected->run(30)};
  hosted.begin_note({1, 0, 60}, 0.7);
  parts.push_back(expected->run(70));
  hosted.set(number_of(hosted, "bar_loss_s_per_m"), 1);
  parts.push_back(expected->run(50));
  hosted.express({.id = 1}, NoteExpression::kTuning, 200);
  parts.push_back(expected->run(50));
  hosted.end_note({.id = 1}, 0.5);
  parts.push_back(expected->run(56));

  plugin->note_on({2, 0, 64}, 0.7);
  plugin->send_exclusive(kTuned);
  (void)plugin->run(1, 0);
  hosted.begin_note({2, 0, 64}, 0.7);
  hosted.midi(kTuned);
  plugin->note_on({3, 0, 60}, 0.7);
  hosted.begin_note({3, 0, 60}, 0.7);
  parts.push_back(expected->run(kBlocks * kBlock));
  const auto rest = plugin->run(kBlocks);
  for (const std::size_t side : {0u, 1u}) {
    played[side].insert(played[side].end(), rest[side].begin(), rest[side].end());
    std::vector<float> all;
    for (const auto& part : parts) all.insert(all.end(), part[side].begin(), part[side].end());
    EXPECT_GE(agreement_db<float>(played[side], all), 110);
  }
}

// Without an identity VST3 means the first note of a key, not all of them; a key is pressed alone.
TEST(Vst3, EndsTheFirstNoteOfAKey) {
  const auto plugin = open_vst3("lap_steel");
  const auto expected = reference("lap_steel");
  Hosted<float>& hosted = expected->hosted();
  for (int n = 0; n < 2; ++n) {
    plugin->note_on({-1, 0, 60}, 0.7);
    hosted.begin_note({-1, 0, 60}, 0.7f);
  }
  plugin->note_off({-1, 0, 60}, 0.5);
  plugin->press_key(0, 60, 1);
  hosted.end_note({-1, 0, 60}, 0.5, true);
  hosted.express({-1, 0, 60}, NoteExpression::kPressure, 1);
  const auto played = plugin->run(kBlocks);
  expect_same(played, expected->run(kBlocks * kBlock));
  const auto both = reference("lap_steel");
  for (int n = 0; n < 2; ++n) both->hosted().begin_note({-1, 0, 60}, 0.7f);
  both->hosted().end_note({-1, 0, 60}, 0.5);
  expect_differs(played, both->run(kBlocks * kBlock));
}

// Messages that tune keys, which the framework leaves out.
TEST(Clap, IsTunedByExclusiveMessages) {
  const auto clap = open_clap("lap_steel");
  const auto vst3 = open_vst3("lap_steel");
  const auto expected = reference("lap_steel");
  expected->midi(kTuned);
  clap->send_exclusive(kTuned);
  vst3->send_exclusive(kTuned);
  expected->hosted().begin_note({-1, 0, 60}, 0.75f);
  clap->note_on({-1, 0, 60}, 0.75f);
  vst3->note_on({-1, 0, 60}, 0.75f);
  const auto sound = expected->run(kBlocks * kBlock);
  expect_same(clap->run(kBlocks), sound);
  expect_same(vst3->run(kBlocks), sound);
}

// By parameters of its own, whatever the format: against the class, whose keys are tuned so; a wheel by the bend
// range.
class TunedPlugin : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(InEveryFormat, TunedPlugin, ::testing::Values("clap", "vst3", "lv2"));

TEST_P(TunedPlugin, TunesKeysByItsParameters) {
  const auto plugin = open_plugin(GetParam(), "lap_steel", kRate);
  const auto expected = reference("lap_steel");
  plugin->set("bend range", 12);
  plugin->set("pitch of A4", 415);
  plugin->set("temperament", 4);
  plugin->set("tonic", 2);
  plugin->send(0, {0x90, 60, 100});
  expected->hosted().set_bend_range(12);
  expected->hosted().tune(tempered_keys(kTemperaments[4], 2, 415));
  expected->midi(std::array<std::uint8_t, 3>{0x90, 60, 100});
  const auto played = plugin->run(kBlocks);
  expect_same(played, expected->run(kBlocks * kBlock));
  const auto plain = reference("lap_steel");
  plain->midi(std::array<std::uint8_t, 3>{0x90, 60, 100});
  expect_differs(played, plain->run(kBlocks * kBlock));
  plugin->send(0, {0xe0, 0, 0});
  expected->midi(std::array<std::uint8_t, 3>{0xe0, 0, 0});
  expect_same(plugin->run(kBlocks), expected->run(kBlocks * kBlock));

  const auto restored = open_plugin(GetParam(), "lap_steel", kRate);
  restored->restore(plugin->save());
  for (HostedPlugin* const one : {plugin.get(), restored.get()}) {
    EXPECT_EQ(one->value("temperament"), 4);
    EXPECT_EQ(one->value("tonic"), 2);
    EXPECT_EQ(one->value("pitch of A4"), 415);
    EXPECT_EQ(one->value("bend range"), 12);
  }
}

// The wheel of a channel bends its notes, and "all notes off" ends them.
TEST_P(TunedPlugin, BendsAndEndsEachChannelAlone) {
  const auto plugin = open_plugin(GetParam(), "lap_steel", kRate);
  const auto expected = reference("lap_steel");
  HostedPlugin::Sound played, of_class;
  const auto send = [&](std::array<std::uint8_t, 3> message) {
    plugin->send(0, message);
    expected->midi(message);
    played = plugin->run(kBlocks);
    of_class = expected->run(kBlocks * kBlock);
  };
  send({0x90, 60, 100});
  send({0x94, 67, 100});
  send({0xe4, 0, 0x70});
  expect_same(played, of_class);
  send({0xe0, 0, 0x10});
  expect_same(played, of_class);
  send({0xef, 0, 0x10});  // of a channel that plays nothing
  expect_same(played, of_class);
  send({0xb4, 123, 0});
  expect_same(played, of_class);
}

// A value is held to its range, that of a list to its entries.
TEST(Clap, HoldsValuesOfItsTuning) {
  const auto plugin = open_clap("piano");
  plugin->set("temperament", 2.4);
  plugin->set("tonic", 1000);
  plugin->set("bend range", -1);
  plugin->set("pitch of A4", std::nan(""));
  (void)plugin->run(1);
  EXPECT_EQ(plugin->value("temperament"), 2);
  EXPECT_EQ(plugin->value("tonic"), 11);
  EXPECT_EQ(plugin->value("bend range"), 0);
  EXPECT_EQ(plugin->value("pitch of A4"), 440);
}

// A program that tunes the session (mts_stub.cpp), from the next note on; keys that it leaves out do not sound; once
// it leaves, all is as before.
TEST_P(TunedPlugin, FollowsMtsEsp) {
  MtsStub& stub = mts_stub();
  const auto plugin = open_plugin(GetParam(), "lap_steel", kRate);
  EXPECT_EQ(stub.clients(), 1);
  const auto expected = reference("lap_steel");
  stub.tune(60, 270);
  stub.leave_out(62);
  stub.has_master(true);
  for (const std::uint8_t key : {std::uint8_t(60), std::uint8_t(62)}) plugin->send(0, {0x90, key, 100});
  expected->hosted().tune_key(60, 1200 * std::log2(270 / 440.0) + 900);
  expected->midi(std::array<std::uint8_t, 3>{0x90, 60, 100});
  expect_same(plugin->run(kBlocks), expected->run(kBlocks * kBlock));
  stub.has_master(false);
  plugin->send(0, {0x90, 62, 100});
  expected->midi(std::array<std::uint8_t, 3>{0x90, 62, 100});
  expect_same(plugin->run(kBlocks), expected->run(kBlocks * kBlock));
}

// What is tuned by 500 cents is played by the strings that have that pitch; a client leaves with its plug-in.
TEST(Clap, PlaysFarTuningsOfMtsEspByOtherStrings) {
  MtsStub& stub = mts_stub();
  auto plugin = open_clap("piano");
  stub.tune(60, 440 * std::exp2(-4 / 12.0));
  stub.has_master(true);
  plugin->note_on({1, 0, 60}, 0.7);
  const auto expected = reference("piano");
  expected->hosted().begin_note({1, 0, 65}, 0.7);
  expect_same(plugin->run(kBlocks), expected->run(kBlocks * kBlock));
  stub.has_master(false);
  plugin.reset();
  EXPECT_EQ(stub.clients(), 0);
}

TEST(Clap, SaysThatItTakesNotesByNameAndMpe) {
  const auto plugin = open_clap("piano");
  const auto* const ports = plugin->extension<clap_plugin_note_ports_t>(CLAP_EXT_NOTE_PORTS);
  ASSERT_NE(ports, nullptr);
  EXPECT_EQ(ports->count(nullptr, true), 1u);
  EXPECT_EQ(ports->count(nullptr, false), 0u);
  clap_note_port_info_t info = {};
  ASSERT_TRUE(ports->get(nullptr, 0, true, &info));
  EXPECT_EQ(info.supported_dialects,
            std::uint32_t(CLAP_NOTE_DIALECT_CLAP | CLAP_NOTE_DIALECT_MIDI | CLAP_NOTE_DIALECT_MIDI_MPE));
  EXPECT_FALSE(ports->get(nullptr, 1, true, &info));
  EXPECT_FALSE(ports->get(nullptr, 0, false, &info));
}

std::string text_of(const v3_str_128& text) {
  std::string ascii;
  for (const std::int16_t c : text)
    if (c != 0)
      ascii += static_cast<char>(c);
    else
      break;
  return ascii;
}

TEST(Vst3, ListsWhatItExpresses) {
  const auto plugin = open_vst3("lap_steel");
  auto** const list = plugin->of_controller<v3_note_expression_controller>(v3_note_expression_controller_iid);
  ASSERT_NE(list, nullptr);
  const auto& functions = *v3_cpp_obj(list);
  std::string titles;
  const int count = functions.get_note_expression_count(list, 0, 0);
  for (int number = 0; number < count; ++number) {
    v3_note_expression_type_info info = {};
    ASSERT_EQ(functions.get_note_expression_info(list, 0, 0, number, &info), V3_OK);
    titles += text_of(info.title) + " ";
    v3_str_128 text = {};
    ASSERT_EQ(functions.get_note_expression_string_by_value(list, 0, 0, info.type_id, 0.75, text), V3_OK);
    double part = 0;
    ASSERT_EQ(functions.get_note_expression_value_by_string(list, 0, 0, info.type_id, text, &part), V3_OK);
    EXPECT_NEAR(part, 0.75, 1e-12) << titles;
  }
  EXPECT_EQ(titles, "volume expression pan tuning brightness pressure ");
  v3_note_expression_type_info info = {};
  EXPECT_NE(functions.get_note_expression_info(list, 0, 0, count, &info), V3_OK);
  EXPECT_EQ(functions.get_note_expression_count(list, 1, 0), 0);
  v3_str_128 text = {'x'};
  double part = 0;
  EXPECT_NE(functions.get_note_expression_value_by_string(list, 0, 0, 2, text, &part), V3_OK);

  auto** const fingers = plugin->of_controller<v3_note_expression_physical>(v3_note_expression_physical_iid);
  ASSERT_NE(fingers, nullptr);
  std::array<v3_physical_ui_map, 4> maps = {{{0, 0}, {1, 0}, {2, 0}, {9, 0}}};
  v3_physical_ui_map_list asked = {4, maps.data()};
  ASSERT_EQ(v3_cpp_obj(fingers)->get_physical_ui_mapping(fingers, 0, 0, &asked), V3_OK);
  EXPECT_EQ(maps[0].expression, 2u);
  EXPECT_EQ(maps[1].expression, 5u);
  EXPECT_EQ(maps[2].expression, 100000u);
  EXPECT_EQ(maps[3].expression, 0xffffffffu);
}

}  // namespace
}  // namespace contactspline::testing
