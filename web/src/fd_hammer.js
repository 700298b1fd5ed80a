// SPDX-License-Identifier: MIT
// The strike of the comparison by Faust's fd.hammer (bench/baselines/fd_hammer_c4.dsp), and where its energy is.
import { startProgram } from "./faust_program.js";

const kMass = 0.00297; // [kg] these numbers are those of the program
const kStiffness = 4.5e9, kExponent = 2.5;
const kSpeed = 2.5; // [m/s]
const kStart = 1e-4; // [m] below the string

/** The displacement of the string where it is struck [m], for so many seconds. program: { module, description, sampleRate }. */
export function renderFd({ module, description, sampleRate }, ratio, seconds) {
  const program = startProgram(module, description, sampleRate);
  const samples = Math.round(seconds * sampleRate);
  program.set("stiffness ratio", ratio);
  program.set("strike", 1);
  const out = new Float32Array(samples);
  for (let i = 0; i < samples; i += 128) {
    const count = Math.min(128, samples - i);
    out.set(program.process(count)[0].subarray(0, count), i);
  }
  return out;
}

/** The energy [J] of hammer, felt and all that the string was given, after each sample, by the displacement of the string where
 * it is struck. The hammer is followed by the recursion of fd.hammer, whose force is that of the sample before. What it takes from
 * the hammer and gives to the string is counted as that scheme moves both, so that only the felt can bring energy from nothing. */
export function energiesFd(displacement, ratio, sampleRate) {
  const step = 1 / sampleRate;
  const stiffness = ratio * kStiffness;
  const force = (y) => (y > 0 ? stiffness * y ** kExponent : 0);
  const stored = (y) => (y > 0 ? (stiffness * y ** (kExponent + 1)) / (kExponent + 1) : 0);
  let [before, now, given] = [-kStart, kSpeed * step - kStart, 0]; // of the hammer
  const all = new Float64Array(displacement.length - 1);
  for (let n = 0; n < all.length; ++n) {
    const y = now - displacement[n];
    const next = 2 * now - before - (step ** 2 * force(y)) / kMass;
    given += (force(y) * (displacement[n + 1] - (displacement[n - 1] ?? 0))) / 2;
    [before, now] = [now, next];
    all[n] = (kMass * ((next - before) / step) ** 2) / 2 + (stored(y) + stored(next - displacement[n + 1])) / 2 + given;
  }
  return all;
}
