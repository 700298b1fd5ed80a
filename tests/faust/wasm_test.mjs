// SPDX-License-Identifier: MIT
// wasm_test.mjs SAMPLES.json FOLDER: what the installed Faust's WebAssembly back end made, run in Node.
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { compare, runProgram } from "./wasm_program.mjs";

const [samples, folder] = process.argv.slice(2);
const runs = JSON.parse(readFileSync(samples));
const worst = {};
for (const run of runs) {
  const name = `${run.program}_${run.precision}`;
  const actual = await runProgram(readFileSync(join(folder, `wasm_${name}.wasm`)), run);
  worst[name] = Math.max(worst[name] ?? 0, compare(actual, run, name));
}
if (Object.keys(worst).length !== 4) throw new Error(`runs of ${Object.keys(worst)} only`);
console.log(`${runs.length} runs; worst error relative to the bound:`, worst);
