// SPDX-License-Identifier: MIT
// Files that the page hands out: text, CSV of a figure, sound.

/** Offers a file for download. content: text or bytes. */
export function download(name, content, type = "text/plain") {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** Columns with their titles as CSV; null is an empty field. */
export function csvOf(titles, columns) {
  const quoted = titles.map((title) => `"${title.replaceAll('"', '""')}"`);
  const rows = Array.from(columns[0], (_, i) => columns.map((column) => column[i] ?? "").join(","));
  return `${[quoted.join(","), ...rows].join("\n")}\n`;
}

/** Blocks [[left, right], ...] of samples within -1 to 1 as a WAV file of 16 bits. */
export function wavOf(blocks, sampleRate) {
  const frames = blocks.reduce((sum, [left]) => sum + left.length, 0);
  const view = new DataView(new ArrayBuffer(44 + 4 * frames));
  const text = (at, letters) => [...letters].forEach((letter, i) => view.setUint8(at + i, letter.charCodeAt(0)));
  text(0, "RIFF");
  view.setUint32(4, 36 + 4 * frames, true);
  text(8, "WAVEfmt ");
  // Size of the format, PCM, channels, rate, bytes per second, bytes per frame, bits.
  [[16, 4], [1, 2], [2, 2], [sampleRate, 4], [4 * sampleRate, 4], [4, 2], [16, 2]].reduce((at, [value, bytes]) => {
    if (bytes === 4) view.setUint32(at, value, true);
    else view.setUint16(at, value, true);
    return at + bytes;
  }, 16);
  text(36, "data");
  view.setUint32(40, 4 * frames, true);
  let at = 44;
  for (const [left, right] of blocks)
    for (let i = 0; i < left.length; ++i, at += 4) {
      view.setInt16(at, Math.round(32767 * left[i]), true);
      view.setInt16(at + 2, Math.round(32767 * right[i]), true);
    }
  return view.buffer;
}
