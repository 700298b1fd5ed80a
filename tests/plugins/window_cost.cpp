// SPDX-License-Identifier: MIT
// window_cost [INSTRUMENT [SCALE [PHOTO]]]: the processor time of the window of a plug-in of the build tree, 60 times
// a second on a display without graphics hardware, while notes sound and when all is still: as a share of one core,
// without the audio thread, and beside it the display's own. The photo, a PPM file, is that of
// docs/figures/window.png.
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "plugins/count_pictures.hpp"
#include "plugins/open_plugin.hpp"
#include "plugins/virtual_display.hpp"

// Not counted here.
constinit thread_local std::size_t contactspline::testing::allocations = 0, contactspline::testing::locks = 0;

namespace contactspline::testing {
namespace {

constexpr int kPictures_hz = 60, kBlock = 48000 / kPictures_hz;

double seconds_of(clockid_t clock) {
  timespec time;
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void measure(HostedPlugin& plugin, clockid_t display, bool is_played, const char* what) {
  constexpr int kTime_s = 10;
  const int pictures_before = pictures;
  const double window_before = seconds_of(CLOCK_PROCESS_CPUTIME_ID), display_before = seconds_of(display);
  const auto begin = std::chrono::steady_clock::now();
  double audio_s = 0;
  for (int i = 0; i < kTime_s * kPictures_hz; ++i) {
    const double audio_before = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    const auto key = static_cast<std::uint8_t>(48 + i / 30);
    if (is_played && i % 30 == 0) plugin.send(0, {0x90, key, 100});
    if (is_played && i % 30 == 25) plugin.send(0, {0x80, key, 0});
    (void)plugin.run(1, kBlock);
    audio_s += seconds_of(CLOCK_THREAD_CPUTIME_ID) - audio_before;
    plugin.idle_window();
    std::this_thread::sleep_until(begin + (i + 1) * std::chrono::microseconds(1000000 / kPictures_hz));
  }
  const double passed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double window_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID) - window_before - audio_s;
  std::printf("%s: %.0f pictures a second, window %.1f %% of a core, display %.1f %%\n", what,
              (pictures - pictures_before) / passed_s, 100 * window_s / passed_s,
              100 * (seconds_of(display) - display_before) / passed_s);
}

int run(const std::string& instrument, double scale, const std::string& photo) {
  const VirtualDisplay display;
  clockid_t display_clock;
  if (clock_getcpuclockid(display.process(), &display_clock) != 0) return 1;
  const auto plugin = open_plugin("clap", instrument, 48000);
  const HostWindow window(display, static_cast<unsigned>(960 * scale), static_cast<unsigned>(640 * scale));
  plugin->open_window(window.get(), scale);
  measure(*plugin, display_clock, true, "first notes");  // shaders are compiled meanwhile
  measure(*plugin, display_clock, true, "notes");
  if (!photo.empty()) {
    plugin->send(0, {0x90, 60, 100});
    plugin->send(0, {0xe0, 0, 0x60});  // a semitone up
    for (int i = 0; i < kPictures_hz / 4; ++i) {
      (void)plugin->run(1, kBlock);
      plugin->idle_window();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // until the server draws
    }
    window.photo().write(photo);
    plugin->send(0, {0xe0, 0, 0x40});
    plugin->send(0, {0x80, 60, 0});
  }
  for (int before = -1, waited_s = 0; before != pictures && waited_s < 60; ++waited_s) {
    before = pictures;
    for (int i = 0; i < kPictures_hz; ++i) {
      (void)plugin->run(1, kBlock);
      plugin->idle_window();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // until the server draws
    }
  }
  measure(*plugin, display_clock, false, "still");
  plugin->close_window();
  return 0;
}

}  // namespace
}  // namespace contactspline::testing

int main(int argc, char** argv) try {
  return contactspline::testing::run(argc > 1 ? argv[1] : "hammer_string", argc > 2 ? std::atof(argv[2]) : 1,
                                     argc > 3 ? argv[3] : "");
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
