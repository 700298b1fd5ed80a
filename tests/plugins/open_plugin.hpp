// SPDX-License-Identifier: MIT
// The plug-ins of the build tree in hosts of each format.
#pragma once

#include <cmath>
#include <limits>

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

/// Signal over error in decibels; not a number where the lengths differ or a sample is none, so that no bound holds.
template <typename Expected>
double agreement_db(std::span<const float> actual, std::span<const Expected> expected) {
  if (actual.size() != expected.size()) return std::numeric_limits<double>::quiet_NaN();
  double error = 0, power = 0;
  for (std::size_t n = 0; n < expected.size(); ++n) {
    error += std::pow(static_cast<double>(actual[n]) - static_cast<double>(expected[n]), 2);
    power += std::pow(static_cast<double>(expected[n]), 2);
  }
  return 10 * std::log10(power / error);
}

}  // namespace contactspline::testing
