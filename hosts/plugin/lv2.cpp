// SPDX-License-Identifier: MIT
// The LV2 side of a plug-in. Version 1.6 of the framework refuses a host without the feature `options`, which tells
// the length of blocks. These plug-ins play blocks of any length and do not need it.
#include "without_states.hpp"
static_assert(!DISTRHO_PLUGIN_WANT_STATE, "the includes below see no states");

#include <src/lv2/buf-size.h>
#include <src/lv2/lv2.h>
#include <src/lv2/options.h>

#include <cstdint>
#include <cstring>
#include <src/DistrhoPluginInternal.hpp>
#include <vector>

START_NAMESPACE_DISTRHO
static LV2_Handle lv2_instantiate(const LV2_Descriptor*, double, const char*, const LV2_Feature* const*);
END_NAMESPACE_DISTRHO

// Renames the framework's function, but not where its address is taken.
#define lv2_instantiate(...) lv2_instantiate_of_framework(__VA_ARGS__)
#include <DistrhoPluginMain.cpp>
#undef lv2_instantiate

START_NAMESPACE_DISTRHO
static LV2_Handle lv2_instantiate(const LV2_Descriptor* descriptor, double sample_rate_hz, const char* bundle,
                                  const LV2_Feature* const* features) {
  const LV2_URID_Map* map = nullptr;
  std::vector<const LV2_Feature*> all;
  for (; *features != nullptr; ++features) {
    const char* const uri = (*features)->URI;
    if (std::strcmp(uri, LV2_URID__map) == 0) map = static_cast<const LV2_URID_Map*>((*features)->data);
    if (std::strcmp(uri, LV2_OPTIONS__options) != 0 || (*features)->data != nullptr) all.push_back(*features);
  }
  if (map == nullptr) return nullptr;
  // Where the host has options, too, the framework takes the last ones: these stand first.
  const auto urid = [&](const char* uri) { return map->map(map->handle, uri); };
  const std::int32_t samples = 8192;
  LV2_Options_Option options[] = {
      {LV2_OPTIONS_INSTANCE, 0, urid(LV2_BUF_SIZE__maxBlockLength), sizeof samples, urid(LV2_ATOM__Int), &samples},
      {}};
  const LV2_Feature block_length = {LV2_OPTIONS__options, options};
  all.insert(all.begin(), &block_length);
  all.push_back(nullptr);
  return lv2_instantiate_of_framework(descriptor, sample_rate_hz, bundle, all.data());
}
END_NAMESPACE_DISTRHO
