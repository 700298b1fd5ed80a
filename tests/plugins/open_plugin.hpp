// SPDX-License-Identifier: MIT
// The plug-ins of the build tree in hosts of each format.
#pragma once

#include "plugins/agreement.hpp"
#include "plugins/clap_host.hpp"
#include "plugins/lv2_plugin.hpp"
#include "plugins/vst3_host.hpp"
#include "support/compare.hpp"

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

/// The same as the host of one format has them.
inline std::unique_ptr<ClapPlugin> open_clap(const std::string& name, double sample_rate_hz = 48000) {
  auto plugin = open_plugin("clap", name, sample_rate_hz);
  return std::unique_ptr<ClapPlugin>(dynamic_cast<ClapPlugin*>(plugin.release()));
}
inline std::unique_ptr<Vst3Plugin> open_vst3(const std::string& name, double sample_rate_hz = 48000) {
  auto plugin = open_plugin("vst3", name, sample_rate_hz);
  return std::unique_ptr<Vst3Plugin>(dynamic_cast<Vst3Plugin*>(plugin.release()));
}

/// The name of an instrument and a format of its plug-in.
struct InFormat {
  std::string format, name;
  friend void PrintTo(const InFormat& plugin, std::ostream* out) { *out << plugin.format << ' ' << plugin.name; }
};

inline std::vector<InFormat> in_every_format(const std::vector<std::string>& names) {
  std::vector<InFormat> plugins;
  for (const char* format : {"clap", "vst3", "lv2"})
    for (const std::string& name : names) plugins.push_back({format, name});
  return plugins;
}

/// A test of each of several plug-ins.
class PluginTest : public ::testing::TestWithParam<InFormat> {
 public:
  static std::string name_of(const ::testing::TestParamInfo<InFormat>& test) {
    return test.param.format + "_" + test.param.name;
  }

 protected:
  [[nodiscard]] static std::unique_ptr<HostedPlugin> open(double sample_rate_hz = 48000) {
    return open_plugin(GetParam().format, GetParam().name, sample_rate_hz);
  }
};

/// What every plug-in has behind the parameters of its instrument, and behind its readings.
inline const std::vector<HostedParameter> kTuning = {{"bend range", "semitones", 0, 96, 2},
                                                     {"pitch of A4", "Hz", 380, 500, 440},
                                                     {"temperament", "", 0, 7, 0},
                                                     {"tonic", "", 0, 11, 0}};
inline const HostedParameter kOversampling = {"oversampling", "", 1, 8, 1};
inline const HostedParameter kLatency = {"latency", "samples", 0, 38, 0};

/// The parameters but the oversampling, which acts when a thread of the plug-in has prepared it.
inline std::vector<HostedParameter> prompt_parameters(const HostedPlugin& plugin) {
  auto parameters = plugin.parameters();
  std::erase_if(parameters, [](const HostedParameter& p) { return p.name == kOversampling.name; });
  return parameters;
}

/// Numbers of single precision; the product with 1000 is rounded once more.
inline void expect_list(const std::vector<HostedParameter>& actual, const std::vector<HostedParameter>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    SCOPED_TRACE(expected[i].name);
    EXPECT_EQ(actual[i].name, expected[i].name);
    EXPECT_EQ(actual[i].unit, expected[i].unit);
    EXPECT_TRUE(relatively_within(actual[i].min, expected[i].min, 2e-7));
    EXPECT_TRUE(relatively_within(actual[i].max, expected[i].max, 2e-7));
  }
}

/// The list of a plug-in at its first values.
inline void expect_parameters(HostedPlugin& plugin, const std::vector<HostedParameter>& expected) {
  const auto parameters = plugin.parameters();
  expect_list(parameters, expected);
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    EXPECT_TRUE(relatively_within(parameters[p].initial, expected[p].initial, 2e-7)) << parameters[p].name;
    EXPECT_TRUE(within(plugin.value(parameters[p].name), expected[p].initial, 2e-6)) << parameters[p].name;
  }
}

}  // namespace contactspline::testing
