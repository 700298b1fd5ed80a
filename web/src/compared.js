// SPDX-License-Identifier: MIT
// What two strikes of the comparison tell and sound like, also for the thread of worker.js.

const kBound = 0.05; // metres: no string swings so far
const kPeak = 0.2; // of full scale: both play equally loud

/** What a displacement tells: its peak [m], or that it grew beyond all bounds. */
function verdict(samples) {
  let peak = 0;
  for (const value of samples) {
    if (!Number.isFinite(value) || Math.abs(value) > kBound) return { peak: Infinity, bounded: false };
    peak = Math.max(peak, Math.abs(value));
  }
  return { peak, bounded: true };
}

// As sound, up to where it leaves its bound: without the slow parts below 60 Hz, for which speakers are not made.
function audible(samples) {
  const end = samples.findIndex((value) => !(Math.abs(value) < kBound));
  const out = new Float32Array(end < 0 ? samples : samples.slice(0, end));
  let slow = 0;
  for (let i = 0; i < out.length; ++i) {
    slow += 0.008 * (out[i] - slow);
    out[i] -= slow;
  }
  return out;
}

/** As sound with the peak kPeak; peak: before that [m]. */
export function levelled(displacement) {
  const samples = audible(displacement);
  const peak = samples.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  return { peak, samples: samples.map((value) => (value * kPeak) / Math.max(peak, 1e-30)) };
}

/** Of both strikes: their first samples for a plot [ms, mm], what they tell, and by how many dB theirs is louder. */
export function compared({ ours, theirs }, samples, sampleRate) {
  const shown = (list) => Array.from(list.subarray(0, samples), (value) => (Math.abs(value) < kBound ? 1000 * value : null));
  const louder = 20 * Math.log10(levelled(theirs).peak / levelled(ours).peak);
  return { data: [Array.from({ length: samples }, (_, i) => (1000 * i) / sampleRate), shown(ours), shown(theirs)], us: verdict(ours), them: verdict(theirs), louder };
}
