// SPDX-License-Identifier: MIT
// The window of a plug-in. Of LV2 it is a library of its own: hosts without windows need no graphics.
#include "without_states.hpp"
static_assert(DISTRHO_PLUGIN_WANT_DIRECT_ACCESS, "a window takes its figures from the plug-in itself");

#include <DistrhoUIMain.cpp>

#include "window/instrument_ui.hpp"

#ifdef DISTRHO_PLUGIN_TARGET_LV2
#define DISTRHO_IS_STANDALONE 0
#include <src/DistrhoUtils.cpp>
#endif
