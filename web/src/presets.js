// SPDX-License-Identifier: MIT
// Sounds to start from.

const keys = (material, controls = {}) => ({ instrument: "hammer_on_string", material: { name: material }, controls });
const other = (instrument, controls = {}) => ({ instrument, material: { name: "felt_c4" }, controls });

export const kPresets = {
  "Piano felt": keys("felt_c4"),
  "Hard, worn felt": keys("felt_c4", { stiffness_ratio: 30, speed_m_per_s: 3 }),
  "Soft mallet": keys("felt_c2", { stiffness_ratio: 0.05, mass_ratio: 2 }),
  "Struck in the middle": keys("felt_c4", { strike_position: 0.5 }),
  "Felt over wood": keys("felt_over_wood", { speed_m_per_s: 4 }),
  "Rubber": keys("rubber_on_wood", { mass_ratio: 0.5 }),
  "Steel on steel": keys("steel_on_steel", { speed_m_per_s: 1 }),
  "Piano of 88 keys": other("piano"),
  "Bouncing mass": other("mass_barrier", { gravity_m_per_s2: 50, speed_m_per_s: 1 }),
  "Light hand on a slide": other("lap_steel", { press_gap_shift_m: -0.008, pick_release_n: 2 }),
  "Buzzing string": other("fret_guitar", { fret_gap_shift_m: -1.5e-5 }),
  "Tanpura": other("tanpura"),
  "Snare without wires": other("snare", { strainer_gap_shift_m: 0.002 }),
};
