// SPDX-License-Identifier: MIT
// Live figures of the model that sounds: contact force, energies, spectrogram.
import { kSampleRate } from "./audio.js";
import { readable } from "./controls.js";
import { kLinear } from "../../hosts/npm/src/limiter.js";
import { linePlot } from "./plots.js";
import { Spectrogram } from "./spectrogram.js";

const kShown = 529; // samples of force in view: 12 ms
const kSpan = 6; // seconds of energy in view
const kSilent = 1e-5; // of full scale
const kTold = 2000; // milliseconds that a line stays

const byId = (id) => document.getElementById(id);

export class Figures {
  /** moves(): there is something new, draw() is to be called. */
  constructor(moves) {
    Object.assign(this, { moves, isSeen: false, soundsUntil: -Infinity });
    new IntersectionObserver((list) => {
      this.isSeen = list.at(-1).isIntersecting;
      if (this.isSeen) moves();
    }).observe(byId("figures"));
    this.force = linePlot(byId("force"), { x: "time [ms]", y: "force [N]", lines: [{ label: "contact force", colour: "orange", isFilled: true }] });
    this.energy = linePlot(byId("energy"), {
      x: "time since the strike [s]",
      y: "energy [mJ]",
      lines: [
        { label: "total", colour: "ink", width: 3 },
        { label: "hammer", colour: "orange", dash: [8, 4] },
        { label: "string", colour: "blue" },
        { label: "dissipated", colour: "green", dash: [2, 3] },
      ],
      range: (_, low, high) => [0, Math.max(1e-9, high ?? 0) * 1.08],
    });
    this.spectrogram = new Spectrogram(byId("spectrogram"));
    this.reset();
  }

  /** For a new instrument, until its reports tell whether it keeps books of energy. */
  reset() {
    byId("energy-figure").hidden = true;
    this.captured = [];
    this.isArmed = false;
    this.strikes ??= 0;
    this.books = [[], [], [], [], []];
    this.changed();
  }

  changed() {
    this.isDirty = true;
    if (this.isSeen) this.moves();
  }

  /** A strike has been sent: reports of earlier ones are not drawn any more. */
  struck() {
    ++this.strikes;
    this.isArmed = true;
    this.captured = [];
    this.books = [[], [], [], [], []];
    this.began = null;
  }

  report({ time, strikes, peak, force, books }) {
    this.tellLimit(peak);
    if (peak > kSilent) this.soundsUntil = performance.now() + 1000 * kSpan;
    if (peak > kSilent && this.isSeen) this.moves();
    if (strikes !== this.strikes) return;
    this.capture(force);
    if (!books) return;
    byId("energy-figure").hidden = false;
    if (books.work === 0) return;
    this.began ??= time;
    const seconds = time - this.began;
    if (seconds > kSpan) return;
    const hammer = books.hammer + books.felt;
    const total = hammer + books.string + books.dissipated;
    [total, hammer, books.string, books.dissipated].forEach((energy, k) => this.books[k + 1].push(1000 * energy));
    this.books[0].push(seconds);
    this.imbalance = Math.max(seconds === 0 ? 0 : this.imbalance, Math.abs(total - books.work) / books.work);
    this.changed();
  }

  // Says so while the limiter of the audio thread bends the sound.
  tellLimit(peak) {
    if (peak > kLinear) this.limitedUntil = performance.now() + kTold;
    const isLimited = performance.now() < this.limitedUntil;
    if (byId("limit").hidden === isLimited) byId("limit").hidden = !isLimited;
  }

  // Takes the force from where it first acts.
  capture(force) {
    if (!this.isArmed) return;
    let from = 0;
    if (this.captured.length === 0) {
      from = force.findIndex((value) => value > 0);
      if (from < 0) return;
    }
    this.captured.push(...force.subarray(from, from + kShown - this.captured.length));
    this.changed();
    if (this.captured.length >= kShown) this.isArmed = false;
  }

  /** Draws what is new, where it is in view. Returns whether it goes on. */
  draw(analyser, now) {
    const moves = this.isSeen && Boolean(analyser) && performance.now() < this.soundsUntil;
    if (moves) this.spectrogram.draw(analyser, now);
    if (this.isDirty && this.isSeen) this.drawPlots();
    return moves;
  }

  drawPlots() {
    this.isDirty = false;
    this.force.set([Array.from(this.captured, (_, i) => (1000 * i) / kSampleRate), this.captured]);
    this.energy.set(this.books);
    const told = this.books[0].length > 0 ? `the total is flat within ${readable(this.imbalance)}` : "the total stays flat";
    byId("energy-note").textContent = told;
  }
}
