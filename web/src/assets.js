// SPDX-License-Identifier: MIT
// The files that the build packed into the page (web/build.mjs), gzip in base64.

async function bytesOf(element) {
  const packed = await fetch(`data:application/gzip;base64,${element.textContent}`); // faster than atob()
  const unpacked = packed.body.pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(unpacked).arrayBuffer());
}

const loaded = new Map();

/** The bytes of an asset; unpacked once. */
export function asset(name) {
  if (!loaded.has(name)) loaded.set(name, bytesOf(document.getElementById(`asset-${name}`)));
  return loaded.get(name);
}

const compiled = new Map();

/** An asset that is a WebAssembly module; compiled once, also for the audio thread. */
export function moduleAsset(name) {
  if (!compiled.has(name)) compiled.set(name, asset(name).then((bytes) => WebAssembly.compile(bytes)));
  return compiled.get(name);
}

/** An asset that is JSON. */
export const jsonAsset = async (name) => JSON.parse(new TextDecoder().decode(await asset(name)));

/** An asset that is a script, as a blob: URL, for a thread that gets compiled modules. */
export const blobUrl = async (name) => URL.createObjectURL(new Blob([await asset(name)], { type: "text/javascript" }));

/** An asset that is a script, as a data: URL. From file://, worklets load from no other URL. */
export async function scriptUrl(name) {
  let text = "";
  for (const byte of await asset(name)) text += String.fromCharCode(byte);
  return `data:text/javascript;base64,${btoa(text)}`;
}
