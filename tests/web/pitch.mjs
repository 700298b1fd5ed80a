// SPDX-License-Identifier: MIT
// The frequency of a partial, measured from samples.

/** Magnitude of the spectrum at a frequency [Hz], under a Hann window. */
function magnitude(samples, sampleRate, frequency) {
  let real = 0;
  let imaginary = 0;
  const step = (2 * Math.PI * frequency) / sampleRate;
  samples.forEach((value, i) => {
    const windowed = value * (1 - Math.cos((2 * Math.PI * i) / samples.length));
    real += windowed * Math.cos(step * i);
    imaginary += windowed * Math.sin(step * i);
  });
  return Math.hypot(real, imaginary);
}

/** The frequency [Hz] of the highest peak within 60 cents of an expected one. Throws if there is no sound or no peak. */
export function partialNear(samples, sampleRate, expected) {
  const at = (cents) => magnitude(samples, sampleRate, expected * 2 ** (cents / 1200));
  let best = 0;
  for (let cents = -60; cents <= 60; cents += 2) if (at(cents) > at(best)) best = cents;
  if (Math.abs(best) >= 60 || !(at(best) > 1e-3)) throw new Error(`no partial near ${expected} Hz`);
  const [before, peak, after] = [best - 2, best, best + 2].map((cents) => Math.log(at(cents)));
  return expected * 2 ** ((best + (2 * (before - after)) / (2 * (before - 2 * peak + after))) / 1200);
}
