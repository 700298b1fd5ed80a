// SPDX-License-Identifier: MIT
// The instruments of the page: what they are called, which of their outputs sounds, what a key does.

/** The keyboard by the C++ runtime, and the Faust programs. `output`: the one that sounds, with its `gain`. */
export const kInstruments = {
  keyboard: { title: "Hammer and string, your material", by: "C++" },
  piano: { title: "Piano, 88 keys", by: "Faust", voices: 8, gain: 1 },
  hammer_string: { title: "Hammer and string, C4", by: "Faust", button: "strike", output: 0, force: 1, gain: 0.4 },
  mass_barrier: { title: "Mass at a barrier", by: "Faust", button: "throw", output: 1, force: 1, gain: 0.02 },
  slide_string: { title: "Slide guitar", by: "Faust", button: "pluck", output: 0, force: 1, gain: 15 },
  fret_string: { title: "String buzzing at a fret", by: "Faust", button: "pluck", output: 0, force: 1, gain: 1.5 },
};

/** Controls of the keyboard by the C++ runtime. They act at the next strike. */
export const kKeyboardControls = [
  { label: "speed", unit: "m/s", min: 0.1, max: 8, step: 0.01, init: 2.5, isLogarithmic: true },
  { label: "stiffness ratio", unit: "", min: 0.01, max: 1000, step: 0.001, init: 1, isLogarithmic: true },
  { label: "mass ratio", unit: "", min: 0.25, max: 4, step: 0.001, init: 1, isLogarithmic: true },
  { label: "strike position", unit: "of length", min: 0.02, max: 0.5, step: 0.001, init: 0.12 },
];

/** The frequency of a MIDI key [Hz]. */
export const frequencyOf = (key) => 440 * 2 ** ((key - 69) / 12);
