// SPDX-License-Identifier: MIT
// The VST3 side of a plug-in. In version 1.6 of the framework the MIDI controllers end one parameter too late, so
// hosts can neither read nor set the first parameter of an instrument (github.com/DISTRHO/DPF, issue 442).
#include <src/DistrhoPluginVST.hpp>

#define kVst3InternalParameterMidiCC_end (kVst3InternalParameterMidiCC_start + 130 * 16 - 1)

#include <DistrhoPluginMain.cpp>
