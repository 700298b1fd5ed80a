// SPDX-License-Identifier: MIT
// What takes the offset out of a sound, as of a slide that rests on its string and pulls at the bridge.

const kLowest = 8; // Hz, far below what is heard

/** A high-pass of first order, for one channel. The sound is taken to have been at its first sample for ever. */
export class Centre {
  constructor(sampleRate) {
    this.part = 1 - Math.exp((-2 * Math.PI * kLowest) / sampleRate);
    this.offset = null;
  }

  /** A sample without the offset. What is no number is left as it is. */
  next(sample) {
    if (!Number.isFinite(sample)) return sample;
    this.offset ??= sample;
    const centred = sample - this.offset;
    this.offset += this.part * centred;
    return centred;
  }
}
