// SPDX-License-Identifier: MIT
// The class of a plug-in is one in all formats, with the functions for states that CLAP asks for: so each instrument
// is compiled once. LV2 and VST3 save parameters without states. Their sides of a plug-in include this first.
#pragma once

#include <DistrhoPlugin.hpp>

#ifndef DISTRHO_PLUGIN_TARGET_CLAP
#undef DISTRHO_PLUGIN_WANT_STATE
#define DISTRHO_PLUGIN_WANT_STATE 0

START_NAMESPACE_DISTRHO
inline void Plugin::initState(uint32_t, State&) {}
inline void Plugin::setState(const char*, const char*) {}
END_NAMESPACE_DISTRHO
#endif
