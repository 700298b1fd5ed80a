// SPDX-License-Identifier: MIT
// The same strike by Faust's fd.hammer and by the contact step, side by side.
import { levelled } from "./compared.js";
import { readable, slider } from "./controls.js";
import { linePlot } from "./plots.js";

const kShown = 0.008; // seconds
const kHeard = 1.5;
const kPause = 0.4;
const kTold = 0.25;
const byId = (id) => document.getElementById(id);

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

  /** Both strikes as long as they are heard [m]: { ours, theirs }. */
  strikes(seconds) {
    return this.background.ask("strikes", { ratio: this.stiffness.get(), seconds });
  }

  /** fd.hammer, a pause, and the contact step, as sound. */
  async inTurn() {
    const { ours, theirs } = await this.strikes(kHeard);
    const [first, second] = [theirs, ours].map((displacement) => levelled(displacement).samples);
    const pause = Math.round(kPause * this.sampleRate);
    const both = new Float32Array(first.length + pause + second.length);
    both.set(first);
    both.set(second, first.length + pause);
    return both;
  }

  /** The figure follows the stiffness. */
  draw() {
    this.drawn = this.background.latest("comparison", "compared", { ratio: this.stiffness.get(), seconds: kTold, shown: kShown }).then((both) => both && this.show(both));
  }

  show({ data, us, them, louder }) {
    this.plot.set(data);
    const told = them.bounded ? `a peak of ${readable(1000 * them.peak)} mm` : "no bound: it has become unstable";
    const turned = louder > 1 ? ` To play as loud, it is turned down by ${louder.toFixed(0)} dB.` : "";
    byId("compare-note").textContent = `Contact step: a peak of ${readable(1000 * us.peak)} mm. fd.hammer: ${told}.${turned}`;
    this.verdict = { ours: us, fd: them };
  }
}
