// SPDX-License-Identifier: MIT
// The Faust compiler of the npm package: its module, and a compiler whose own file system holds some of our files.
import { readFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

/** Folder of our files in the compiler's file system, for -I. */
export const kOurs = "/contactspline";
/** Folder of the libraries of Faust there. */
export const kStandard = "/usr/share/faust";

export async function loadFaustwasm(modules, files) {
  const folder = join(resolve(modules), "@grame", "faustwasm");
  const faustwasm = await import(pathToFileURL(join(folder, "dist", "esm", "index.js")).href);
  const { FaustCompiler, LibFaust, instantiateFaustModuleFromFile } = faustwasm;
  const compiler = new FaustCompiler(
    new LibFaust(await instantiateFaustModuleFromFile(join(folder, "libfaust-wasm", "libfaust-wasm.js"))),
  );
  compiler.fs().mkdirTree(kOurs);
  for (const file of files) compiler.fs().writeFile(`${kOurs}/${basename(file)}`, readFileSync(file, "utf8"));
  return { faustwasm, compiler };
}

/** Compiles a program to WebAssembly; throws what the compiler says if it does not compile. */
export async function compileToWasm(compiler, name, code, precision) {
  const factory = await compiler.createMonoDSPFactory(name, code, `-I ${kOurs} -${precision}`);
  if (!factory?.code?.length) throw new Error(`${name}, ${precision}: ${compiler.getErrorMessage()}`);
  return factory;
}
