// SPDX-License-Identifier: MIT
// Sounds to start from.

const keyboard = (material, controls = {}) => ({ instrument: "keyboard", material: { name: material }, controls });
const faust = (instrument, controls = {}) => ({ instrument, material: { name: "felt_c4" }, controls });

export const kPresets = {
  "Piano felt": keyboard("felt_c4"),
  "Hard, worn felt": keyboard("felt_c4", { "stiffness ratio": 30, speed: 3 }),
  "Soft mallet": keyboard("felt_c2", { "stiffness ratio": 0.05, "mass ratio": 2 }),
  "Struck in the middle": keyboard("felt_c4", { "strike position": 0.5 }),
  "Felt over wood": keyboard("felt_over_wood", { speed: 4 }),
  "Rubber": keyboard("rubber_on_wood", { "mass ratio": 0.5 }),
  "Steel on steel": keyboard("steel_on_steel", { speed: 1 }),
  "Piano of 88 keys": faust("piano"),
  "Bouncing mass": faust("mass_barrier", { gravity: 50, speed: 1 }),
  "Slide with vibrato": faust("slide_string", { "vibrato depth": 3 }),
  "Buzzing string": faust("fret_string", { gap: 0.1 }),
};
