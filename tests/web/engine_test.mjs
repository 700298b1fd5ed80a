// SPDX-License-Identifier: MIT
// engine_test.mjs ENGINE.wasm GENERATOR.wasm CONTACTSPLINE: the samples of the page's engine are those of `contactspline render`, in double
// precision on this machine, for a blow on instruments of files and for the voices of a score; and the limiter keeps within
// full scale.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";

import { startEngine } from "../../hosts/npm/src/engine.js";
import { startGenerator } from "../../hosts/npm/src/generator.js";
import { kLinear, limited } from "../../hosts/npm/src/limiter.js";
import { play } from "../../hosts/npm/src/messages.js";
import { instrumentOf, performance as performanceOf } from "../../web/src/scores.js";
import { assertEqualSound, fullScaleOf, kSamples, rendered, renderedScore } from "./rendered.mjs";

const [wasm, generatorWasm, program] = process.argv.slice(2);
const engine = startEngine(readFileSync(wasm), 44100);
const instruments = engine.instruments();
for (const file of readdirSync(new URL("../../data/instruments", import.meta.url)))
  assert.ok(instruments.some(({ name }) => `${name}.json` === file), `the page lacks ${file}`);

/** The first output of a blow by the engine. */
function played({ name, parameters, events }, number) {
  const samples = [];
  assert.ok(engine.choose(number));
  parameters.forEach(({ init }, parameter) => engine.set(parameter, init));
  engine.strike(0);
  while (samples.length < kSamples) samples.push(...engine.process(126)[0]);
  assert.ok(events.length > 0);
  const fullScale = fullScaleOf(program, name);
  return samples.map((x) => x * fullScale);
}

for (const name of ["tom", "marimba", "trichord_c4"]) {
  const number = instruments.findIndex((instrument) => instrument.name === name);
  const { parameter } = instruments[number].events[0];
  const { name: event, init } = instruments[number].parameters[parameter];
  const worst = assertEqualSound(name, played(instruments[number], number), rendered(program, name, event, init));
  console.log(`${name}: within ${worst.toExponential(1)} of the peak`);
}

// Scores: voices that are tuned and on two sides, whose keys are held, struck again while they are held, and let go, with the fret
// away, because what buzzes magnifies roundings; and keys that tune bodies together. Notes begin between blocks of 128 samples,
// where they are played here.
{
  const kBlock = 128;
  const at = (block) => (kBlock * block) / 44100;
  const velocity = 100 / 127; // as MIDI has it
  const scores = [
    {
      instrument: "fret_guitar",
      voices: [{ name: "low", tuning_cents: -300, pan: -0.5 }, { name: "plain", pan: 0 }, { name: "high", tuning_cents: 650, pan: 0.4 }],
      events: [
        { time_s: 0, fret_gap_shift_m: 0.005 },
        { time_s: at(1), voice: "low", key: 50, velocity, hold_s: at(20) },
        { time_s: at(1), voice: "high", key: 52, velocity, hold_s: at(10) },
        { time_s: at(6), voice: "high", key: 52, velocity, hold_s: at(30) },
        { time_s: at(8), voice: "plain", key: 45, velocity, hold_s: at(40) },
        { time_s: at(16), voice: "plain", key: 57, velocity, hold_s: at(40) },
      ],
    },
    ...["kalimba", "marimba"].map((instrument) => ({ instrument, events: [60, 73].map((key) => ({ time_s: at(1), key, velocity, hold_s: at(40) })) })),
  ];
  const generator = startGenerator(readFileSync(generatorWasm));
  const described = new Map(instruments.map((instrument) => [instrument.name, { ...instrument, tuned: (cents) => generator.tuned(instrument.name, cents, 44100) }]));
  for (const score of scores) {
    const name = instrumentOf(score, described);
    const { voices, messages } = performanceOf({ duration_s: 0, ...score }, described.get(name));
    assert.ok(engine.choose(instruments.findIndex((instrument) => instrument.name === name)));
    voices.forEach((voice, i) => {
      assert.ok(engine.addVoice(voice));
      engine.pan(i + 1, voice.pan);
    });
    const sides = [[], []];
    for (let block = 0; sides[0].length < kSamples; ++block) {
      while (messages[0].at < at(block + 0.5)) play(engine, messages.shift());
      engine.process(kBlock).slice(0, 2).forEach((samples, side) => sides[side].push(...samples));
    }
    // A voice in the middle is as loud on each side as one voice alone.
    const scale = (voices.length > 0 ? Math.SQRT2 : 1) / fullScaleOf(program, name);
    const expected = renderedScore(program, score, voices.length > 0 ? 2 : 1).map((side) => side.map((x) => x * scale));
    const worst = expected.map((side, i) => assertEqualSound(`${name}, side ${i}`, sides[i].slice(0, kSamples), side));
    console.log(`a score for ${name}: within ${Math.max(...worst).toExponential(1)} of the peak`);
  }
}

// Beside voices, the instrument itself waits until it is struck.
{
  const number = instruments.findIndex(({ name }) => name === "tanpura");
  const level = () => Math.max(...Array.from({ length: 100 }, () => engine.process(128)[0]).flatMap((samples) => [...samples].map(Math.abs)));
  assert.equal(startEngine(readFileSync(wasm)).addVoice(), false, "no instrument was chosen");
  assert.ok(engine.choose(number) && engine.addVoice());
  engine.strike(0, undefined, 1);
  const alone = level();
  assert.ok(engine.choose(number) && engine.addVoice());
  engine.strike(0, undefined, 1);
  engine.strike(0, undefined, 0);
  assert.ok(Math.abs(level() / alone - 2) < 1e-3, "the instrument is struck, too");
}

// Without an instrument nothing plays.
{
  const fresh = startEngine(readFileSync(wasm));
  assert.equal(fresh.choose(999), false);
  fresh.set(0, 1);
  fresh.noteOn(60, 1);
  fresh.noteOff(60);
  fresh.midi([0x90, 60, 100]);
  fresh.strike(0, 1);
  fresh.watchNone();
  assert.equal(fresh.books(), null);
  assert.equal(fresh.energy(), 0);
  assert.ok(fresh.process(128).every((channel) => channel.every((x) => x === 0)));
}

// A felt with memory answers a blow more stiffly than a slow press, and what it takes is in the books.
{
  const felt = JSON.parse(readFileSync(new URL("../../generated/felt_stulov_c4.json", import.meta.url)));
  const table = felt.knots_m.map((knot, i) => [knot, felt.energy_j[i], felt.force_n[i], felt.half_curvature_n_per_m[i]]);
  const blow = (memory) => {
    assert.ok(engine.choose(0));
    assert.ok(engine.useMaterial({ table, memory, mass_kg: 0.008, loss_s_per_m: 0 }));
    engine.noteOn(60, 1);
    const forces = [];
    while (forces.length < 250) forces.push(...engine.process(125)[2]);
    const { hammer, felt: stored, string, dissipated, work } = engine.books();
    // Single precision: 250 roundings of 6e-8 each.
    assert.ok(Math.abs(hammer + stored + string + dissipated - work) < 2e-5 * work, "the books balance");
    return { force: Math.max(...forces), lost: dissipated / work };
  };
  const [with_memory, without] = [blow(felt.memory.map((m) => [m.weight, m.relaxation_time_s])), blow([])];
  assert.ok(with_memory.lost > 5 * without.lost, `a memory takes ${with_memory.lost} of the blow`);
  assert.ok(with_memory.force < 0.95 * without.force, `force of ${with_memory.force} and ${without.force} N`);
  console.log(`a felt with memory takes ${with_memory.lost.toFixed(3)} of a blow, without ${without.lost.toFixed(3)}; forces ${with_memory.force.toFixed(1)} and ${without.force.toFixed(1)} N`);
}

// Choosing and playing all instruments again and again takes no more memory. The module begins with 16 MB, of which a leak of
// one voice of 60 kB in each round uses up the rest.
const used = [];
for (let round = 0; round < 250; ++round) {
  for (const number of instruments.keys()) {
    assert.ok(engine.choose(number));
    for (const bytes of [undefined, engine.packed(number)]) engine.addVoice({ bytes });
    for (const voice of [0, 1, 2]) engine.noteOn(60, 0.7, voice);
    engine.process(128);
  }
  used.push(engine.memory());
}
assert.equal(used.at(-1), used[1], `memory grows: ${used[1]} to ${used.at(-1)} bytes`);
console.log(`memory after 2 and after ${used.length} rounds of all instruments: ${(used[1] / 1e6).toFixed(1)} and ${(used.at(-1) / 1e6).toFixed(1)} MB`);

let last = limited(-1000);
assert.ok(last >= -1);
for (let x = -4; x <= 4; x += 1 / 1024) {
  assert.ok(limited(x) >= last && Math.abs(limited(x)) <= 1, `limited(${x})`);
  assert.ok(limited(x) - last <= 1 / 1024 + 1e-12 || x === -4, "no jump");
  if (Math.abs(x) <= kLinear) assert.equal(limited(x), x);
  last = limited(x);
}
assert.equal(limited(Infinity), 1);
assert.equal(limited(NaN), 0);
