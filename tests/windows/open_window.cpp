// SPDX-License-Identifier: MIT
// open_window clap|vst3 FILE: opens the window of a plug-in at the top left of the screen, on Windows, clicks a key
// in it until its note sounds, and ends at the next line of its input.
#include <cstdio>
#include <thread>

#include "plugins/clap_host.hpp"
#include "plugins/vst3_host.hpp"

// Not counted here.
constinit thread_local std::size_t contactspline::testing::allocations = 0, contactspline::testing::locks = 0;

namespace contactspline::testing {
namespace {

// What Windows sends to windows, and a block of sound: about 60 times a second.
float advance(HostedPlugin& plugin) {
  MSG message;
  while (PeekMessageW(&message, nullptr, 0, 0, PM_REMOVE)) {
    TranslateMessage(&message);
    DispatchMessageW(&message);
  }
  plugin.idle_window();
  Sleep(17);
  const auto sound = plugin.run(3);
  return *std::max_element(sound[0].begin(), sound[0].end());
}

void run(HostedPlugin& plugin) {
  HWND frame = CreateWindowExW(0, L"STATIC", L"", WS_POPUP | WS_CLIPCHILDREN | WS_VISIBLE, 0, 0, 960, 640, nullptr,
                               nullptr, nullptr, nullptr);
  if (frame == nullptr) throw std::runtime_error("no window of the host");
  plugin.open_window(reinterpret_cast<std::uintptr_t>(frame), 1);
  HWND inner = GetWindow(frame, GW_CHILD);
  if (inner == nullptr) throw std::runtime_error("nothing stands in the window");
  constexpr LPARAM kKey = 600 << 16 | 480;
  float largest = 0;
  for (int frames = 0; largest == 0 && frames < 600; ++frames) {
    if (frames % 60 == 30) PostMessageW(inner, WM_LBUTTONDOWN, MK_LBUTTON, kKey);
    if (frames % 60 == 50) PostMessageW(inner, WM_LBUTTONUP, 0, kKey);
    largest = std::max(largest, advance(plugin));
  }
  if (!(largest > 0)) throw std::runtime_error("no sound");
  std::puts("sounds");
  std::fflush(stdout);
  std::atomic<bool> is_over = false;
  std::thread input([&is_over] {
    (void)std::getchar();
    is_over = true;
  });
  while (!is_over) advance(plugin);
  input.join();
  plugin.close_window();
  DestroyWindow(frame);
}

}  // namespace
}  // namespace contactspline::testing

int main(int argc, char** argv) try {
  using namespace contactspline::testing;
  if (argc != 3) return 2;
  if (argv[1] == std::string("clap")) {
    ClapPlugin plugin(argv[2], 48000);
    run(plugin);
  } else {
    Vst3Plugin plugin(argv[2], 48000);
    run(plugin);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
