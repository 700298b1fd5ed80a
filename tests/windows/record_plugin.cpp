// SPDX-License-Identifier: MIT
// record_plugin clap|vst3|lv2 FILE SOUND: a phrase of a second at 48 kHz, played by a plug-in of this system, as
// bytes of single precision, left and right in turn. A CLAP is then restarted 2000 times, as hosts do between songs:
// its thread must end at whatever moment it is told to.
#include <cstdio>
#include <fstream>

#include "plugins/clap_host.hpp"
#include "plugins/vst3_host.hpp"
#include "windows/lv2_binary.hpp"

// Not counted here.
constinit thread_local std::size_t contactspline::testing::allocations = 0, contactspline::testing::locks = 0;

namespace contactspline::testing {
namespace {

// Notes, a parameter, two controllers, a release.
template <typename Plugin>
void record(Plugin& plugin, const std::filesystem::path& sound) {
  std::ofstream file(sound, std::ios::binary);
  const auto play = [&](std::size_t blocks) {
    const auto [left, right] = plugin.run(blocks);
    for (std::size_t n = 0; n < left.size(); ++n) {
      file.write(reinterpret_cast<const char*>(&left[n]), sizeof left[n]);
      file.write(reinterpret_cast<const char*>(&right[n]), sizeof right[n]);
    }
  };
  plugin.send(37, {0x90, 60, 90});
  play(60);
  plugin.set("volume", 0.8);
  plugin.send(5, {0x90, 64, 120});
  plugin.send(200, {0xb0, 64, 127});
  play(60);
  plugin.send(0, {0x80, 60, 0});
  plugin.send(100, {0x90, 67, 30});
  play(60);
  plugin.send(0, {0xb0, 64, 0});
  plugin.send(1, {0x80, 67, 0});
  play(8);
  if (!file.flush()) throw std::runtime_error(sound.string() + ": cannot be written");
}

}  // namespace
}  // namespace contactspline::testing

int main(int argc, char** argv) try {
  using namespace contactspline::testing;
  if (argc != 4) return 2;
  const std::string format = argv[1];
  constexpr double kRate = 48000;
  if (format == "clap") {
    ClapPlugin plugin(argv[2], kRate);
    record(plugin, argv[3]);
    for (int i = 0; i < 2000; ++i) plugin.restart(kRate);
  } else if (format == "vst3") {
    Vst3Plugin plugin(argv[2], kRate);
    record(plugin, argv[3]);
  } else {
    Lv2Binary plugin(argv[2], kRate);
    record(plugin, argv[3]);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
