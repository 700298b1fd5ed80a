// SPDX-License-Identifier: MIT
// How loud an instrument is made: one note of each has the same peak.
import { Centre } from "../../hosts/npm/src/centre.js";

const kMiddleC = 60; // the key of the first event, too
const kPeak = 0.18; // of full scale: one note of every instrument, so that a chord has room
const kSeconds = 0.3;

/** The gain of an instrument of an engine (engine.js), by its number there and the velocity of its notes. */
export function noteGain(engine, number, velocity, sampleRate) {
  engine.choose(number, sampleRate);
  engine.watchNone();
  engine.noteOn(kMiddleC, velocity);
  const centres = [new Centre(sampleRate), new Centre(sampleRate)];
  const [left, right] = engine.process(Math.round(kSeconds * sampleRate));
  const peak = [left, right].reduce((most, side, k) => side.reduce((max, x) => Math.max(max, Math.abs(centres[k].next(x))), most), 0);
  return peak > 0 ? kPeak / peak : 1; // without a note: as loud as its file says
}
