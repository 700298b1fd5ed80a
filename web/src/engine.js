// SPDX-License-Identifier: MIT
// The C++ runtime in WebAssembly: the keyboard of hammer-strings, and studies of single strikes.
import { startModule } from "./wasm_module.js";

const kBlock = 128;

/** Numbers of a frame of a study before the points of the string. */
const kFrameHead = ["place", "compression", "force", "hammer", "felt", "string", "dissipated", "imbalance"];

/** From engine.wasm, compiled or as bytes. */
export function startEngine(module, sampleRate) {
  const exports = startModule(module);

  function read(address, frames) {
    const size = exports.engine_frame_size();
    const numbers = new Float64Array(exports.memory.buffer, address, frames * size);
    const copy = numbers.slice();
    const study = { frames, sampleRate, points: size - kFrameHead.length };
    kFrameHead.forEach((name, k) => {
      study[name] = Float64Array.from({ length: frames }, (_, i) => copy[i * size + k]);
    });
    study.shape = (i) => copy.subarray(i * size + kFrameHead.length, (i + 1) * size);
    return study;
  }

  return {
    /** Makes the keyboard: call it before one of the functions from strike to books. */
    makeKeyboard: () => exports.engine_start(sampleRate),
    /** Makes a design of the generator the material of later strikes. Returns whether it has no more than 128 segments. */
    useMaterial({ table, mass_kg, loss_s_per_m }) {
      if (table.length > 128) return false;
      new Float64Array(exports.memory.buffer, exports.engine_rows(), 4 * table.length).set(table.flat());
      return exports.engine_use_material(table.length, mass_kg ?? 0.00297, loss_s_per_m) === 1;
    },
    control: ({ stiffness, mass, loss, position }) => exports.engine_control(stiffness, mass, loss, position),
    strike: (key, speed) => exports.engine_strike(key, speed),
    release: (key) => exports.engine_release(key),
    pedal: (down) => exports.engine_pedal(down ? 1 : 0),
    silence: () => exports.engine_silence(),
    watchNone: () => exports.engine_watch_none(),

    /** Plays up to 128 samples: left, right and the contact force of the last strike, views that the next call changes. */
    process(samples) {
      const address = exports.engine_process(samples);
      return [0, 1, 2].map((k) => new Float32Array(exports.memory.buffer, address + 4 * k * kBlock, samples));
    },
    /** Energies of the last strike [J]. */
    books() {
      const [hammer, felt, string, dissipated, work] = new Float64Array(exports.memory.buffer, exports.engine_books(), 5);
      return { hammer, felt, string, dissipated, work };
    },

    /** One strike of a key at rest, in double precision: a list for each column of kFrameHead, and shape(frame) [m]. */
    studyString: (key, speed, frames) => read(exports.engine_study_string(key, speed, frames, sampleRate), frames),
    /** The strike of fd_hammer_c4.dsp by the contact step: displacement at the place of the strike [m]. */
    strikeC4(stiffness, samples) {
      const address = exports.engine_strike_c4(stiffness, samples, sampleRate);
      return new Float64Array(exports.memory.buffer, address, samples).slice();
    },
    /** One throw of a mass at a barrier. */
    studyBarrier: (mass, speed, frames) => read(exports.engine_study_barrier(mass, speed, frames, sampleRate), frames),
  };
}
