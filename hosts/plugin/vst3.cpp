// SPDX-License-Identifier: MIT
// The VST3 side of a plug-in. contactspline_plugin() makes instrument_vst3.cpp of the framework's source and of
// instrument_vst3.hpp.
#include "without_states.hpp"
static_assert(!DISTRHO_PLUGIN_WANT_STATE, "the includes below see no states");

#include <src/DistrhoPlugin.cpp>

#include "instrument_vst3.cpp"

#define DISTRHO_IS_STANDALONE 0
#include <src/DistrhoUtils.cpp>
