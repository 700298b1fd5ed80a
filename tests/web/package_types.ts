// SPDX-License-Identifier: MIT
// A program that package_test.mjs compiles against the types of the package, in strict mode.
import { ContactSpline, instruments, loadGenerator, Player, type Report } from "contactspline";

const forces: number[] = [];
const context = new OfflineAudioContext(2, 44100, 44100);
const report = ({ time, force, energy, books }: Report) => forces.push(time, force[0], energy, books?.work ?? 0);
const piano: ContactSpline = await ContactSpline.create(context, "piano", { report, isLimited: true, oversample: 2 });
piano.connect(context.destination);
piano.parameters.get("knock_ratio")?.linearRampToValueAtTime(0, 1);
piano.noteOn(60);
piano.noteOn(60, 0.7, 0.5);
piano.noteOff(60, 1);
piano.midi([0xb0, 64, 127]);
piano.midi(new Uint8Array(3), 0.5);
piano.set("sustain", 1);
piano.loadPreset(piano.description.presets[0].name);
await piano.sent();
await piano.close();

const generator = await loadGenerator();
generator.takeFile("felt.csv", "compression_m, force_n");
const fitted: string = generator.fit(generator.fitFile(["felt.csv"], 0.003), "measurements").material;
const read = generator.instrument(generator.instruments().tanpura, "tanpura.json", { sampleRate: 48000 });
const line: string = read.error ?? read.parts;
for (const { time, bytes } of generator.readMidi(new Uint8Array(99), "song.mid").messages) piano.midi(bytes, 1 + time);
const player = await Player.create({ text: line, file: "mine.json" }, 48000, { oversample: 4 });
player.strike(player.description.events[0].name, 2.5);
player.useMaterial(generator.design(generator.materials().felt_c4, "felt_c4.json"));
await piano.replace({ text: line }), await player.replace({ text: line, file: "mine.json" });
player.tune(generator.readTuning({ scale: line, a4: 442 })), player.tune(null);
const [left, right, force]: Float32Array[] = player.process(64);
const sum: number = left[0] + right[0] + force[0] + player.energy() + player.sampleRate + player.latency + piano.latency;
player.close();
const [first, last]: number[] = (await instruments())[0].keys ?? [sum, 0];

// @ts-expect-error: a key is a number
piano.noteOn("C4", first + last);
// @ts-expect-error: an instrument is made by create()
new Player();
// @ts-expect-error: there is no such function
piano.play();
