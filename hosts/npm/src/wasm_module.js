// SPDX-License-Identifier: MIT
// Starts a WebAssembly module that Emscripten built without JavaScript beside it.

/** What such a module may import: no files, no clock. A program that ends has failed. */
function imports() {
  const none = () => 0;
  const end = (code) => {
    throw new Error(`the module ended with code ${code}`);
  };
  const named = {
    proc_exit: end,
    fd_write: none,
    fd_close: none,
    fd_seek: none,
    fd_read: none,
    environ_get: none,
    environ_sizes_get: none,
    emscripten_notify_memory_growth: none,
  };
  return new Proxy({}, { get: () => new Proxy(named, { get: (known, name) => known[name] ?? none }) });
}

/** The exports of a module, given compiled or as bytes, ready for calls. Synchronous: a worklet must not wait. */
export function startModule(given) {
  const module = given instanceof WebAssembly.Module ? given : new WebAssembly.Module(given);
  const provided = imports();
  const table = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) (table[from] ??= {})[name] = provided[from][name];
  const { exports } = new WebAssembly.Instance(module, table);
  exports._initialize?.();
  return exports;
}

/** The text at an address, up to its terminating zero. */
export function textAt(exports, address) {
  const bytes = new Uint8Array(exports.memory.buffer, address);
  return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
}

/** Calls use(address...) with texts copied into the module's memory. */
export function withTexts(exports, texts, use) {
  const damaged = texts.find((text) => typeof text !== "string" || text.includes("\0"));
  if (damaged !== undefined) throw new Error(`contactspline: text: ${typeof damaged === "string" ? "has a character of value 0" : "is no text"}; allowed: that of a file`);
  return withBytes(exports, texts.map((text) => new TextEncoder().encode(text + "\0")), use);
}

/** Calls use(address...) with bytes copied into the module's memory. */
export function withBytes(exports, copied, use) {
  const addresses = copied.map((bytes) => {
    const address = exports.contactspline_allocate(bytes.length);
    new Uint8Array(exports.memory.buffer, address, bytes.length).set(bytes);
    return address;
  });
  try {
    return use(...addresses);
  } finally {
    for (const address of addresses) exports.contactspline_free(address);
  }
}
