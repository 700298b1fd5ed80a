// SPDX-License-Identifier: MIT
// levels.mjs WASM_FOLDER OUTPUT.json: by how many dB the page turns each score that ships up or down (src/loudness.js), from
// its sound by the engine.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import { Centre } from "../hosts/npm/src/centre.js";
import { startEngine } from "../hosts/npm/src/engine.js";
import { startGenerator } from "../hosts/npm/src/generator.js";
import { play } from "../hosts/npm/src/messages.js";
import { gainsOf, loudnessOf } from "./src/loudness.js";
import { noteGain } from "./src/note_gain.js";
import { instrumentOf, performance as performanceOf, readScore } from "./src/scores.js";
import { packedScores } from "./packed_scores.mjs";

const kRate = 44100, kBlock = 128;
const kBent = 1e-3; // of the samples may be above what counts as the peak: the limiter bends the points of drum strokes
const [wasm, output] = process.argv.slice(2);
const engine = startEngine(readFileSync(join(wasm, "engine.wasm")), kRate);
const generator = startGenerator(readFileSync(join(wasm, "generator.wasm")));
const tuned = ({ name }) => (cents) => generator.tuned(name, cents, kRate);
const instruments = new Map(engine.instruments().map((instrument, number) => [instrument.name, { ...instrument, number, tuned: tuned(instrument) }]));

function soundOf({ voices, messages }, instrument) {
  const { number } = instrument;
  const gain = noteGain(engine, instrument, kRate);
  engine.choose(number, kRate);
  voices.forEach((voice, i) => {
    engine.addVoice(voice);
    engine.pan(i + 1, voice.pan);
  });
  // Each message at its sample, as the audio thread has it: a bar that is struck while it sounds answers by where it is then.
  const sampleOf = ({ at }) => Math.round(at * kRate);
  const end = sampleOf(messages.at(-1));
  const channels = [0, 1].map(() => ({ centre: new Centre(kRate), samples: new Float32Array(end) }));
  for (let now = 0, next = 0; now < end; ) {
    for (; sampleOf(messages[next]) <= now; ++next) play(engine, messages[next]);
    const count = Math.min(kBlock, sampleOf(messages[next]) - now);
    const played = engine.process(count);
    channels.forEach(({ centre, samples }, k) => played[k].forEach((x, i) => (samples[now + i] = gain * centre.next(x))));
    now += count;
  }
  return channels.map(({ samples }) => samples);
}

const pieces = {};
for (const [name, packed] of Object.entries(packedScores())) {
  const score = readScore(packed, name, generator);
  const instrument = instruments.get(instrumentOf(score, instruments));
  if (!instrument) continue;
  const channels = soundOf(performanceOf(score, instrument), instrument);
  const peak = Math.max(...channels.map((samples) => samples.map(Math.abs).sort().at(-Math.ceil(kBent * samples.length))));
  pieces[name] = { loudness: loudnessOf(channels, kRate), peak };
}
const gains = gainsOf(pieces);
writeFileSync(output, JSON.stringify(gains));
for (const [name, { loudness, peak }] of Object.entries(pieces)) console.log(`${name}: ${loudness.toFixed(1)} dB(A), peak ${peak.toFixed(2)}, turned by ${gains[name]} dB`);
