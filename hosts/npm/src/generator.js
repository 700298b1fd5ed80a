// SPDX-License-Identifier: MIT
// The generator of Contact Spline.
import { channelsIn, partsOf } from "./midi_parts.js";
import { startModule, textAt, withBytes, withTexts } from "./wasm_module.js";

// The JSON at an address; its error is thrown.
function answered(exports, address) {
  const answer = JSON.parse(textAt(exports, address));
  if (answer.error !== undefined) throw new Error(answer.error);
  return answer;
}

/** The generator, from generator.wasm compiled or as bytes. */
export function startGenerator(module) {
  const exports = startModule(module);
  const packedBytes = (answer) => new Uint8Array(exports.memory.buffer, exports.contactspline_packed(), answered(exports, answer).size).slice();
  return {
    /** The text of every material that ships, by name. */
    materials: () => JSON.parse(textAt(exports, exports.contactspline_materials())),

    /** Takes a file that materials, instrument files and fit files may name: a measured curve or data in CSV, a material. */
    takeFile: (name, text) => withTexts(exports, [name, text], (...at) => exports.contactspline_take_file(...at)),

    /** The text of a fit file for data files that it was given, of impacts of this mass [kg]. Throws bad input. */
    fitFile: (names, mass) => answered(exports, withTexts(exports, [Array.isArray(names) ? names.join("\n") : names], (at) => exports.contactspline_fit_file(at, mass))).text,

    /** Fits a material as a fit file says: { material: the text of its file, report, panels } (hosts/wasm/generator.cpp). Throws bad
     * input. */
    fit: (text, file) => answered(exports, withTexts(exports, [text, file], (...at) => exports.contactspline_fit(...at))),

    /** The text of every instrument file that ships, by name. */
    instruments: () => JSON.parse(textAt(exports, exports.contactspline_instruments())),

    /** Reads an instrument file: { name, title, parts, drawing } (hosts/wasm/generator.cpp) and the bytes that engine and studies
     * take at this rate; or { error }. width: of the drawing, in points of the screen. */
    instrument(text, file, options) {
      const { width = 640, sampleRate = 44100 } = options ?? {};
      let instrument;
      try {
        const address = withTexts(exports, [text, file], (...at) => exports.contactspline_instrument(...at, width, sampleRate));
        instrument = JSON.parse(textAt(exports, address));
      } catch ({ message }) {
        return { error: message };
      }
      if (instrument.error !== undefined) return instrument;
      const bytes = new Uint8Array(exports.memory.buffer, exports.contactspline_instrument_bytes(), exports.contactspline_instrument_size());
      return { ...instrument, bytes: bytes.slice() };
    },

    /** The bytes of what is drawn of an instrument that ships, for the studies: they follow those of engine.packed(). */
    drawn: (name, sampleRate) => packedBytes(withTexts(exports, [name], (at) => exports.contactspline_drawn(at, sampleRate))),

    /** The bytes of an instrument that ships, its strings tuned by -1200 to 1200 cents. Throws bad input. */
    tuned: (name, cents, sampleRate) => packedBytes(withTexts(exports, [name], (at) => exports.contactspline_tuned(at, cents, sampleRate))),

    /** Reads a MIDI file, given as a Uint8Array: { title, remarks, end, channels, unchosen, messages: [{ time, bytes }] }
     * (hosts/wasm/generator.cpp), in seconds. channels: those to read, 1 to 16; instruments: midi_parts.js. Throws bad input. */
    readMidi(bytes, file, { channels = [], instruments } = {}) {
      if (!(bytes instanceof Uint8Array)) throw new Error(`contactspline: ${String(file)}: is no MIDI file; allowed: its bytes as a Uint8Array`);
      const read = (chosen) => {
        const bits = channelsIn(chosen);
        const { messages, ...rest } = answered(exports, withBytes(exports, [bytes], (at) => withTexts(exports, [file], (name) => exports.contactspline_midi(at, bytes.length, name, bits))));
        return { ...rest, messages: messages.map(([time, ...bytes]) => ({ time, bytes })) };
      };
      return instruments === undefined ? read(channels) : partsOf(read, instruments, file);
    },

    /** The cents of the 128 keys of MIDI above equal temperament, by the texts of a scale and a key map of Scala and the pitch of A4
     * [Hz]; NaN: the key does not sound. Throws bad input. */
    readTuning({ scale = "", keymap = "", a4 = 0 } = {}) {
      const { cents } = answered(exports, withTexts(exports, [scale, keymap], (...at) => exports.contactspline_tuning(...at, a4)));
      return Float64Array.from(cents, (value) => value ?? NaN);
    },

    /** Designs a material: its emitted files by name, table, curve and errors (hosts/wasm/generator.cpp). Throws bad input. */
    design: (text, file) => answered(exports, withTexts(exports, [text, file], (...at) => exports.contactspline_generate(...at))),
  };
}
