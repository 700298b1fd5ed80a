// SPDX-License-Identifier: MIT
// The CLAP side of a plug-in. In version 1.6 of the framework `reset` does nothing; here it silences the instrument,
// as the MIDI message "all sound off" does.
#include <src/clap/plugin.h>

#include <src/DistrhoPluginInternal.hpp>

START_NAMESPACE_DISTRHO
static CLAP_ABI void clap_plugin_reset(const clap_plugin_t* plugin);
END_NAMESPACE_DISTRHO

// Renames the framework's function, but not where its address is taken.
#define clap_plugin_reset(plugin) clap_plugin_reset_of_framework(plugin)
#include <DistrhoPluginMain.cpp>
#undef clap_plugin_reset

START_NAMESPACE_DISTRHO
// The framework passes events on with a block only: one of a sample, which nobody hears.
static CLAP_ABI void clap_plugin_reset(const clap_plugin_t* const plugin) {
  static const clap_event_midi_t all_sound_off = {
      {sizeof(clap_event_midi_t), 0, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_MIDI, 0}, 0, {0xb0, 120, 0}};
  const clap_input_events_t events = {nullptr, [](const clap_input_events_t*) -> uint32_t { return 1; },
                                      [](const clap_input_events_t*, uint32_t) { return &all_sound_off.header; }};
  float samples[DISTRHO_PLUGIN_NUM_OUTPUTS] = {};
  float* channels[] = {&samples[0], &samples[1]};
  clap_audio_buffer_t bus = {channels, nullptr, DISTRHO_PLUGIN_NUM_OUTPUTS, 0, 0};
  const clap_output_events_t none = {nullptr,
                                     [](const clap_output_events_t*, const clap_event_header_t*) { return true; }};
  const clap_process_t block = {-1, 1, nullptr, nullptr, &bus, 0, 1, &events, &none};
  clap_plugin_process(plugin, &block);
}
END_NAMESPACE_DISTRHO
