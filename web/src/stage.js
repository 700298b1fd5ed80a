// SPDX-License-Identifier: MIT
// The slow motion of one note: strings, what is thrown at them or stands in their way, where the energy is, the force.
import { readable } from "./controls.js";
import { colour } from "./plots.js";

/** Colours of energies by their names; those that are not here take the next of kOthers. */
const kPaints = { hammer: "orange", mass: "orange", felt: "felt", contact: "felt", string: "blue", strings: "blue", board: "green", lost: "soft" };
const kBridge = 0.05; // part of a string in which many stops are one bridge, which is drawn larger
const kReach = 130; // pixels by which a hammer is pulled back for its highest speed
const kNear = 60; // pixels around a hammer or a finger that take hold of it
const kTraces = 4; // earlier shapes of a string that stay in view
const kTrace = 1.5e-4; // seconds between two of them
const kSectors = 24; // of a membrane's circle
const kTilt = 0.3; // height of a membrane's circle over its width

const largest = (list) => list.reduce((max, value) => Math.max(max, Math.abs(value)), 0);

/** The largest of 1, 2 or 5 times a power of ten that is not above a number. */
function roundDown(number) {
  const power = 10 ** Math.floor(Math.log10(number));
  return [5, 2, 1].find((factor) => factor * power <= number * 1.000001) * power;
}

/** The value of a parameter, from 0 on, that is furthest from 0. */
export const strongest = ({ min, max }) => (Math.abs(max) >= Math.abs(min) ? max : min);

// Parts of a whole as whole percents whose sum is that of the parts: those with the largest remainders are rounded up.
function wholePercents(parts) {
  const sum = (numbers) => numbers.reduce((all, number) => all + number, 0);
  const percents = parts.map((part) => Math.floor(100 * part));
  const missing = Math.round(100 * sum(parts)) - sum(percents);
  const remainder = (k) => 100 * parts[k] - percents[k];
  [...parts.keys()].toSorted((a, b) => remainder(b) - remainder(a)).slice(0, missing).forEach((k) => ++percents[k]);
  return percents;
}

/** What a hammer that is pulled back, or a string that is pulled, will do, in words. parameters: of the instrument. */
export function toldOf({ throws }, parameters, power, place) {
  const told = [];
  if (throws !== null && power > 0)
    told.push(`${readable(Number((parameters[throws].factor * power * strongest(parameters[throws])).toPrecision(3)))} ${parameters[throws].unit}`);
  if (throws === null && power > 0) told.push(`${Math.round(100 * power)} %`);
  if (place !== null) told.push(`at ${place.toFixed(2)} of the length`);
  return told.join(", ");
}

// The quadrilaterals of a membrane from back to front, each with its corners { at: number of the point, or null at the rim; x, y }.
function surfaceOf(rings) {
  const corner = (ring, sector) => {
    const angle = (2 * Math.PI * sector) / kSectors;
    const half = Math.min(sector % kSectors, kSectors - (sector % kSectors));
    const at = ring === 0 ? 0 : ring > rings ? null : 1 + (ring - 1) * (kSectors / 2 + 1) + half;
    return { at, x: (ring / (rings + 1)) * Math.cos(angle), y: (ring / (rings + 1)) * Math.sin(angle) };
  };
  const all = [];
  for (let ring = 0; ring <= rings; ++ring)
    for (let s = 0; s < kSectors; ++s) all.push([corner(ring, s), corner(ring + 1, s), corner(ring + 1, s + 1), corner(ring, s + 1)]);
  const depth = (corners) => corners.reduce((sum, { y }) => sum + y, 0);
  return all.sort((a, b) => depth(a) - depth(b));
}

export class Stage {
  /** thrown({ power, place }): a hammer was pulled back and let go, or a string, power 0 to 1, and put at a part of the
   * string's length; null for what did not change. tell(power, place) says so in words while it moves. */
  constructor(canvas, { play, time, speed }, { thrown, tell }) {
    Object.assign(this, { canvas, play, time, speed, thrown, tell, study: null, at: 0, isPlaying: true, last: null, pulled: null });
    play.addEventListener("click", () => this.setPlaying(!this.isPlaying));
    time.addEventListener("input", () => {
      this.setPlaying(false);
      this.at = Number(time.value) * this.length();
      this.draw();
    });
    this.listenToPointers();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Shows a study from its beginning. */
  show(study) {
    const { scene } = study;
    this.items = scene.items.map((item) => ({
      ...item,
      values: item.column !== undefined && !item.points && study.column(item.column),
      compressions: item.compression !== undefined && study.column(item.compression),
      forces: item.force !== undefined && study.column(item.force),
      places: item.atColumn !== undefined && study.column(item.atColumn),
      boards: item.board !== undefined && study.column(item.board),
      quads: item.rings > 0 && surfaceOf(item.rings),
    }));
    // Membranes stand above each other and above all strings.
    const surfaces = this.items.filter(({ kind }) => kind === "surface");
    surfaces.forEach((item, k) => (item.slot = k));
    this.slots = surfaces.length === 0 ? 1 : surfaces.length + (this.items.some(({ kind }) => kind === "string") ? 1 : 0);
    this.forces = study.column(scene.force);
    this.energies = scene.energies.map(([name, column]) => [name, study.column(column)]);
    Object.assign(this, { study, at: 0, pulled: null });
    this.measure();
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) this.rest();
    else this.setPlaying(true);
  }

  // The largest displacement that is in view [m], of strings and bodies, or else of what is thrown.
  measure() {
    let reach = 0;
    for (const item of this.items.filter(({ points }) => points))
      for (let i = 0; i < this.study.frames; ++i) reach = Math.max(reach, largest(this.study.points(i, item.column, item.points)));
    const hammers = this.items.filter(({ kind }) => kind === "hammer").map(({ values }) => largest(values.filter((place) => place > -2e-3)));
    this.reach = Math.max(reach, Math.min(2e-3, ...hammers), 1e-9);
    const stops = this.items.filter(({ kind, at }) => kind === "stop" && at < kBridge);
    this.bridge = stops.length >= 8 ? stops : null;
  }

  // Where the force is largest, without motion.
  rest() {
    this.at = this.forces.indexOf(largest(this.forces)) / this.study.sampleRate;
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
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio))
      Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colour("paper");
    context.fillRect(0, 0, width, height);
    if (!study) return;
    const frame = this.at * study.sampleRate;
    const i = Math.max(0, Math.min(study.frames - 2, Math.floor(frame)));
    const value = (list) => list[i] + (list[i + 1] - list[i]) * (frame - i);
    const wide = width > 560;
    const bottom = height - (wide ? 96 : 76);
    const box = { left: 60, right: width - (this.energies.length === 0 ? 24 : wide ? 150 : 116), top: 48, bottom };
    box.middle = (box.top + bottom) / 2;
    box.unit = ((this.study.scene.isFlipped ? -1 : 1) * (bottom - box.top) * 0.42) / this.reach / this.slots;
    this.hold = null;
    this.box = box;
    for (const item of this.items) this.drawItem(context, this.slotOf(box, item), item, i, frame - i, value);
    if (this.bridge) this.drawBridge(context, box, i, frame - i);
    this.drawScale(context, box);
    if (this.energies.length > 0) this.drawEnergy(context, { x: box.right + (wide ? 26 : 16), width: wide ? 26 : 18, bottom }, value);
    this.drawForce(context, { left: box.left, right: width - 24, top: bottom + 14, bottom: height - 22 }, frame, value);
    this.write(context, `${(this.at * 1000).toFixed(2)} ms`, 12, 22, "ink", "600 15px system-ui");
    this.write(context, `${value(this.forces).toFixed(2)} N`, 12, 40, "orange", "600 13px system-ui");
  }

  write(context, text, x, y, paint, font = "12px system-ui") {
    context.fillStyle = colour(paint);
    context.font = font;
    context.fillText(text, x, y);
  }

  // The part of the box where an item is drawn.
  slotOf(box, { kind, slot }) {
    if (this.slots === 1) return box;
    const number = slot ?? (kind === "hammer" ? 0 : this.slots - 1);
    const size = (box.bottom - box.top) / this.slots;
    return { ...box, top: box.top + number * size, middle: box.top + (number + 0.5) * size, bottom: box.top + (number + 1) * size };
  }

  // A displacement as a height on the canvas.
  height(box, displacement) {
    return box.middle - displacement * box.unit;
  }

  drawItem(context, box, item, i, part, value) {
    const across = (at) => box.left + (box.right - box.left) * at;
    if (item.kind === "wall") this.drawWall(context, box);
    if (item.kind === "string") this.drawString(context, box, item, this.curve(item, i, part), value);
    if (item.kind === "surface") this.drawSurface(context, box, item, this.curve(item, i, part));
    if (item.kind === "body") this.drawBody(context, box, this.curve(item, i, part));
    if (item.kind === "hammer") this.drawHammer(context, box, item, across(item.at), value);
    if (item.kind === "stop" && !this.bridge?.includes(item)) {
      const x = across(item.places ? value(item.places) : item.at);
      this.drawStop(context, x, this.height(box, item.values ? value(item.values) : item.height), item, value(item.forces), box);
    }
    if (item.kind === "touch") this.drawTouch(context, across(item.at), box.middle, value(item.forces));
  }

  // The displacements of an item, between two frames.
  curve({ column, points }, i, part) {
    const now = this.study.points(i, column, points);
    const next = this.study.points(i + 1, column, points);
    return Array.from(now, (y, p) => y + (next[p] - y) * part);
  }

  drawString(context, box, item, curve, value) {
    const across = (p) => box.left + ((box.right - box.left) * p) / (curve.length - 1);
    context.strokeStyle = colour("blue");
    context.lineJoin = "round";
    if (!this.pulled) this.drawTraces(context, box, item, across);
    context.lineWidth = 3;
    context.beginPath();
    const { plucks } = this.study.scene;
    const finger = plucks?.column === item.column ? across(plucks.at * (curve.length - 1)) : null;
    if (this.pulled && finger !== null) {
      context.moveTo(box.left, box.middle);
      context.lineTo(finger, box.middle + this.pulled.power * this.pulled.side * kReach);
      context.lineTo(box.right, box.middle);
    } else {
      curve.forEach((y, p) => context.lineTo(across(p), this.height(box, y)));
    }
    context.stroke();
    if (finger !== null) this.drawFinger(context, box, finger, curve[Math.round(plucks.at * (curve.length - 1))]);
    context.fillStyle = colour("ink");
    context.fillRect(box.left - 3, box.middle - 10, 6, 20);
    if (item.boards) this.drawBoard(context, box, item, value(item.boards));
    else context.fillRect(box.right - 3, box.middle - 10, 6, 20);
  }

  // Where a string has just been, paler the longer ago.
  drawTraces(context, box, { column, points }, across) {
    const now = Math.floor(this.at * this.study.sampleRate);
    context.lineWidth = 1.5;
    for (let k = kTraces; k > 0; --k) {
      const i = now - Math.round(k * kTrace * this.study.sampleRate);
      if (i < 0) continue;
      context.globalAlpha = 0.45 / k;
      context.beginPath();
      this.study.points(i, column, points).forEach((y, p) => context.lineTo(across(p), this.height(box, y)));
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  // Where a string is plucked: a ring to pull at.
  drawFinger(context, box, x, displacement) {
    const y = this.pulled ? box.middle + this.pulled.power * this.pulled.side * kReach : this.height(box, displacement);
    context.strokeStyle = colour("orange");
    context.lineWidth = 2;
    context.beginPath();
    context.arc(x, y, 9, 0, 2 * Math.PI);
    context.stroke();
    if (this.pulled) this.write(context, this.pulled.text, x + 18, y + 5, "ink", "600 14px system-ui");
    this.hold = { x, y, down: 0 };
  }

  // A membrane seen from the side, blue where its displacement is positive, orange where it is negative.
  drawSurface(context, box, { quads }, curve) {
    const [rx, cx] = [(box.right - box.left) / 2, (box.left + box.right) / 2];
    const ry = Math.min(kTilt * rx, 0.36 * (box.bottom - box.top));
    const height = ({ at }) => (at === null ? 0 : curve[at]);
    const [up, down, mesh] = [colour("blue"), colour("orange"), colour("soft")];
    context.lineWidth = 0.5;
    context.strokeStyle = mesh;
    for (const corners of quads) {
      context.beginPath();
      for (const corner of corners) context.lineTo(cx + corner.x * rx, box.middle + corner.y * ry - height(corner) * box.unit);
      context.closePath();
      const mean = corners.reduce((sum, corner) => sum + height(corner), 0) / corners.length;
      context.fillStyle = colour("panel");
      context.fill();
      context.globalAlpha = Math.min(0.9, 0.06 + 1.6 * Math.abs(mean) / this.reach);
      context.fillStyle = mean >= 0 ? up : down;
      context.fill();
      context.globalAlpha = 1;
      context.stroke();
    }
    context.strokeStyle = colour("ink");
    context.lineWidth = 2;
    context.beginPath();
    context.ellipse(cx, box.middle, rx, ry, 0, 0, 2 * Math.PI);
    context.stroke();
  }

  // The board moves too little to be seen: it is drawn larger, up to a fifth of the height.
  drawBoard(context, box, { boards }, now) {
    const zoom = roundDown((0.45 * this.reach) / Math.max(largest(boards), 1e-12));
    const y = this.height(box, now * zoom);
    context.fillStyle = colour("wood");
    context.fillRect(box.right - 70, y, 76, 9);
    context.fillStyle = colour("ink");
    context.fillRect(box.right - 4, Math.min(y, box.middle), 6, Math.abs(y - box.middle) + 3);
    this.write(context, `board × ${zoom}`, box.right - 70, Math.max(y, box.middle) + 28, "soft");
  }

  drawBody(context, box, curve) {
    const across = (p) => box.left + (box.right - box.left) * ((p + 1) / (curve.length + 1));
    context.fillStyle = colour("green");
    context.strokeStyle = colour("line");
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(box.left, box.middle);
    context.lineTo(box.right, box.middle);
    context.stroke();
    curve.forEach((y, p) => {
      context.fillRect(across(p) - 5, this.height(box, y) - 5, 10, 10);
      context.fillRect(across(p) - 1, Math.min(box.middle, this.height(box, y)), 2, Math.abs(this.height(box, y) - box.middle));
    });
  }

  drawWall(context, box) {
    context.fillStyle = colour("soft");
    context.fillRect(box.left, box.middle - 14, box.right - box.left, 14);
    this.write(context, "rigid barrier", box.left + 8, box.middle - 20, "soft");
  }

  // A point that a string meets; it is filled while it pushes.
  drawStop(context, x, y, { side, name }, force, box) {
    const away = Math.sign(side * -box.unit); // to where the stop continues on the canvas
    context.fillStyle = colour(force > 0 ? "orange" : "soft");
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x - 7, y + 16 * away);
    context.lineTo(x + 7, y + 16 * away);
    context.fill();
    if (name) this.write(context, name, x + 12, y + 16 * away + 4, "soft");
  }

  drawTouch(context, x, y, force) {
    context.fillStyle = colour(force > 0 ? "orange" : "line");
    context.beginPath();
    context.arc(x, y, 5, 0, 2 * Math.PI);
    context.fill();
  }

  // The felt yields where it meets the string: its top stays at the string.
  drawHammer(context, box, item, x, value) {
    const place = this.pulled?.place ?? null;
    if (place !== null) x = box.left + (box.right - box.left) * place;
    const compression = Math.max(0, value(item.compressions));
    const down = Math.sign(box.unit); // on the canvas
    const top = this.height(box, value(item.values) + (item.surface ?? 0) - compression) + (this.pulled ? this.pulled.power * kReach : 0) * down;
    const squeezed = this.pulled ? 0 : Math.min(30, compression * Math.abs(box.unit));
    const [radius, depth] = [18, 47];
    const felt = Math.max(10, depth - squeezed);
    context.save();
    context.beginPath();
    context.rect(0, 0, this.canvas.clientWidth, box.bottom + 6);
    context.clip();
    context.fillStyle = colour("wood");
    context.fillRect(x - 5, down > 0 ? top + felt - 8 : top - felt + 8 - 400, 10, 400);
    context.fillStyle = colour("felt");
    context.beginPath();
    context.roundRect(x - radius - squeezed / 4, down > 0 ? top : top - felt, 2 * radius + squeezed / 2, felt, radius * 0.8);
    context.fill();
    context.restore();
    this.hold = { x, y: top + (down * felt) / 2, down };
    if (this.pulled) this.write(context, this.pulled.text, x + 26, top + down * 20, "ink", "600 14px system-ui");
  }

  // The points of a bridge near the end of the string, larger in both directions.
  drawBridge(context, box, i, part) {
    const string = this.items.find(({ kind }) => kind === "string");
    const curve = this.curve(string, i, part);
    const end = this.bridge.at(-1).at * 1.4;
    const at = (place) => {
      const p = place * (curve.length - 1);
      const k = Math.min(curve.length - 2, Math.floor(p));
      return curve[k] + (curve[k + 1] - curve[k]) * (p - k);
    };
    const reach = 4 * largest(this.bridge.map(({ height }) => height));
    const inset = { left: box.left + (box.right - box.left) * 0.42, right: box.right, top: box.top - 30, bottom: box.top + (box.bottom - box.top) * 0.36 };
    const inner = { ...inset, middle: inset.top + (inset.bottom - inset.top) * 0.42, unit: (Math.sign(box.unit) * (inset.bottom - inset.top) * 0.5) / reach };
    context.fillStyle = colour("panel");
    context.strokeStyle = colour("line");
    context.lineWidth = 1;
    context.beginPath();
    context.roundRect(inset.left, inset.top, inset.right - inset.left, inset.bottom - inset.top, 8);
    context.fill();
    context.stroke();
    context.save();
    context.clip();
    const across = (place) => inset.left + ((inset.right - inset.left) * place) / end;
    for (const stop of this.bridge)
      this.drawStop(context, across(stop.at), this.height(inner, stop.height), stop, stop.forces[i], inner);
    context.strokeStyle = colour("blue");
    context.lineWidth = 3;
    context.beginPath();
    for (let p = 0; p <= 60; ++p) context.lineTo(across((end * p) / 60), this.height(inner, at((end * p) / 60)));
    context.stroke();
    const points = `bridge, ${this.bridge.length} points`, wide = inset.right - inset.left > 240;
    this.write(context, wide ? `${points}: the end of the string, larger` : points, inset.left + 10, inset.top + 18, "soft");
    this.drawScale(context, { unit: inner.unit, bottom: inset.bottom - 10 }, { x: inset.left + 10, size: 30, isBeside: true });
    context.restore();
  }

  // A bar of millimetres, at most `size` pixels high, with its number above it or beside it.
  drawScale(context, { unit, bottom }, { x = 16, size = 70, isBeside = false } = {}) {
    const metres = roundDown(size / Math.abs(unit));
    const height = metres * Math.abs(unit);
    context.fillStyle = colour("ink");
    context.fillRect(x + 4, bottom - height, 2, height);
    context.fillRect(x, bottom - height, 10, 2);
    context.fillRect(x, bottom - 2, 10, 2);
    const [right, down] = isBeside ? [16, 4 - height / 2] : [-8, -height - 8];
    this.write(context, `${readable(1000 * metres)} mm`, x + right, bottom + down, "ink");
  }

  // The force of the whole note, filled up to the time that is shown.
  drawForce(context, { left, right, top, bottom }, frame, value) {
    const peak = largest(this.forces) || 1;
    const across = (i) => left + ((right - left) * i) / (this.forces.length - 1);
    const area = (end) => {
      context.beginPath();
      context.moveTo(left, bottom);
      for (let i = 0; i <= end; ++i) context.lineTo(across(i), bottom - ((bottom - top) * this.forces[i]) / peak);
      context.lineTo(across(end), bottom);
      context.fill();
    };
    context.globalAlpha = 0.3;
    context.fillStyle = colour("orange");
    area(this.forces.length - 1);
    context.globalAlpha = 1;
    area(Math.min(this.forces.length - 1, Math.floor(frame)));
    context.fillStyle = colour("ink");
    context.fillRect(left, bottom, right - left, 1);
    context.fillRect(across(frame) - 1, top - 4, 2, bottom - top + 8);
    ["force", "up to", `${readable(Number(peak.toPrecision(3)))} N`].forEach((line, k) => this.write(context, line, 12, top + 10 + 14 * k, "soft"));
    const text = `${readable(1000 * this.length())} ms`;
    this.write(context, "0 ms", left, bottom + 15, "soft");
    this.write(context, text, right - context.measureText(text).width, bottom + 15, "soft");
  }

  // One column of constant height: what changes is only where the energy is.
  drawEnergy(context, { x, width, bottom }, value) {
    const parts = this.energies.map(([name, list]) => [Math.max(0, value(list)), name, kPaints[name] ?? "soft"]);
    const total = parts.reduce((sum, [energy]) => sum + energy, 0) || 1;
    const percents = wholePercents(parts.map(([energy]) => energy / total));
    const top = 34;
    const full = bottom - top;
    let y = bottom;
    parts.forEach(([energy, label, paint], k) => {
      const part = (energy / total) * full;
      context.fillStyle = colour(paint);
      context.fillRect(x, y - part, width, part);
      const line = bottom - 16 - k * Math.min(40, full / parts.length);
      context.fillRect(x + width + 8, line - 9, 9, 9);
      this.write(context, label, x + width + 21, line, "ink");
      this.write(context, `${percents[k]} %`, x + width + 21, line + 14, "ink");
      y -= part;
    });
    context.strokeStyle = colour("ink");
    context.lineWidth = 1;
    context.strokeRect(x - 0.5, top - 0.5, width + 1, full + 1);
    this.write(context, `energy ${readable(Number((1000 * total).toPrecision(3)))} mJ`, x - 6, 22, "ink");
  }

  // Pulling a hammer back sets its speed, moving it along the string its place; letting go throws it. Pulling a string sets
  // the force of its pluck.
  listenToPointers() {
    const { canvas } = this;
    const at = ({ clientX, clientY }) => {
      const { left, top } = canvas.getBoundingClientRect();
      return { x: clientX - left, y: clientY - top };
    };
    const isNear = ({ x, y }) => this.hold && Math.hypot(x - this.hold.x, y - this.hold.y) <= kNear;
    // A finger that has taken hold of something, which pointerdown tells first, does not scroll the page.
    canvas.addEventListener("touchstart", (event) => this.pulled && event.preventDefault(), { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      const { x, y } = at(event);
      if (!isNear({ x, y })) return;
      event.preventDefault();
      canvas.setPointerCapture(event.pointerId);
      this.setPlaying(false);
      this.at = 0;
      this.from = { x, y, down: this.hold.down };
      this.pull({ x, y });
    });
    canvas.addEventListener("pointermove", (event) => this.pulled && this.pull(at(event)));
    canvas.addEventListener("pointerup", () => {
      if (!this.pulled) return;
      const { power, place } = this.pulled;
      this.pulled = null;
      this.thrown({ power: power > 0.03 ? power : null, place });
    });
    canvas.addEventListener("pointercancel", () => {
      this.pulled = null;
      this.draw();
    });
  }

  // A hammer is pulled back, a string to both sides.
  pull({ x, y }) {
    const { left, right } = this.box;
    const way = (y - this.from.y) / kReach;
    const { down } = this.from;
    const power = Math.max(0, Math.min(1, down === 0 ? Math.abs(way) : way * down));
    const moves = down !== 0 && this.study.scene.moves !== null && Math.abs(x - this.from.x) > 6;
    const place = moves || this.pulled?.place ? Math.max(0.02, Math.min(0.98, (x - left) / (right - left))) : null;
    this.pulled = { power, place, side: Math.sign(way), text: this.tell(power, place) };
    this.draw();
  }
}
