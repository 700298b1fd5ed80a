// SPDX-License-Identifier: MIT
// native_test.mjs FAUST_WASM NATIVE: the samples of the page's Faust programs over one strike, and of the piano's effect
// after an impulse, are those of native programs, Faust's C++ with its architecture plot.cpp.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { startProgram } from "../../web/src/faust_program.js";

const [wasm, native] = process.argv.slice(2);
const kSamples = 4000;

/** The page's samples of a program: one list for each output. With no button to press, each input is an impulse. */
function fromPage(name, button) {
  const description = JSON.parse(readFileSync(join(wasm, `${name}.json`), "utf8"));
  const program = startProgram(new WebAssembly.Module(readFileSync(join(wasm, `${name}.wasm`))), description, 44100);
  if (button) program.set(button, 1);
  for (const input of program.inputs) input[0] = 1;
  const outputs = Array.from({ length: description.outputs }, () => []);
  for (let i = 0; i < kSamples; i += 100) {
    program.process(100).forEach((view, k) => outputs[k].push(...view.subarray(0, 100)));
    for (const input of program.inputs) input.fill(0);
  }
  return outputs;
}

/** The same by the native program: a line for each sample. */
function fromNative(name, button) {
  const pressed = button ? [`-${button}`, "1"] : [];
  const text = execFileSync(join(native, name), [...pressed, "-n", String(kSamples)], { encoding: "utf8" });
  const rows = text.split("\n").map((line) => line.trim().split(/[\s;]+/).map(Number)).filter((row) => row.length === 2 && row.every(Number.isFinite));
  return [0, 1].map((k) => rows.map((row) => row[k]));
}

for (const [name, button] of [["hammer_string", "strike"], ["mass_barrier", "throw"], ["piano_effect"]]) {
  const page = fromPage(name, button);
  const expected = fromNative(name, button);
  page.forEach((samples, k) => {
    if (samples.length !== kSamples || expected[k].length !== kSamples)
      throw new Error(`${name}, output ${k}: ${samples.length} and ${expected[k].length} samples`);
    const peak = expected[k].reduce((max, x) => Math.max(max, Math.abs(x)), 0);
    const worst = samples.reduce((max, x, i) => Math.max(max, Math.abs(x - expected[k][i])), 0) / peak;
    if (!(peak > 0 && worst <= 1e-5)) throw new Error(`${name}, output ${k}: ${worst} of the peak ${peak} apart`);
    console.log(`${name}, output ${k}: within ${worst.toExponential(1)} of the peak`);
  });
}
