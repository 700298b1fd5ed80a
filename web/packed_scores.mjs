// SPDX-License-Identifier: MIT
// The scores that ship, by name, as the page holds them.
import { readFileSync, readdirSync } from "node:fs";
import { basename, dirname, extname, join } from "node:path";

const folder = join(dirname(new URL(import.meta.url).pathname), "..", "data", "scores");
const withoutComments = (text) => JSON.parse(text.replace(/^\s*\/\/.*$/gm, ""));
const readers = { ".json": (bytes) => withoutComments(bytes.toString()), ".mid": (bytes) => ({ midi: bytes.toString("base64") }) };

export const packedScores = () =>
  Object.fromEntries(readdirSync(folder).map((file) => [basename(file, extname(file)), readers[extname(file)](readFileSync(join(folder, file)))]));
