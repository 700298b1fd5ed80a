// SPDX-License-Identifier: MIT
// What is built for Windows, under Wine, beside what is built for Linux.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <vector>

#include "plugins/agreement.hpp"
#include "windows/recording.hpp"

namespace contactspline::testing {
namespace {

const fs::path kBuilt = BUILT, kLinux = LINUX;

// The binary of hammer_string.
fs::path plugin(const std::string& format, bool is_for_windows) {
  const std::string name = "contactspline_hammer_string";
  const fs::path folder = (is_for_windows ? kBuilt : kLinux) / format;
  if (format == "clap") return folder / (name + ".clap");
  if (format == "lv2") return folder / (name + ".lv2") / (name + (is_for_windows ? ".dll" : ".so"));
  return folder / (name + ".vst3") / "Contents" /
         (is_for_windows ? "x86_64-win/" + name + ".vst3" : "x86_64-linux/" + name + ".so");
}

std::vector<float> recording(const std::string& format, bool is_for_windows) {
  const std::string recorder =
      is_for_windows ? WINE " " BUILT "/tests/windows/record_plugin.exe" : LINUX "/tests/windows/record_plugin";
  return recorded(recorder, format, plugin(format, is_for_windows), kBuilt / ("recorded_" + format));
}

class WindowsPlugin : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(InEveryFormat, WindowsPlugin, ::testing::Values("clap", "vst3", "lv2"));

// Each of them keeps 85 dB of the model in double precision (tests/plugins/instruments_test.cpp): so their difference
// is at most twice that error. Measured: 109 dB.
TEST_P(WindowsPlugin, PlaysTheSamplesOfLinux) {
  const std::vector<float> here = recording(GetParam(), false), there = recording(GetParam(), true);
  ASSERT_EQ(here.size(), 2u * 188 * 256);
  EXPECT_GT(*std::ranges::max_element(here), 0.1f);
  EXPECT_GT(agreement_db(std::span<const float>(there), std::span<const float>(here)), 85 - 6.1);
}

// Plug-ins have no window on Windows.
std::string without_window(const std::string& text) {
  static const std::regex window(
      R"(@prefix (ui|opts):[^\n]*\n|\n    ui:ui <[^>]*> ;\n|\n<[^>]*#DPF_UI>[^]*? \.\n\n)");
  return std::regex_replace(text, window, "");
}

TEST(WindowsPlugin, IsDescribedAsOnLinux) {
  for (const std::string file : {"contactspline_hammer_string", "presets", "manifest"}) {
    const auto text = [&](bool is_for_windows) {
      return read_file(plugin("lv2", is_for_windows).parent_path() / (file + ".ttl"));
    };
    const std::string here = std::regex_replace(text(false), std::regex(R"(string\.so>)"), "string.dll>");
    EXPECT_EQ(without_window(text(true)), without_window(here)) << file;
  }
}

// The libraries that a binary asks for are those of Windows.
TEST(WindowsPlugin, NeedsNoLibraryOfTheCompiler) {
  for (const char* format : {"clap", "vst3", "lv2"}) {
    const std::string bytes = read_file(plugin(format, true));
    EXPECT_NE(bytes.find("KERNEL32.dll"), std::string::npos) << format;
    for (const char* library : {"libstdc++-6.dll", "libwinpthread-1.dll", "libgcc_s_seh-1.dll"})
      EXPECT_EQ(bytes.find(library), std::string::npos) << format << ' ' << library;
  }
}

// Under temporary names first, then renamed; put back where one of them cannot be.
TEST(WindowsFiles, AreWrittenAsSafelyAsOnLinux) {
  EXPECT_EQ(std::system(WINE " " BUILT "/tests/windows/write_files.exe " BUILT "/written"), 0);
}

}  // namespace
}  // namespace contactspline::testing
