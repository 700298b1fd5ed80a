// SPDX-License-Identifier: MIT
// doc_test.mjs FAUST LIBRARY.lib WORK_FOLDER PROGRAM.dsp... -- FOLDER...: the library's documentation. Every public
// function is documented, its usage names its parameters, its example compiles, also on a normalised material, and
// one of the programs, whose output is tested, calls it. The folders hold the libraries.
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [faust, library, work, ...rest] = process.argv.slice(2);
const programs = rest.slice(0, rest.indexOf("--"));
const folders = rest.slice(rest.indexOf("--") + 1);
const text = readFileSync(library, "utf8");
const problems = [];

/** Blocks between a line of dashes with `(ct.)name` in it and the next line of dashes. */
function documentedFunctions() {
  const blocks = [...text.matchAll(/^\/\/-+`\((\w+)\.\)(\w+)`-+\n((?:\/\/(?!-).*\n)*)\/\/-+\n/gm)];
  return blocks.map(([, prefix, name, body]) => ({ prefix, name, doc: body.replace(/^\/\/ ?/gm, "") }));
}

/** Parameters of every definition at the left margin, helpers excepted. */
function publicDefinitions() {
  const [before] = text.split(/^\/\/=+Helpers=+/m);
  const found = [...before.matchAll(/^([a-z]\w*)(?:\(([^)]*)\))?\s*=/gm)];
  const listed = (parameters) => (parameters ?? "").split(/,\s*/).filter(Boolean);
  return Object.fromEntries(found.map(([, name, parameters]) => [name, listed(parameters)]));
}

/** The code under a heading. */
function codeUnder(doc, heading) {
  return doc.match(new RegExp(`#### ${heading}\\s*\`\`\`\\n([^]*?)\`\`\``))?.[1];
}

/** Compiles an example in both precisions; returns how many outputs it has. */
function compile(name, code) {
  const file = join(work, `${name}.dsp`);
  writeFileSync(file, code);
  const includes = folders.flatMap((folder) => ["-I", folder]);
  const [outputs] = ["-single", "-double"].map((precision) => {
    const cpp = execFileSync(faust, [precision, ...includes, file], { stdio: "pipe" });
    return Number(/getNumOutputs\(\)\s*{\s*return (\d+)/.exec(cpp)[1]);
  });
  return outputs;
}

function checkUsage({ name, doc }, parameters, complain) {
  const usage = codeUnder(doc, "Usage")?.trim();
  if (!usage) return complain("has no Usage");
  const call = new RegExp(`(?:^|: )${name}\\(([^)]*)\\)`).exec(usage);
  if (!call) return complain(`is not called in its Usage: ${usage}`);
  const before = usage.includes(` : ${name}(`) ? usage.split(" : ")[0].split(",") : [];
  const given = [...call[1].split(/,\s*/), ...before.filter((input) => input !== "_")];
  const expected = before.includes("_") ? parameters.slice(0, given.length) : parameters;
  if (given.join() !== expected.join()) complain(`Usage says (${given}), the definition (${parameters})`);
  const where = doc.match(/Where:\n([^]*?)(?=####|$)/)?.[1];
  if (!where) return complain("has no Where");
  for (const parameter of given)
    if (!where.includes(`* \`${parameter}\`:`)) complain(`Where does not tell ${parameter}`);
  return usage.split(" : ").at(-1).split(",").length;
}

function checkExample({ prefix, name, doc }, outputs, complain) {
  const example = codeUnder(doc, "Test");
  if (!example) return complain("has no Test");
  if (!example.includes(`${prefix}.${name}(`)) complain("is not called in its Test");
  const code = `${example}process = ${name}_test;\n`;
  const normalised = code.replaceAll(/library\("(?!contact)\w+\.lib"\)/g, "$&.normalised");
  if (normalised === code) complain("has a Test without a material");
  for (const [variant, source] of [[name, code], [`${name}_normalised`, normalised]])
    try {
      const has = compile(variant, source);
      if (has !== outputs) complain(`has ${outputs} outputs in Usage, ${has} in Test`);
    } catch (error) {
      complain(`Test does not compile: ${error.stderr?.toString().trim() ?? error.message}`);
    }
}

mkdirSync(work, { recursive: true });
const definitions = publicDefinitions();
const documented = documentedFunctions();
for (const name of Object.keys(definitions))
  if (!documented.some((entry) => entry.name === name)) problems.push(`${name} is public and not documented`);
for (const entry of documented) {
  const complain = (what) => void problems.push(`${entry.name}: ${what}`);
  if (!definitions[entry.name]) {
    complain("is documented and not defined");
    continue;
  }
  const outputs = checkUsage(entry, definitions[entry.name], complain);
  checkExample(entry, outputs, complain);
  if (!programs.some((program) => readFileSync(program, "utf8").includes(`${entry.prefix}.${entry.name}(`)))
    complain(`is in none of the tested programs ${programs}`);
}
if (documented.length === 0) problems.push("nothing is documented");
for (const problem of problems) console.error(`${library}: ${problem}`);
if (problems.length > 0) process.exit(1);
console.log(`${documented.length} functions: ${documented.map(({ name }) => name).join(", ")}`);
