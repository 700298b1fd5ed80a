// SPDX-License-Identifier: MIT
// How long Faust takes. Printed, not judged: the machine may be busy.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "faust_command.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

/// User time of all children so far [s].
double children_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

/// User time of faust on a program, C++ back end [s].
double compile_seconds(const std::filesystem::path& program) {
  const auto folder = empty_folder("compile_time_" + program.stem().string());
  const double before = children_seconds();
  const auto outcome = run_faust_compiler("-lang cpp -double", program, folder / "out.cpp");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  return children_seconds() - before;
}

class CompileTimeTest : public ::testing::TestWithParam<int> {};

TEST_P(CompileTimeTest, OfTheMassBarrierIsPrinted) {
  const std::string name = "mass_barrier_felt_c4_n" + std::to_string(GetParam());
  Measured() << "faust on mass_barrier.dsp with " << GetParam()
             << " segments: " << compile_seconds(std::filesystem::path(kGenerated) / (name + ".dsp"))
             << " s of user time";
}

INSTANTIATE_TEST_SUITE_P(Segments, CompileTimeTest, ::testing::Values(1, 64, 1024));

TEST(CompileTime, OfStringsIsPrinted) {
  const std::filesystem::path shipped = kFaustSources, strings = kBenchStrings, tests = kFaustTests;
  for (const auto& program : {shipped / "hammer_string.dsp", strings / "eighty_modes.dsp", strings / "c2.dsp",
                              shipped / "piano.dsp", tests / "piano_effect.dsp", shipped / "slide_string.dsp"})
    Measured() << "faust on " << program.filename().string() << ": " << compile_seconds(program) << " s of user time";
}

}  // namespace
}  // namespace contactspline::testing
