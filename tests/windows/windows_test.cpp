// SPDX-License-Identifier: MIT
// What is built for Windows, under Wine, beside what is built for Linux.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <vector>

#include "plugins/agreement.hpp"
#include "plugins/virtual_display.hpp"
#include "windows/recording.hpp"

namespace contactspline::testing {
namespace {

const fs::path kBuilt = BUILT, kLinux = LINUX;

// The binary of an instrument.
fs::path plugin(const std::string& format, bool is_for_windows, const std::string& instrument = "hammer_string") {
  const std::string name = "contactspline_" + instrument;
  const fs::path folder = (is_for_windows ? kBuilt : kLinux) / format;
  if (format == "clap") return folder / (name + ".clap");
  if (format == "lv2") return folder / (name + ".lv2") / (name + (is_for_windows ? ".dll" : ".so"));
  return folder / (name + ".vst3") / "Contents" /
         (is_for_windows ? "x86_64-win/" + name + ".vst3" : "x86_64-linux/" + name + ".so");
}

std::vector<float> recording(const std::string& format, bool is_for_windows, const std::string& instrument) {
  const std::string recorder =
      is_for_windows ? WINE " " BUILT "/tests/windows/record_plugin.exe" : LINUX "/tests/windows/record_plugin";
  return recorded(recorder, format, plugin(format, is_for_windows, instrument), kBuilt / ("recorded_" + format));
}

class WindowsPlugin : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(InEveryFormat, WindowsPlugin, ::testing::Values("clap", "vst3", "lv2"));

// Each of them keeps 85 dB of the model in double precision (tests/plugins/instruments_test.cpp): so their difference
// is at most twice that error. Measured: 109 dB of the hammer-string.
TEST_P(WindowsPlugin, PlaysTheSamplesOfLinux) {
  for (const std::string instrument : {"hammer_string", "lap_steel"}) {
    const std::vector<float> here = recording(GetParam(), false, instrument),
                             there = recording(GetParam(), true, instrument);
    ASSERT_EQ(here.size(), 2u * 188 * 256);
    EXPECT_GT(*std::ranges::max_element(here), 0.1f) << instrument;
    const double db = agreement_db(std::span<const float>(there), std::span<const float>(here));
    EXPECT_GT(db, 85 - 6.1) << instrument;
    std::printf("%s: %.1f dB\n", instrument.c_str(), db);
  }
}

TEST(WindowsPlugin, IsDescribedAsOnLinux) {
  for (const std::string file : {"contactspline_hammer_string", "presets", "manifest"}) {
    const auto text = [&](bool is_for_windows) {
      return read_file(plugin("lv2", is_for_windows).parent_path() / (file + ".ttl"));
    };
    std::string here = std::regex_replace(text(false), std::regex(R"((_ui)?\.so>)"), "$1.dll>");
    here = std::regex_replace(here, std::regex("ui:X11UI"), "ui:WindowsUI");
    EXPECT_EQ(text(true), here) << file;
  }
}

// It is drawn, a click on a key sounds, and it closes. Wine draws on the display of the test, in a window beside the
// host's.
TEST_P(WindowsPlugin, OpensItsWindow) {
  const std::string format = GetParam();
  if (format == "lv2") GTEST_SKIP() << "no host of LV2 is built for Windows";
  constexpr int kWidth = 960, kHeight = 640;
  constexpr std::size_t kPixels = kWidth * kHeight;
  constexpr Pixel kBackground{20, 22, 27}, kPanel{29, 32, 39};
  const VirtualDisplay display;
  // Programs of one prefix share a desktop, which keeps the display that the first of them had, or none.
  setenv("WINEPREFIX", (kBuilt / ("wine_" + format)).c_str(), 1);
  XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });  // where a window of Wine's goes while we look at it
  const fs::path log = kBuilt / (format + "_window.log");
  std::ofstream(log).close();  // what an earlier run wrote goes, and it is there before the host opens it
  ChildProcess host({WINE, BUILT "/tests/windows/open_window.exe", format, plugin(format, true)}, log);
  const auto becomes_true = [&](auto holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(300);
    while (!holds() && host.is_running() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return holds();
  };
  ASSERT_TRUE(becomes_true([&] { return read_file(log).find("sounds") != std::string::npos; })) << read_file(log);
  EXPECT_TRUE(becomes_true([&] {
    return std::ranges::any_of(display.photos(kWidth, kHeight), [&](const Photo& photo) {
      return photo.count(kBackground) > kPixels / 5 && photo.count(kPanel) > kPixels / 4;
    });
  }));
  host.write("\n");
  EXPECT_EQ(host.exit_code(std::chrono::seconds(30)), 0) << read_file(log);
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
