// SPDX-License-Identifier: MIT
// engine_test.mjs ENGINE.wasm CONTACTSPLINE: the samples of the page's engine are those of `contactspline render`, in double
// precision on this machine, for a blow on instruments of files; and the limiter keeps within full scale.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";

import { startEngine } from "../../hosts/npm/src/engine.js";
import { kLinear, limited } from "../../hosts/npm/src/limiter.js";
import { assertEqualSound, fullScaleOf, kSamples, rendered } from "./rendered.mjs";

const [wasm, program] = process.argv.slice(2);
const engine = startEngine(readFileSync(wasm), 44100);
const instruments = engine.instruments();
for (const file of readdirSync(new URL("../../data/instruments", import.meta.url)))
  assert.ok(instruments.some(({ name }) => `${name}.json` === file), `the page lacks ${file}`);

/** The first output of a blow by the engine. */
function played({ name, parameters, events }, number) {
  const samples = [];
  assert.ok(engine.choose(number));
  parameters.forEach(({ init }, parameter) => engine.set(parameter, init));
  engine.noteOn(60, 1);
  while (samples.length < kSamples) samples.push(...engine.process(126)[0]);
  assert.ok(events.length > 0);
  return samples.map((x) => x * fullScaleOf(name));
}

for (const name of ["tom", "marimba_tube", "trichord_c4"]) {
  const number = instruments.findIndex((instrument) => instrument.name === name);
  const { parameter } = instruments[number].events[0];
  const { name: event, init } = instruments[number].parameters[parameter];
  const worst = assertEqualSound(name, played(instruments[number], number), rendered(program, name, event, init));
  console.log(`${name}: within ${worst.toExponential(1)} of the peak`);
}

// A slide rests on its string, which pulls at the bridge; beside voices, the instrument itself waits until it is struck.
{
  const number = instruments.findIndex(({ name }) => name === "slide_string");
  const last = () => Math.abs(Array.from({ length: 100 }, () => engine.process(128)[0][127]).at(-1));
  assert.ok(engine.choose(number) && last() > 0.01, "a slide pulls");
  assert.ok(engine.choose(number) && engine.addVoice({ string: 0, pluck_m: 0.3, height_m: 0.05 }));
  assert.equal(last(), 0, "a voice whose slide is away, alone");
  engine.noteOn(60, 1);
  assert.ok(last() > 0.01, "the instrument is struck");
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
    for (const cents of [-498, 0]) engine.addVoice({ cents }); // where it can be
    engine.addVoice({ cents: 700, string: 0, pluck_m: 0.3 });
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
