// SPDX-License-Identifier: MIT
// The frequency of a partial, measured from samples.

/** Magnitude at a frequency [Hz] of samples under a window. */
function magnitude(windowed, sampleRate, frequency) {
  const step = (2 * Math.PI * frequency) / sampleRate;
  const [c, s] = [Math.cos(step), Math.sin(step)];
  let [x, y, real, imaginary] = [1, 0, 0, 0]; // x + iy: e^(i step n)
  for (const value of windowed) {
    real += value * x;
    imaginary += value * y;
    [x, y] = [x * c - y * s, x * s + y * c];
  }
  return Math.hypot(real, imaginary);
}

/** The frequency [Hz] of the highest peak within 60 cents of an expected one, under a Hann window. Throws if there is no sound or no peak. */
export function partialNear(samples, sampleRate, expected) {
  const windowed = samples.map((value, i) => value * (1 - Math.cos((2 * Math.PI * i) / samples.length)));
  const at = (cents) => magnitude(windowed, sampleRate, expected * 2 ** (cents / 1200));
  let best = 0;
  for (let cents = -60; cents <= 60; cents += 2) if (at(cents) > at(best)) best = cents;
  if (Math.abs(best) >= 60 || !(at(best) > 1e-3)) throw new Error(`no partial near ${expected} Hz`);
  const [before, peak, after] = [best - 2, best, best + 2].map((cents) => Math.log(at(cents)));
  return expected * 2 ** ((best + (2 * (before - after)) / (2 * (before - 2 * peak + after))) / 1200);
}
