// SPDX-License-Identifier: MIT
// Standard MIDI files, as messages for the audio thread.

const kDrums = 9; // channel 10, which no piano plays
const kUsualTempo = 500000; // microseconds in a quarter, where a file says nothing
const kTail = 2; // seconds after the last event
const kControllers = [64, 66, 67]; // sustain, sostenuto, soft pedal

/** Reads bytes one after the other; what lies beyond the end is an error. */
class Reader {
  constructor(bytes) {
    Object.assign(this, { bytes, at: 0 });
  }
  byte() {
    if (this.at >= this.bytes.length) throw new Error("it ends too early");
    return this.bytes[this.at++];
  }
  number(size) {
    let value = 0;
    for (let i = 0; i < size; ++i) value = value * 256 + this.byte();
    return value;
  }
  text(size) {
    return String.fromCharCode(...Array.from({ length: size }, () => this.byte()));
  }
  variable() {
    for (let value = 0, i = 0; i < 4; ++i) {
      const byte = this.byte();
      value = value * 128 + (byte & 127);
      if (byte < 128) return value;
    }
    throw new Error("a time has more than four bytes");
  }
  part(size) {
    if (this.at + size > this.bytes.length) throw new Error("it ends too early");
    this.at += size;
    return this.bytes.subarray(this.at - size, this.at);
  }
}

// All events of a track: { tick, tempo }, { tick, title } or { tick, bytes }.
function eventsOf(track) {
  const reader = new Reader(track);
  const events = [];
  for (let tick = 0, status = 0; reader.at < track.length; ) {
    tick += reader.variable();
    const first = reader.byte();
    if (first >= 0xf0) {
      const kind = first === 0xff ? reader.byte() : null;
      const data = reader.part(reader.variable());
      if (kind === 0x51 && data.length === 3) events.push({ tick, tempo: new Reader(data).number(3) });
      if (kind === 0x03) events.push({ tick, title: new TextDecoder().decode(data) });
      if (kind === 0x2f) break;
      continue;
    }
    if (first >= 0x80) status = first;
    if (status === 0) throw new Error("a track begins with data");
    const second = first >= 0x80 ? reader.byte() : first;
    const isShort = [0xc0, 0xd0].includes(status & 0xf0);
    events.push({ tick, bytes: [status, second, isShort ? 0 : reader.byte()] });
  }
  return events;
}

// What the piano does with an event; nothing for those of other instruments.
function messageOf([status, first, second]) {
  const kind = status & 0xf0;
  if ((status & 0x0f) === kDrums) return null;
  if (kind === 0x90 && second > 0) return { do: "noteOn", key: first, velocity: second / 127 };
  if (kind === 0x80 || kind === 0x90) return { do: "noteOff", key: first };
  if (kind === 0xb0 && kControllers.includes(first)) return { do: "midi", bytes: [kind, first, second] };
  return null;
}

/** A standard MIDI file for the piano, as performance() of scores.js makes it, and its title, the name of its first track. Throws what is wrong with the file. */
export function midiPerformance(bytes) {
  const reader = new Reader(bytes);
  if (bytes.length < 14 || reader.text(4) !== "MThd") throw new Error("it is no standard MIDI file");
  const size = reader.number(4);
  const [, tracks, division] = [reader.number(2), reader.number(2), reader.number(2)];
  if (division === 0 || division >= 0x8000) throw new Error("its times are not in parts of a quarter");
  reader.part(Math.max(0, size - 6));
  const events = []; // of each track
  for (let t = 0; t < tracks && reader.at < bytes.length; ++t) {
    const isTrack = reader.text(4) === "MTrk";
    const track = reader.part(reader.number(4));
    if (isTrack) events.push(eventsOf(track));
  }
  const messages = [];
  let [tempo, now, last] = [kUsualTempo, 0, 0];
  const all = events.flat();
  for (const event of all.toSorted((a, b) => a.tick - b.tick)) {
    now += ((event.tick - last) * tempo) / division / 1e6;
    last = event.tick;
    if (event.tempo) tempo = event.tempo;
    const message = event.bytes && messageOf(event.bytes);
    if (message) messages.push({ at: now, ...message });
  }
  if (!messages.some((message) => message.do === "noteOn")) throw new Error("it has no notes beside those of drums");
  const title = all.find((event) => event.title !== undefined)?.title ?? "";
  return { title, voices: [], messages: [...messages, { at: now + kTail, do: "end" }] };
}
