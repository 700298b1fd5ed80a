// SPDX-License-Identifier: MIT
// build.mjs NODE_MODULES WASM_FOLDER OUTPUT_FOLDER: the npm package as a folder, for `npm pack` or to be served as it is.
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const [modules, wasm, output] = process.argv.slice(2);
const source = fileURLToPath(new URL(".", import.meta.url));
const root = join(source, "..", "..");
const esbuild = createRequire(join(resolve(modules), "x"))("esbuild");

rmSync(output, { recursive: true, force: true });
mkdirSync(output, { recursive: true });
// One file each: a worklet's module that imports others is not found by all bundlers, nor by a page from another host.
esbuild.buildSync({
  entryPoints: ["contactspline.js", "node.js", "processor.js"].map((file) => join(source, "src", file)),
  bundle: true,
  format: "esm",
  target: "es2022",
  external: ["node:*"],
  outdir: output,
});
for (const name of ["engine.wasm", "generator.wasm"]) cpSync(join(wasm, name), join(output, name));
for (const name of ["README.md", "contactspline.d.ts", "example"]) cpSync(join(source, name), join(output, name), { recursive: true });
cpSync(join(root, "LICENSE"), join(output, "LICENSE"));
const [, version] = readFileSync(join(root, "CITATION.cff"), "utf8").match(/^version: (.+)$/m);
const { name, ...rest } = JSON.parse(readFileSync(join(source, "package.json"), "utf8"));
writeFileSync(join(output, "package.json"), `${JSON.stringify({ name, version, ...rest }, null, 2)}\n`);
console.log(`${output}: ${name} ${version}`);
