// SPDX-License-Identifier: MIT
// The same strike by Faust's fd.hammer and by the contact step, side by side.
import { readable, slider } from "./controls.js";
import { linePlot } from "./plots.js";

const kShown = 0.008; // seconds
const kHeard = 1.5;
const kPause = 0.4;
const kTold = 0.25;
const kBound = 0.05; // metres: no string swings so far
const kPeak = 0.2; // of full scale: both play equally loud

const byId = (id) => document.getElementById(id);

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
  /** background: computes both strikes (worker.js). play(samples) sounds; change() after each new stiffness. */
  constructor(background, sampleRate, play, change) {
    Object.assign(this, { background, sampleRate, change });
    this.plot = linePlot(byId("comparison"), {
      x: "time [ms]",
      y: "displacement [mm]",
      height: 280,
      lines: [{ label: "contact step", colour: "blue", width: 3 }, { label: "fd.hammer", colour: "orange", dash: [6, 3] }],
    });
    this.stiffness = slider({ label: "stiffness ratio", min: 0.1, max: 1000, init: 1000, isLogarithmic: true }, () => {
      this.draw();
      change();
    });
    byId("compare-controls").append(this.stiffness.box);
    byId("play-both").addEventListener("click", async () => play(await this.inTurn()));
  }

  setStiffness(ratio) {
    this.stiffness.set(ratio);
    this.draw();
  }

  /** As sound with the peak kPeak; peak: before that [m]. */
  levelled(displacement) {
    const samples = audible(displacement, kBound);
    const peak = peakOf(samples);
    return { peak, samples: samples.map((value) => (value * kPeak) / Math.max(peak, 1e-30)) };
  }

  /** Both strikes as long as they are heard [m]: { ours, theirs }. */
  strikes(seconds) {
    return this.background.ask("strikes", { ratio: this.stiffness.get(), seconds });
  }

  /** fd.hammer, a pause, and the contact step, as sound. */
  async inTurn() {
    const { ours, theirs } = await this.strikes(kHeard);
    const [first, second] = [theirs, ours].map((displacement) => this.levelled(displacement).samples);
    const pause = Math.round(kPause * this.sampleRate);
    const both = new Float32Array(first.length + pause + second.length);
    both.set(first);
    both.set(second, first.length + pause);
    return both;
  }

  /** The figure follows the stiffness. */
  draw() {
    this.drawn = this.background.latest("comparison", "strikes", { ratio: this.stiffness.get(), seconds: kTold }).then((both) => both && this.show(both));
  }

  show({ ours, theirs }) {
    const samples = Math.round(kShown * this.sampleRate);
    const shown = (list) => Array.from(list.subarray(0, samples), (value) => (Math.abs(value) < kBound ? 1000 * value : null));
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
