// SPDX-License-Identifier: MIT
// The messages that play an instrument: the functions that send them, and what an engine does with them.

/** Of a material: hosts/wasm/hammer_keys.hpp. */
export const kMaxSegments = 128;
export const kMaxMemories = 4;
const kMidiKeys = 128;
const kLargest = 1e15; // of a number of a table, far from the end of single precision

/** Plays a message in an engine (engine.js). */
export function play(engine, message) {
  if (message.do === "own") engine.takeInstrument(message.bytes);
  if (message.do === "replace") engine.replace();
  if (message.do === "material") engine.useMaterial(message.design);
  if (message.do === "set") engine.set(message.parameter, message.value, message.voice);
  if (message.do === "noteOn") engine.noteOn(message.key, message.velocity, message.voice);
  if (message.do === "noteOff") engine.noteOff(message.key, message.voice);
  if (message.do === "strike") engine.strike(message.event, message.value, message.voice);
  if (message.do === "midi") engine.midi(message.bytes, message.voice);
  if (message.do === "tune") engine.tune(message.cents);
  if (message.do === "watchNone") engine.watchNone();
}

/** Input that cannot be used, in one line as the program writes it. */
export const badInput = (key, wrong, allowed) => new Error(`contactspline: ${key}: ${wrong}; allowed: ${allowed}`);

/** An argument that is a number within a range. Throws others. */
export function numberWithin(key, value, min, max) {
  if (typeof value !== "number" || !(value >= min && value <= max)) throw badInput(key, `${String(value)} is out of range`, `${min} to ${max}`);
  return value;
}

/** The same, of a whole number. */
export function wholeNumberWithin(key, value, min, max) {
  if (!Number.isInteger(numberWithin(key, value, min, max))) throw badInput(key, `${value} is no whole number`, `${min} to ${max}`);
  return value;
}

/** A number that is moved into the range of a parameter. Throws what is none. */
export function parameterValue({ name, allowed: [min, max] }, value) {
  if (typeof value !== "number" || Number.isNaN(value)) throw badInput(name, `${String(value)} is no number`, `${min} to ${max}`);
  return value;
}

/** A design of the generator, or of somebody who made one alike: its numbers. Throws what an engine cannot take. */
function designOf(design) {
  const { name = "material", table, memory, mass_kg, loss_s_per_m } = design ?? {};
  const areRows = (rows, length) => Array.isArray(rows) && rows.every((row) => Array.isArray(row) && row.length === length && row.every((x) => x >= -kLargest && x <= kLargest));
  if (!areRows(table, 4) || !areRows(memory, 2)) throw badInput(name, "is no design", "table and memory as generator.design() gives them");
  if (table.length < 1 || table.length > kMaxSegments) throw badInput(name, `has ${table.length} segments`, `1 to ${kMaxSegments}`);
  if (memory.length > kMaxMemories) throw badInput(name, `has ${memory.length} memories`, `up to ${kMaxMemories}`);
  const rises = table.every(([knot, energy, force], k) => (k === 0 ? knot === 0 : knot > table[k - 1][0]) && energy >= 0 && force >= 0);
  if (!rises || memory.some(([weight, time]) => !(weight > 0 && time > 0)))
    throw badInput(name, "its table or memory is damaged", "knots that rise from 0, energies and forces from 0, weights and times above 0");
  if (mass_kg !== undefined) numberWithin(`${name}: mass_kg`, mass_kg, 1e-6, 1e4);
  numberWithin(`${name}: loss_s_per_m`, loss_s_per_m, 0, kLargest);
  return { table, memory, mass_kg, loss_s_per_m };
}

/** Where an object of this name is in a list. Throws unknown names. */
export function indexOf(key, name, list) {
  const index = list.findIndex((other) => other.name === name);
  if (index < 0) throw badInput(key, `${String(name)} is unknown`, list.map((other) => other.name).join(", ") || "none");
  return index;
}

/** Base with the functions that play an instrument, by its description and send(message). Times: [s] of the context. */
export const playable = (Base) =>
  class extends Base {
    noteOn(key, velocity = this.description.velocity, time = 0) {
      numberWithin("velocity", velocity, 0, 1);
      this.sendAt(time, { do: "noteOn", key: wholeNumberWithin("key", key, 0, 127), velocity });
    }

    noteOff(key, time = 0) {
      this.sendAt(time, { do: "noteOff", key: wholeNumberWithin("key", key, 0, 127) });
    }

    strike(event, value = NaN, time = 0) {
      if (!Number.isNaN(value)) numberWithin("value", value, -Number.MAX_VALUE, Number.MAX_VALUE);
      this.sendAt(time, { do: "strike", event: indexOf("event", event, this.description.events), value });
    }

    midi(bytes, time = 0) {
      if (typeof bytes !== "object" || bytes === null) throw badInput("midi", `${String(bytes)} is no message`, "bytes, such as [0x90, 60, 100]");
      this.sendAt(time, { do: "midi", bytes: Uint8Array.from(bytes, (byte) => (typeof byte === "number" ? byte : 0)) });
    }

    tune(cents) {
      const { name, isTunable } = this.description;
      if (!isTunable) throw badInput(name, "has no keys that could be tuned", "a piano, or an instrument whose keys have a tuned_key");
      const numbers = Float64Array.from(cents ?? Array(kMidiKeys).fill(0));
      if (numbers.length !== kMidiKeys) throw badInput("cents", `has ${numbers.length} numbers`, `${kMidiKeys}, as generator.readTuning() gives, or null`);
      this.send({ do: "tune", cents: numbers });
    }

    loadPreset(name) {
      const { presets, parameters } = this.description;
      presets[indexOf("preset", name, presets)].values.forEach((value, k) => this.set(parameters[k].name, value));
    }

    useMaterial(design) {
      if (!this.description.takesMaterial) throw badInput(this.description.name, "has materials of its own", "an instrument with takesMaterial");
      this.send({ do: "material", design: designOf(design) });
    }

    sendAt(time, message) {
      this.send({ ...message, at: numberWithin("time", time, 0, Number.MAX_VALUE) });
    }
  };
