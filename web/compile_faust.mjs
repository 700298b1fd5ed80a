// SPDX-License-Identifier: MIT
// compile_faust.mjs NODE_MODULES OUTPUT_FOLDER FILE...: every .dsp among the files as NAME.wasm, in single precision, and
// NAME.json with its controls, by the Faust compiler of npm. The .lib among the files are what they import.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const kVirtual = "/contactspline";
const [modules, output, ...files] = process.argv.slice(2);
const faustwasm = join(resolve(modules), "@grame", "faustwasm");
const { FaustCompiler, LibFaust, instantiateFaustModuleFromFile } = await import(
  pathToFileURL(join(faustwasm, "dist", "esm", "index.js")).href
);
const compiler = new FaustCompiler(
  new LibFaust(await instantiateFaustModuleFromFile(join(faustwasm, "libfaust-wasm", "libfaust-wasm.js"))),
);

compiler.fs().mkdirTree(kVirtual);
const programs = [];
for (const file of files) {
  const text = readFileSync(file, "utf8");
  compiler.fs().writeFile(`${kVirtual}/${basename(file)}`, text);
  if (file.endsWith(".dsp")) programs.push([basename(file, ".dsp"), text]);
}
mkdirSync(output, { recursive: true });

for (const [name, text] of programs) {
  const factory = await compiler.createMonoDSPFactory(name, text, `-I ${kVirtual} -single -ftz 2`);
  if (!factory?.code?.length) throw new Error(`${name}.dsp: ${compiler.getErrorMessage()}`);
  writeFileSync(join(output, `${name}.wasm`), factory.code);
  const { size, inputs, outputs, ui } = JSON.parse(factory.json);
  writeFileSync(join(output, `${name}.json`), JSON.stringify({ name, size, inputs, outputs, ui }));
  console.log(`${name}: ${factory.code.length} bytes`);
}
