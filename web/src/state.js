// SPDX-License-Identifier: MIT
// The state of the page in its address: instrument, material and controls.

/** The address part of a state { instrument, material: a name that ships or the text of a file, controls: { label: value } }. */
export function addressOf({ instrument, material, controls }) {
  const part = new URLSearchParams({ instrument });
  if (material.name) part.set("material", material.name);
  else part.set("text", material.text);
  for (const [label, value] of Object.entries(controls)) part.set(`.${label}`, String(value));
  return `#${part}`;
}

/** The state of an address part; nothing for what it does not say. */
export function stateOf(hash) {
  const part = new URLSearchParams(hash.replace(/^#/, ""));
  const controls = {};
  for (const [key, value] of part) if (key.startsWith(".") && Number.isFinite(Number(value))) controls[key.slice(1)] = Number(value);
  const material = part.has("text") ? { text: part.get("text") } : part.has("material") ? { name: part.get("material") } : null;
  return { instrument: part.get("instrument"), material, controls };
}
