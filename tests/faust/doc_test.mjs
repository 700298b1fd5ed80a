// SPDX-License-Identifier: MIT
// doc_test.mjs NODE_MODULES FAUST LIBRARY.lib... -- EMITTED.lib...: the documentation of our Faust libraries. Every public
// function has a block in the form of the Faust libraries. Its Usage and Where name its parameters. Its Test runs as
// theirs do, for 48,000 samples in double precision, in the installed Faust and in that of the npm package: the samples
// are finite, not all of them 0, and the same within 1e-4. Every button is pressed. Writes a program for each library.
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { basename, dirname } from "node:path";

import { compileToWasm, loadFaustwasm } from "./npm/faustwasm.mjs";
import { runProgram } from "./wasm_program.mjs";

const kSamples = 48000;
const kTolerance = 1e-4;

const [modules, faust, ...rest] = process.argv.slice(2);
const libraries = rest.slice(0, rest.indexOf("--")).map(readLibrary);
const files = rest.filter((file) => file !== "--");
const problems = [];

/** A library: its prefix, parameters of its definitions by name, and documented functions with their text. */
function readLibrary(file) {
  const text = readFileSync(file, "utf8");
  const prefix = /Its official prefix is `(\w+)`/.exec(text)?.[1];
  const definitions = [...text.matchAll(/^([a-z]\w*)(?:\(([^)]*)\))?\s*=(?! library\()/gm)];
  const blocks = [...text.matchAll(/^\/\/-+`\((\w+)\.\)(\w+)`-+\n((?:\/\/(?!-).*\n)*)\/\/-+\n/gm)];
  return {
    name: basename(file, ".lib"),
    text,
    prefix,
    parameters: Object.fromEntries(definitions.map(([, name, list]) => [name, (list ?? "").split(/,\s*/).filter(Boolean)])),
    helpersAt: text.search(/^\/\/=+Helpers=+/m),
    documented: blocks.map(([, given, name, body]) => ({ name, prefix: given, doc: body.replace(/^\/\/ ?/gm, "") })),
  };
}

/** Public is what stands before the helpers, and what another library calls. */
function isPublic(library, name) {
  const at = library.text.search(new RegExp(`^${name}(\\(|\\s*=)`, "m"));
  const call = new RegExp(`\\b${library.prefix}\\.${name}\\b`);
  return at < library.helpersAt || libraries.some((other) => other !== library && call.test(other.text));
}

/** The code under a heading. */
function codeUnder(doc, heading) {
  return doc.match(new RegExp(`#### ${heading}\\s*\`\`\`\\n([^]*?)\`\`\``))?.[1];
}

/** Compares Usage and Where with the parameters; returns the number of outputs that Usage states. */
function checkUsage({ name, doc }, parameters, complain) {
  const usage = codeUnder(doc, "Usage")?.trim();
  if (!usage) return complain("has no Usage");
  const call = new RegExp(`(?:^|: )${name}(?:\\(([^)]*)\\))?(?= :|$)`).exec(usage);
  if (!call) return complain(`is not called in its Usage: ${usage}`);
  const before = usage.includes(` : ${name}`) ? usage.split(" : ")[0].split(",") : [];
  const given = [...(call[1] ?? "").split(/,\s*/).filter(Boolean), ...before.filter((input) => input !== "_")];
  const expected = before.includes("_") ? parameters.slice(0, given.length) : parameters;
  if (given.join() !== expected.join()) complain(`Usage says (${given}), the definition (${parameters})`);
  const where = doc.match(/Where:\n([^]*?)(?=####|$)/)?.[1] ?? "";
  for (const parameter of given)
    if (!where.includes(`* \`${parameter}\`:`)) complain(`Where does not tell ${parameter}`);
  return usage.includes(" : ") ? usage.split(" : ").at(-1).split(",").length : undefined;
}

/** The libraries that a Test imports and its one definition. */
function readTest({ name, prefix, doc }, complain) {
  const test = codeUnder(doc, "Test");
  if (!test) return complain("has no Test");
  const [, imports, definition] = /^((?:\w+ = library\("\w+\.lib"\);\n)*)([^]*)$/.exec(test);
  if (!definition.startsWith(`${name}_test =`)) return complain("its Test is not libraries and then its definition");
  if (!test.includes(`${prefix}.${name}`)) complain("is not called in its Test");
  return { imports: imports.trim().split("\n"), definition };
}

/** The documented functions of a library that have a Test; complains of what is missing. */
function checkedFunctions(library) {
  const complainOf = (name) => (what) => void problems.push(`${library.name}: ${name} ${what}`);
  for (const name of Object.keys(library.parameters))
    if (isPublic(library, name) && !library.documented.some((entry) => entry.name === name))
      complainOf(name)("is public and not documented");
  return library.documented.flatMap((entry) => {
    const complain = complainOf(entry.name);
    if (!library.parameters[entry.name]) return complain("is documented and not defined") ?? [];
    if (entry.prefix !== library.prefix) complain(`is documented with the prefix ${entry.prefix}`);
    const outputs = checkUsage(entry, library.parameters[entry.name], complain);
    const test = readTest(entry, complain);
    return test ? [{ ...entry, ...test, outputs, complain }] : [];
  });
}

/** All tests in one program, a group each; before the outputs of each it states how many they are. */
function programOf(functions) {
  const imports = new Set(functions.flatMap((entry) => entry.imports));
  const outputs = functions.map(({ name }) => `  outputs(${name}_test), hgroup("${name}", ${name}_test)`);
  return `${[...imports].join("\n")}\n${functions.map((entry) => entry.definition).join("")}process =\n${outputs.join(",\n")};\n`;
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
  const functions = checkedFunctions(library);
  if (functions.length === 0) throw new Error(`${library.name}: nothing is documented`);
  const worst = await runTests(library, functions, compiler);
  functions.forEach(({ name }, i) => console.log(`${library.prefix}.${name}: ${worst[i]?.toExponential(1)} tolerances`));
}
for (const problem of problems) console.error(problem);
process.exitCode = problems.length > 0 ? 1 : 0;
