// SPDX-License-Identifier: MIT
// doc_test.mjs NODE_MODULES FAUST FUNCTIONS LIBRARY.lib...: the tests in the documentation of our Faust libraries, which
// the script FUNCTIONS lists. Each runs as theirs do, for 48,000 samples in double precision, in the installed Faust and
// in that of the npm package: as many outputs as Usage states, all samples finite, not all of them 0, the same within
// 1e-4. Every button is pressed. Writes a program for each library.
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";

import { compileToWasm, loadFaustwasm } from "./npm/faustwasm.mjs";
import { runProgram } from "./wasm_program.mjs";

const kSamples = 48000;
const kTolerance = 1e-4;

const [modules, faust, functions, ...files] = process.argv.slice(2);
const libraries = JSON.parse(execFileSync(functions, ["--json"], { encoding: "utf8" }));
const problems = [];

/** The documented functions of a library, with the number of outputs that Usage states. */
function testsOf(library) {
  return library.functions.map((entry) => ({
    ...entry,
    outputs: entry.usage.includes(" : ") ? entry.usage.split(" : ").at(-1).split(",").length : undefined,
    complain: (what) => void problems.push(`${library.name}: ${entry.name} ${what}`),
  }));
}

/** All tests in one program, a group each; before the outputs of each it states how many they are. */
function programOf(functions) {
  const imports = new Set(functions.flatMap((entry) => entry.imports));
  const outputs = functions.map(({ name }) => `  outputs(${name}_test), hgroup("${name}", ${name}_test)`);
  return `${[...imports].join("")}${functions.map((entry) => entry.definition).join("")}process =\n${outputs.join(",\n")};\n`;
}

function buttonsOf(items) {
  return items.flatMap((item) => (item.items ? buttonsOf(item.items) : item.type === "button" ? [item.label] : []));
}

/** Outputs of a program by function. Its description may be given too. */
async function play(bytes, functions, ui, description) {
  const controls = Object.fromEntries(buttonsOf(ui).map((label) => [label, 1]));
  const run = { precision: "double", sample_rate_hz: 48000, inputs: [], outputs: [{ length: kSamples }], controls };
  const channels = await runProgram(bytes, run, description);
  let next = 0;
  return functions.map(() => channels.slice(next + 1, (next += 1 + channels[next][0])));
}

/** Both Fausts on the tests of a library. */
async function runTests(library, functions, compiler) {
  const code = programOf(functions);
  const program = `${library.name}_tests`;
  writeFileSync(`${program}.dsp`, code);
  const factory = await compileToWasm(compiler, program, code, "double");
  const description = JSON.parse(factory.json);
  const npm = await play(factory.code, functions, description.ui, description);
  const folders = [...new Set(files.map(dirname))].flatMap((folder) => ["-I", folder]);
  execFileSync(faust, ["-lang", "wasm", "-double", ...folders, `${program}.dsp`, "-o", `${program}.wasm`]);
  const installed = await play(readFileSync(`${program}.wasm`), functions, description.ui);
  return functions.map((entry, i) => {
    if (entry.outputs !== undefined && installed[i].length !== entry.outputs)
      entry.complain(`has ${entry.outputs} outputs in Usage, ${installed[i].length} in Test`);
    return compare(installed[i], npm[i], entry.complain);
  });
}

/** Largest difference of the outputs of a test, relative to the tolerance: 1e-4, and of the peak if that is below 1. */
function compare(actual, expected, complain) {
  if (actual.length !== expected.length) return complain(`has ${actual.length} and ${expected.length} outputs`);
  let worst = 0;
  actual.forEach((samples, k) => {
    const peak = samples.reduce((largest, value) => Math.max(largest, Math.abs(value)), 0);
    if (![...samples, ...expected[k]].every(Number.isFinite)) return complain(`output ${k} is not finite`);
    if (!(peak > 0)) return complain(`output ${k} is 0 throughout`);
    const difference = samples.reduce((largest, value, i) => Math.max(largest, Math.abs(value - expected[k][i])), 0);
    worst = Math.max(worst, difference / (kTolerance * Math.min(1, peak)));
  });
  if (!(worst <= 1)) complain(`the two Fausts differ by ${worst} tolerances`);
  return worst;
}

const { compiler } = await loadFaustwasm(modules, files);
for (const library of libraries) {
  const functions = testsOf(library);
  if (functions.length === 0) throw new Error(`${library.name}: nothing is documented`);
  const worst = await runTests(library, functions, compiler);
  functions.forEach(({ name }, i) => console.log(`${library.prefix}.${name}: ${worst[i]?.toExponential(1)} tolerances`));
}
for (const problem of problems) console.error(problem);
process.exitCode = problems.length > 0 ? 1 : 0;
