// SPDX-License-Identifier: MIT
// The class of a plug-in is one in all formats, with the functions for states and the latency that CLAP asks for: so
// each instrument is compiled once. LV2 and VST3 save parameters without states and read the latency as a parameter.
// Their sides of a plug-in include this first.
#pragma once

#include <DistrhoPlugin.hpp>

#ifndef DISTRHO_PLUGIN_TARGET_CLAP
#undef DISTRHO_PLUGIN_WANT_STATE
#undef DISTRHO_PLUGIN_WANT_LATENCY
#define DISTRHO_PLUGIN_WANT_STATE 0
#define DISTRHO_PLUGIN_WANT_LATENCY 0

START_NAMESPACE_DISTRHO
inline void Plugin::initState(uint32_t, State&) {}
inline void Plugin::setState(const char*, const char*) {}
// Not virtual: nothing else here asks for it.
[[gnu::used]] inline void Plugin::setLatency(uint32_t) noexcept {}
END_NAMESPACE_DISTRHO
#endif
