// SPDX-License-Identifier: MIT
// build.mjs NODE_MODULES WASM_FOLDER FAUST_FOLDER LEVELS.json OUTPUT.html: the page as one file, which plays from any static
// host and from file://. LEVELS.json: of levels.mjs. CONTACTSPLINE_PAGE_ADDRESS in the environment: where it will stand, with preview.png beside it; links to the
// page then show that image.
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, dirname, extname, join, resolve } from "node:path";
import { gzipSync } from "node:zlib";

import { packedScores } from "./packed_scores.mjs";

const [modules, wasm, faust, levels, output] = process.argv.slice(2);
const source = dirname(new URL(import.meta.url).pathname);
const esbuild = createRequire(join(resolve(modules), "x"))("esbuild");

function bundle(entry) {
  const { outputFiles } = esbuild.buildSync({
    entryPoints: [entry],
    bundle: true,
    minify: true,
    write: false,
    format: "esm",
    target: "es2022",
    legalComments: "inline",
    nodePaths: [resolve(modules)],
  });
  return outputFiles[0].text;
}

const assets = { processor: Buffer.from(bundle(join(source, "..", "hosts", "npm", "src", "processor.js"))), worker: Buffer.from(bundle(join(source, "src", "worker.js"))) };
for (const name of ["engine", "studies", "generator"]) assets[name] = readFileSync(join(wasm, `${name}.wasm`));
assets.scores = JSON.stringify(packedScores());
assets.levels = readFileSync(levels);
for (const file of readdirSync(faust))
  assets[`${basename(file, extname(file))}-${extname(file) === ".wasm" ? "wasm" : "json"}`] = readFileSync(join(faust, file));

const packed = Object.entries(assets).map(
  ([name, bytes]) => `<script type="text/plain" id="asset-${name}">${gzipSync(bytes, { level: 9 }).toString("base64")}</script>`,
);
const style = readFileSync(join(resolve(modules), "uplot", "dist", "uPlot.min.css"), "utf8") + readFileSync(join(source, "style.css"), "utf8");
const licence = readFileSync(join(resolve(modules), "uplot", "LICENSE"), "utf8");
const address = process.env.CONTACTSPLINE_PAGE_ADDRESS ?? "";
if (!/^(https?:\/\/[^\s"<>]+\/)?$/.test(address))
  throw new Error(`CONTACTSPLINE_PAGE_ADDRESS: ${address} is no address of a folder; allowed: https://example.org/strings/`);
const preview = { "og:url": address, "og:image": `${address}preview.png`, "og:image:alt": "A hammer on a string in slow motion" };
const card = '<meta name="twitter:card" content="summary_large_image">';
const tags = Object.entries(preview).map(([property, content]) => `<meta property="${property}" content="${content}">`);
const fill = {
  "<!--PREVIEW-->": address ? [...tags, card].join("\n") : "",
  "<!--LICENCES-->": `<!-- The plots are drawn by uPlot:\n\n${licence.replaceAll("--", "- -")}-->`,
  "/*STYLE*/": style,
  "<!--ASSETS-->": packed.join("\n"),
  "/*SCRIPT*/": bundle(join(source, "src", "main.js")).replaceAll("</script", "<\\/script"),
};
let page = readFileSync(join(source, "index.html"), "utf8");
for (const [mark, text] of Object.entries(fill)) {
  if (page.split(mark).length !== 2) throw new Error(`index.html: ${mark} must stand there once`);
  page = page.split(mark).join(text);
}
mkdirSync(dirname(output), { recursive: true });
writeFileSync(output, page);
console.log(`${output}: ${(page.length / 1e6).toFixed(2)} MB`);
