// SPDX-License-Identifier: MIT
// play_plugin clap|vst3|lv2 FILE_OR_URI: fails unless one of the keys from 60 on sounds in a host.
#include <cmath>
#include <cstdio>

#include "plugins/clap_host.hpp"
#include "plugins/lv2_plugin.hpp"
#include "plugins/vst3_host.hpp"

int main(int argc, char** argv) try {
  using namespace contactspline::testing;
  if (argc != 3) return 2;
  const std::string format = argv[1], place = argv[2];
  const Lv2World world;
  std::unique_ptr<HostedPlugin> plugin;
  if (format == "clap")
    plugin = std::make_unique<ClapPlugin>(place, 48000);
  else if (format == "vst3")
    plugin = std::make_unique<Vst3Plugin>(place, 48000);
  else
    plugin = std::make_unique<Lv2Plugin>(world, place, 48000);
  for (std::uint8_t key = 60; key < 70; ++key) plugin->send(key, {0x90, key, 100});
  float peak = 0;
  for (const auto& side : plugin->run(40))
    for (const float sample : side) peak = std::isfinite(sample) ? std::max(peak, std::abs(sample)) : 1e30f;
  std::printf("largest sample %g\n", static_cast<double>(peak));
  return peak > 1e-4f && peak < 100 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
