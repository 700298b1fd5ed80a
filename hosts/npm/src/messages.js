// SPDX-License-Identifier: MIT
// The messages that play an instrument: the functions that send them, and what an engine does with them.

const kMaxSegments = 128; // of a material: web/wasm/hammer_keys.hpp

/** Plays a message in an engine (engine.js). */
export function play(engine, message) {
  if (message.do === "own") engine.takeInstrument(message.bytes);
  if (message.do === "material") engine.useMaterial(message.design);
  if (message.do === "set") engine.set(message.parameter, message.value, message.voice);
  if (message.do === "noteOn") engine.noteOn(message.key, message.velocity, message.voice);
  if (message.do === "noteOff") engine.noteOff(message.key, message.voice);
  if (message.do === "strike") engine.strike(message.event, message.value);
  if (message.do === "midi") engine.midi(message.bytes);
  if (message.do === "watchNone") engine.watchNone();
}

/** Input that cannot be used, in one line as the program writes it. */
const badInput = (key, wrong, allowed) => new Error(`contactspline: ${key}: ${wrong}; allowed: ${allowed}`);

/** An argument that is a number within a range. Throws others. */
export function numberWithin(key, value, min, max) {
  if (typeof value !== "number" || !(value >= min && value <= max)) throw badInput(key, `${value} is out of range`, `${min} to ${max}`);
  return value;
}

/** Where an object of this name is in a list. Throws unknown names. */
export function indexOf(key, name, list) {
  const index = list.findIndex((other) => other.name === name);
  if (index < 0) throw badInput(key, `${name} is unknown`, list.map((other) => other.name).join(", ") || "none");
  return index;
}

/** Base with the functions that play an instrument, by its description and send(message). Times: [s] of the context. */
export const playable = (Base) =>
  class extends Base {
    noteOn(key, velocity = this.description.velocity, time = 0) {
      numberWithin("velocity", velocity, 0, 1);
      this.sendAt(time, { do: "noteOn", key: numberWithin("key", key, 0, 127), velocity });
    }

    noteOff(key, time = 0) {
      this.sendAt(time, { do: "noteOff", key: numberWithin("key", key, 0, 127) });
    }

    strike(event, value = NaN, time = 0) {
      if (!Number.isNaN(value)) numberWithin("value", value, -Number.MAX_VALUE, Number.MAX_VALUE);
      this.sendAt(time, { do: "strike", event: indexOf("event", event, this.description.events), value });
    }

    midi(bytes, time = 0) {
      this.sendAt(time, { do: "midi", bytes: Array.from(bytes) });
    }

    loadPreset(name) {
      const { presets, parameters } = this.description;
      presets[indexOf("preset", name, presets)].values.forEach((value, k) => this.set(parameters[k].name, value));
    }

    useMaterial({ name, table, memory, mass_kg, loss_s_per_m }) {
      if (!this.description.takesMaterial) throw badInput(this.description.name, "has materials of its own", "an instrument with takesMaterial");
      if (table.length > kMaxSegments) throw badInput(name, `has ${table.length} segments`, `up to ${kMaxSegments}`);
      this.send({ do: "material", design: { table, memory, mass_kg, loss_s_per_m } });
    }

    sendAt(time, message) {
      this.send({ ...message, at: numberWithin("time", time, 0, Number.MAX_VALUE) });
    }
  };
