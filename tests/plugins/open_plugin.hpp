// SPDX-License-Identifier: MIT
// The plug-ins of the build tree in hosts of each format.
#pragma once

#include "plugins/agreement.hpp"
#include "plugins/clap_host.hpp"
#include "plugins/lv2_plugin.hpp"
#include "plugins/vst3_host.hpp"

namespace contactspline::testing {

/// All LV2 plug-ins: reading their descriptions takes most of a host's time.
inline const Lv2World& world() {
  static const Lv2World world;
  return world;
}

/// format: clap, vst3 or lv2; name: of an instrument that ships.
inline std::unique_ptr<HostedPlugin> open_plugin(const std::string& format, const std::string& name,
                                                 double sample_rate_hz) {
  const std::string plugin = "contactspline_" + name;
  const std::filesystem::path folder = PLUGINS;
  if (format == "clap") return std::make_unique<ClapPlugin>(folder / "clap" / (plugin + ".clap"), sample_rate_hz);
  if (format == "lv2") return std::make_unique<Lv2Plugin>(world(), "urn:contactspline:" + plugin, sample_rate_hz);
  return std::make_unique<Vst3Plugin>(
      folder / "vst3" / (plugin + ".vst3") / "Contents" / VST3_FOLDER / (plugin + ".so"), sample_rate_hz);
}

}  // namespace contactspline::testing
