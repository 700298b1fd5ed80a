// SPDX-License-Identifier: MIT
// The thread that designs and computes slow motion and the figures of the story, asked by background.js.
import { startGenerator } from "../../hosts/npm/src/generator.js";
import { BowedString } from "./bowed_string.js";
import { compared } from "./compared.js";
import { renderFd } from "./fd_hammer.js";
import { StoryNumbers } from "./story_numbers.js";
import { startStudies } from "./studies.js";

const kEnergyShown = 0.008; // seconds

let studies = null; // with the material of the editor
let numbers = null; // of the story
let generator = null;
let program = null; // fd.hammer
let bowed = null; // the string of the story

const tasks = {
  start({ modules, description, parameters, sampleRate }) {
    generator = startGenerator(modules.generator);
    studies = startStudies(modules.studies, sampleRate);
    program = { module: modules.fd, description, sampleRate };
    bowed = new BowedString(startStudies(modules.studies, sampleRate), generator, sampleRate);
    numbers = new StoryNumbers(startStudies(modules.studies, sampleRate), generator, parameters, sampleRate);
  },
  material: (design) => studies.useMaterial(design),
  play: ({ instrument, bytes, values, note }) => studies.play(instrument, values, note, { bytes }),
  scene: ({ instrument, bytes, values, note }) => numbers.scene(instrument, values, note, bytes),
  blow: ({ text, speed, mass }) => numbers.told(numbers.blow(text, speed, { mass })),
  blows: (exponent) => numbers.blows(exponent),
  spline: (pieces) => numbers.spline(pieces),
  step: (ratio) => numbers.step(ratio),
  compared: ({ ratio, seconds, shown }) => compared(tasks.strikes({ ratio, seconds }), Math.round(shown * program.sampleRate), program.sampleRate),
  strikes: ({ ratio, seconds }) => ({ ours: numbers.strike(ratio, seconds), theirs: renderFd(program, ratio, seconds) }),
  energies: (ratio) => numbers.energies(ratio, renderFd(program, ratio, kEnergyShown)),
  gong: ({ bytes, values, speeds }) => numbers.gong(bytes, values, speeds),
  bow: (given) => bowed.scene(given),
  bowColumn: (given) => bowed.column(given),
  design: ({ text, name }) => generator.design(text, name),
};

// Large lists are handed over, not copied.
const listsOf = (answer) => Object.values(answer ?? {}).filter(ArrayBuffer.isView).map(({ buffer }) => buffer);

onmessage = ({ data: { number, task, given } }) => {
  try {
    const answer = tasks[task](given);
    postMessage({ number, answer }, [...new Set(listsOf(answer))]);
  } catch (error) {
    postMessage({ number, error: error.message });
  }
};
