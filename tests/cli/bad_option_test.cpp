// SPDX-License-Identifier: MIT
// All the errors that a command line can have: one line that names option or file and what is allowed, nothing
// written.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "bad_input.hpp"
#include "cases.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

constexpr auto kWithoutImpact = R"({
  "name": "bare",
  "contact": { "stiffness_n_per_m_alpha": 1e9, "exponent": 2 },
  "spline": { "knots": "uniform", "segments": 8, "max_compression_m": 1e-3 }
})";

constexpr auto kSoft = R"({
  "name": "soft",
  "contact": { "stiffness_n_per_m_alpha": 0.001, "exponent": 10 },
  "impact": { "mass_kg": 1e4, "max_speed_m_per_s": 1e-6, "min_speed_m_per_s": 1e-6 },
  "spline": { "knots": "uniform", "segments": 8, "max_compression_m": 1 }
})";

std::vector<BadLine> long_cases() {
  return {{"output_long",
           {"generate", "probe.json", "-o", std::string(300, 'o')},
           "--output: the name has 300 bytes",
           "allowed: a name of at most"}};
}

class BadCommandLine : public ::testing::TestWithParam<BadLine> {};

TEST_P(BadCommandLine, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [test, words, beginning, says] = GetParam();
  const Sandbox box;
  write_file(box / "probe.json", kProbeMaterial);
  write_file(box / "other.json", kProbeMaterial);
  write_file(box / "probe.svg", kProbeMaterial);
  write_file(box / "probe.aif", kProbeMaterial);
  write_file(box / "bare.json", kWithoutImpact);
  const std::string mixed = hammer_score("felt_c4", "string_c4"),
                    mixed_files = hammer_score("string_c4", "my_string.json");
  for (const auto& [name, text] :
       {std::pair{"my_string.json", std::string(find_embedded(Shipped::kResonators, "string_c4.json")->content)},
        std::pair{"my_score.json", hammer_score("string_c4", "felt_c4")},
        std::pair{"my.mid", std::string(find_embedded(Shipped::kScores, "bach_prelude.mid")->content)},
        std::pair{"my_output.json", read_file(fs::path(SOURCE_FOLDER) / "generated/mb1.json")},
        std::pair{"mixed.json", mixed}, std::pair{"mixed_files.json", mixed_files}})
    write_file(box / name, text);
  write_file(box / "soft.json", kSoft);
  write_file(box / "file.txt", "text");
  for (const auto folder : {"tmp", "out", "links", "taken/probe.hpp", "taken.wav", "taken.svg", "line\nend"})
    fs::create_directories(box / folder);
  write_file(box / "line\nend/probe.json", kProbeMaterial);
  fs::create_symlink("probe.json", box / "link.json");
  fs::create_symlink("nowhere", box / "links/probe.json");
  const auto before = box.listing();
  const auto outcome =
      run({.arguments = words, .folder = box.path(), .environment = {{"TMPDIR", (box / "tmp").string()}}});
  expect_refused(outcome, beginning, says);
  EXPECT_EQ(names_in(box.listing()), names_in(before));
  EXPECT_TRUE(box.listing() == before);
}

// Files of Scala, which tune a MIDI file. What they are called stands in front of each message.
class BadTuning : public ::testing::TestWithParam<std::pair<std::string, BadFile>> {};

TEST_P(BadTuning, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [option, bad] = GetParam();
  const std::string name = option == "--tuning" ? "probe.scl" : "probe.kbm";
  const Sandbox box;
  write_file(box / "my.mid", std::string(find_embedded(Shipped::kScores, "bach_prelude.mid")->content));
  write_file(box / name, bad.text);
  const auto before = box.listing();
  expect_refused(run({.arguments = {"render", "my.mid", option, name, "-o", "a.wav"}, .folder = box.path()}),
                 name + ": " + bad.key, bad.says);
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

std::vector<std::pair<std::string, BadFile>> bad_tunings() {
  std::vector<std::pair<std::string, BadFile>> cases;
  for (const BadFile& bad :
       bad_files("tuning", "Scale", {{"", "! probe.scl\nA scale\n 4\n 5/4\n 701.955\n 7/4\n 2/1\n"}}))
    cases.emplace_back("--tuning", bad);
  for (const BadFile& bad :
       bad_files("tuning", "Keymap", {{"", "! probe.kbm\n3\n0\n127\n60\n69\n440.0\n12\n! Mapping\n0\n2\nx\n"}}))
    cases.emplace_back("--keymap", bad);
  return cases;
}
INSTANTIATE_TEST_SUITE_P(All, BadTuning, ::testing::ValuesIn(bad_tunings()),
                         [](const auto& bad) { return bad.param.second.test; });

CONTACTSPLINE_CASES(Command, BadCommandLine, bad_lines("option", "Command"));
CONTACTSPLINE_CASES(Material, BadCommandLine, bad_lines("option", "Material"));
CONTACTSPLINE_CASES(Generate, BadCommandLine, bad_lines("option", "Generate"));
CONTACTSPLINE_CASES(Impact, BadCommandLine, bad_lines("option", "Impact"));
CONTACTSPLINE_CASES(Render, BadCommandLine, bad_lines("option", "Render"));
CONTACTSPLINE_CASES(Long, BadCommandLine, long_cases());

}  // namespace
}  // namespace contactspline::testing
