// SPDX-License-Identifier: MIT
// The state of the page in its address: instrument, material, controls, keys, comparison, story and theme.

const within = (low, high) => (number) => number >= low && number <= high;
const integer = (low, high) => (number) => Number.isInteger(number) && within(low, high)(number);

/** The numbers of a state beside its controls, with what they may be. */
const kNumbers = new Map([["octave", integer(1, 8)], ["key", integer(0, 127)], ["compare", within(0.1, 1000)], ["step", integer(1, 9)]]);
const kThemes = ["light", "dark"];

/** The instrument of the user's own file. */
export const kOwn = "own";
/** Letters of such a file that a link takes. */
export const kMaxFile = 20000;

/** The address part of a state { instrument, file: the text of its file if it is the user's own, material: a name that ships or
 * the text of a file, controls: { parameter: value }, octave, key, compare, step, theme }. */
export function addressOf({ instrument, file, material, controls, ...rest }) {
  const part = new URLSearchParams({ instrument });
  if (file !== undefined && file.length <= kMaxFile) part.set("file", file);
  if (material.name) part.set("material", material.name);
  else part.set("text", material.text);
  for (const [parameter, value] of Object.entries(controls).sort()) part.set(`.${parameter}`, String(value));
  for (const [name, value] of Object.entries(rest)) part.set(name, String(value));
  return `#${part}`;
}

/** What of the page a lecture embeds, by its query: "stage", the number of a chapter of the story, or null for all. */
export function embeddedOf(query) {
  const embed = new URLSearchParams(query).get("embed");
  if (embed === null) return null;
  return kNumbers.get("step")(Number(embed)) ? Number(embed) : "stage";
}

/** The state of an address part, nothing for what it does not say; leftOut: what of it is no state, each in words. */
export function stateOf(hash) {
  const part = new URLSearchParams(hash.replace(/^#/, ""));
  const state = { instrument: part.get("instrument"), material: null, controls: {}, leftOut: [] };
  if (part.has("text")) state.material = { text: part.get("text") };
  else if (part.has("material")) state.material = { name: part.get("material") };
  if (part.has("file") && state.instrument === kOwn) state.file = part.get("file");
  for (const [name, value] of part) {
    if (["instrument", "material", "text"].includes(name) || (name === "file" && state.file !== undefined)) continue;
    const number = value.trim() === "" ? NaN : Number(value);
    if (name.startsWith(".") && Number.isFinite(number)) state.controls[name.slice(1)] = number;
    else if (kNumbers.get(name)?.(number)) state[name] = number;
    else if (name === "theme" && kThemes.includes(value)) state.theme = value;
    else state.leftOut.push(`${name} ${value}`);
  }
  return state;
}
