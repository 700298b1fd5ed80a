// SPDX-License-Identifier: MIT
// --help and --version: of the program and of every subcommand, whatever else is missing.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "program.hpp"

namespace contactspline::testing {
namespace {

struct Command {
  std::string test;
  Words words;
  Words mentions;
};

void PrintTo(const Command& command, std::ostream* stream) {
  *stream << command.test;
}

const std::vector<Command> kCommands = {
    {"program", {}, {"generate", "inspect", "list", "show", "impact", "render", "plugin", "dataset", "Exit status"}},
    {"generate",
     {"generate"},
     {"MATERIAL", "--emit", "faust", "cpp", "json", "-o,--output", "--check", "--watch", "--depfile", "--rate",
      "--force", "standard output", "An instrument is a Faust program\ntoo if"}},
    {"inspect", {"inspect"}, {"MATERIAL", "--figure", "--compare", "--rate"}},
    {"list", {"list"}, {"materials", "resonators", "keyboards", "instruments", "scores"}},
    {"show", {"show"}, {"NAME", "my_felt.json"}},
    {"impact", {"impact"}, {"MATERIAL", "--speed", "--rate", "1e-06 to 1000"}},
    {"render", {"render"}, {"mass-barrier"}},
    {"dataset", {"dataset"}, {"PLAN", "-o,--output", "--shards", "--shard", "--threads", "--join", "--force"}},
    {"plugin", {"plugin"}, {"INSTRUMENT", "-o,--output", "--vendor", "--no-build", "--force", "dpf-source"}},
    {"mass_barrier",
     {"render", "mass-barrier"},
     {"--material",  "--mass",     "--speed",       "--start",  "--gravity", "--stiffness-ratio",
      "--loss",      "--duration", "--rate",        "--signal", "force",     "displacement",
      "-o,--output", "--figure",   "--no-figure",   "--gain",   "--force",   ".flac",
      ".png",        "44100",      "rubber_on_wood"}}};

class EveryCommand : public ::testing::TestWithParam<Command> {};

std::string printed(Words words, const std::string& flag) {
  words.push_back(flag);
  return succeed({.arguments = words, .folder = "/"});
}

TEST_P(EveryCommand, HasHelpThatMentionsEachOption) {
  const std::string help = printed(GetParam().words, "--help");
  EXPECT_EQ(printed(GetParam().words, "-h"), help);
  EXPECT_NE(help.find("Usage: contactspline"), std::string::npos) << help;
  for (const std::string& word : followed_by(GetParam().mentions, {"-h,--help", "--version"}))
    EXPECT_NE(help.find(word), std::string::npos) << help << "does not mention " << word;
}

TEST_P(EveryCommand, HasAVersion) {
  EXPECT_EQ(printed(GetParam().words, "--version"), "contactspline " VERSION "\n");
}

INSTANTIATE_TEST_SUITE_P(Help, EveryCommand, ::testing::ValuesIn(kCommands), ::testing::PrintToStringParamName());

TEST(Help, IsPrintedWhateverElseIsWrong) {
  const std::string help = printed({"generate"}, "--help");
  EXPECT_EQ(printed({"generate", "gone.json", "--emit", "json"}, "--help"), help);
}

TEST(Help, FitsATerminal) {
  for (const auto& command : kCommands) {
    std::istringstream help(printed(command.words, "--help"));
    for (std::string line; std::getline(help, line);) EXPECT_LE(line.size(), 118u) << line;
  }
}

TEST(Help, IsWhatAProgramWithoutWordsPrints) {
  EXPECT_EQ(succeed(Call{.arguments = {}, .folder = "/"}), printed({}, "--help"));
}

}  // namespace
}  // namespace contactspline::testing
