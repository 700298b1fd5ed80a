// SPDX-License-Identifier: MIT
// Single notes from rest in double precision, sample by sample (web/wasm/studies.cpp).
import { writeInstrument, writeMaterial } from "../../hosts/npm/src/engine.js";
import { startModule, textAt, withTexts } from "../../hosts/npm/src/wasm_module.js";

/** From studies.wasm, compiled or as bytes. */
export function startStudies(module, sampleRate) {
  const exports = startModule(module);
  return {
    useMaterial: (design) => writeMaterial(exports, exports.studies_rows, exports.studies_use_material, design),
    /** Takes the instrument of a user's file, which is called "own". */
    takeInstrument: (bytes) => writeInstrument(exports, exports.studies_own_instrument, bytes),

    /** A note of an instrument with these values of its parameters. Returns null, or frames with column(k), the numbers
     * k of all frames, points(frame, k, count), and their scene (web/wasm/study.hpp). */
    play(instrument, values, { key, velocity, event }) {
      new Float64Array(exports.memory.buffer, exports.studies_values(values.length), values.length).set(values);
      const address = withTexts(exports, [instrument], (name) => exports.studies_play(name, key, velocity, event, sampleRate));
      if (address === 0) return null;
      const [frames, size] = [exports.studies_frames(), exports.studies_frame_size()];
      const numbers = new Float64Array(exports.memory.buffer, address, frames * size).slice();
      return {
        frames,
        sampleRate,
        scene: JSON.parse(textAt(exports, exports.studies_scene())),
        column: (k) => Float64Array.from({ length: frames }, (_, i) => numbers[i * size + k]),
        points: (frame, k, count) => numbers.subarray(frame * size + k, frame * size + k + count),
      };
    },

    /** The strike of fd_hammer_c4.dsp by the contact step: displacement at the place of the strike [m]. */
    strikeC4(stiffness, samples) {
      const address = exports.studies_strike_c4(stiffness, samples, sampleRate);
      return new Float64Array(exports.memory.buffer, address, samples).slice();
    },
  };
}
