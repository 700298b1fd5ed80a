// SPDX-License-Identifier: MIT
// What keeps the sound within full scale.

/** Up to this level a sample stays as it is. */
export const kLinear = 0.5;

/** A sample within -1 to 1: beyond kLinear it bends, without a corner. What is no number becomes 0. */
export function limited(sample) {
  const size = Math.abs(sample);
  if (size <= kLinear) return sample;
  return Math.sign(sample) * (kLinear + (1 - kLinear) * Math.tanh((size - kLinear) / (1 - kLinear))) || 0;
}
