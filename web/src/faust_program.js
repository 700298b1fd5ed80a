// SPDX-License-Identifier: MIT
// A program of Faust in WebAssembly, fd.hammer: its controls, and blocks of samples. In single precision.

const kBlock = 128;

/** Math functions under the names Faust imports them by: _powf, ... */
const kEnvironment = new Proxy({ memoryBase: 0, tableBase: 0 }, {
  get: (known, name) => known[name] ?? Math[name.replace(/^_/, "").replace(/f$/, "")],
});

const flat = (items) => items.flatMap((item) => (item.items ? flat(item.items) : [item]));

/** A compiled module with its description. */
export function startProgram(module, description, sampleRate) {
  const { exports } = new WebAssembly.Instance(module, { env: kEnvironment });
  const { size, inputs, outputs } = description;
  const count = inputs + outputs;
  const lists = Math.ceil(size / 16) * 16;
  const channels = lists + 16 * Math.ceil((4 * count) / 16);
  const needed = channels + count * kBlock * 4 - exports.memory.buffer.byteLength;
  if (needed > 0) exports.memory.grow(Math.ceil(needed / 65536));
  exports.init(0, sampleRate);
  const list = new Int32Array(exports.memory.buffer, lists, count);
  const views = Array.from({ length: count }, (_, k) => {
    list[k] = channels + k * kBlock * 4;
    return new Float32Array(exports.memory.buffer, list[k], kBlock);
  });
  const indexOf = Object.fromEntries(flat(description.ui).map(({ label, index }) => [label, index]));
  const played = views.slice(inputs);
  return {
    set: (label, value) => exports.setParamValue(0, indexOf[label], value),
    /** Plays up to 128 samples; returns the outputs, which the next call changes. */
    process(samples) {
      exports.compute(0, samples, lists, lists + 4 * inputs);
      return played;
    },
  };
}
