// SPDX-License-Identifier: MIT
// The instruments by the C++ runtime in WebAssembly (hosts/wasm/engine.cpp).
import { kMaxMemories, kMaxSegments } from "./messages.js";
import { startModule, textAt } from "./wasm_module.js";

const kBlock = 128;
const kMidiBytes = 128; // at once

/** Writes a design of the generator as rows of a table, and its memories. Returns whether it fits there. */
export function writeMaterial(exports, rows, use, { table, memory, mass_kg, loss_s_per_m }) {
  const numbers = [...table, ...memory].flat();
  if (table.length > kMaxSegments || memory.length > kMaxMemories || numbers.length !== 4 * table.length + 2 * memory.length) return false;
  new Float64Array(exports.memory.buffer, rows(), numbers.length).set(numbers);
  return use(table.length, memory.length, mass_kg ?? 0.00297, loss_s_per_m) === 1;
}

/** Writes the bytes of an instrument (generator.js) where room(size) says. */
export function writeInstrument(exports, room, bytes) {
  const address = room(bytes.length);
  new Uint8Array(exports.memory.buffer, address, bytes.length).set(bytes);
}

/** From engine.wasm, compiled or as bytes. An instrument is called by its number in instruments(). */
export function startEngine(module, sampleRate = 44100) {
  const exports = startModule(module);
  return {
    /** What each instrument is called, plays and has to set: hosts/wasm/playable.hpp, described(). */
    instruments: () => JSON.parse(textAt(exports, exports.engine_instruments())),
    /** Makes the instrument of a user's file the last one of all. */
    takeInstrument: (bytes) => writeInstrument(exports, exports.engine_own_instrument, bytes),
    /** The bytes of the instrument of a file that ships, without what is drawn of it; nothing of another one. */
    packed(number) {
      const size = exports.engine_pack(number);
      return size === 0 ? undefined : new Uint8Array(exports.memory.buffer, exports.engine_packed(), size).slice();
    },
    /** How late an instrument is that runs so many times finer [samples]. */
    latency: (oversample) => exports.engine_latency(oversample),
    /** Makes an instrument, which runs 1, 2, 4 or 8 times finer: call it before one of the functions below. */
    choose: (number, rate = sampleRate, oversample = 1) => exports.engine_choose(number, rate, oversample) === 1,
    /** Lets the instrument of a user's file take the place of the one that plays, while it sounds. */
    replace: () => exports.engine_replace() === 1,
    /** Adds a voice: the instrument once more, or that of `bytes` (generator.js). Returns whether it can be. */
    addVoice({ bytes } = {}) {
      if (bytes?.length > 0) writeInstrument(exports, exports.engine_voice_instrument, bytes);
      return exports.engine_add_voice() === 1;
    },
    /** Adds another instrument as a voice, so many times as loud as its file says. Returns whether there is one. */
    addPart: (number, level = 1) => exports.engine_add_part(number, level) === 1,
    /** Moves a voice between -1, left, and 1, right. */
    pan: (voice, pan) => exports.engine_pan(voice, pan),
    /** Makes a design of the generator the material of later strikes. */
    useMaterial: (design) => writeMaterial(exports, exports.engine_rows, exports.engine_use_material, design),
    set: (parameter, value, voice = 0) => exports.engine_set(voice, parameter, value),
    noteOn: (key, velocity, voice = 0) => exports.engine_note_on(voice, key, velocity),
    noteOff: (key, voice = 0) => exports.engine_note_off(voice, key),
    /** Takes bytes of MIDI: messages, or pieces of a stream; for one voice, from 1 on, or for all of the instrument. */
    midi(bytes, voice = 0) {
      for (let done = 0; done < bytes.length; done += kMidiBytes) {
        const part = bytes.slice(done, done + kMidiBytes);
        new Uint8Array(exports.memory.buffer, exports.engine_midi_bytes(), part.length).set(part);
        exports.engine_midi(voice, part.length);
      }
    },
    /** Tunes the keys of MIDI by so many cents, from the next notes on; NaN: the key does not sound. */
    tune(cents) {
      new Float64Array(exports.memory.buffer, exports.engine_key_cents(), cents.length).set(cents);
      exports.engine_tune();
    },
    /** Lets all keys and pedals of MIDI go. */
    letGo: () => exports.engine_let_go(),
    /** Keys that have begun to play since the last call, each with its velocity, and keys that were let go, with 0. */
    heard() {
      const keys = new Float64Array(exports.memory.buffer, exports.engine_heard_keys(), 2 * exports.engine_heard());
      return Array.from({ length: keys.length / 2 }, (_, n) => ({ key: keys[2 * n], velocity: keys[2 * n + 1] }));
    },
    /** Where the parameters are or go to. */
    targets() {
      const all = [];
      for (let value; !Number.isNaN((value = exports.engine_target(all.length))); ) all.push(value);
      return all;
    },
    /** Bytes of the module's memory. */
    memory: () => exports.memory.buffer.byteLength,
    /** Plays an event by a speed [m/s] or a force [N]; by its parameter if that is NaN. */
    strike: (event, value, voice = 0) => exports.engine_strike(voice, event, value),
    /** Energy that is stored [J]. */
    energy: () => exports.engine_energy(),
    /** Forgets all, as if it had just been started. */
    restart: () => exports.engine_restart(),
    watchNone: () => exports.engine_watch_none(),

    /** Plays samples: left, right and the contact force. Up to 128 are views that the next call changes. */
    process(samples) {
      if (samples > kBlock) return this.processBlocks(samples);
      const address = exports.engine_process(samples);
      return [0, 1, 2].map((k) => new Float32Array(exports.memory.buffer, address + 4 * k * kBlock, samples));
    },
    processBlocks(samples) {
      const channels = [0, 1, 2].map(() => new Float32Array(samples));
      for (let done = 0; done < samples; done += kBlock) {
        const played = this.process(Math.min(kBlock, samples - done));
        channels.forEach((channel, k) => channel.set(played[k], done));
      }
      return channels;
    },
    /** Energies of the last strike [J]; null where the instrument keeps no books. */
    books() {
      const address = exports.engine_books();
      if (address === 0) return null;
      const [hammer, felt, string, dissipated, work] = new Float64Array(exports.memory.buffer, address, 5);
      return { hammer, felt, string, dissipated, work };
    },
  };
}
