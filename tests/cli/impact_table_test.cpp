// SPDX-License-Identifier: MIT
// The table of `impact --speeds` fits into a terminal of 100 columns.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

std::size_t words_in(const std::string& line) {
  std::istringstream stream(line);
  std::size_t words = 0;
  for (std::string word; stream >> word;) ++words;
  return words;
}

std::vector<std::string> table(const fs::path& folder, const Words& more) {
  const Words words = followed_by({"impact", "probe.json"}, more);
  return lines_of(succeed({.arguments = words, .folder = folder}));
}

constexpr auto kProbe = R"({{"name": "probe", "contact": {{"stiffness_n_per_m_alpha": {}, "exponent": 1.5}},
  "impact": {{"mass_kg": {}, "max_speed_m_per_s": 2, "min_speed_m_per_s": 0.1}},
  "spline": {{"knots": "uniform", "segments": 8}}}})";

// The shortest and lightest contact, and the longest and heaviest: no number is too wide for its column.
TEST(ImpactTable, FitsInto100Columns) {
  const Sandbox box;
  for (const auto& [stiffness, mass] : {std::pair{1e12, 1e-7}, {1e9, 0.01}, {1e5, 1e2}}) {
    write_file(box / "probe.json", fmt::format(kProbe, stiffness, mass));
    Words words = {"--speeds", "0.1", "123.456", "4"};
    for (const int rates : {1, 4, 5, 12}) {
      while (words.size() < 4 + 2 * static_cast<std::size_t>(rates))
        words.insert(words.end(), {"--rate", std::to_string(1000 + 11111 * static_cast<int>(words.size()))});
      const auto lines = table(box.path(), words);
      for (const std::string& line : lines) EXPECT_LE(line.size(), 100u) << line;
      // Behind the title come blocks of three lines of heading and four of numbers: with the speed, the four columns
      // of the exact motion and the spline, and 4 rates; then with the speed and 9 rates.
      ASSERT_EQ(lines.size(), rates <= 4 ? 9u : 17u);
      for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(words_in(lines[4 + i]), 5u + static_cast<std::size_t>(std::min(rates, 4))) << lines[4 + i];
        if (rates > 4) {
          EXPECT_EQ(words_in(lines[12 + i]), 1u + static_cast<std::size_t>(rates - 4)) << lines[12 + i];
        }
      }
    }
  }
}

TEST(ImpactTable, HasAHeadingAboveEachColumn) {
  const Sandbox box;
  write_file(box / "probe.json", fmt::format(kProbe, 1e9, 0.01));
  const auto lines = table(box.path(), {"--speeds", "0.1", "2", "2", "--rate", "44100"});
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_EQ(lines[0], "probe, 0.01 kg");
  EXPECT_EQ(lines[1], "                 exact        exact    spline      spline  44.1 kHz");
  EXPECT_EQ(lines[2], "    speed     duration  compression  duration compression  duration");
  EXPECT_EQ(lines[3], "    [m/s]         [us]         [um] error [%]   error [%] error [%]");
}

}  // namespace
}  // namespace contactspline::testing
