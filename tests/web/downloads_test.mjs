// SPDX-License-Identifier: MIT
// downloads_test.mjs GENERATOR.wasm CONTACTSPLINE [RANDOM]: what the page's generator emits is byte for byte what
// `contactspline generate` writes, for every material that ships and RANDOM others with uniform knots. RANDOM others with
// fitted knots too, but a fit may end at other last digits on another machine (docs/how-it-works/knots.md), as the browser is one.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { startGenerator } from "../../hosts/npm/src/generator.js";
import { materialText } from "../../web/src/material.js";

const [wasm, program, random = "0"] = process.argv.slice(2);
const generator = startGenerator(readFileSync(wasm));

/** Numbers from 0 to 1 that are the same in each run (mulberry32). */
function numbersFrom(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** A material as the page's editor can make it, with knots of one of these kinds. */
function randomMaterial(number, name, kinds) {
  const between = (low, high) => Number((low * (high / low) ** number()).toPrecision(3));
  const one = (values) => values[Math.floor(number() * values.length)];
  const exponent = Number((1.2 + 2.8 * number()).toFixed(2));
  return {
    name,
    stiffness: between(1e3, 1e6) * 1000 ** (exponent - 1),
    exponent,
    loss: one([0, between(0.01, 1)]),
    mass: between(1e-3, 1e-2),
    slowest: between(0.05, 0.5),
    fastest: between(1, 8),
    segments: Math.round(between(4, 64)),
    knots: one(kinds),
    minimise: one(["contact_duration", "force", "spectrum"]),
  };
}

/** The text of each file that the program writes for a material file of this text, or the program's message. */
function written(name, text) {
  const folder = mkdtempSync(join(tmpdir(), "contactspline-web-"));
  try {
    const file = join(folder, `${name}.json`);
    writeFileSync(file, text);
    const listed = name.startsWith("random_") ? file : name;
    execFileSync(program, ["generate", listed, "-o", join(folder, "out")], { stdio: ["ignore", "ignore", "pipe"] });
    return Object.fromEntries(
      ["lib", "hpp", "json"].map((ending) => [`${name}.${ending}`, readFileSync(join(folder, "out", `${name}.${ending}`), "utf8")]),
    );
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Are the knots and forces of two emitted JSON files within the digits to which a fit ends? */
function areClose(actual, expected) {
  const [a, b] = [JSON.parse(actual), JSON.parse(expected)];
  return ["knots_m", "force_n"].every(
    (key) => a[key].length === b[key].length && a[key].every((value, i) => Math.abs(value - b[key][i]) <= 1e-5 * Math.abs(b[key][i])),
  );
}

const number = numbersFrom(18);
const made = (prefix, kinds) =>
  Array.from({ length: Number(random) }, (_, i) => randomMaterial(number, `random_${prefix}_${i}`, kinds)).map((m) => [m.name, materialText(m)]);
const shipped = Object.entries(generator.materials());
const exact = [...shipped, ...made("uniform", ["uniform"])];
const fitted = made("fitted", ["graded", "optimal"]);

let compared = 0;
for (const [name, text] of exact) {
  const { files } = generator.design(text, `${name}.json`);
  for (const [file, bytes] of Object.entries(written(name, text))) {
    if (files[file] !== bytes) throw new Error(`${file}: the page's bytes differ from the program's; material: ${text}`);
    ++compared;
  }
}
if (shipped.length < 10 || compared !== 3 * exact.length) throw new Error(`only ${compared} files compared`);
console.log(`${shipped.length} materials that ship, ${random} random ones with uniform knots: every byte of ${compared} files is equal`);

let equal = 0;
for (const [name, text] of fitted) {
  const { files } = generator.design(text, `${name}.json`);
  const bytes = written(name, text);
  if (Object.keys(bytes).every((file) => files[file] === bytes[file])) ++equal;
  else if (!areClose(files[`${name}.json`], bytes[`${name}.json`])) throw new Error(`${name}: another spline; material: ${text}`);
}
console.log(`${random} random ones with fitted knots: every byte is equal for ${equal}, the others agree to the digits of the fit`);
