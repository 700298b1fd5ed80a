// SPDX-License-Identifier: MIT
// faustwasm_test.mjs NODE_MODULES SAMPLES.json FILE...: the Faust compiler of the npm package on every .dsp among the
// files, with the .lib among them; what it makes is run and compared with the C++ twin.
import { readFileSync } from "node:fs";
import { basename } from "node:path";

import { compare, runProgram } from "../wasm_program.mjs";
import { compileToWasm, kOurs, loadFaustwasm } from "./faustwasm.mjs";

const [modules, samples, ...files] = process.argv.slice(2);
const { faustwasm, compiler } = await loadFaustwasm(modules, files);

/** The programs among the files, text by name. */
function programsAmong() {
  const programs = files.filter((path) => path.endsWith(".dsp"));
  return Object.fromEntries(programs.map((path) => [basename(path, ".dsp"), readFileSync(path, "utf8")]));
}

/** Every program as WebAssembly: its factory by NAME_PRECISION. */
async function compileAll(programs) {
  const factories = {};
  for (const [name, code] of Object.entries(programs))
    for (const precision of ["single", "double"])
      factories[`${name}_${precision}`] = await compileToWasm(compiler, name, code, precision);
  return factories;
}

/** The C++ back end, where the package has it. */
function compileToCpp(programs) {
  for (const [name, code] of Object.entries(programs))
    for (const precision of ["single", "double"]) {
      const file = `${kOurs}/${name}_${precision}.cpp`;
      try {
        compiler.generateAuxFiles(name, code, `-lang cpp -I ${kOurs} -${precision} -o ${file}`);
      } catch (error) {
        if (/backend is not built/.test(error.message)) return `SKIPPED: ${error.message.trim()}`;
        throw error;
      }
      const source = compiler.fs().readFile(file, { encoding: "utf8" });
      if (!source.includes("compute(int count")) throw new Error(`${name}, ${precision}: no C++`);
    }
  return "compiled";
}

/** The samples through the factories, all on felt C4. */
async function runSamples(factories, runs) {
  const worst = {};
  for (const run of runs) {
    const name = `${run.program}_felt_c4_${run.precision}`;
    const { code, json } = factories[name];
    const error = compare(await runProgram(code, run, JSON.parse(json)), run, name);
    worst[name] = Math.max(worst[name] ?? 0, error);
  }
  return worst;
}

/** One strike through the package's own offline processor, as its users run programs. */
async function renderOffline(programs, runs) {
  const run = runs.find(({ program, precision }) => program === "mass_barrier" && precision === "single");
  const generator = new faustwasm.FaustMonoDspGenerator();
  await generator.compile(compiler, "mass_barrier", programs.mass_barrier_felt_c4, `-I ${kOurs} -single`);
  const processor = await generator.createOfflineProcessor(run.sample_rate_hz, 64);
  for (const [label, value] of Object.entries(run.controls)) {
    const ending = `/${label.replace(/ /g, "_")}`;
    processor.setParamValue(processor.getParams().find((path) => path.endsWith(ending)), value);
  }
  return compare(processor.render([], run.outputs[0].length), run, "offline processor");
}

const programs = programsAmong();
const runs = JSON.parse(readFileSync(samples));
const factories = await compileAll(programs);
console.log(`Faust ${compiler.version()}: ${Object.keys(factories).length} WebAssembly programs`);
console.log(`${runs.length} runs; worst error relative to the bound:`, await runSamples(factories, runs));
console.log("offline processor, relative to the bound:", await renderOffline(programs, runs));
console.log("C++ back end:", compileToCpp(programs));
