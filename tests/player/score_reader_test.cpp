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

// Five voices of one file and one of another: each material is designed once. Its curve is read by the design alone.
TEST(ScoreReader, DesignsEachMaterialOnce) {
  std::map<std::string, int> reads;
  const ReadFile read = [&](const std::string& path) {
    ++reads[path];
    return shipped_text(path.ends_with(".csv") ? "felt_synthetic.csv" : "felt_synthetic.json");
  };
  std::string voices;
  for (const char* voice : {"a", "b", "c", "d", "e", "f"}) {
    voices.append(voices.empty() ? "" : ", ").append(R"({ "resonator": "string_c4", "name": ")").append(voice);
    voices.append(R"(", "material": "folder/)").append(*voice == 'f' ? "other" : "felt").append(R"(.json" })");
  }
  std::string text = R"({ "instrument": "hammer-string", "duration_s": 1, "events": [ { "time_s": 0,
    "speed_m_per_s": 1 } ], "voices": [ )";
  const Score score = parse_score(text.append(voices).append(" ] }"), "probe.json", read);
  ASSERT_EQ(score.voices.size(), 6u);
  EXPECT_EQ(reads["folder/felt_synthetic.csv"], 2);
  EXPECT_GT(reads["folder/felt.json"], 0);
  EXPECT_GT(score.voices[4].contact.size(), 5u);
}

}  // namespace
}  // namespace contactspline::testing
