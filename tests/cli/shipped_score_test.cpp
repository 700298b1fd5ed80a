// SPDX-License-Identifier: MIT
// Every score that ships, and those of docs/reference/scores.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <string>

#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "render_score.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

Words words_of(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

// Every shipped score: about ten seconds of sound, in stereo if its voices are panned, never silent for half a second
// before the last two, no sample at full scale, all of it gone at the end.
class ShippedScore : public ::testing::TestWithParam<EmbeddedFile> {};

TEST_P(ShippedScore, Plays) {
  const Sandbox box;
  const auto& [file, text] = GetParam();
  const std::string list = succeed({.arguments = {"list", "scores"}});
  const std::string name(file.substr(0, file.rfind('.')));
  const bool is_midi = file.ends_with(".mid");
  const auto line = list.substr(list.find("\n" + name + " ") + 1);
  const std::string instrument = words_of(line).at(1);
  const std::string report =
      succeed({.arguments = {"render", instrument, "--score", name, "-o", name + ".wav"}, .folder = box.path()});
  const bool has_contacts = !report.starts_with("full scale");
  expect_drawn(box / (name + ".svg"), has_contacts ? 3 : 2);  // without them the force has no panel
  const Sound sound = read_sound(box / (name + ".wav"));
  const bool is_panned = text.find("\"pan\"") != text.npos || text.find("\"keyboard\"") != text.npos || is_midi;
  EXPECT_EQ(sound.channels, is_panned ? 2 : 1);
  EXPECT_TRUE(within(sound.peak(), kPeak, kLevel));
  const std::ptrdiff_t half_second = 22050 * sound.channels;
  const std::ptrdiff_t stretches = std::ssize(sound.samples) / half_second;
  EXPECT_TRUE(within(static_cast<double>(stretches), 24, 5));
  for (std::ptrdiff_t i = 0; i < stretches; ++i) {
    const auto begin = sound.samples.begin() + i * half_second;
    double loudest = 0;
    for (auto at = begin; at != begin + half_second; ++at) loudest = std::max(loudest, std::abs(*at));
    EXPECT_TRUE(loudest > 0.01 || i + 4 >= stretches) << "at " << 0.5 * static_cast<double>(i) << " s";
  }
  double last = 0;
  for (auto at = sound.samples.end() - 4410; at != sound.samples.end(); ++at) last = std::max(last, std::abs(*at));
  EXPECT_LT(last, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Each, ShippedScore, ::testing::ValuesIn(embedded_files(Shipped::kScores)),
                         [](const auto& score) {
                           return std::string(score.param.name.substr(0, score.param.name.rfind('.')));
                         });

TEST(ShippedScore, AreFiveAtLeast) {
  EXPECT_GE(embedded_files(Shipped::kScores).size(), 5u);
}

TEST(ScoresOfTheDocs, Play) {
  const std::string page = read_file(fs::path(SOURCE_FOLDER) / "docs/reference/scores.md"), fence = "```json\n";
  int examples = 0;
  for (auto at = page.find(fence); at != std::string::npos; at = page.find(fence, at + 1), ++examples) {
    const auto begin = at + fence.size();
    const std::string score = page.substr(begin, page.find("```", begin) - begin);
    const bool slides = score.find("slide-string") != std::string::npos;
    EXPECT_TRUE(within(sound_of(slides ? "slide-string" : "hammer-string", score).peak(), kPeak, kLevel)) << score;
  }
  EXPECT_EQ(examples, 3);
}

}  // namespace
}  // namespace contactspline::testing
