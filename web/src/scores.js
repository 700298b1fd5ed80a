// SPDX-License-Identifier: MIT
// The scores that ship (docs/reference/scores.md), as messages for the audio thread.

const kStep = 0.005; // seconds between two values of a control that glides
const kFirstKey = 60; // of the events of an instrument without keys
const kTail = 1; // seconds after the last event of a score that says no longer

/** A score as the build packed it, of a file of JSON or of MIDI (in base64). */
export function readScore(packed, name, generator) {
  if (packed.midi === undefined) return packed;
  return scoreOfMidi(generator.readMidi(Uint8Array.from(atob(packed.midi), (letter) => letter.charCodeAt(0)), name));
}

/** The score of a MIDI file that the generator has read, of which the piano plays all, or that much of its parts. */
export function scoreOfMidi({ title, messages, end, parts = [{ messages }] }) {
  const played = parts.flatMap(({ messages }, voice) => messages.map(({ time, bytes }) => ({ at: time, do: "midi", bytes, voice })));
  played.sort((a, b) => a.at - b.at);
  return { instrument: "piano", description: title, played: { voices: [], messages: [...played, { at: end + kTail, do: "end" }] } };
}

/** The instrument of the page that a score plays, or null. */
export function instrumentOf(score, instruments) {
  return instruments.has(score.instrument) ? score.instrument : null;
}

// A note and its end. A key or voice is let go when the last of its notes ends (runtime/contactspline/midi).
function noteMessages({ time_s, hold_s }, message) {
  const strike = { at: time_s, do: "noteOn", ...message };
  return hold_s === undefined ? [strike] : [strike, { at: time_s + hold_s, do: "noteOff", ...message }];
}

// Pressed keys, and let go.
function keyMessages({ events }, { speeds: [softest, loudest] }) {
  const velocityOf = (speed) => Math.max(0.01, Math.min(1, Math.log(speed / softest) / Math.log(loudest / softest)));
  return events.flatMap((note) => noteMessages(note, { key: note.key, velocity: velocityOf(note.speed_m_per_s) }));
}

// A key of an event, if it has one, pressed and let go.
function pressed(event, voice) {
  if (event.key === undefined) return [];
  return noteMessages(event, { voice, key: event.key, velocity: event.velocity ?? 1 });
}

// A control on its way from one value to another, which eases in and out.
function glide(at, over, from, to) {
  const steps = Math.max(1, Math.round(over / kStep));
  return Array.from({ length: steps }, (_, i) => {
    const u = (i + 1) / steps;
    return { at: at + over * u, value: from + (to - from) * u * u * (3 - 2 * u) };
  });
}

// What a score of another instrument says to one of its voices: keys that it has, and values of its parameters.
function eventMessages({ events }, { keys, parameters, events: played }, name, voice) {
  const now = parameters.map(({ init }) => init);
  const own = events.filter((event) => event.voice === undefined || event.voice === name).toSorted((a, b) => a.time_s - b.time_s);
  return own.flatMap((event) => [
    ...pressed(event, voice),
    ...parameters.flatMap((shape, parameter) => {
      const to = event[shape.name];
      if (to === undefined) return [];
      const set = { do: "set", voice, parameter };
      const number = played.findIndex((one) => one.parameter === parameter && !one.name.startsWith("bow_"));
      if (number >= 0 && keys) return [{ at: event.time_s, do: "strike", voice, event: number, value: to }];
      if (number >= 0) return [{ ...set, at: event.time_s, value: to }, ...noteMessages(event, { voice, key: kFirstKey + number, velocity: 1 })];
      const from = now[parameter];
      now[parameter] = to;
      return glide(event.time_s, event.over_s ?? 0, from, to).map((step) => ({ ...set, ...step }));
    }),
  ]);
}

/** A score for an instrument as engine.cpp describes it: { voices (engine.js), each with its pan, messages by rising time `at` [s] }.
 * A voice of the score is one beside the instrument; without voices the instrument itself plays. Its tuned(cents)
 * tells the bytes of the instrument with its strings tuned. */
export function performance(score, instrument) {
  if (score.played) return score.played;
  const voices = (score.voices ?? []).map(({ tuning_cents = 0, pan = 0 }) => ({ pan, bytes: tuning_cents === 0 ? undefined : instrument.tuned(tuning_cents) }));
  const names = score.voices?.map(({ name }) => name) ?? [undefined];
  const messages = instrument.speeds
    ? keyMessages(score, instrument)
    : names.flatMap((name, i) => eventMessages(score, instrument, name, score.voices ? i + 1 : 0));
  messages.sort((a, b) => a.at - b.at);
  const end = Math.max(score.duration_s, messages.at(-1).at + kTail);
  return { voices, messages: [...messages, { at: end, do: "end" }] };
}
