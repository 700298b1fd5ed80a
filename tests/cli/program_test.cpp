// SPDX-License-Identifier: MIT
// The built program, started once for each subcommand: it does what the command line does within the other tests.
#include "program.hpp"

namespace contactspline::testing {
namespace {

struct ProgramCase {
  std::string test;
  Words arguments;
  int exit_code;
};

void PrintTo(const ProgramCase& one, std::ostream* stream) {
  *stream << one.test;
}

class Program : public ::testing::TestWithParam<ProgramCase> {};

// Runs in two folders: the same exit code, the same text on both streams, the same files.
TEST_P(Program, DoesWhatTheCommandLineDoesInProcess) {
  const Sandbox started, in_process;
  for (const Sandbox* box : {&started, &in_process}) write_file(*box / "stroke.json", kStroke);
  const Call call = {.arguments = GetParam().arguments};
  Call there = call, here = call;
  there.folder = started.path();
  here.folder = in_process.path();
  const Outcome program = run_program(there), function = run_in_process(here);
  EXPECT_EQ(program.exit_code, GetParam().exit_code) << program.err;
  EXPECT_EQ(function.exit_code, program.exit_code);
  EXPECT_EQ(function.out, program.out);
  EXPECT_EQ(function.err, program.err);
  const auto written = started.listing(), expected = in_process.listing();
  ASSERT_EQ(names_in(written), names_in(expected));
  for (const auto& [name, state] : written) EXPECT_EQ(state.content, expected.at(name).content) << name;
  if (program.exit_code == 2) {
    expect_refused(program, "", "");
    EXPECT_EQ(names_in(written), "stroke.json\n");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, Program,
    ::testing::ValuesIn(std::vector<ProgramCase>{
        {"nothing", {}, 0},
        {"version", {"--version"}, 0},
        {"help", {"--help"}, 0},
        {"generate", {"generate", "felt_c4", "string_c4", "-o", "out"}, 0},
        {"generate_bad_option", {"generate", "felt_c4", "--emit", "rust"}, 2},
        {"generate_bad_file", {"generate", "absent.json"}, 2},
        {"generate_check", {"generate", "felt_c4", "--check"}, 1},
        {"inspect", {"inspect", "felt_over_wood", "--figure", "a.svg"}, 0},
        {"inspect_bad_option", {"inspect", "felt_c4", "--rate", "0"}, 2},
        {"list", {"list"}, 0},
        {"list_bad_option", {"list", "all"}, 2},
        {"show", {"show", "bach_prelude"}, 0},
        {"show_bad_name", {"show", "felt_c5"}, 2},
        {"impact", {"impact", "mb1", "--speed", "2"}, 0},
        {"impact_bad_option", {"impact", "mb1", "--speed", "fast"}, 2},
        {"render_mass_barrier", {"render", "mass-barrier", "--duration", "0.01", "-o", "a.wav"}, 0},
        {"render_mass_barrier_bad_option", {"render", "mass-barrier", "--mass", "-1", "-o", "a.wav"}, 2},
        {"render_bad_score", {"render", "waltz", "-o", "a.wav"}, 2},
        {"render", {"render", "stroke.json", "-o", "a.wav"}, 0}}),
    ::testing::PrintToStringParamName());

}  // namespace
}  // namespace contactspline::testing
