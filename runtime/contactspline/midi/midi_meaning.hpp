// SPDX-License-Identifier: MIT
// What each controller, registered parameter and universal message of MIDI does: the one list, which MidiInterpreter
// obeys and docs/how-to/midi.md shows.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace contactspline {

/// The controllers of pedals.
inline constexpr int kSustainPedal = 64, kSostenutoPedal = 66, kSoftPedal = 67;
inline constexpr std::array kMidiPedals = {kSustainPedal, kSostenutoPedal, kSoftPedal};

/// The controller of brightness, which MPE gives to each note.
inline constexpr int kBrightnessController = 74;

/// The place of a controller among kMidiPedals; behind the last where it is none.
[[nodiscard]] constexpr std::size_t midi_pedal(int controller) {
  return static_cast<std::size_t>(std::ranges::find(kMidiPedals, controller) - kMidiPedals.begin());
}

/// Is a parameter one of the performance, a pedal or the bend, which a program leaves where it is?
[[nodiscard]] constexpr bool is_of_performance(std::string_view parameter, int controller) {
  return midi_pedal(controller) < kMidiPedals.size() || parameter == "bend_cents";
}

/// What a controller is for.
enum class MidiControl {
  kParameter,
  kPedal,
  kSwitch,
  kDataHigh,
  kDataLow,
  kIncrement,
  kDecrement,
  kVelocityLow,
  kUnregistered,
  kRegisteredLow,
  kRegisteredHigh,
  kSoundOff,
  kReset,
  kNotesOff
};

/// A row of the list: the first and last number that it is for.
template <typename Meaning>
struct MidiRow {
  int first, last;
  Meaning meaning;
  std::string_view name, effect;
};

inline constexpr auto kMidiControllers = std::to_array<MidiRow<MidiControl>>({
    {1, 1, MidiControl::kParameter, "modulation", "moves the parameter that has it"},
    {2, 2, MidiControl::kParameter, "breath", "moves the parameter that has it"},
    {6, 6, MidiControl::kDataHigh, "data entry", "sets the registered parameter, and its low byte to 0"},
    {7, 7, MidiControl::kParameter, "volume", "moves the parameter that has it; in plug-ins their volume"},
    {10, 10, MidiControl::kParameter, "pan", "moves the parameter that has it"},
    {11, 11, MidiControl::kParameter, "expression", "moves the parameter that has it"},
    {38, 38, MidiControl::kDataLow, "data entry, low byte", "sets the low byte of the registered parameter"},
    {kSustainPedal, kSustainPedal, MidiControl::kPedal, "sustain pedal",
     "down from 64 on; value/64 of the way below"},
    {kSostenutoPedal, kSostenutoPedal, MidiControl::kSwitch, "sostenuto pedal", "down from 64 on, else up"},
    {kSoftPedal, kSoftPedal, MidiControl::kPedal, "soft pedal", "down from 64 on; value/64 of the way below"},
    {kBrightnessController, kBrightnessController, MidiControl::kParameter, "brightness",
     "moves the parameter that has it: the stiffness of felts; in an MPE zone that of the note"},
    {88, 88, MidiControl::kVelocityLow, "velocity, low byte", "adds value/128 to the velocity of the next note"},
    {96, 96, MidiControl::kIncrement, "increment",
     "registered parameter + 1 in its low byte; parameter 2: a semitone"},
    {97, 97, MidiControl::kDecrement, "decrement", "the same downwards"},
    {98, 99, MidiControl::kUnregistered, "unregistered parameter", "ends the choice of a registered parameter"},
    {100, 100, MidiControl::kRegisteredLow, "registered parameter, low byte", "chooses it; 127 chooses none"},
    {101, 101, MidiControl::kRegisteredHigh, "registered parameter", "chooses it; 127 chooses none"},
    {120, 120, MidiControl::kSoundOff, "all sound off",
     "silences the instrument; in a file where others sound, "
     "lets the keys of its channel go"},
    {121, 121, MidiControl::kReset, "reset all controllers",
     "wheel to its centre, pedals up, modulation 0, expression 127, pressure as at first, no registered parameter "
     "chosen"},
    {123, 127, MidiControl::kNotesOff, "all notes off, modes",
     "lets the keys of its channel go, as the pedals allow; "
     "modes do no more"},
});

/// What a registered parameter is for.
enum class MidiTuning { kBendRange, kFine, kCoarse, kModulationRange, kZone };

inline constexpr auto kMidiRegistered = std::to_array<MidiRow<MidiTuning>>({
    {0, 0, MidiTuning::kBendRange, "bend range", "semitones, and cents in the low byte; 2 semitones at first"},
    {1, 1, MidiTuning::kFine, "fine tuning", "8192 is 0, 16383 nearly 100 cents"},
    {2, 2, MidiTuning::kCoarse, "coarse tuning", "64 is 0, 66 two semitones up"},
    {5, 5, MidiTuning::kModulationRange, "modulation depth", "kept; no instrument has a vibrato of MIDI"},
    {6, 6, MidiTuning::kZone, "MPE zone",
     "on channel 1 or 16: so many member channels, each with a bend range of 48 semitones; 0 ends the zone"},
});

/// A message that is neither, in words only.
struct MidiWords {
  std::string_view name, effect;
};

inline constexpr auto kMidiOthers = std::to_array<MidiWords>({
    {"note on", "strikes the key; at velocity 0 lets it go"},
    {"note off",
     "ends the note of that key and channel that began first; its velocity moves the damper of a keyboard: "
     "64 and 0 at its own pace, 127 four times as fast, 1 four times as slow"},
    {"pitch wheel",
     "bends what its channel plays by the bend range, in an MPE zone beside that of the first channel"},
    {"pressure of a key or channel",
     "moves the parameter that has it, as the force of a bow; of a key, or in an MPE zone, that of the note alone, "
     "where each has a voice"},
    {"program", "loads the preset of its number, counted from 0, if there is one; pedals and bends stay"},
    {"master fine and coarse tuning", "universal, real time: tunes all"},
    {"single-note tuning",
     "universal, with or without a bank: tunes keys from their next note on, whatever the program"},
    {"bulk tuning", "universal, with or without a bank: the same for all 128 keys"},
    {"system reset, GM on and off", "silences, and brings all channels and tunings to their beginning"},
    {"all other messages", "nothing"},
});

/// The row for a number, or null.
template <typename Rows>
[[nodiscard]] constexpr const typename Rows::value_type* midi_row(const Rows& rows, int number) {
  const auto found = std::ranges::find_if(rows, [=](const auto& r) { return r.first <= number && number <= r.last; });
  return found == rows.end() ? nullptr : &*found;
}

}  // namespace contactspline
