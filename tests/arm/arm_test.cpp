// SPDX-License-Identifier: MIT
// A plug-in that is built for 64-bit ARM, in qemu, beside the one of this machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "plugins/agreement.hpp"
#include "windows/recording.hpp"

namespace contactspline::testing {
namespace {

std::filesystem::path plugin(const std::string& format, bool is_for_arm) {
  const std::string name = "contactspline_hammer_string";
  const std::filesystem::path folder = std::filesystem::path(is_for_arm ? BUILT : LINUX) / format;
  if (format == "clap") return folder / (name + ".clap");
  if (format == "lv2") return folder / (name + ".lv2") / (name + ".so");
  return folder / (name + ".vst3") / "Contents" / (is_for_arm ? "aarch64-linux" : HERE) / (name + ".so");
}

std::vector<float> recording(const std::string& format, bool is_for_arm) {
  const std::string recorder =
      is_for_arm ? QEMU " " BUILT "/tests/arm/record_plugin" : LINUX "/tests/windows/record_plugin";
  return recorded(recorder, format, plugin(format, is_for_arm), BUILT "/recorded_" + format);
}

class ArmPlugin : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(InEveryFormat, ArmPlugin, ::testing::Values("clap", "vst3", "lv2"));

// Each of them keeps 85 dB of the model in double precision (tests/plugins/instruments_test.cpp): so their difference
// is at most twice that error.
TEST_P(ArmPlugin, PlaysTheSamplesOfThisMachine) {
  const std::vector<float> here = recording(GetParam(), false), there = recording(GetParam(), true);
  ASSERT_EQ(here.size(), 2u * 188 * 256);
  EXPECT_GT(*std::ranges::max_element(here), 0.1f);
  const double decibels = agreement_db(std::span<const float>(there), std::span<const float>(here));
  RecordProperty("decibels", std::to_string(decibels));
  EXPECT_GT(decibels, 85 - 6.1);
}

}  // namespace
}  // namespace contactspline::testing
