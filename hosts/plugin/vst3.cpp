// SPDX-License-Identifier: MIT
// The VST3 side of a plug-in. contactspline_plugin() makes instrument_vst3.cpp of the framework's source and of
// instrument_vst3.hpp.
#include <src/DistrhoPlugin.cpp>

#include "instrument_vst3.cpp"

#define DISTRHO_IS_STANDALONE 0
#include <src/DistrhoUtils.cpp>
