// SPDX-License-Identifier: MIT
// What the DISTRHO Plugin Framework asks of every plug-in. contactspline_plugin() adds name, identity and inputs.
#pragma once

// A window takes its figures from the plug-in itself, in the same process.
#define DISTRHO_PLUGIN_HAS_UI CONTACTSPLINE_HAS_WINDOW
#define DISTRHO_PLUGIN_WANT_DIRECT_ACCESS CONTACTSPLINE_HAS_WINDOW
#define DISTRHO_UI_FILE_BROWSER 0
#define DISTRHO_UI_USE_NANOVG 1
#define DISTRHO_UI_USER_RESIZABLE 1

#define DISTRHO_PLUGIN_IS_RT_SAFE 1
#define DISTRHO_PLUGIN_IS_SYNTH 1
#define DISTRHO_PLUGIN_NUM_OUTPUTS 2
#define DISTRHO_PLUGIN_WANT_PROGRAMS 1
// For CLAP. In VST3 the framework would give all parameters other numbers, in LV2 other ports: see without_states.hpp.
#define DISTRHO_PLUGIN_WANT_LATENCY 1
#define DISTRHO_PLUGIN_CLAP_FEATURES "instrument", "synthesizer", "stereo"
#define DISTRHO_PLUGIN_VST3_CATEGORIES "Instrument|Synth|Stereo"

// Parameters are all that is saved. For CLAP the framework saves nothing without this: see without_states.hpp.
#define DISTRHO_PLUGIN_WANT_STATE 1
#define DISTRHO_PLUGIN_WANT_FULL_STATE 0
