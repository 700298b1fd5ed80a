// SPDX-License-Identifier: MIT
// The package's files, beside this one, and the modules made of them: each loaded once.
import { startEngine } from "./engine.js";
import { startGenerator } from "./generator.js";
import { badInput, indexOf, numberWithin } from "./messages.js";

const kOversamplings = [1, 2, 4, 8];
export const kRates = [1000, 768000]; // that an instrument may run at [Hz]

/** Where they are. */
export const kFiles = {
  engine: new URL("./engine.wasm", import.meta.url),
  generator: new URL("./generator.wasm", import.meta.url),
  processor: new URL("./processor.js", import.meta.url),
};

/** How they are read; Node reads them otherwise (node.js). */
export const reader = {
  async read(url) {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
    return answer.arrayBuffer();
  },
};

const compiled = new Map();

/** A file as a WebAssembly module, which any number of engines are started from. */
export function moduleOf(url) {
  if (!compiled.has(url.href)) {
    const module = reader.read(url).then((bytes) => WebAssembly.compile(bytes));
    module.catch(() => compiled.delete(url.href)); // to try again
    compiled.set(url.href, module);
  }
  return compiled.get(url.href);
}

let generator = null;

/** The generator: instrument files and materials (generator.js). */
export const loadGenerator = async () => (generator ??= startGenerator(await moduleOf(kFiles.generator)));

let describing = null; // an engine that plays nothing

const describer = async () => (describing ??= startEngine(await moduleOf(kFiles.engine)));

let shipped = null;

/** The descriptions of all instruments that ship (hosts/wasm/playable.hpp). */
export const instruments = async () => (shipped ??= (await describer()).instruments());

/** What an engine takes of { text, file } of an instrument file. Throws bad input. */
export async function bytesOf(instrument, rate) {
  const { text, file = "instrument.json" } = instrument ?? {};
  if (typeof text !== "string" || typeof file !== "string")
    throw badInput("instrument", instrument instanceof Object ? "has no text" : `${String(instrument)} is no instrument`, "a name such as piano, or { text, file } of an instrument file");
  const { error, bytes } = (await loadGenerator()).instrument(text, file, { sampleRate: rate });
  if (error !== undefined) throw new Error(error);
  return bytes;
}

/** An instrument by its name, or by { text, file } of an instrument file, that runs so many times finer: its description, its
 * number in an engine, the messages that an engine takes before, and how late it is [samples]. Throws bad input. */
export async function findInstrument(instrument, sampleRate, oversample) {
  const all = await instruments();
  if (!kOversamplings.includes(oversample)) throw badInput("oversample", `${String(oversample)} is unknown`, kOversamplings.join(", "));
  const rate = numberWithin("sampleRate times oversample", sampleRate * oversample, ...kRates);
  const latency = (await describer()).latency(oversample);
  if (typeof instrument === "string") {
    const number = indexOf("instrument", instrument, all);
    return { description: all[number], number, messages: [], latency };
  }
  const bytes = await bytesOf(instrument, rate);
  const engine = await describer();
  engine.takeInstrument(bytes);
  return { description: engine.instruments().at(-1), number: all.length, messages: [{ do: "own", bytes }], latency };
}
