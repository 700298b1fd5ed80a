// SPDX-License-Identifier: MIT
// faustwasm_test.mjs NODE_MODULES SAMPLES.json FILE...: the Faust compiler of the npm package on every .dsp among the
// files, with the .lib among them; what it makes is run and compared with the C++ twin.
import { readFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { compare, runProgram } from "../wasm_program.mjs";

const kVirtual = "/contactspline";
const [modules, samples, ...files] = process.argv.slice(2);
const faustwasm = join(resolve(modules), "@grame", "faustwasm");
const { FaustCompiler, FaustMonoDspGenerator, LibFaust, instantiateFaustModuleFromFile } = await import(
  pathToFileURL(join(faustwasm, "dist", "esm", "index.js")).href
);
const compiler = new FaustCompiler(
  new LibFaust(await instantiateFaustModuleFromFile(join(faustwasm, "libfaust-wasm", "libfaust-wasm.js"))),
);

/** Copies the files into the compiler's own file system; returns the programs, text by name. */
function mirror() {
  const texts = Object.fromEntries(files.map((path) => [basename(path), readFileSync(path, "utf8")]));
  compiler.fs().mkdirTree(kVirtual);
  for (const [name, text] of Object.entries(texts)) compiler.fs().writeFile(`${kVirtual}/${name}`, text);
  const programs = Object.entries(texts).filter(([name]) => name.endsWith(".dsp"));
  return Object.fromEntries(programs.map(([name, text]) => [basename(name, ".dsp"), text]));
}

const options = (precision) => `-I ${kVirtual} -${precision}`;

/** Every program as WebAssembly: its factory by NAME_PRECISION. */
async function compileToWasm(programs) {
  const factories = {};
  for (const [name, code] of Object.entries(programs))
    for (const precision of ["single", "double"]) {
      const factory = await compiler.createMonoDSPFactory(name, code, options(precision));
      if (!factory?.code?.length) throw new Error(`${name}, ${precision}: ${compiler.getErrorMessage()}`);
      factories[`${name}_${precision}`] = factory;
    }
  return factories;
}

/** The C++ back end, where the package has it. */
function compileToCpp(programs) {
  for (const [name, code] of Object.entries(programs))
    for (const precision of ["single", "double"]) {
      const file = `${kVirtual}/${name}_${precision}.cpp`;
      try {
        compiler.generateAuxFiles(name, code, `-lang cpp ${options(precision)} -o ${file}`);
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
  const generator = new FaustMonoDspGenerator();
  await generator.compile(compiler, "mass_barrier", programs.mass_barrier_felt_c4, options("single"));
  const processor = await generator.createOfflineProcessor(run.sample_rate_hz, 64);
  for (const [label, value] of Object.entries(run.controls)) {
    const ending = `/${label.replace(/ /g, "_")}`;
    processor.setParamValue(processor.getParams().find((path) => path.endsWith(ending)), value);
  }
  return compare(processor.render([], run.outputs[0].length), run, "offline processor");
}

const programs = mirror();
const runs = JSON.parse(readFileSync(samples));
const factories = await compileToWasm(programs);
console.log(`Faust ${compiler.version()}: ${Object.keys(factories).length} WebAssembly programs`);
console.log(`${runs.length} runs; worst error relative to the bound:`, await runSamples(factories, runs));
console.log("offline processor, relative to the bound:", await renderOffline(programs, runs));
console.log("C++ back end:", compileToCpp(programs));
