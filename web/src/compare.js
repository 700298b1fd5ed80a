// SPDX-License-Identifier: MIT
// The same strike by Faust's fd.hammer and by the contact step, side by side.
import { asset, jsonAsset } from "./assets.js";
import { readable, slider } from "./controls.js";
import { startProgram } from "./faust_program.js";
import { linePlot } from "./plots.js";

const kShown = 0.008; // seconds
const kHeard = 1.5;

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

// As sound: without the slow parts below 60 Hz, for which speakers are not made, and never louder than 0.9.
function audible(samples) {
  const out = new Float32Array(samples.length);
  let slow = 0;
  for (let i = 0; i < samples.length; ++i) {
    const value = Number.isFinite(samples[i]) ? samples[i] * 400 : 1;
    slow += 0.008 * (value - slow);
    out[i] = Math.max(-0.9, Math.min(0.9, value - slow));
  }
  return out;
}

export class Comparison {
  /** reference: an engine whose material is felt_c4. play(samples) sounds. */
  constructor(reference, sampleRate, play) {
    Object.assign(this, { reference, sampleRate });
    this.plot = linePlot(byId("comparison"), {
      x: "time [ms]",
      y: "displacement [mm]",
      lines: [{ label: "contact step", colour: "blue", width: 3 }, { label: "fd.hammer", colour: "orange", dash: [6, 3] }],
    });
    this.stiffness = slider({ label: "stiffness ratio", min: 0.1, max: 1000, init: 1, isLogarithmic: true }, () => this.draw());
    byId("compare-controls").append(this.stiffness.box);
    byId("play-ours").addEventListener("click", () => play(audible(this.ours(kHeard))));
    byId("play-fd").addEventListener("click", () => play(audible(this.theirs(kHeard))));
  }

  setStiffness(ratio) {
    this.stiffness.set(ratio);
    this.draw();
  }

  async load() {
    this.description = await jsonAsset("fd_hammer_c4-json");
    this.module = await WebAssembly.compile(await asset("fd_hammer_c4-wasm"));
    this.draw();
  }

  ours(seconds) {
    return this.reference.strikeC4(this.stiffness.get(), Math.round(seconds * this.sampleRate));
  }

  theirs(seconds) {
    return renderFd(this.module, this.description, this.stiffness.get(), Math.round(seconds * this.sampleRate), this.sampleRate);
  }

  draw() {
    const ours = this.ours(0.25);
    const theirs = this.theirs(0.25);
    const bound = 0.05;
    const samples = Math.round(kShown * this.sampleRate);
    const shown = (list) => Array.from(list.slice(0, samples), (value) => (Math.abs(value) < bound ? 1000 * value : null));
    this.plot.set([Array.from({ length: samples }, (_, i) => (1000 * i) / this.sampleRate), shown(ours), shown(theirs)]);
    const us = verdict(ours, bound);
    const them = verdict(theirs, bound);
    const told = them.bounded ? `a peak of ${readable(1000 * them.peak)} mm` : "no bound: it has become unstable";
    byId("compare-note").textContent = `Contact step: a peak of ${readable(1000 * us.peak)} mm. fd.hammer: ${told}.`;
    this.verdict = { ours: us, fd: them };
  }
}
