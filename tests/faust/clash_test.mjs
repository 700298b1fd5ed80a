// SPDX-License-Identifier: MIT
// clash_test.mjs NODE_MODULES FAUST RESERVED_NAMES.cpp LIBRARY.lib... -- EMITTED.lib...: our Faust libraries beside
// those of the installed Faust and of the npm package. No file, prefix or symbol of ours is one of theirs; we call their
// libraries as they do (`ma`). All of them compile in one scope, and no material can have the name of a library. Writes
// one_scope.dsp.
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";

import { compileToWasm, kStandard, loadFaustwasm } from "./npm/faustwasm.mjs";

const [modules, faust, reservedNames, ...rest] = process.argv.slice(2);
const ours = rest.slice(0, rest.indexOf("--"));
const files = rest.filter((file) => file !== "--");
const problems = [];

/** What a library defines at its top level: each symbol with the text of its last definition. */
function definitions(text) {
  const code = text.replace(/"[^"]*"|\/\/[^\n]*|\/\*[^]*?\*\//g, (part) => (part[0] === '"' ? part : " "));
  const found = new Map();
  let depth = 0;
  let statement = "";
  for (const [token] of code.matchAll(/"[^"]*"|[(){};]|[^"(){};]+/g)) {
    if (token === "(" || token === "{") ++depth;
    if (token === ")" || token === "}") --depth;
    statement += token;
    if (token !== ";" || depth > 0) continue;
    const [, name] = /^\s*(\w+)\s*[(=]/.exec(statement) ?? [];
    if (name && !["import", "declare"].includes(name)) found.set(name, statement.trim());
    statement = "";
  }
  if (depth !== 0) throw new Error("the brackets do not match");
  return found;
}

/** Libraries of a Faust: definitions by file name. */
function standardLibraries(names, read) {
  const libraries = names.filter((name) => name.endsWith(".lib"));
  return new Map(libraries.map((name) => [basename(name), definitions(read(name))]));
}

/** Every .lib below a folder of the compiler's file system. */
function librariesBelow(fs, folder) {
  return fs.readdir(folder).filter((name) => !name.startsWith(".")).flatMap((name) => {
    const path = `${folder}/${name}`;
    return fs.isDir(fs.stat(path).mode) ? librariesBelow(fs, path) : [path];
  });
}

function prefixOf(file) {
  const prefix = /Its usual prefix is `(\w+)`/.exec(readFileSync(file, "utf8"))?.[1];
  if (!prefix) throw new Error(`${file}: names no prefix`);
  return prefix;
}

/** The file in `ma = library("maths.lib");`. */
function named(definition) {
  return /"(.*)"/.exec(definition)?.[1];
}

/** Fails on what a Faust has too. */
function compareWith(title, libraries) {
  const symbols = new Set([...libraries.values()].flatMap((found) => [...found.keys()]));
  if (libraries.size < 30 || symbols.size < 1000)
    throw new Error(`${title}: ${libraries.size} libraries with ${symbols.size} symbols only`);
  const where = (symbol) => [...libraries].filter(([, found]) => found.has(symbol)).map(([name]) => name);
  for (const file of ours) {
    if (libraries.has(basename(file))) problems.push(`${basename(file)} is a library of ${title}`);
    const found = definitions(readFileSync(file, "utf8"));
    const isTheirs = (symbol) => /^\w+ = library\(/.test(found.get(symbol)) && libraries.has(named(found.get(symbol)));
    for (const symbol of [prefixOf(file), ...found.keys()])
      if (symbols.has(symbol) && !isTheirs(symbol))
        problems.push(`${basename(file)}: ${symbol} is in ${where(symbol)} of ${title}`);
  }
  console.log(`${title}: ${libraries.size} libraries, ${symbols.size} symbols`);
}

/** Our libraries are imported into one scope: what two of them define must be the same. */
function compareAmongOurs() {
  const seen = new Map();
  for (const file of ours)
    for (const [symbol, text] of definitions(readFileSync(file, "utf8"))) {
      if ((seen.get(symbol) ?? text) !== text) problems.push(`${basename(file)}: ${symbol} has two definitions`);
      seen.set(symbol, text);
    }
  for (const prefix of ours.map(prefixOf))
    if (seen.has(prefix) && !/^\w+ = library\(/.test(seen.get(prefix))) problems.push(`${prefix} is prefix and function`);
  console.log(`ours: ${ours.length} libraries, ${seen.size} symbols`);
}

function checkReservedNames(names) {
  const reserved = readFileSync(reservedNames, "utf8").split(/\s+/);
  for (const name of names)
    if (!reserved.includes(basename(name, ".lib"))) problems.push(`a material may be called ${name}: reserve its name`);
}

// Everything of Faust and of ours in one scope, and Faust's environments beside ours.
const kOneScope = `import("stdfaust.lib");
import("all.lib");
${ours.map((file) => `import("${basename(file)}");`).join("\n")}
felt = library("felt_c4.lib");
body = library("guitar_d3.lib");
played = os.osc(440.0) : si.smoo : force(felt) : vibrate(body, 0.0, body.strike_shape, body.pickup_shape);
process = played, fret_string_ui(felt, body), smooth(0.9), ct.step(felt, 0.0000001), cm.move_to(body), ci.glide(0.1);
${ours.map((file) => `${prefixOf(file)} = library("${basename(file)}");`).join("\n")}
`;

const { compiler } = await loadFaustwasm(modules, files);
const installed = execFileSync(faust, ["-dspdir"], { encoding: "utf8" }).trim();
const debian = standardLibraries(readdirSync(installed), (name) => readFileSync(join(installed, name), "utf8"));
const npm = standardLibraries(librariesBelow(compiler.fs(), kStandard), (path) =>
  compiler.fs().readFile(path, { encoding: "utf8" }));
compareWith(`Faust ${/[\d.]+\d/.exec(execFileSync(faust, ["--version"], { encoding: "utf8" }))}`, debian);
compareWith(`Faust ${compiler.version()}`, npm);
compareAmongOurs();
checkReservedNames(new Set([...debian.keys(), ...npm.keys(), ...ours.map((file) => basename(file))]));
for (const problem of problems) console.error(problem);

const folders = [...new Set(files.map(dirname))].flatMap((folder) => ["-I", folder]);
writeFileSync("one_scope.dsp", kOneScope);
execFileSync(faust, [...folders, "-double", "one_scope.dsp"]);
await compileToWasm(compiler, "one_scope", kOneScope, "double");
process.exitCode = problems.length > 0 ? 1 : 0;
