// SPDX-License-Identifier: MIT
// Which instrument plays which channels of a MIDI file, as the program's --instrument has it (docs/how-to/midi.md).
import { badInput } from "./messages.js";

const kChannels = 16, kDrums = 10, kPrograms = 128;
const kAll = Array.from({ length: kChannels }, (_, i) => i + 1);
const kAllowed = '1 to 16, p1 to p128 for programs, or *, such as { 10: "kit", "*": "piano" }';

/** Channels as bits, the lowest for channel 1. Throws what is none. */
export function channelsIn(channels) {
  if (!Array.isArray(channels) || channels.some((channel) => !kAll.includes(channel))) throw badInput("channels", `${String(channels)} is no list of channels`, "numbers from 1 to 16");
  return channels.reduce((bits, channel) => bits | (1 << (channel - 1)), 0);
}

function isPlace(what) {
  const number = Number(what.replace(/^p/, ""));
  return what === "*" || (/^p?[1-9][0-9]*$/.test(what) && number <= (what.startsWith("p") ? kPrograms : kChannels));
}

/** The parts of a MIDI file: { title, remarks, end, parts: [{ instrument, channels, messages }] }. read: of channels.
 * instruments: by channel, by the program of its first note, or by * for all others but the tenth. Throws bad input. */
export function partsOf(read, instruments, file) {
  const wrong = Object.keys(Object(instruments)).find((what) => !isPlace(what));
  if (wrong !== undefined) throw badInput("instruments", `'${wrong}' names no channel`, kAllowed);
  const { title, remarks, end, channels } = read(kAll);
  const playerOf = ({ channel, program }) => instruments?.[channel] ?? (channel === kDrums ? undefined : (instruments?.[`p${program}`] ?? instruments?.["*"]));
  const players = new Map();
  for (const channel of channels) players.set(playerOf(channel), [...(players.get(playerOf(channel)) ?? []), channel]);
  const others = players.get(undefined) ?? [];
  players.delete(undefined);
  if (players.size === 0) throw badInput(`${file}: MIDI`, "no note is on a channel that instruments names", kAllowed);
  if (others.length > 0) remarks.push(`left out: notes of channels that instruments does not name: ${others.map(({ channel, notes }) => `${channel} (${notes})`).join(", ")}`);
  const parts = [...players].map(([instrument, played]) => {
    const own = played.map(({ channel }) => channel);
    return { instrument, channels: own, messages: read(own).messages };
  });
  return { title, remarks, end, parts };
}
