// SPDX-License-Identifier: MIT
// An instrument without Web Audio, in Node or anywhere: blocks of samples, when they are asked for.
import { startEngine } from "./engine.js";
import { bytesOf, findInstrument, kFiles, kRates, moduleOf } from "./files.js";
import { badInput, indexOf, numberWithin, parameterValue, play, playable, wholeNumberWithin } from "./messages.js";

const idle = []; // engines that no player has
const kMaxSamples = 2 ** 24; // at once
const kClosed = new Proxy({}, {
  get() {
    throw badInput("Player", "is closed", "another one, by Player.create()");
  },
});

export class Player extends playable(Object) {
  /** An instrument at rest, by its name or { text, file } of an instrument file. Throws bad input. */
  static async create(instrument, sampleRate = 44100, { oversample = 1 } = {}) {
    numberWithin("sampleRate", sampleRate, ...kRates);
    const { description, number, messages, latency } = await findInstrument(instrument, sampleRate, oversample);
    const module = await moduleOf(kFiles.engine);
    const engine = idle.pop() ?? startEngine(module);
    for (const message of messages) play(engine, message);
    engine.choose(number, sampleRate, oversample);
    return Object.assign(new Player(), { description, sampleRate, latency, rate: sampleRate * oversample, engine });
  }

  /** Lets the instrument of { text, file } take the place of this one, also while it sounds. Throws bad input. */
  async replace(instrument) {
    this.send({ do: "own", bytes: await bytesOf(instrument, this.rate) });
    this.send({ do: "replace" });
  }

  send(message) {
    play(this.engine, message);
  }

  set(parameter, value) {
    const number = indexOf("parameter", parameter, this.description.parameters);
    this.engine.set(number, parameterValue(this.description.parameters[number], value));
  }

  /** Plays samples: left, right and the contact force [N]. Up to 128 are views that the next call changes. */
  process(samples = 128) {
    return this.engine.process(wholeNumberWithin("samples", samples, 0, kMaxSamples));
  }

  /** Energy that is stored [J]. */
  energy() {
    return this.engine.energy();
  }

  /** Ends it; another player takes its memory. */
  close() {
    if (this.engine === kClosed) return;
    this.engine.restart();
    idle.push(this.engine);
    this.engine = kClosed;
  }
}
