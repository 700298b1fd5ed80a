// SPDX-License-Identifier: MIT
// A spectrogram that moves to the left: dark to light, in an order that also holds without colours.

// The top of the spectrogram [Hz], and its width [s].
const kMaxFrequency = 10000;
const kSpan = 6;
const kFloor = -100; // dB
const kGap = 0.5; // seconds after which it goes on where it was

/** From black over blue and orange to pale yellow: lightness rises throughout. */
const kColours = Array.from({ length: 256 }, (_, i) => {
  const t = i / 255;
  const stops = [[0, 0, 4], [40, 11, 84], [120, 28, 109], [190, 55, 82], [237, 105, 37], [251, 180, 26], [252, 255, 164]];
  const at = t * (stops.length - 1);
  const k = Math.min(stops.length - 2, Math.floor(at));
  return stops[k].map((value, c) => Math.round(value + (stops[k + 1][c] - value) * (at - k)));
});

export class Spectrogram {
  constructor(canvas) {
    this.canvas = canvas;
    this.canvas.width = 600;
    this.canvas.height = 190;
    this.context = canvas.getContext("2d", { willReadFrequently: false });
    this.context.fillRect(0, 0, 600, 190);
    this.last = 0;
    this.column = this.context.createImageData(1, 190);
  }

  /** Draws what the analyser hears now. Call on every frame of the screen. */
  draw(analyser, seconds) {
    const { width, height } = this.canvas;
    if (seconds - this.last > kGap) this.last = seconds - kSpan / width;
    const columns = Math.min(width, Math.floor(((seconds - this.last) / kSpan) * width));
    if (columns < 1) return;
    this.last = seconds;
    this.levels ??= new Float32Array(analyser.frequencyBinCount);
    analyser.getFloatFrequencyData(this.levels);
    const bins = (kMaxFrequency / (analyser.context.sampleRate / 2)) * this.levels.length;
    for (let y = 0; y < height; ++y) {
      const level = this.levels[Math.floor(((height - 1 - y) / height) * bins)];
      const [r, g, b] = kColours[Math.max(0, Math.min(255, Math.round((255 * (level - kFloor)) / (-20 - kFloor)))) || 0];
      this.column.data.set([r, g, b, 255], 4 * y);
    }
    this.context.drawImage(this.canvas, -columns, 0);
    for (let x = width - columns; x < width; ++x) this.context.putImageData(this.column, x, 0);
  }
}
