// SPDX-License-Identifier: MIT
// The slow motion of one strike: the string or the barrier, the hammer with its felt, and where the energy is.
import { colour } from "./plots.js";

/** Where the energy is: column of the study, its name, its colour. */
const kEnergies = {
  string: [["hammer", "hammer", "orange"], ["felt", "felt", "felt"], ["string", "string", "blue"], ["dissipated", "lost", "soft"]],
  barrier: [["hammer", "mass", "orange"], ["felt", "contact", "felt"], ["dissipated", "lost", "soft"]],
};

export class Stage {
  constructor(canvas, { play, time, speed }) {
    Object.assign(this, { canvas, play, time, speed, study: null, at: 0, isPlaying: true, last: null });
    play.addEventListener("click", () => this.setPlaying(!this.isPlaying));
    time.addEventListener("input", () => {
      this.setPlaying(false);
      this.at = Number(time.value) * this.length();
      this.draw();
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Shows a study from its beginning. kind: "string" or "barrier"; position: of the hammer, part of the length. */
  show(study, kind, position) {
    const largest = (list) => list.reduce((max, value) => Math.max(max, Math.abs(value)), 1e-9);
    const shapes = Array.from({ length: study.frames }, (_, i) => largest(study.shape(i)));
    const inView = study.place.filter((place) => place > -2e-3);
    this.scale = 1 / Math.max(largest(shapes), Math.min(2e-3, largest(inView)));
    Object.assign(this, { study, kind, position, at: 0 });
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) this.rest();
    else this.setPlaying(true);
  }

  // Where the force is largest, without motion.
  rest() {
    const { force, sampleRate } = this.study;
    this.at = force.indexOf(force.reduce((max, value) => Math.max(max, value), 0)) / sampleRate;
    this.time.value = this.at / this.length();
    this.setPlaying(false);
    this.draw();
  }

  setPlaying(isPlaying) {
    this.isPlaying = isPlaying;
    this.play.textContent = isPlaying ? "Pause" : "Play";
    this.last = null;
  }

  length() {
    return this.study ? (this.study.frames - 1) / this.study.sampleRate : 0;
  }

  /** Moves on to the time of the screen [s] and draws. */
  frame(now) {
    if (!this.study || !this.isPlaying) return;
    if (this.last !== null) this.at += Math.min(0.1, now - this.last) / Number(this.speed.value);
    this.last = now;
    if (this.at > this.length()) this.at = 0;
    this.time.value = this.at / this.length();
    this.draw();
  }

  draw() {
    const { canvas, study } = this;
    const ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio))
      Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    if (!study) return;
    const at = this.at * study.sampleRate;
    const i = Math.min(study.frames - 2, Math.floor(at));
    const value = (list) => list[i] + (list[i + 1] - list[i]) * (at - i);
    const wide = width > 560;
    const box = { left: 24, right: width - (wide ? 170 : 138), middle: height * 0.42, unit: height * 0.3 * this.scale };
    this.drawString(context, box, i, at - i);
    this.drawHammer(context, box, value);
    this.drawEnergy(context, { x: box.right + (wide ? 34 : 22), width: wide ? 26 : 18, height }, value);
    context.fillStyle = colour("ink");
    context.font = "600 14px system-ui";
    context.fillText(`${(this.at * 1000).toFixed(2)} ms`, 12, 20);
    context.fillStyle = colour("soft");
    context.font = "13px system-ui";
    context.fillText(`force ${value(study.force).toFixed(2)} N`, 12, 38);
  }

  drawString(context, { left, right, middle, unit }, i, part) {
    const { study, kind } = this;
    const now = study.shape(i);
    const next = study.shape(i + 1);
    context.strokeStyle = colour(kind === "barrier" ? "soft" : "blue");
    context.lineWidth = kind === "barrier" ? 10 : 3;
    context.lineJoin = "round";
    const shift = kind === "barrier" ? -5 : 0;
    context.beginPath();
    now.forEach((y, p) => {
      const x = left + ((right - left) * p) / (now.length - 1);
      context.lineTo(x, middle + shift - (y + (next[p] - y) * part) * unit);
    });
    context.stroke();
    if (kind === "barrier") return;
    context.fillStyle = colour("ink");
    for (const x of [left, right]) context.fillRect(x - 3, middle - 9, 6, 18);
  }

  // The felt yields where it meets the string: its top stays at the string.
  drawHammer(context, { left, right, middle, unit }, value) {
    const { study, kind, position } = this;
    const x = left + (right - left) * (kind === "barrier" ? 0.5 : position);
    const compression = Math.max(0, value(study.compression));
    const top = middle - (value(study.place) - compression) * unit;
    const squeezed = compression * unit;
    const [radius, depth] = [17, 30];
    const bottom = top + depth + radius - squeezed;
    context.fillStyle = colour("wood");
    if (kind === "string") context.fillRect(x - 5, bottom - 4, 10, 400);
    context.fillStyle = colour("felt");
    context.beginPath();
    context.roundRect(x - radius - squeezed / 4, top, 2 * radius + squeezed / 2, Math.max(8, bottom - top), radius);
    context.fill();
  }

  // One column of constant height: what changes is only where the energy is.
  drawEnergy(context, { x, width, height }, value) {
    const { study, kind } = this;
    const parts = kEnergies[kind].map(([name, label, paint]) => [Math.max(0, value(study[name])), label, paint]);
    const total = parts.reduce((sum, [energy]) => sum + energy, 0);
    const [top, full] = [28, height - 44];
    let y = top + full;
    context.font = "12px system-ui";
    parts.forEach(([energy, label, paint], k) => {
      const part = (energy / total) * full;
      context.fillStyle = colour(paint);
      context.fillRect(x, y - part, width, part);
      const line = top + full - 8 - k * 30;
      context.fillRect(x + width + 8, line - 9, 9, 9);
      context.fillStyle = colour("ink");
      context.fillText(label, x + width + 21, line);
      context.fillText(`${Math.round((100 * energy) / total)} %`, x + width + 21, line + 13);
      y -= part;
    });
    context.strokeStyle = colour("ink");
    context.lineWidth = 1;
    context.strokeRect(x - 0.5, top - 0.5, width + 1, full + 1);
    context.fillText("energy", x - 6, 18);
  }
}
