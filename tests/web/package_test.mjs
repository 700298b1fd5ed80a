// SPDX-License-Identifier: MIT
// package_test.mjs NODE_MODULES PACKAGE.tgz CONTACTSPLINE [CASE]: the npm package, installed as a user does, in Node and in headless
// Chromium under a policy without eval. CASE: only the cases with this text in their name.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { extname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

import { closeBrowser, kSlow, openPage } from "./browser.mjs";
import { assertEqualSound, fullScaleOf, kSamples, rendered, renderedMidi } from "./rendered.mjs";

const [modules, packed, program, chosen = ""] = process.argv.slice(2);
const kRate = 44100;
const kBlock = 128;
const kFaded = 441; // samples at the end of what the program renders
const kPolicy = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self'; img-src data:";

// As a user installs it.
const size = statSync(packed).size;
assert.ok(size <= 2e6, `${size} bytes`);
const folder = mkdtempSync(join(tmpdir(), "contactspline-package-"));
writeFileSync(join(folder, "package.json"), '{ "private": true, "type": "module" }');
execFileSync("npm", ["install", "--offline", "--no-audit", "--no-fund", "--loglevel=error", resolve(packed)], { cwd: folder });
const installed = join(folder, "node_modules", "contactspline");

let made = 0; // WebAssembly instances
WebAssembly.Instance = new Proxy(WebAssembly.Instance, { construct: (of, [...given]) => (++made, new of(...given)) });

const { Player, instruments, loadGenerator } = await import(pathToFileURL(join(installed, "node.js")).href);
const all = await instruments();
const generator = await loadGenerator();

/** Numbers from 0 to 1 that are the same in each run (mulberry32). */
let seed = 33;
function random() {
  seed = (seed + 0x6d2b79f5) | 0;
  let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
}
const one = (list) => list[Math.floor(random() * list.length)];

const kLine = { constructor: Error, message: /^[^\n]*; allowed: [^\n]*$/ };

/** Plays blocks; before(block) acts before each. Returns left and right. */
function blocks(player, count, before = () => {}) {
  const channels = [0, 1].map(() => new Float32Array(count * kBlock));
  for (let block = 0; block < count; ++block) {
    before(block);
    const played = player.process(kBlock);
    channels.forEach((channel, k) => channel.set(played[k], block * kBlock));
  }
  return channels;
}

// MIDI files as other programs write them (tests/support/midi_files.hpp). A tick is 1/960 s.
const chunk = (kind, content) => [...Buffer.from(kind), ...[24, 16, 8, 0].map((bits) => (content.length >> bits) & 255), ...content];
const midiFile = (...tracks) => Buffer.from([...chunk("MThd", [0, 1, 0, tracks.length, 1, 224]), ...tracks.flat()]);
const ticks = (n) => (n < 128 ? [n] : [(n >> 7) | 128, n & 127]);
const exclusive = (...bytes) => [0xf0, bytes.length + 1, ...bytes, 0xf7];

/** A track of [tick, ...bytes]. */
function trackOf(...events) {
  const content = events.flatMap(([tick, ...bytes], i) => [...ticks(tick - (i > 0 ? events[i - 1][0] : 0)), ...bytes]);
  return chunk("MTrk", [...content, 0, 0xff, 0x2f, 0]);
}

// On the piano without pedals: the program leaves out strings that no note plays, which would ring along.
const kMidiFiles = {
  "tunings, a bend, fine velocities, releases, silence": midiFile(trackOf(
    [0, 0xb0, 101, 0], [0, 0xb0, 100, 0], [0, 0xb0, 6, 0], [0, 0xb0, 38, 50], [0, 0xe0, 127, 127],
    [0, ...exclusive(0x7f, 0x7f, 8, 2, 0, 1, 64, 64, 0x40, 0)], [0, 0xb0, 88, 64], [0, 0x90, 60, 40], [0, 0x90, 64, 90], [80, 0x80, 60, 127],
    [100, 0x80, 64, 1], [180, 0x90, 60, 90], [200, 0xb0, 120, 0], [220, 0x90, 64, 90], [240, 0x80, 64, 1],
  )),
  "two notes of a key, on two tracks, beside drums and a key that nobody lets go": midiFile(
    trackOf([0, 0x90, 60, 90], [101, 0x90, 60, 50], [303, 0x80, 60, 64], [400, 0x99, 36, 90]),
    trackOf([50, 0x90, 72, 70], [203, 0x80, 60, 64], [500, 0xff, 1, 1, 120]),
  ),
  "bends of MPE": midiFile(trackOf(
    [0, 0xb0, 101, 0], [0, 0xb0, 100, 6], [0, 0xb0, 6, 5], [0, 0xe1, 0, 72], [0, 0xe2, 0, 48], [0, 0x91, 60, 90], [0, 0x92, 67, 90],
    [500, 0x81, 60, 64], [500, 0x82, 67, 64],
  )),
  "running status after another event, a half pedal, a reset of controllers": midiFile(trackOf(
    [0, 0xb0, 64, 40], [3, 0x90, 60, 90], [200, 0xff, 1, 1, 120], [200, 60, 0], [600, 0xb0, 64, 127], [601, 0x90, 55, 90], [650, 0x80, 55, 64],
    [900, 0xb0, 121, 0], [1000, 0xb0, 123, 0],
  )),
};

/** The sound of the messages of a MIDI file, each taken before its sample; closes the player. */
function soundOf(player, messages, samples) {
  const sounds = [0, 1].map(() => new Float32Array(samples));
  let played = 0;
  const playTo = (sample) => {
    const parts = player.process(sample - played);
    sounds.forEach((sound, k) => sound.set(parts[k], played));
    played = sample;
  };
  for (const { time, bytes } of messages) {
    playTo(Math.round(time * kRate));
    player.midi(bytes);
  }
  playTo(samples);
  player.close();
  return sounds;
}

const cases = {
  "the package resolves by its name": () => {
    const text = 'import { Player, instruments } from "contactspline"; await Player.create("tom"); console.log((await instruments()).length);';
    writeFileSync(join(folder, "use.js"), text);
    assert.equal(execFileSync(process.execPath, ["use.js"], { cwd: folder, encoding: "utf8" }).trim(), String(all.length));
  },

  "the first lines of its README play": () => {
    const [, , node] = readFileSync(join(installed, "README.md"), "utf8").split("```js\n");
    writeFileSync(join(folder, "readme.js"), `${node.split("```")[0]}\nconsole.log(left.some((x) => x !== 0), right.length, force.length);`);
    assert.equal(execFileSync(process.execPath, ["readme.js"], { cwd: folder, encoding: "utf8" }).trim(), "true 128 128");
  },

  "types are those of the functions": () => {
    cpSync(fileURLToPath(new URL("package_types.ts", import.meta.url)), join(folder, "use.ts"));
    const options = ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext", "--lib", "es2022,dom,dom.iterable"];
    const { stdout, status } = spawnSync(process.execPath, [join(resolve(modules), "typescript", "bin", "tsc"), ...options, "use.ts"], { cwd: folder, encoding: "utf8" });
    assert.equal(status, 0, stdout);
    // Each function that the package exports has a type.
    const types = readFileSync(join(installed, "contactspline.d.ts"), "utf8");
    for (const type of [Player.prototype, Object.getPrototypeOf(Player.prototype)])
      for (const name of Object.getOwnPropertyNames(type))
        if (!["constructor", "send", "sendAt"].includes(name)) assert.match(types, new RegExp(`^  ${name}\\(`, "m"), name);
  },

  "samples are those of the program": async () => {
    for (const name of ["tom", "marimba", "trichord_c4"]) {
      const player = await Player.create(name, kRate);
      const { parameters, events } = player.description;
      const { name: event, init } = parameters[events[0].parameter];
      player.strike(events[0].name);
      const fullScale = fullScaleOf(program, name);
      const played = Array.from(blocks(player, 64)[0].subarray(0, kSamples), (x) => x * fullScale);
      const worst = assertEqualSound(name, played, rendered(program, name, event, init));
      // A strike of a value of its own is that with the parameter moved there.
      const [moved, struck] = [await Player.create(name, kRate), await Player.create(name, kRate)];
      moved.set(event, 0.5 * init);
      moved.strike(events[0].name);
      struck.strike(events[0].name, 0.5 * init);
      const [expected, actual] = [moved, struck].map((other) => blocks(other, 8)[0]);
      assert.deepEqual(actual, expected);
      assert.notDeepEqual(Array.from(actual), played.slice(0, actual.length));
      for (const other of [player, moved, struck]) other.close();
      console.log(`  ${name}: within ${worst.toExponential(1)} of the peak`);
    }
  },

  // What rings, 5.89/s at least, steps by less than the blow did, and is gone after 441 samples.
  "a file takes the place of what sounds, without a click": async () => {
    const text = generator.instruments().tom;
    const changed = text.replaceAll('"tension_n_per_m": 403', '"tension_n_per_m": 330');
    const step = (sound) => sound.reduce((most, x, i) => Math.max(most, i > 0 ? Math.abs(x - sound[i - 1]) : 0), 0);
    const note = (player) => (player.strike("strike_stick", 2), Array.from(blocks(player, 16)[0]));
    const player = await Player.create("tom", kRate), fresh = await Player.create({ text: changed }, kRate);
    const [before, expected] = [player, fresh].map(note);
    assert.notDeepEqual(expected, before);
    for (let change = 0; change < 100; ++change) {
      await assert.rejects(player.replace({ text: "{" }), /instrument\.json/);
      assert.notDeepEqual(Array.from(blocks(player, 1)[0]), Array(128).fill(0), "it rings on beside a damaged file");
      await player.replace({ text: change % 2 === 0 ? changed : text });
      const sound = [before.at(-1), ...blocks(player, 4)[0]].slice(1);
      assert.ok(step(sound) < step(before), "a click");
      assert.deepEqual(sound.slice(441), Array(512 - 441).fill(0));
      assertEqualSound("tom", note(player), change % 2 === 0 ? expected : before, 1e-4);
    }
    for (const other of [player, fresh]) other.close();
  },

  // The program takes the delay of an oversampled score away. Modes of files end at half of one rate; what hears little of higher ones agrees.
  "an oversampled instrument plays the samples of the program, late": async () => {
    for (const oversample of [2, 8]) {
      const player = await Player.create("classical_guitar", kRate, { oversample });
      const { parameters, events } = player.description;
      const { name: event, init } = parameters[events[0].parameter];
      player.strike(events[0].name);
      const fullScale = fullScaleOf(program, "classical_guitar");
      const played = Array.from(blocks(player, 64)[0].subarray(player.latency), (x) => x * fullScale);
      const expected = rendered(program, "classical_guitar", event, init, { oversample }).slice(0, played.length);
      assertEqualSound("classical_guitar", played.slice(0, expected.length), expected);
      assert.notEqual(player.latency, 0);
      player.close();
    }
    await assert.rejects(Player.create("tom", kRate, { oversample: 3 }), { message: "contactspline: oversample: 3 is unknown; allowed: 1, 2, 4, 8" });
    await assert.rejects(Player.create("tom", 192000, { oversample: 8 }), /sampleRate times oversample: 1536000 is out of range/);
  },

  "MIDI files are played as by the program": async () => {
    for (const [name, bytes] of Object.entries(kMidiFiles)) {
      const [instrument, fullScale] = name.includes("pedal") ? ["lap_steel", fullScaleOf(program, "lap_steel")] : ["piano", 1 / 12];
      const player = await Player.create(instrument, kRate);
      const { messages } = generator.readMidi(bytes, "song.mid");
      const expected = renderedMidi(program, bytes, instrument, fullScale).map((channel) => channel.slice(0, -kFaded));
      const sounds = soundOf(player, messages, expected[0].length).slice(0, expected.length);
      const worst = sounds.map((sound, k) => assertEqualSound(name, Array.from(sound), expected[k], 1e-4));
      console.log(`  ${name}: within ${Math.max(...worst).toExponential(1)} of the peak`);
    }
  },

  "a MIDI file plays on several instruments as by the program": async () => {
    const song = midiFile(trackOf(
      [0, 0xc2, 26], [0, 0x90, 60, 90], [10, 0x92, 55, 80], [20, 0x99, 48, 100], [30, 0x94, 60, 50], [100, 0x99, 36, 90], [200, 0x80, 60, 64], [300, 0x82, 55, 64],
    ));
    const instruments = { 1: "piano", 10: "kit", p27: "lap_steel" };
    const { parts, remarks } = generator.readMidi(song, "song.mid", { instruments });
    assert.deepEqual(parts.map(({ instrument, channels }) => [instrument, channels]), [["piano", [1]], ["lap_steel", [3]], ["kit", [10]]]);
    assert.deepEqual(remarks, ["left out: notes of channels that instruments does not name: 5 (1)"]);
    for (const { instrument, channels, messages } of parts) {
      const fullScale = instrument === "piano" ? 1 / 12 : fullScaleOf(program, instrument);
      const expected = renderedMidi(program, song, instrument, fullScale, channels).map((channel) => channel.slice(0, -kFaded));
      const sounds = soundOf(await Player.create(instrument, kRate), messages, expected[0].length).slice(0, expected.length);
      const worst = sounds.map((sound, k) => assertEqualSound(instrument, Array.from(sound), expected[k], instrument === "kit" ? 1e-3 : 1e-4));
      console.log(`  ${instrument}: within ${Math.max(...worst).toExponential(1)} of the peak`);
    }
    assert.deepEqual(generator.readMidi(song, "song.mid", { instruments: { 1: "piano", "*": "piano" } }).parts.map(({ channels }) => channels), [[1, 3, 5]], "all but the drums");
    assert.deepEqual(generator.readMidi(song, "song.mid", { channels: [10] }).channels, [{ channel: 10, program: 1, notes: 2 }]);
    for (const [options, line] of [
      [{ instruments: { 17: "kit" } }, "contactspline: instruments: '17' names no channel; allowed: 1 to 16, p1 to p128 for programs, or *, such as { 10: \"kit\", \"*\": \"piano\" }"],
      [{ instruments: { p129: "kit" } }, /^contactspline: instruments: 'p129' names no channel; /],
      [{ instruments: { 7: "kit" } }, /^contactspline: song\.mid: MIDI: no note is on a channel that instruments names; /],
      [{ instruments: null }, /^contactspline: song\.mid: MIDI: no note is on a channel that instruments names; /],
      [{ channels: [0] }, "contactspline: channels: 0 is no list of channels; allowed: numbers from 1 to 16"],
      [{ channels: "1" }, /^contactspline: channels: 1 is no list of channels; /],
    ])
      assert.throws(() => generator.readMidi(song, "song.mid", options), { message: line });
  },

  "a damaged MIDI file is one line, or plays": () => {
    const [bytes] = Object.values(kMidiFiles);
    let lines = 0;
    for (let i = 0; i < 500; ++i) {
      const damaged = Uint8Array.from(bytes.subarray(0, 14 + Math.floor(random() * bytes.length)));
      for (let k = Math.floor(random() * 6); k > 0; --k) damaged[Math.floor(random() * damaged.length)] = Math.floor(random() * 256);
      try {
        assert.ok(generator.readMidi(damaged, "damaged.mid").messages.every(({ time }) => time >= 0));
      } catch ({ message }) {
        assert.match(message, /^damaged\.mid: MIDI: [^\n]+$/);
        ++lines;
      }
    }
    assert.ok(lines > 20 && lines < 480, String(lines));
    for (const wrong of [undefined, "MThd", [77]]) assert.throws(() => generator.readMidi(wrong, "song.mid"), kLine);
  },

  "keys are tuned by files of Scala": async () => {
    const keymap = "2\n0\n127\n64\n64\n261.6255653005986\n12\n0\nx\n"; // middle C four keys higher, without its neighbour
    const cents = generator.readTuning({ keymap });
    assert.ok(cents.length === 128 && Math.abs(cents[64] + 400) < 1e-9 && Number.isNaN(cents[65]));
    assert.ok(Math.abs(generator.readTuning({ a4: 442 })[69] - 1200 * Math.log2(442 / 440)) < 1e-9);
    for (const name of ["piano", "lap_steel"]) {
      const played = async (key, tuning) => {
        const player = await Player.create(name, kRate);
        if (tuning !== undefined) player.tune(tuning);
        player.noteOn(key, 0.7);
        const sound = Array.from(blocks(player, 16)[0]);
        player.close();
        return sound;
      };
      const expected = await played(60);
      assertEqualSound(name, await played(64, cents), expected, 1e-5);
      assert.deepEqual(await played(60, null), expected);
      assert.ok((await played(65, cents)).every((x) => Math.abs(x) < 1e-12)); // a bar that rests on its string moves by roundings
    }
    const player = await Player.create("piano", kRate);
    for (const wrong of [[0, 1], "a scale", 7]) assert.throws(() => player.tune(wrong), kLine);
    assert.throws(() => generator.readTuning({ scale: "a scale\n1\n2/0\n" }), /^Error: scale: line 3: the ratio 2\/0 is not positive; allowed: /);
    const tom = await Player.create("tom", kRate);
    assert.throws(() => tom.tune(cents), /tom: has no keys that could be tuned/);
  },

  "a file's text plays what ships": async () => {
    const { tanpura } = generator.instruments();
    const sounds = [];
    for (const instrument of ["tanpura", { text: tanpura }, { text: tanpura.replace(/"tension_n": ([\d.]+)/, (_, n) => `"tension_n": ${1.1 * n}`) }]) {
      const player = await Player.create(instrument, kRate);
      player.strike(player.description.events[0].name);
      sounds.push(Array.from(blocks(player, 16)[0]));
      player.close();
    }
    assert.deepEqual(sounds[1], sounds[0]);
    assert.notDeepEqual(sounds[2], sounds[0]);
  },

  "a material of one's own plays": async () => {
    const sounds = [];
    for (const stiffness of [null, "4.5e9", "1e9"]) {
      const player = await Player.create("hammer_on_string", kRate);
      const text = generator.materials().felt_c4.replace('"felt_c4"', '"my_felt"').replace("4.5e9", stiffness);
      if (stiffness) player.useMaterial(generator.design(text, "my_felt.json"));
      player.noteOn(60, 1);
      sounds.push(Array.from(blocks(player, 16)[0]));
      player.close();
    }
    assert.deepEqual(sounds[1], sounds[0]);
    assert.notDeepEqual(sounds[2], sounds[0]);
    // A closed player leaves no material behind.
    const next = await Player.create("hammer_on_string", kRate);
    next.noteOn(60, 1);
    assert.deepEqual(Array.from(blocks(next, 16)[0]), sounds[0]);
    next.close();
  },

  "bad input is one line, that of the program": async () => {
    const text = generator.instruments().tanpura.replace('"bodies"', '"bodys"');
    writeFileSync(join(folder, "mine.json"), text);
    const { stderr } = spawnSync(program, ["inspect", "mine.json"], { cwd: folder, encoding: "utf8" });
    await assert.rejects(Player.create({ text, file: "mine.json" }), { message: stderr.trim().replace(/^contactspline: |^error: /, "") });
    const piano = await Player.create("piano");
    for (const [use, line] of [
      [() => Player.create("pianola"), /^contactspline: instrument: pianola is unknown; allowed: hammer_on_string, piano, /],
      [() => Player.create("piano", NaN), /^contactspline: sampleRate: NaN is out of range; allowed: 1000 to 768000$/],
      [() => piano.noteOn(NaN), /^contactspline: key: NaN is out of range; allowed: 0 to 127$/],
      [() => piano.noteOn(60.5), /^contactspline: key: 60.5 is no whole number; allowed: 0 to 127$/],
      [() => piano.noteOn(60, 2), /^contactspline: velocity: 2 is out of range; allowed: 0 to 1$/],
      [() => piano.noteOff("60"), /^contactspline: key: 60 is out of range/],
      [() => piano.strike("pluck"), /^contactspline: event: pluck is unknown; allowed: none$/],
      [() => piano.set("loudness", 1), /^contactspline: parameter: loudness is unknown; allowed: stiffness_ratio, /],
      [() => piano.set("sustain", NaN), /^contactspline: sustain: NaN is no number; allowed: 0 to 1$/],
      [() => piano.set("sustain", "1"), /^contactspline: sustain: 1 is no number/],
      [() => piano.process(-1), /^contactspline: samples: -1 is out of range; allowed: 0 to 16777216$/],
      [() => piano.process(1.5), /^contactspline: samples: 1.5 is no whole number/],
      [() => piano.midi(null), /^contactspline: midi: null is no message; allowed: bytes, /],
      [() => Player.create(null), /^contactspline: instrument: null is no instrument; allowed: a name such as piano/],
      [() => Player.create({ text: null }), /^contactspline: instrument: has no text; allowed: a name such as piano/],
      [() => Player.create(), /^contactspline: instrument: undefined is no instrument/],
      [() => piano.loadPreset("louder"), /^contactspline: preset: louder is unknown; allowed: /],
      [() => piano.useMaterial(generator.design(generator.materials().felt_c2, "felt_c2.json")), /^contactspline: piano: has materials of its own/],
      [() => generator.design("{", "felt.json"), /^felt.json: line 1, /],
    ])
      await assert.rejects(async () => use(), { message: line });
    piano.close();
  },

  "more samples than a block are those of its blocks": async () => {
    const [whole, parts] = [await Player.create("tanpura", kRate), await Player.create("tanpura", kRate)];
    for (const player of [whole, parts]) player.strike("pluck_finger");
    for (const samples of [0, 129, 256, 1000]) {
      const played = whole.process(samples);
      for (let done = 0; done < samples; done += kBlock) {
        const part = parts.process(Math.min(kBlock, samples - done));
        part.forEach((channel, k) => assert.deepEqual(played[k].slice(done, done + channel.length), channel.slice()));
      }
      assert.deepEqual(played.map(({ length }) => length), [samples, samples, samples]);
    }
    for (const player of [whole, parts]) player.close();
  },

  "after close() each function but close() is one line": async () => {
    const player = await Player.create("hammer_on_string");
    const { name } = player.description.parameters[0];
    player.close();
    for (const use of [
      () => player.process(), () => player.noteOn(60), () => player.noteOff(60), () => player.midi([0x90, 60, 1]), () => player.set(name, 1),
      () => player.energy(), () => player.useMaterial(generator.design(generator.materials().felt_c2, "felt.json")),
    ])
      assert.throws(use, { constructor: Error, message: /^contactspline: Player: is closed; allowed: [^\n]*$/ });
    player.close();
  },

  "400 misuses are one line each, or give finite samples": async () => {
    const wrong = [undefined, null, NaN, Infinity, -Infinity, -1, 1.5, 129, 1e9, 2 ** 31, "7", "", "x\0y", [], {}, [NaN, {}], Symbol("s"), true, () => 0, 10n];
    const design = generator.design(generator.materials().felt_stulov_c4, "felt.json");
    const copy = () => structuredClone({ ...design, files: {}, curve: {} });
    const damage = (rows) => {
      const row = one(rows);
      if (Array.isArray(row)) row[Math.floor(random() * row.length)] = one([NaN, -1, 1e300, "1", null, 0, 1e-300, Infinity, ...row]);
    };
    const damaged = [
      () => one(wrong),
      () => ({ ...copy(), table: one([...wrong, Array(129).fill(design.table[0]), [...design.table].reverse(), Array(4).fill(Array(5000).fill(1))]) }),
      () => ({ ...copy(), memory: one([...wrong, Array(5).fill([0.1, 1e-5]), Array(100000).fill([0.1, 1e-5]), [[0.1]]]) }),
      () => ({ ...copy(), mass_kg: one(wrong), loss_s_per_m: one(wrong) }),
      () => { const made = copy(); damage(made.table); damage(made.memory); return made; },
    ];
    let player = await Player.create("hammer_on_string", 44100);
    const { parameters } = player.description;
    const uses = [
      () => player.process(one(wrong.filter((value) => value !== Infinity))), () => player.noteOn(one(wrong), one([0.5, ...wrong])), () => player.noteOff(one(wrong)),
      () => player.strike(one(wrong), one(wrong)), () => player.midi(one(wrong)), () => player.set(one(wrong), one(wrong)),
      () => player.set(one(parameters).name, one(wrong)), () => player.loadPreset(one(wrong)),
      ...damaged.map((make) => () => player.useMaterial(make())),
      () => Player.create(one(wrong)), () => Player.create({ text: one(wrong), file: one(wrong) }), () => Player.create("tom", one(wrong)),
    ];
    let lines = 0;
    for (let i = 0; i < 400; ++i) {
      try {
        (await uses[i % uses.length]())?.close?.();
      } catch (error) {
        assert.equal(error.constructor, Error, `${error.stack}`);
        assert.match(error.message, /^[^\n]+$/);
        ++lines;
      }
      player.noteOn(60, 0.7);
      for (const channel of player.process(256)) assert.ok(channel.every(Number.isFinite), `misuse ${i}`);
      if (i % 100 === 99) {
        player.close();
        player = await Player.create("hammer_on_string", 44100);
      }
    }
    player.close();
    assert.ok(lines > 200, String(lines));
  },

  "a million values at random, and no sample that is not finite": async () => {
    const values = [NaN, 0, Infinity, -Infinity, 1e300, -1e300, 1e-300, 1, -1];
    let count = 0;
    for (const { name, parameters, events } of all) {
      const player = await Player.create(name, one([8000, 44100, 192000]));
      for (let block = 0; block < 800; ++block) {
        for (let i = 0; i < 100; ++i, ++count) {
          const { name: parameter, min, max } = one(parameters);
          const value = random() < 0.5 ? one(values) : min + random() * (max - min);
          if (Number.isNaN(value)) assert.throws(() => player.set(parameter, value), kLine);
          else player.set(parameter, value);
        }
        player.midi([one([0x80, 0x90, 0xb0, 0xe0, 0x00, 0xff]), Math.floor(random() * 256), Math.floor(random() * 256)]);
        if (events.length > 0) player.strike(one(events).name, one([undefined, 0, 1e300, -1e300, random()]));
        for (const channel of player.process(Math.floor(random() * 129))) assert.ok(channel.every(Number.isFinite), name);
      }
      player.close();
    }
    assert.ok(count >= 1e6, String(count));
  },

  // For twenty seconds; then four without a key. No friction exceeds 5.3 N.
  "a bow that jumps in each block rings out": async () => {
    const player = await Player.create("violin", kRate);
    const { parameters } = all.find(({ name }) => name === "violin");
    const bow = parameters.filter(({ name }) => name.startsWith("bow_") || name === "assistance");
    assert.equal(bow.length, 5);
    const [played, ended] = [20, 24].map((seconds) => Math.round((seconds * kRate) / kBlock));
    const levels = blocks(player, ended, (block) => {
      if (block < played) for (const { name, min, max } of bow) player.set(name, random() < 0.25 ? max : min + random() * (max - min));
      if (block < played && random() < 0.1) player.noteOn(55 + Math.floor(random() * 37), 1);
      if (block === played || random() < 0.02) for (let key = 55; key < 92; ++key) player.noteOff(key);
    });
    const peak = (channel) => channel.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
    for (const channel of levels) {
      assert.ok(channel.every(Number.isFinite) && peak(channel) > 0.01 && peak(channel) < 30, String(peak(channel)));
      assert.ok(peak(channel.subarray(-kRate / 10)) < 1e-3 * peak(channel), String(peak(channel.subarray(-kRate / 10))));
    }
    player.close();
  },

  "a hundred players in turn need no more memory": async () => {
    (await Player.create("tom")).close();
    const before = made;
    for (let i = 0; i < 100; ++i) {
      const player = await Player.create(all[i % all.length].name);
      player.noteOn(60, 0.7);
      player.process();
      player.close();
      player.close(); // does nothing
    }
    assert.equal(made, before, "engines that were made");
  },
};

/** Serves the folder of the package with the policy. */
function serveInstalled() {
  const types = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };
  const server = createServer(({ url }, response) => {
    try {
      const path = new URL(url, "http://localhost").pathname.replace(/\/$/, "/index.html");
      const bytes = readFileSync(join(installed, path));
      response.writeHead(200, { "Content-Type": types[extname(path)] ?? "text/plain", "Content-Security-Policy": kPolicy });
      setTimeout(() => response.end(bytes), 100 * (kSlow - 1));
    } catch {
      response.writeHead(404).end();
    }
  });
  return new Promise((done) => server.listen(0, "127.0.0.1", () => done({ address: `http://127.0.0.1:${server.address().port}/example/`, close: () => server.close() })));
}

const browserCases = {
  "the policy forbids eval": async (page) => {
    const isForbidden = await page.evaluate(async () => {
      await new Promise((later) => setTimeout(later)); // the policy does not hold for what a debugger calls itself
      try {
        return new Function("return false")();
      } catch {
        return true;
      }
    });
    assert.ok(isForbidden);
  },

  "a chord and AudioParams have the samples of Node": async (page) => {
    const sounds = await page.evaluate(async ([rate, block]) => {
      const { ContactSpline, instruments } = await import("../contactspline.js");
      const sounds = {};
      for (const { name, parameters, events } of await instruments()) {
        const context = new OfflineAudioContext(2, 100 * block, rate);
        const node = await ContactSpline.create(context, name);
        node.connect(context.destination);
        const wrong = parameters.filter(({ name, init, allowed }) => {
          const { defaultValue, minValue, maxValue } = node.parameters.get(name);
          return [[defaultValue, init], [minValue, allowed[0]], [maxValue, allowed[1]]].some(([is, shall]) => is !== Math.fround(shall));
        });
        if (wrong.length > 0 || node.parameters.size !== parameters.length) throw new Error(`${name}: ${JSON.stringify(wrong)}`);
        // Each moves at a block of its own; times in the middle of the block before.
        const at = (k) => (k - 0.5) * (block / rate);
        parameters.forEach(({ name, min, max }, k) => node.parameters.get(name).setValueAtTime(min + 0.3 * (max - min), at(10 + k)));
        const begin = (k) => k * (block / rate);
        for (const key of [60, 64, 67]) node.noteOn(key, 0.7, begin(40));
        node.noteOn(55, 0.5);
        if (events.length > 0) node.strike(events.at(-1).name, undefined, begin(50));
        node.noteOff(60, begin(60));
        node.midi([0xb0, 64, 127], begin(20));
        await node.sent();
        const buffer = await context.startRendering();
        sounds[name] = [0, 1].map((k) => Array.from(buffer.getChannelData(k)));
      }
      return sounds;
    }, [kRate, kBlock]);
    assert.equal(Object.keys(sounds).length, all.length);
    for (const { name, parameters, events } of all) {
      const player = await Player.create(name, kRate);
      player.noteOn(55, 0.5);
      const expected = blocks(player, 100, (block) => {
        if (block === 20) player.midi([0xb0, 64, 127]);
        if (block === 40) for (const key of [60, 64, 67]) player.noteOn(key, 0.7);
        if (block === 50 && events.length > 0) player.strike(events.at(-1).name);
        if (block === 60) player.noteOff(60);
        const moved = parameters[block - 10];
        if (moved) player.set(moved.name, Math.fround(moved.min + 0.3 * (moved.max - moved.min)));
      });
      player.close();
      assert.ok(expected[0].some((x) => x !== 0), name);
      expected.forEach((channel, k) => assert.deepEqual(Float32Array.from(sounds[name][k]), channel, name));
    }
  },

  "the page of the docs plays, bundled by esbuild": async (page) => {
    const docs = readFileSync(new URL("../../docs/how-to/npm.md", import.meta.url), "utf8");
    const [, html, script] = docs.match(/### With a bundler[^]*?```html\n([^]*?)```[^]*?```js\n([^]*?)```/);
    const built = join(installed, "bundled");
    mkdirSync(built);
    writeFileSync(join(folder, "main.js"), script);
    writeFileSync(join(built, "index.html"), html);
    const { buildSync } = createRequire(join(resolve(modules), "x"))("esbuild");
    buildSync({ entryPoints: [join(folder, "main.js")], bundle: true, format: "esm", outdir: built });
    for (const file of ["engine.wasm", "generator.wasm", "processor.js"]) cpSync(join(installed, file), join(built, file));
    // All that is connected is measured, too.
    await page.addInitScript(() => {
      const { connect } = AudioNode.prototype;
      AudioNode.prototype.connect = function (to, ...rest) {
        connect.call(this, (globalThis.meter ??= new AnalyserNode(this.context)));
        return connect.call(this, to, ...rest);
      };
    });
    await page.waitForLoadState("networkidle"); // what the example still loads would be an error
    await page.goto(new URL("/bundled/", server.address).href);
    await page.getByRole("button", { name: "Play" }).click();
    await page.waitForFunction(() => {
      const samples = new Float32Array(2048);
      globalThis.meter?.getFloatTimeDomainData(samples);
      return Math.max(...samples) > 1e-3;
    });
  },

  "a MIDI file has the samples of Node": async (page) => {
    const [[name, bytes]] = Object.entries(kMidiFiles);
    const samples = 200 * kBlock;
    const sounds = await page.evaluate(async ([file, samples, rate]) => {
      const { ContactSpline, loadGenerator } = await import("../contactspline.js");
      const node = await ContactSpline.create(new OfflineAudioContext(2, samples, rate), "piano");
      node.connect(node.context.destination);
      for (const { time, bytes } of (await loadGenerator()).readMidi(new Uint8Array(file), "song.mid").messages) node.midi(bytes, time);
      await node.sent();
      const buffer = await node.context.startRendering();
      return [0, 1].map((k) => Array.from(buffer.getChannelData(k)));
    }, [[...bytes], samples, kRate]);
    const expected = soundOf(await Player.create("piano", kRate), generator.readMidi(bytes, "song.mid").messages, samples);
    sounds.forEach((sound, k) => assertEqualSound(name, sound, Array.from(expected[k]), 1e-5));
  },

  "each parameter changes the sound": async (page) => {
    const silentOf = async (instrument) => {
      const { ContactSpline, instruments } = await import("../contactspline.js");
      const render = async (name, parameter) => {
        const context = new OfflineAudioContext(2, 0.4 * 44100, 44100);
        const node = await ContactSpline.create(context, name);
        node.connect(context.destination);
        // Far from where it is now.
        if (parameter) node.set(parameter.name, parameter.init - parameter.min > parameter.max - parameter.init ? parameter.min : parameter.max);
        const { keys, ranges, events, parameters } = node.description;
        const isOfKeys = ranges.length > 0 && events.length === 1; // an event without a key would hold the damper up
        for (const { name } of events) if (!isOfKeys) node.strike(name, undefined, 0.01);
        for (const { name } of events) if (name.startsWith("bow_")) node.strike(name, 0, 0.1); // so that the damper falls
        const key = Math.min(60, keys?.[1] ?? 60);
        if (keys || parameters.some(({ controller }) => controller === 64)) node.noteOn(key, 0.7, 0.01), node.noteOff(key, 0.1), node.noteOn(key, 0.7, 0.2);
        await node.sent();
        return (await context.startRendering()).getChannelData(0);
      };
      const silent = [];
      const { name, parameters } = (await instruments())[instrument];
      const usual = await render(name);
      for (const parameter of parameters) {
        const moved = await render(name, parameter);
        if (moved.every((x, i) => x === usual[i])) silent.push(`${name} ${parameter.name}`);
      }
      return silent;
    };
    const silent = [];
    const { length } = await page.evaluate(async () => (await import("../contactspline.js")).instruments());
    for (let instrument = 0; instrument < length; ++instrument) {
      await page.evaluate(async () => void (await (await import("../contactspline.js")).loadGenerator())); // as the example does: not in the midst of it
      await page.reload(); // a page has room for so many memories, which its contexts keep
      silent.push(...(await page.evaluate(silentOf, instrument)));
    }
    // A pedal that holds what keys do.
    assert.deepEqual(silent, ["piano sostenuto"]);
  },

  "force and energy are told": async (page) => {
    const { reports, largest } = await page.evaluate(async () => {
      const { ContactSpline } = await import("../contactspline.js");
      const context = new OfflineAudioContext(2, 16 * 1024, 44100);
      const reports = [];
      const node = await ContactSpline.create(context, "hammer_on_string", { report: ({ force, ...rest }) => reports.push({ ...rest, force: Array.from(force) }) });
      node.connect(context.destination);
      node.noteOn(60, 1);
      await node.sent();
      const buffer = await context.startRendering();
      for (let i = 0; i < 500 && reports.length < 16; ++i) await new Promise((later) => setTimeout(later, 10)); // they are on their way
      return { reports, largest: buffer.getChannelData(0).reduce((max, x) => Math.max(max, Math.abs(x)), 0) };
    });
    const player = await Player.create("hammer_on_string", kRate);
    player.noteOn(60, 1);
    const forces = [];
    for (let block = 0; block < 128; ++block) forces.push(...player.process()[2]);
    assert.deepEqual(reports.flatMap(({ force }) => force), forces);
    assert.ok(Math.max(...forces) > 10, "newtons");
    const { energy, books, strikes } = reports.at(-1);
    assert.equal(energy, player.energy());
    assert.equal(strikes, 1);
    assert.ok(books.work > 0 && books.string > 0 && Math.abs(books.hammer + books.felt + books.string + books.dissipated - books.work) < 1e-4 * books.work);
    assert.equal(Math.max(...reports.map(({ peak }) => peak)), largest);
    player.close();
  },

  "an instrument file and a material of one's own play": async (page) => {
    const { tanpura } = generator.instruments();
    const felt = generator.materials().felt_c4.replace('"felt_c4"', '"my_felt"').replace("4.5e9", "1e9");
    const [own, struck, error] = await page.evaluate(async ([tanpura, felt]) => {
      const { ContactSpline, loadGenerator } = await import("../contactspline.js");
      const render = async (instrument, play) => {
        const context = new OfflineAudioContext(2, 16 * 128, 48000);
        const node = await ContactSpline.create(context, instrument);
        node.connect(context.destination);
        play(node);
        await node.sent();
        return Array.from((await context.startRendering()).getChannelData(0));
      };
      const design = (await loadGenerator()).design(felt, "my_felt.json");
      return [
        await render({ text: tanpura }, (node) => node.strike(node.description.events[0].name)),
        await render("hammer_on_string", (node) => (node.useMaterial(design), node.noteOn(60, 1))),
        await render({ text: tanpura.replace('"bodies"', '"bodys"'), file: "mine.json" }).catch(({ message }) => message),
      ];
    }, [tanpura, felt]);
    const [expected, hammer] = [await Player.create("tanpura", 48000), await Player.create("hammer_on_string", 48000)];
    expected.strike(expected.description.events[0].name);
    assert.deepEqual(Float32Array.from(own), blocks(expected, 16)[0]);
    hammer.useMaterial(generator.design(felt, "my_felt.json"));
    hammer.noteOn(60, 1);
    assert.deepEqual(Float32Array.from(struck), blocks(hammer, 16)[0]);
    assert.match(error, /^mine\.json: bodys: unknown key; allowed: name, /);
    for (const player of [expected, hammer]) player.close();
  },

  "values and messages at random give finite samples": async (page) => {
    const isFinite = await page.evaluate(async () => {
      const { ContactSpline, instruments } = await import("../contactspline.js");
      const kLargest = 3.4e38;
      for (const { name, parameters, events } of await instruments()) {
        const context = new OfflineAudioContext(2, 200 * 128, 44100);
        const node = await ContactSpline.create(context, name);
        node.connect(context.destination);
        for (let block = 0; block < 200; ++block) {
          const time = (block * 128) / 44100;
          for (const { name, min, max } of parameters)
            node.parameters.get(name).setValueAtTime([kLargest, -kLargest, 0, 1e-38, min + Math.random() * (max - min)][Math.floor(5 * Math.random())], time);
          node.midi([0x80 + Math.floor(Math.random() * 128), Math.random() * 256, Math.random() * 256], time);
          node.midi([], time);
          if (events.length > 0) node.strike(events[0].name, [undefined, 1e300, 0][block % 3], time);
        }
        await node.sent();
        const buffer = await context.startRendering();
        if (![0, 1].every((k) => buffer.getChannelData(k).every(Number.isFinite))) return name;
      }
      return true;
    });
    assert.equal(isFinite, true);
  },

  "the example plays every instrument and a file": async (page) => {
    await page.waitForFunction(() => document.getElementById("text").value !== ""); // what the example does last
    assert.equal(await page.locator("#instrument option").count(), all.length);
    await page.click("#start");
    for (const { name, parameters } of all) {
      await page.selectOption("#instrument", name);
      await page.locator(`#parameters[data-instrument="${name}"]`).waitFor();
      assert.equal(await page.locator("#parameters input").count(), parameters.length, name);
      await page.locator("#keys button").first().dispatchEvent("pointerdown");
      await page.locator("#energy", { hasText: /[1-9]\.\d+e/ }).waitFor();
    }
    await page.selectOption("#instrument", "tom");
    await page.locator('#parameters[data-instrument="tom"]').waitFor();
    await page.getByText("An instrument file").click();
    await page.fill("#text", generator.instruments().snare.replace('"bodies"', '"bodys"'));
    await page.click("#play-text");
    await page.getByRole("alert").filter({ hasText: "instrument.json: bodys: unknown key" }).waitFor();
    await page.fill("#text", generator.instruments().snare);
    await page.click("#play-text");
    await page.locator('#parameters[data-instrument="snare"]').waitFor();
    assert.equal(await page.getByRole("alert").textContent(), "");
    assert.equal(await page.locator("#parameters input").count(), all.find(({ name }) => name === "snare").parameters.length);
  },

  "a node that is closed fades within 20 ms": async (page) => {
    const sound = await page.evaluate(async ([rate, block]) => {
      const { ContactSpline } = await import("../contactspline.js");
      const context = new OfflineAudioContext(2, 30 * block, rate);
      const node = await ContactSpline.create(context, "tom");
      node.connect(context.destination);
      node.strike("strike_stick");
      node.send({ do: "close", fades: true, at: 10 * (block / rate) });
      await node.sent();
      return Array.from((await context.startRendering()).getChannelData(0));
    }, [kRate, kBlock]);
    const player = await Player.create("tom", kRate);
    player.strike("strike_stick");
    const kFade = 882; // samples
    const expected = Array.from(blocks(player, 30)[0], (x, i) => x * Math.min(1, Math.max(0, 1 - (i + 1 - 10 * kBlock) / kFade)));
    player.close();
    assert.ok(Math.max(...expected.slice(10 * kBlock)) > 1e-3);
    sound.forEach((x, i) => assert.ok(Math.abs(x - expected[i]) < 1e-6, `sample ${i}: ${x}, ${expected[i]}`));
  },

  "a node that is closed, and what is no number, are one line": async (page) => {
    const lines = await page.evaluate(async () => {
      const { ContactSpline } = await import("../contactspline.js");
      const node = await ContactSpline.create(new OfflineAudioContext(2, 128, 44100), "tom");
      const [{ name }] = node.description.parameters;
      const message = (use) => { try { use(); } catch (error) { return error.message; } return "none"; };
      node.set(name, Infinity);
      const lines = [message(() => node.set(name, NaN))];
      await node.close();
      return [...lines, message(() => node.noteOn(60))];
    });
    assert.match(lines[0], /^contactspline: [a-z_]+: NaN is no number; allowed: /);
    assert.match(lines[1], /^contactspline: tom: is closed; allowed: /);
  },

  "an engine that cannot be made is an error in one line": async (page) => {
    const line = await page.evaluate(async () => {
      const { ContactSpline } = await import("../contactspline.js");
      const context = new OfflineAudioContext(2, 128, 44100);
      await context.audioWorklet.addModule("refuse.js");
      return ContactSpline.create(context, "piano").then(() => "made", ({ message }) => message);
    });
    assert.match(line, /^contactspline: piano: failed on the audio thread; allowed: /);
  },

  "a hundred nodes in turn need no more memory": async (page) => {
    await page.click("#start"); // now a context may run
    const { early, late } = await page.evaluate(async () => {
      const { ContactSpline, instruments } = await import("../contactspline.js");
      const context = new AudioContext();
      await context.resume();
      // Counts the instances of WebAssembly on the audio thread.
      await context.audioWorklet.addModule("count.js");
      const counter = new AudioWorkletNode(context, "count");
      const made = () => new Promise((told) => ((counter.port.onmessage = ({ data }) => told(data)), counter.port.postMessage("")));
      const names = (await instruments()).map(({ name }) => name);
      const round = async (i) => {
        const node = await ContactSpline.create(context, names[i % names.length], i % 2 ? { report: () => {} } : {});
        if (i % 3 > 0) node.connect(context.destination);
        node.noteOn(60, 0.7);
        await node.sent();
        await node.close();
        await node.close(); // does nothing
      };
      await round(0);
      const early = await made();
      for (let i = 0; i < 100; ++i) await round(i);
      return { early, late: await made() };
    });
    assert.equal(early, 1);
    assert.equal(late, 1);
  },
};

const chosenOf = (tests) => Object.entries(tests).filter(([name]) => name.includes(chosen));
for (const [name, test] of chosenOf(cases)) {
  await test();
  console.log(name);
}

// On the audio thread: WebAssembly as where no memory is left, and counted.
writeFileSync(join(installed, "example", "refuse.js"), `WebAssembly.Instance = class { constructor() { throw new RangeError("no memory"); } };`);
writeFileSync(join(installed, "example", "count.js"), `
let made = 0;
WebAssembly.Instance = new Proxy(WebAssembly.Instance, { construct: (of, given) => (++made, new of(...given)) });
registerProcessor("count", class extends AudioWorkletProcessor {
  constructor() {
    super();
    this.port.onmessage = () => this.port.postMessage(made);
  }
  process() { return true; }
});`);
const server = await serveInstalled();
const isExpected = (text) => /'unsafe-eval'|outside nominal range/.test(text); // of the first case, and of random values
const isElsewhere = (url) => !url.startsWith(new URL("/", server.address).href) && !url.startsWith("data:");
for (const [name, test] of chosenOf(browserCases)) {
  const { page, complaints, requests, close } = await openPage(modules, server.address);
  await test(page);
  assert.deepEqual(complaints.filter((text) => !isExpected(text)), []);
  assert.deepEqual(requests.filter(isElsewhere), [], "requests to elsewhere");
  await close();
  console.log(name);
}

// How many times real time, by the time that this process computes, whatever else the machine does.
const piano = await Player.create("piano", kRate);
for (let key = 52; key < 68; ++key) piano.noteOn(key, 0.7);
const began = process.cpuUsage().user;
for (let done = 0; done < 4 * kRate; done += kBlock) piano.process();
console.log(`16 notes of the piano: ${(4e6 / (process.cpuUsage().user - began)).toFixed(1)} times real time`);
console.log(`${(size / 1e6).toFixed(2)} MB packed`);
await closeBrowser();
server.close();
rmSync(folder, { recursive: true });
