// SPDX-License-Identifier: MIT
// Single notes from rest in double precision, sample by sample (hosts/wasm/studies.cpp).
import { writeInstrument, writeMaterial } from "../../hosts/npm/src/engine.js";
import { startModule, textAt, withTexts } from "../../hosts/npm/src/wasm_module.js";

const kLoop = 3e-3; // seconds that are shown at least, again and again

function columnOf({ frames, size, numbers }, k) {
  const column = new Float64Array(frames);
  for (let i = 0; i < frames; ++i) column[i] = numbers[i * size + k];
  return column;
}

// How many frames are shown: the blow and a quarter more; and the largest displacement of strings and bodies there [m].
function viewOf(played, { force, items }) {
  const { frames, size, numbers, sampleRate } = played;
  const last = columnOf(played, force).findLastIndex((now) => now > 0);
  const shown = last < 0 ? frames : Math.min(frames, Math.round(Math.max(kLoop * sampleRate, 1.25 * last)) + 1);
  let reach = 0;
  for (const { column, points } of items.filter(({ points }) => points))
    for (let i = 0; i < shown; ++i)
      for (let p = i * size + column; p < i * size + column + points; ++p) reach = Math.max(reach, Math.abs(numbers[p]));
  return { frames: shown, reach };
}

/** What is played, also by another thread, with column(k), the numbers k of all frames, and points(frame, k, count). */
export const studyOf = (played) => ({
  ...played,
  column: (k) => columnOf(played, k),
  points: (frame, k, count) => played.numbers.subarray(frame * played.size + k, frame * played.size + k + count),
});

/** From studies.wasm, compiled or as bytes. */
export function startStudies(module, sampleRate) {
  const exports = startModule(module);
  return {
    useMaterial: (design) => writeMaterial(exports, exports.studies_rows, exports.studies_use_material, design),
    /** A note of an instrument with these values of its parameters. bytes: the instrument itself, of a file. Returns null, or `size` numbers for each of `frames`, their
     * scene (hosts/wasm/study.hpp), and what of it is in view. */
    play(instrument, values, { key, velocity, event }, { bytes, rate = sampleRate } = {}) {
      if (bytes) writeInstrument(exports, exports.studies_file_instrument, bytes);
      new Float64Array(exports.memory.buffer, exports.studies_values(values.length), values.length).set(values);
      const address = withTexts(exports, [bytes ? "of_file" : instrument], (name) => exports.studies_play(name, key, velocity, event, rate));
      if (address === 0) return null;
      const [frames, size] = [exports.studies_frames(), exports.studies_frame_size()];
      const numbers = new Float64Array(exports.memory.buffer, address, frames * size).slice();
      const [played, scene] = [{ frames, size, numbers, sampleRate: rate }, JSON.parse(textAt(exports, exports.studies_scene()))];
      return { ...played, scene, view: viewOf(played, scene) };
    },

    /** The first event of the instrument of a file from rest: samples of its first output, or by how much its bow slips in each [m]. */
    follow(bytes, values, samples, { isSlip = false } = {}) {
      writeInstrument(exports, exports.studies_file_instrument, bytes);
      new Float64Array(exports.memory.buffer, exports.studies_values(values.length), values.length).set(values);
      const address = exports.studies_follow(samples, sampleRate, isSlip ? 1 : 0);
      return address === 0 ? null : new Float64Array(exports.memory.buffer, address, samples).slice();
    },

    /** The strike of fd_hammer_c4.dsp by the contact step: displacement at the place of the strike [m]. */
    strikeC4(stiffness, samples) {
      const address = exports.studies_strike_c4(stiffness, samples, sampleRate);
      return new Float64Array(exports.memory.buffer, address, samples).slice();
    },
  };
}
