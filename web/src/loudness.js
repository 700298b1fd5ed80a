// SPDX-License-Identifier: MIT
// How loud a sound is, and by how much pieces are turned up or down so that all are equally loud (web/levels.mjs).

const kPoles = [20.598997, 20.598997, 107.65265, 737.86223]; // Hz: A-weighting of IEC 61672-1
const kUpperPoles = [12194.217, 12194.217];
const kPart = 0.4; // seconds
const kGate = 10; // dB: parts that are so much below the mean count as silence
const kMostPeak = 0.6; // of full scale: a piece is not turned up further
const kApart = 1; // dB: pieces with high peaks may be softer by so much, and by what the limiter takes

const decibels = (power) => 10 * Math.log10(power);

// A section of first order by the bilinear transform: high is s/(s + w), else w/(s + w).
function section(samples, frequency, sampleRate, isHigh) {
  const w = Math.tan((Math.PI * frequency) / sampleRate);
  const [gain, feedback, sign] = [(isHigh ? 1 : w) / (1 + w), (1 - w) / (1 + w), isHigh ? -1 : 1];
  let [x1, y1] = [0, 0];
  return samples.map((x) => {
    y1 = gain * (x + sign * x1) + feedback * y1;
    x1 = x;
    return y1;
  });
}

function weighted(samples, sampleRate) {
  const high = kPoles.reduce((sound, pole) => section(sound, pole, sampleRate, true), Float64Array.from(samples));
  return kUpperPoles.reduce((sound, pole) => section(sound, pole, sampleRate, false), high);
}

/** The A-weighted level of a sound of any channels [dB of full scale]: the mean power of parts of 0.4 s, without silence. */
export function loudnessOf(channels, sampleRate) {
  const size = Math.round(kPart * sampleRate);
  const parts = [];
  for (const sound of channels.map((channel) => weighted(channel, sampleRate)))
    sound.forEach((x, i) => (parts[Math.floor(i / size)] = (parts[Math.floor(i / size)] ?? 0) + x * x / size));
  const mean = (powers) => powers.reduce((sum, power) => sum + power, 0) / powers.length;
  const heard = parts.filter((power) => decibels(power) > decibels(mean(parts)) - kGate);
  return decibels(mean(heard)) + 2; // 0 dB at 1 kHz
}

/** The gains of pieces [dB], by { name: { loudness, peak } } as they are without: all as loud as the highest peak allows, but
 * pieces with high peaks up to 1 dB softer. */
export function gainsOf(pieces) {
  const all = Object.entries(pieces).map(([name, { loudness, peak }]) => ({ name, loudness, room: decibels((kMostPeak / peak) ** 2) }));
  const goal = Math.min(...all.map(({ loudness, room }) => loudness + room)) + kApart;
  return Object.fromEntries(all.map(({ name, loudness, room }) => [name, Number(Math.min(goal - loudness, room).toFixed(2))]));
}
