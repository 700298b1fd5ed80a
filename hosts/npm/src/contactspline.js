// SPDX-License-Identifier: MIT
// An instrument as a node of Web Audio.
import { bytesOf, findInstrument, kFiles, moduleOf } from "./files.js";
import { badInput, indexOf, parameterValue, playable } from "./messages.js";

export { instruments, loadGenerator } from "./files.js";
export { Player } from "./player.js";

const kLargest = 3.4028234663852886e38; // of single precision, in which AudioParams are

/** What an AudioParam is made of, from a parameter of a description. */
const descriptorOf = ({ name, init, allowed: [min, max] }) => ({
  name,
  defaultValue: init,
  minValue: Math.max(min, -kLargest),
  maxValue: Math.min(max, kLargest),
  automationRate: "k-rate",
});

const known = []; // lists of parameters: files of one name may have others

/** The number of a list of parameters, given as text. */
function numberOf(parameters) {
  if (!known.includes(parameters)) known.push(parameters);
  return known.indexOf(parameters);
}

export class ContactSpline extends playable(globalThis.AudioWorkletNode ?? Object) {
  /** An instrument at rest, by its name or { text, file } of an instrument file. Throws bad input. */
  static async create(context, instrument, { report, isLimited = false, oversample = 1 } = {}) {
    const { description, number, messages, latency } = await findInstrument(instrument, context.sampleRate, oversample);
    const first = [...messages, { do: "instrument", number, gain: 1, oversample }];
    if (!report) first.push({ do: "watchNone" });
    const node = await this.open(context, kFiles.processor, await moduleOf(kFiles.engine), first, { description, isLimited, isReported: Boolean(report) });
    node.heard.report = report;
    Object.assign(node, { latency, rate: context.sampleRate * oversample });
    await node.sent();
    return node;
  }

  /** A node whose engine takes these messages before its first block. The processor is told its name and its parameters behind
   * the # of its address: one file serves all instruments, without code that is made up at run time. */
  static async open(context, processor, engine, messages, { description = { name: "any", parameters: [] }, isLimited, isReported, isCentred = false }) {
    const parameters = description.parameters.map(descriptorOf);
    const name = `contactspline ${description.name} ${numberOf(JSON.stringify(parameters))}`;
    await context.audioWorklet.addModule(`${processor}#${encodeURIComponent(JSON.stringify({ name, parameters }))}`);
    const node = new ContactSpline(context, name, {
      numberOfInputs: 0,
      outputChannelCount: [2],
      processorOptions: { engine, messages, isLimited, isReported, isCentred },
    });
    node.description = description;
    node.heard = {}; // what is called with which message of the audio thread
    node.waiting = []; // for answers
    node.port.onmessage = ({ data }) => (data.is === "answer" ? node.waiting.shift()?.answered() : node.heard[data.is]?.(data));
    node.onprocessorerror = () => {
      for (const { failed } of node.waiting.splice(0)) failed(new Error(`contactspline: ${description.name}: failed on the audio thread; allowed: what fits in memory`));
    };
    return node;
  }

  /** Lets the instrument of { text, file } take the place of this one, also while it sounds. Throws bad input. */
  async replace(instrument) {
    this.send({ do: "own", bytes: await bytesOf(instrument, this.rate) });
    this.send({ do: "replace" });
  }

  send(message) {
    if (this.isClosed) throw badInput(this.description.name, "is closed", "another one, by ContactSpline.create()");
    this.port.postMessage(message);
  }

  /** Resolves when the audio thread has taken what was sent: call it before an OfflineAudioContext starts. */
  sent() {
    return this.answerTo({ do: "answer" });
  }

  set(parameter, value) {
    const number = indexOf("parameter", parameter, this.description.parameters);
    const wanted = parameterValue(this.description.parameters[number], value);
    this.parameters.get(parameter).value = Math.max(-kLargest, Math.min(kLargest, wanted));
  }

  /** Ends it, within 20 ms if it sounds; another instrument of the context takes its memory. */
  close() {
    return (this.closing ??= this.end());
  }

  async end() {
    const { state } = this.context;
    if (state !== "closed") await this.answerTo({ do: "close", fades: state === "running" });
    this.isClosed = true;
    this.disconnect();
    this.port.close();
  }

  answerTo(message) {
    return new Promise((answered, failed) => {
      this.waiting.push({ answered, failed });
      this.send(message);
    });
  }
}
