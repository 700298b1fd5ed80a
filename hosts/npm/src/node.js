// SPDX-License-Identifier: MIT
// The package in Node, which reads its files from the disk.
import { readFile } from "node:fs/promises";

import { reader } from "./files.js";

reader.read = (url) => readFile(url);

export * from "./contactspline.js";
