// SPDX-License-Identifier: MIT
// The same strike by Faust's fd.hammer and by the contact step, side by side.
import { jsonAsset, moduleAsset } from "./assets.js";
import { readable, slider } from "./controls.js";
import { startProgram } from "./faust_program.js";
import { linePlot } from "./plots.js";

const kShown = 0.008; // seconds
const kHeard = 1.5;
const kBound = 0.05; // metres: no string swings so far
const kPeak = 0.2; // of full scale: both play equally loud

const byId = (id) => document.getElementById(id);

/** The displacement [m] by fd.hammer, of so many samples. */
function renderFd(module, description, stiffness, samples, sampleRate) {
  const program = startProgram(module, description, sampleRate);
  program.set("stiffness ratio", stiffness);
  program.set("strike", 1);
  const out = new Float32Array(samples);
  for (let i = 0; i < samples; i += 128) {
    const count = Math.min(128, samples - i);
    out.set(program.process(count)[0].subarray(0, count), i);
  }
  return out;
}

/** What a displacement tells: its peak [m], or that it grew beyond all bounds. */
function verdict(samples, bound) {
  let peak = 0;
  for (const value of samples) {
    if (!Number.isFinite(value) || Math.abs(value) > bound) return { peak: Infinity, bounded: false };
    peak = Math.max(peak, Math.abs(value));
  }
  return { peak, bounded: true };
}

// As sound, up to where it leaves a bound: without the slow parts below 60 Hz, for which speakers are not made.
function audible(samples, bound) {
  const end = samples.findIndex((value) => !(Math.abs(value) < bound));
  const out = new Float32Array(end < 0 ? samples : samples.slice(0, end));
  let slow = 0;
  for (let i = 0; i < out.length; ++i) {
    slow += 0.008 * (out[i] - slow);
    out[i] -= slow;
  }
  return out;
}

const peakOf = (samples) => samples.reduce((peak, value) => Math.max(peak, Math.abs(value)), 0);

export class Comparison {
  /** reference: studies whose material is felt_c4. play(samples) sounds; change() after each new stiffness. */
  constructor(reference, sampleRate, play, change) {
    Object.assign(this, { reference, sampleRate, change });
    this.plot = linePlot(byId("comparison"), {
      x: "time [ms]",
      y: "displacement [mm]",
      height: 280,
      lines: [{ label: "contact step", colour: "blue", width: 3 }, { label: "fd.hammer", colour: "orange", dash: [6, 3] }],
    });
    this.stiffness = slider({ label: "stiffness ratio", min: 0.1, max: 1000, init: 1, isLogarithmic: true }, () => {
      this.draw();
      change();
    });
    byId("compare-controls").append(this.stiffness.box);
    byId("play-ours").addEventListener("click", () => play(this.levelled(this.ours(kHeard)).samples));
    byId("play-fd").addEventListener("click", () => play(this.levelled(this.theirs(kHeard)).samples));
  }

  setStiffness(ratio) {
    this.stiffness.set(ratio);
    this.draw();
  }

  async load() {
    this.description = await jsonAsset("fd_hammer_c4-json");
    this.module = await moduleAsset("fd_hammer_c4-wasm");
    this.draw();
  }

  /** As sound with the peak kPeak; peak: before that [m]. */
  levelled(displacement) {
    const samples = audible(displacement, kBound);
    const peak = peakOf(samples);
    return { peak, samples: samples.map((value) => (value * kPeak) / Math.max(peak, 1e-30)) };
  }

  ours(seconds) {
    return this.reference.strikeC4(this.stiffness.get(), Math.round(seconds * this.sampleRate));
  }

  theirs(seconds) {
    return renderFd(this.module, this.description, this.stiffness.get(), Math.round(seconds * this.sampleRate), this.sampleRate);
  }

  draw() {
    if (!this.module) return; // a link may set the stiffness before it is loaded
    const ours = this.ours(0.25);
    const theirs = this.theirs(0.25);
    const samples = Math.round(kShown * this.sampleRate);
    const shown = (list) => Array.from(list.slice(0, samples), (value) => (Math.abs(value) < kBound ? 1000 * value : null));
    this.plot.set([Array.from({ length: samples }, (_, i) => (1000 * i) / this.sampleRate), shown(ours), shown(theirs)]);
    const us = verdict(ours, kBound);
    const them = verdict(theirs, kBound);
    const told = them.bounded ? `a peak of ${readable(1000 * them.peak)} mm` : "no bound: it has become unstable";
    const louder = 20 * Math.log10(this.levelled(theirs).peak / this.levelled(ours).peak);
    const turned = louder > 1 ? ` To play as loud, it is turned down by ${louder.toFixed(0)} dB.` : "";
    byId("compare-note").textContent = `Contact step: a peak of ${readable(1000 * us.peak)} mm. fd.hammer: ${told}.${turned}`;
    this.verdict = { ours: us, fd: them };
  }
}
