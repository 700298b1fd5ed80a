// SPDX-License-Identifier: MIT
// How loud an instrument is made: one note of each has the same peak.
import { Centre } from "../../hosts/npm/src/centre.js";

const kMiddleC = 60; // the key of the first event, too; of instruments without it the one that is nearest
const kSilent = 1e-6; // of full scale: what is below is no note
const kPeak = 0.18; // of full scale: one note of every instrument, so that a chord has room
const kSeconds = 0.3;

/** The gain of an instrument of an engine (engine.js), by its number there and its description. */
export function noteGain(engine, { number, velocity, keys }, sampleRate) {
  const [lowest, highest] = keys ?? [kMiddleC, kMiddleC];
  engine.choose(number, sampleRate);
  engine.watchNone();
  engine.noteOn(Math.max(lowest, Math.min(highest, kMiddleC)), velocity);
  const centres = [new Centre(sampleRate), new Centre(sampleRate)];
  const [left, right] = engine.process(Math.round(kSeconds * sampleRate));
  const peak = [left, right].reduce((most, side, k) => side.reduce((max, x) => Math.max(max, Math.abs(centres[k].next(x))), most), 0);
  return peak > kSilent ? kPeak / peak : 1; // without a note: as loud as its file says
}
