// SPDX-License-Identifier: MIT
// What a score asks of its materials.
#include "generator/player/score_reader.hpp"

#include <algorithm>
#include <map>

#include "generator/support/embedded_files.hpp"

namespace contactspline::testing {
namespace {

std::string shipped_text(std::string_view name) {
  const auto files = embedded_files(Shipped::kMaterials);
  return std::string(std::ranges::find(files, name, &EmbeddedFile::name)->content);
}

// Five contacts of one file and one of another: each material is designed once. Its curve is read by the design
// alone.
TEST(ScoreReader, DesignsEachMaterialOnce) {
  std::map<std::string, int> reads;
  const ReadFile read = [&](const std::string& path) {
    ++reads[path];
    return shipped_text(path.ends_with(".csv") ? "felt_synthetic.csv" : "felt_synthetic.json");
  };
  std::string contacts;
  for (const char* contact : {"a", "b", "c", "d", "e", "f"}) {
    contacts.append(contacts.empty() ? "" : ", ").append(R"({ "between": ["ball", "ground"], "name": ")");
    contacts.append(contact).append(R"(", "material": "folder/)").append(*contact == 'f' ? "other" : "felt");
    contacts.append(R"(.json" })");
  }
  const Score score = parse_score(R"({ "duration_s": 1, "events": [ { "time_s": 0, "ball_speed_m_per_s": 1 } ],
    "instrument": { "name": "probe", "bodies": [ { "name": "ball", "mass_kg": 0.01 } ], "strikes": ["ball"],
                    "outputs": [ { "name": "ball", "velocity_m_per_s": "ball" } ], "contacts": [ )" +
                                      contacts + " ] } }",
                                  "probe.json", read);
  EXPECT_EQ(model_of(score)->connections.size(), 6u);
  EXPECT_EQ(reads["folder/felt_synthetic.csv"], 2);
  EXPECT_GT(reads["folder/felt.json"], 0);
}

// Middle C of three channels, two of them bent: one has the strings of the key, the others have strings of their own.
// The whole piano stands on the board.
TEST(ScoreReader, GivesBentChannelsTheirOwnStrings) {
  const std::string events(
      "\0\xe0\0\x60\0\xe1\0\x20\0\x90\x3c\x40\0\x91\x3c\x40\0\x92\x3c\x40\0\x90\x30\x40\x60\x80\x3c\0\0\xff\x2f\0",
      32);
  const std::string head("MThd\0\0\0\6\0\0\0\1\0\x60MTrk\0\0\0", 21);
  const Score score = parse_midi_score(head + static_cast<char>(events.size()) + events, "probe.mid");
  EXPECT_TRUE(score.body.has_value());
  ASSERT_EQ(score.keys.size(), 90u);
  std::map<std::string, std::size_t> keys;
  for (const Voice& voice : score.voices) keys[voice.name] = voice.key;
  const std::map<std::string, std::size_t> expected = {
      {"48_channel_1", 27}, {"60", 39}, {"60_channel_1", 88}, {"60_channel_2", 89}};
  EXPECT_EQ(keys, expected);
  for (const std::size_t key : {88u, 89u})
    EXPECT_EQ(score.keys[key].strings.tension_n, score.keys[39].strings.tension_n);
  EXPECT_EQ(score.keys[39].strings.detuning_cents.size(), 3u);
}

// Where a note sounds without the body, the sustain pedal holds it when it is all the way down. The rest is left out.
TEST(ScoreReader, TellsThePedalsApart) {
  const auto with_pedal = [](char controller, char position) {
    const std::string head("MThd\0\0\0\6\0\0\0\1\0\x60MTrk\0\0\0", 21);
    std::string events("\0\xb0\0\0\0\x90\x3c\x40\x60\x80\x3c\0\0\xff\x2f\0", 16);
    events[2] = controller, events[3] = position;
    return parse_midi_score(head + static_cast<char>(events.size()) + events, "probe.mid");
  };
  const std::map<char, std::size_t> pedals = {
      {64, KeyboardParameter::kSustain}, {66, KeyboardParameter::kSostenuto}, {67, KeyboardParameter::kUnaCorda}};
  for (const auto& [controller, pedal] : pedals) {
    const Score down = with_pedal(controller, 127), half = with_pedal(controller, controller == 64 ? 32 : 90);
    for (const Score& score : {down, half}) {
      ASSERT_FALSE(score.pedals.empty());
      EXPECT_EQ(score.pedals[0].control, pedal) << int(controller);
    }
    EXPECT_EQ(down.left_out_at_rest.empty(), pedal == KeyboardParameter::kSustain) << int(controller);
    EXPECT_FALSE(half.left_out_at_rest.empty()) << int(controller);
  }
}

// A note of 0.5 s that the pedal of another channel holds until 5 s; and one before a pedal that holds nothing. A
// second rings after the end.
TEST(ScoreReader, EndsWhenThePedalsLetGo) {
  const auto duration_s = [](std::string_view events) {
    const std::string head("MThd\0\0\0\6\0\0\0\1\0\x60MTrk\0\0\0", 21);
    return parse_midi_score(head + static_cast<char>(events.size()) + std::string(events), "probe.mid").duration_s;
  };
  EXPECT_DOUBLE_EQ(duration_s({"\0\xb1\x40\x7f\0\x90\x3c\x40\x60\x80\x3c\0\x86\x60\xb1\x40\0\0\xff\x2f\0", 21}), 6);
  EXPECT_DOUBLE_EQ(duration_s({"\0\x90\x3c\x40\x60\x80\x3c\0\x60\xb0\x42\x7f\x86\x60\xb0\x42\0\0\xff\x2f\0", 21}),
                   1.5);
}

}  // namespace
}  // namespace contactspline::testing
