// SPDX-License-Identifier: MIT
// How long Faust takes. Printed, not judged: the machine may be busy.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <iostream>

#include "faust_command.hpp"

namespace contactspline::testing {
namespace {

/// User time of all children so far [s].
double children_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

class CompileTimeTest : public ::testing::TestWithParam<int> {};

TEST_P(CompileTimeTest, OfTheMassBarrierIsPrinted) {
  const std::string name = "mass_barrier_felt_c4_n" + std::to_string(GetParam());
  const auto program = std::filesystem::path(kGenerated) / (name + ".dsp");
  const auto folder = empty_folder("compile_time_" + std::to_string(GetParam()));
  std::array<double, 5> seconds;
  for (double& time : seconds) {
    const double before = children_seconds();
    const auto outcome = run_faust_compiler("-lang cpp -double", program, folder / "out.cpp");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    time = children_seconds() - before;
  }
  std::ranges::sort(seconds);
  std::cout << "faust on mass_barrier.dsp with " << GetParam() << " segments: " << seconds[2]
            << " s of user time, median of 5\n";
}

INSTANTIATE_TEST_SUITE_P(Segments, CompileTimeTest, ::testing::Values(1, 64, 1024));

}  // namespace
}  // namespace contactspline::testing
