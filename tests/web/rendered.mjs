// SPDX-License-Identifier: MIT
// Samples of `contactspline render`, to compare with.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const kDuration_s = 0.2, kLong_s = 0.6; // the program fades out at the end
const kGain = 1 / 100; // -40 dB, so that nothing reaches the full scale of the file

/** Samples of a blow, of which the program does not fade the last. */
export const kSamples = 8190;

/** The sound of a file by the program, of full scale: 24 bits, each channel by itself. */
function renderedFile(program, name, content, options) {
  const folder = mkdtempSync(join(tmpdir(), "contactspline-rendered-"));
  try {
    const [file, sound] = [name, "sound.wav"].map((name) => join(folder, name));
    writeFileSync(file, content);
    execFileSync(program, ["render", file, "-o", sound, "--no-figure", "--force", ...options], { stdio: "ignore" });
    const bytes = readFileSync(sound);
    const begin = bytes.indexOf("data", 12, "latin1") + 8;
    const channels = bytes.readUInt16LE(22);
    const sample = (i, channel) => bytes.readIntLE(begin + 3 * (channels * i + channel), 3) / 2 ** 23;
    const samples = Math.floor(bytes.readUInt32LE(begin - 4) / 3 / channels);
    return Array.from({ length: channels }, (_, channel) => Array.from({ length: samples }, (_, i) => sample(i, channel)));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** The sound of a score by the program [m/s or N]. */
export function renderedScore(program, score, channels, samples = kSamples) {
  const duration_s = samples > kSamples ? kLong_s : kDuration_s;
  const sound = renderedFile(program, "score.json", JSON.stringify({ ...score, duration_s }), ["--gain", "-40"]);
  assert.ok(sound.length >= channels, "channels");
  return sound.map((channel) => channel.slice(0, samples).map((x) => x / kGain));
}

/** The sound of a MIDI file, or of these channels, on an instrument, in single precision, of this full scale [m/s or N]. */
export const renderedMidi = (program, bytes, instrument, fullScale, channels = []) =>
  renderedFile(program, "song.mid", bytes, ["--gain", String(-20 * Math.log10(fullScale)), "--precision", "single", "--tail", "1", "--instrument", instrument,
    ...channels.flatMap((channel) => ["--channel", String(channel)])]);

/** The first output after an event, of a score with more keys. */
export function rendered(program, instrument, event, value, more = {}, samples = kSamples) {
  return renderedScore(program, { instrument, description: "a blow", events: [{ time_s: 0, [event]: value }], ...more }, 1, samples)[0];
}

/** The emitted file of what ships. */
export const emitted = (program, name) =>
  JSON.parse(execFileSync(program, ["generate", name, "--emit", "json", "-o", "-"], { maxBuffer: 2 ** 24, stdio: ["ignore", "pipe", "ignore"] }));

/** What the engine plays as 1, by the emitted file [m/s or N]. */
export const fullScaleOf = (program, name) => emitted(program, name).outputs[0].full_scale;

/** Asserts that samples are those expected, but for single precision: 8190 roundings of 6e-8 each, which a contact may
 * magnify. Returns the largest difference, over the peak. */
export function assertEqualSound(name, actual, expected, bound = 1e-3) {
  const largest = (list) => list.reduce((max, x) => Math.max(max, Math.abs(x)), 0);
  const peak = largest(expected);
  const worst = largest(expected.map((x, i) => x - actual[i])) / peak;
  assert.ok(actual.length === expected.length && peak > 0 && worst < bound, `${name}: ${worst} of the peak ${peak} apart`);
  assert.ok(actual.every(Number.isFinite));
  return worst;
}
