// SPDX-License-Identifier: MIT
// plugin_soak STEPS [SEED] [windows]: 16 plug-ins of the build tree in one host, which opens, plays, saves, restores
// and closes them at random: an audio thread plays, the main thread does the rest. With windows, it opens, clicks and
// closes those, too, on a display of its own. Fails on a sample that is not finite. For valgrind and the sanitizers,
// and for a test.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <random>
#include <sstream>
#include <thread>

#include "plugins/open_plugin.hpp"
#include "plugins/virtual_display.hpp"
#include "support/finite.hpp"

// Not counted here: valgrind and sanitizers count.
constinit thread_local std::size_t contactspline::testing::allocations = 0, contactspline::testing::locks = 0;

namespace contactspline::testing {
namespace {

constexpr std::size_t kInstances = 16;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  std::size_t below(std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(engine_); }
  std::uint8_t byte(std::size_t end = 256) { return static_cast<std::uint8_t>(below(end)); }
  double part() { return std::uniform_real_distribution<double>(0, 1)(engine_); }

 private:
  std::mt19937 engine_;
};

struct Slot {
  std::string format;
  std::unique_ptr<HostedPlugin> plugin;         // the main thread's
  std::atomic<HostedPlugin*> played = nullptr;  // by the audio thread
  std::unique_ptr<HostWindow> window;           // in which the plug-in's is, if it is open
};

// What the audio thread does to a plug-in: events, a parameter, a block.
void play(HostedPlugin& plugin, Random& random) {
  const auto parameters = plugin.parameters();
  const HostedParameter& moved = parameters[random.below(parameters.size())];
  plugin.set(moved.name, moved.min + random.part() * (moved.max - moved.min));
  plugin.send(0, {random.byte(), random.byte(), random.byte()});
  plugin.send(0, {static_cast<std::uint8_t>(0x80 + 0x10 * random.byte(2)), random.byte(128), random.byte(128)});
  for (const auto& side : plugin.run(1, 1 + random.below(512)))
    if (!all_finite(side)) {
      std::fprintf(stderr, "a sample is not finite\n");
      std::_Exit(1);
    }
}

int soak(int steps, unsigned seed, bool has_windows) {
  const auto display = has_windows ? std::make_unique<VirtualDisplay>() : nullptr;
  std::istringstream list(CONTACTSPLINE_PLUGINS);
  const std::vector<std::string> names{std::istream_iterator<std::string>(list), {}};
  const char* const formats[] = {"clap", "vst3", "lv2"};
  (void)world();
  std::array<Slot, kInstances> slots;
  std::atomic<bool> is_over = false;
  std::atomic<std::size_t> rounds = 0;
  std::thread audio([&] {
    for (Random random(seed + 1); !is_over; ++rounds) {
      for (Slot& slot : slots)
        if (HostedPlugin* const plugin = slot.played) play(*plugin, random);
      std::this_thread::sleep_for(std::chrono::microseconds(200));  // as one that waits for its device
    }
  });
  Random random(seed);
  std::size_t opened = 0, saved = 0, windows = 0, clicks = 0;
  const auto close_window = [](Slot& slot) {
    if (!slot.window) return;
    slot.plugin->close_window();
    slot.window.reset();
  };
  // Opens, clicks or closes a window, and lets all draw.
  const auto use_windows = [&](Slot& slot) {
    if (!slot.window && slot.plugin) {
      slot.window = std::make_unique<HostWindow>(*display, 1440, 960);
      slot.plugin->open_window(slot.window->get(), 1 + 0.5 * static_cast<double>(random.below(2)));
      ++windows;
    } else if (random.below(4) == 0) {
      close_window(slot);
    } else if (slot.window) {
      for (const bool is_down : {true, false})
        slot.window->button(static_cast<int>(random.below(1440)), static_cast<int>(random.below(960)), is_down);
      ++clicks;
    }
    for (Slot& open : slots)
      if (open.window) open.plugin->idle_window();
  };
  const auto close = [&](Slot& slot) {
    close_window(slot);
    slot.played = nullptr;
    for (const std::size_t before = rounds; rounds < before + 2;)
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    slot.plugin.reset();
  };
  for (int step = 0; step < steps; ++step) {
    Slot& slot = slots[random.below(kInstances)];
    if (has_windows) use_windows(slots[random.below(kInstances)]);
    if (slot.plugin == nullptr) {
      slot.format = formats[random.below(std::size(formats))];
      slot.plugin = open_plugin(slot.format, names[random.below(names.size())], 8000 + 184000 * random.part());
      slot.played = slot.plugin.get();
      ++opened;
    } else if (random.below(4) == 0) {
      close(slot);
    } else if (slot.format != "lv2") {  // whose values are the host's
      for (const HostedParameter& parameter : slot.plugin->parameters()) (void)slot.plugin->value(parameter.name);
      slot.plugin->restore(slot.plugin->save());
      if (const std::size_t programs = slot.plugin->programs().size(); programs > 0)
        slot.plugin->load_program(random.below(programs));
      ++saved;
    }
  }
  for (Slot& slot : slots) close(slot);
  is_over = true;
  audio.join();
  std::printf(
      "%zu plug-ins opened, played and closed, %zu states saved and restored, %zu windows, %zu clicks, %zu rounds of "
      "the "
      "audio thread\n",
      opened, saved, windows, clicks, rounds.load());
  return opened > kInstances && saved > 0 && (!has_windows || clicks > 0) ? 0 : 1;
}

}  // namespace
}  // namespace contactspline::testing

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 4) return 2;
  return contactspline::testing::soak(std::atoi(argv[1]), argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1,
                                      argc == 4);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
