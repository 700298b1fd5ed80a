// SPDX-License-Identifier: MIT
// Runs a WebAssembly program of Faust and compares it with samples.

const kBlock = 37;

/** Math functions under the names Faust imports them by: _pow, _powf, ... */
const kEnvironment = new Proxy({ memoryBase: 0, tableBase: 0 }, {
  get: (known, name) => known[name] ?? Math[name.replace(/^_/, "").replace(/f$/, "")],
});

/** Faust leaves a program's description in JSON at the start of its memory. */
function describe(memory) {
  const bytes = new Uint8Array(memory.buffer);
  return JSON.parse(new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))));
}

function controlsOf(items) {
  return items.flatMap((item) => (item.items ? controlsOf(item.items) : [item]));
}

/** Outputs of a program, given as bytes, over a run of the samples file. Its description may be given too. */
export async function runProgram(bytes, run, description) {
  const { instance } = await WebAssembly.instantiate(bytes, { env: kEnvironment });
  const program = instance.exports;
  const { size, inputs, outputs, ui } = description ?? describe(program.memory);
  program.init(0, run.sample_rate_hz);
  for (const [label, value] of Object.entries(run.controls)) {
    const controls = controlsOf(ui).filter((item) => item.label === label);
    if (controls.length === 0) throw new Error(`no control ${label}`);
    for (const { index } of controls) program.setParamValue(0, index, value);
  }

  // Behind the program's own memory: the lists of channels, then the channels.
  const Real = run.precision === "double" ? Float64Array : Float32Array;
  const aligned = (address) => Math.ceil(address / 8) * 8;
  const lists = aligned(size);
  const channels = aligned(lists + 4 * (inputs + outputs));
  const needed = channels + (inputs + outputs) * kBlock * Real.BYTES_PER_ELEMENT;
  if (needed > program.memory.buffer.byteLength)
    program.memory.grow(Math.ceil((needed - program.memory.buffer.byteLength) / 65536));
  const channel = (i) => new Real(program.memory.buffer, channels + i * kBlock * Real.BYTES_PER_ELEMENT, kBlock);
  const list = new Int32Array(program.memory.buffer, lists, inputs + outputs);
  for (let i = 0; i < inputs + outputs; ++i) list[i] = channel(i).byteOffset;

  const length = run.outputs[0].length;
  const result = Array.from({ length: outputs }, () => new Real(length));
  for (let begin = 0; begin < length; begin += kBlock) {
    const count = Math.min(kBlock, length - begin);
    run.inputs.forEach((samples, i) => channel(i).set(samples.slice(begin, begin + count)));
    program.compute(0, count, lists, lists + 4 * inputs);
    result.forEach((samples, i) => samples.set(channel(inputs + i).subarray(0, count), begin));
  }
  return result;
}

/** Largest |actual - expected| / bound of all samples; throws where data is missing, NaN or out of bound. */
export function compare(actual, run, name) {
  if (actual.length !== run.outputs.length) throw new Error(`${name}: ${actual.length} outputs`);
  let worst = 0;
  run.outputs.forEach((expected, k) => {
    if (expected.length === 0 || actual[k].length !== expected.length)
      throw new Error(`${name}: output ${k} has ${actual[k].length} samples, not ${expected.length}`);
    expected.forEach((value, i) => {
      const bound = Array.isArray(run.bounds[k]) ? run.bounds[k][i] : run.bounds[k];
      const error = Math.abs(actual[k][i] - value);
      if (!(error <= bound))
        throw new Error(`${name}: output ${k}, sample ${i}: ${actual[k][i]} is not within ${bound} of ${value}`);
      if (error > 0) worst = Math.max(worst, error / bound);
    });
  });
  return worst;
}
