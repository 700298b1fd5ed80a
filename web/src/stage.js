// SPDX-License-Identifier: MIT
// The slow motion of one note: strings, what is thrown at them or stands in their way, where the energy is, the force.
import { readable } from "./controls.js";
import { drawBall, drawBolt, drawBowHair, drawBridgeFoot, drawDrumStick, drawFingertip, drawFretWire, drawHammerHead, drawMetalTube, drawPlank, drawShell, drawSteel, drawSteelStrip, drawWoodenBar, kFelt, kHead } from "./parts.js";
import { colour } from "./plots.js";

/** Colours of energies by their names; those that are not here take the next of kOthers. */
const kPaints = { hammer: "wood", mass: "wood", felt: "felt", contact: "felt", string: "blue", strings: "blue", board: "green", lost: "soft" };
const kBridge = 0.05; // part of a string in which many stops are one bridge, which is drawn larger
const kReach = 130; // pixels by which a hammer is pulled back for its highest speed, where there is room
const kLeastReach = 80;
const kNear = 60; // pixels around a hammer or a finger that take hold of it
const kTraces = 3; // earlier shapes of a string that stay in view
const kTrace = 1.5e-4; // seconds between two of them
const kTraced = 3; // points of the string between two of theirs
const kShades = 10; // of each colour of a membrane
const kSectors = 24; // of a membrane's circle
const kRingsApart = 2; // between two lines on it
const kTilt = 0.3; // height of a membrane's circle over its width
const kShank = 170;
const kHeadHalf = 48; // half of the width of a hammer's head, with room
const kFarthest = 0.6; // how far a hammer is followed, over the largest displacement
const kSteepest = 0.14; // the largest displacement over the width
const kFirstPlain = 48; // key of the lowest string without windings
const kStringsApart = 11; // pixels between strings side by side
const kDeepest = 1.2; // distance between two of them over the radius, at most
const kDiscOverHeight = 0.85; // radius of a drum or a gong over the height of the stage
const kSticks = 0.15; // of the fastest slip: below it a bow's hair holds the string
const kBlow = { stick: "stick", mallet: "ball", beater: "ball", bass: "ball", thumb: "finger", finger: "finger" }; // what strikes, by its name
const kTitles = "'Iowan Old Style', 'Palatino Linotype', Palatino, 'Book Antiqua', Georgia, serif";

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

// By how much a bow has slipped along its string up to each frame.
const slidOf = (slips) => {
  let sum = 0;
  return slips.map((slip) => (sum += slip));
};

/** The key of MIDI of a frequency. */
const keyOf = (hz) => 69 + 12 * Math.log2(hz / 440);

const surfaces = new Map();

// The quadrilaterals of a disc from back to front, each with its corners { at: number of the point, or null at a rim that is held; x, y }.
function surfaceOf(rings, isFree) {
  const name = `${rings} ${isFree}`;
  if (surfaces.has(name)) return surfaces.get(name);
  const end = isFree ? rings : rings + 1;
  const corner = (ring, sector) => {
    const angle = (2 * Math.PI * sector) / kSectors;
    const half = Math.min(sector % kSectors, kSectors - (sector % kSectors));
    const at = ring === 0 ? 0 : ring > rings ? null : 1 + (ring - 1) * (kSectors / 2 + 1) + half;
    return { at, x: (ring / end) * Math.cos(angle), y: (ring / end) * Math.sin(angle) };
  };
  const all = [];
  for (let ring = 0; ring < end; ++ring)
    for (let s = 0; s < kSectors; ++s) all.push([corner(ring, s), corner(ring + 1, s), corner(ring + 1, s + 1), corner(ring, s + 1)]);
  const depth = (corners) => corners.reduce((sum, { y }) => sum + y, 0);
  all.sort((a, b) => depth(a) - depth(b));
  const ringOf = (ring) => Array.from({ length: kSectors }, (_, s) => corner(ring, s));
  all.rims = ringOf(end);
  all.rings = Array.from({ length: Math.floor(rings / kRingsApart) }, (_, k) => ringOf(kRingsApart * (k + 1)));
  surfaces.set(name, all);
  return all;
}

export class Stage {
  /** thrown({ power, place }): a hammer was pulled back and let go, or a string, power 0 to 1, and put at a part of the
   * string's length; null for what did not change. tell(power, place) says so in words while it moves, energyOf(power) how many
   * times the energy is that of what is shown. moves(): something begins to move, frame() is to be called. */
  constructor(canvas, { play, time, speed }, { thrown, tell, energyOf, moves }) {
    Object.assign(this, { canvas, play, time, speed, thrown, tell, energyOf, moves, study: null, at: 0, isPlaying: false, last: null, pulled: null });
    Object.assign(this, { isAwake: false, isInviting: true, isSeen: true, isKept: false, isDirty: false, givesWay: false, gaveWay: false });
    new IntersectionObserver((list) => {
      this.isSeen = list.at(-1).isIntersecting;
      if (this.isSeen) this.comeBack();
    }).observe(canvas);
    play.addEventListener("click", () => this.setPlaying(!this.isPlaying));
    time.addEventListener("input", () => {
      this.setPlaying(false);
      this.at = Number(time.value) * this.length();
      this.draw();
    });
    this.listenToPointers();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** From now on what is shown moves. */
  wake() {
    this.isAwake = true;
  }

  /** Lets what is pulled slip, as when there will be another instrument. */
  slip() {
    Object.assign(this, { pulled: null, next: null });
  }

  /** Shows a study: from its beginning, or at rest until it is woken; after a pull if there is one. key: of its string, or null. */
  show(study, key = null) {
    if (this.pulled) {
      this.next = { study, key };
      return;
    }
    const { scene } = study;
    this.items = scene.items.map((item) => ({
      ...item,
      values: item.column !== undefined && !item.points && study.column(item.column),
      compressions: item.compression !== undefined && study.column(item.compression),
      forces: item.force !== undefined && study.column(item.force),
      boards: item.board !== undefined && study.column(item.board),
      slid: item.slip !== undefined && slidOf(study.column(item.slip)),
      quads: item.rings > 0 && surfaceOf(item.rings, item.isFree),
    }));
    this.arrange(scene);
    this.forces = study.column(scene.force);
    this.energies = scene.energies.map(([name, column]) => [name, study.column(column)]);
    Object.assign(this, { study, key, at: 0, pulled: null });
    this.fastest = undefined;
    this.measure();
    if (!this.isAwake || matchMedia("(prefers-reduced-motion: reduce)").matches) this.rest();
    else this.setPlaying(true);
  }

  // What lies on what, and where.
  arrange({ plucks, isFlipped }) {
    // Membranes stand above each other and above all strings.
    this.discs = this.items.filter(({ kind }) => kind === "surface");
    this.discs.forEach((item, k) => (item.slot = k));
    // Strings are side by side; the one that is played is in the middle of the height.
    const strings = this.items.filter(({ kind }) => kind === "string");
    const played = plucks?.column ?? this.items.find(({ kind }) => kind === "bow")?.string;
    this.string = strings.find(({ column }) => column === played) ?? strings[strings.length >> 1];
    strings.forEach((item, k) => (item.row = k - strings.indexOf(this.string)));
    this.slots = this.discs.length === 0 ? 1 : this.discs.length + (strings.length > 0 ? 1 : 0);
    // One mass that meets several strings is one hammer.
    const hammers = this.items.filter(({ kind }) => kind === "hammer");
    const twice = hammers.filter(({ column }, k) => hammers.some((other, i) => i < k && other.column === column));
    this.items = this.items.filter((item) => !twice.includes(item));
    // A string lies on its hammer, and a hammer on a membrane.
    const orders = ["tube", "board", "stop", "surface", "bar", "tine", ...(isFlipped || strings.length === 0 ? [] : ["hammer"]), "string"];
    const order = ({ kind, slot = 0, row = 0 }) => (orders.includes(kind) ? orders.indexOf(kind) : orders.length) - 0.1 * slot - 0.01 * Math.abs(row);
    this.items.sort((a, b) => order(a) - order(b));
  }

  // What is in view [m]: the largest displacement of strings and bodies, or else of what is thrown, and how far that goes back.
  measure() {
    const { view } = this.study;
    this.frames = view.frames;
    const hammers = this.items.filter(({ kind }) => kind === "hammer").map(({ values }) => values.slice(0, this.frames));
    this.reach = Math.max(view.reach, Math.min(2e-3, ...hammers.map((values) => largest(values.filter((place) => place > -2e-3)))), 1e-9);
    this.depth = hammers.length === 0 ? null : Math.min(kFarthest * this.reach, -Math.min(0, ...hammers.map((values) => Math.min(...values))));
    const stops = this.items.filter(({ kind }) => kind === "stop");
    this.bridge = stops.length >= 8 && stops.every(({ at }) => at < kBridge) ? stops : null;
    this.frets = this.bridge ? [] : stops;
  }

  // Where the force is largest, without motion.
  rest() {
    const peak = Math.max(...this.forces);
    this.at = peak > 0 ? Math.min(this.length(), this.forces.indexOf(peak) / this.study.sampleRate) : 0.3 * this.length();
    this.setPlaying(false);
    this.draw();
  }

  setPlaying(isPlaying) {
    const said = isPlaying ? "Pause" : "Play";
    if (this.play.textContent !== said) this.play.textContent = said; // what is said again is laid out again
    this.play.classList.toggle("plays", isPlaying);
    this.isPlaying = isPlaying;
    this.last = null;
    if (isPlaying) this.moves();
    else this.time.value = this.at / (this.length() || 1); // which is not seen: that it follows costs as much as all else
  }

  length() {
    return this.study ? (this.frames - 1) / this.study.sampleRate : 0;
  }

  /** Leaves the next frame of the screen to what else changes there, such as a slider, but never two in a row. */
  giveWay() {
    this.givesWay = !this.gaveWay;
  }

  /** Moves on to the time of the screen [s] and draws, where it is in view. Returns whether it goes on. */
  frame(now) {
    const moves = this.study !== null && this.isPlaying && (this.isSeen || this.isKept);
    if (moves) {
      if (this.last !== null) this.at += Math.min(0.1, now - this.last) / Number(this.speed.value);
      this.last = now;
      if (this.at > this.length()) this.at = 0;
    }
    Object.assign(this, { gaveWay: this.givesWay, givesWay: false });
    if ((moves || this.isDirty) && !this.gaveWay) this.draw();
    return moves || this.isDirty;
  }

  // In view again.
  comeBack() {
    this.last = null;
    this.drawSoon();
  }

  // With the next frame of the screen.
  drawSoon() {
    this.isDirty = true;
    this.moves();
  }

  draw() {
    this.isDirty = false;
    const { canvas, study } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio))
      Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const context = canvas.getContext("2d", { alpha: false });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colour("paper");
    context.fillRect(0, 0, width, height);
    if (!study) return;
    const frame = this.at * study.sampleRate;
    const i = Math.max(0, Math.min(study.frames - 2, Math.floor(frame)));
    const value = (list) => list[i] + (list[i + 1] - list[i]) * (frame - i);
    this.size = Math.max(0.55, Math.min(1.8, height / 380, width / 420)); // of what is thrown
    const strip = Math.max(28, Math.min(84, 0.15 * height)); // of the force
    const top = this.drawNumbers(context, width, value);
    const box = { left: 30, right: width - 30, top, bottom: height - strip - 34, ...this.scaleOf(top, height - strip - 34, width) };
    this.hold = null;
    this.box = box;
    this.drawFingerboard(context, box);
    for (const item of this.items) this.drawItem(context, this.slotOf(box, item), item, i, frame - i, value);
    if (this.bridge) this.drawBridge(context, box, i, frame - i);
    this.drawScale(context, { ...box, bottom: box.bottom - 4 }, { x: this.items.some(({ kind }) => kind === "bow") ? box.left : box.right - 56, size: Math.min(70, 0.2 * height), isBeside: true });
    this.drawForce(context, { left: 60, right: width - 16, top: height - strip - 20, bottom: height - 20 }, frame);
    if (this.isInviting && this.hold && !this.pulled) this.drawInvitation(context, box);
    this.showHand();
  }

  // Pixels for a metre, up on the canvas, and the height of rest: all of a string is in view, not too steep, and what is thrown at
  // it.
  scaleOf(top, bottom, width) {
    const height = 0.96 * (bottom - top);
    const sign = this.study.scene.isFlipped ? -1 : 1;
    if (this.depth === null || this.slots > 1) {
      const most = (0.44 * height) / this.slots, inside = this.discs.length > 0 ? 0.8 * kTilt * this.radiusIn(top, bottom, width - 60) : most; // of a shell
      return { middle: (top + bottom) / 2, unit: (sign * Math.min(most, inside)) / this.reach };
    }
    const room = height - kHead * this.size;
    const unit = Math.min(room / (this.reach + this.depth), Math.min(height / 2, kSteepest * width) / this.reach);
    const side = this.reach * unit + 0.4 * Math.max(0, room - (this.reach + this.depth) * unit);
    return { middle: sign > 0 ? top + side : bottom - side, unit: sign * unit };
  }

  // Time, force, and where the energy is: a bar of constant length, of which only the parts change. Returns the height below.
  drawNumbers(context, width, value) {
    const wide = width > 560;
    const left = wide ? 150 : 104;
    this.write(context, `${(this.at * 1000).toFixed(2)} ms`, 16, wide ? 30 : 26, "ink", `${wide ? 26 : 20}px ${kTitles}`);
    this.write(context, `${value(this.forces).toFixed(2)} N`, 16, wide ? 52 : 46, "accent", `${wide ? 18 : 16}px ${kTitles}`);
    if (this.energies.length === 0) return 60;
    const thrown = this.pulled && this.pulled.power > 0 ? this.energyOf(this.pulled.power) : null; // all of it is in what is pulled
    const part = (list, k) => (thrown === null ? Math.max(0, value(list)) : k === 0 ? thrown * this.study.scene.work : 0);
    const parts = this.energies.map(([name, list], k) => [part(list, k), name, kPaints[name] ?? "soft"]);
    const total = parts.reduce((sum, [energy]) => sum + energy, 0) || 1;
    const percents = wholePercents(parts.map(([energy]) => energy / total));
    const full = width - 16 - left;
    this.drawBars(context, parts.map(([energy, , paint]) => [(energy / total) * full, paint]), left, full);
    let [at, line] = [left, wide ? 50 : 48];
    const font = `${wide ? 14 : 12}px system-ui`;
    const put = (text, room, paint) => {
      if (at > left && at + room > width - 12) [at, line] = [left, line + 16];
      if (paint) context.fillStyle = colour(paint);
      if (paint) context.fillRect(at, line - 9, 9, 9);
      this.write(context, text, at + (paint ? 14 : 0), line, paint ? "ink" : "soft", font);
      at += room;
    };
    context.font = font;
    put(`${readable(Number((1000 * total).toPrecision(3)))} mJ`, wide ? 74 : 62);
    parts.forEach(([, label, paint], k) => put(`${label} ${percents[k]} %`, context.measureText(`${label} 100 %`).width + 24, paint));
    return line + 10;
  }

  // Bars side by side, whose outer ends are round. The widest is drawn first, as long as all.
  drawBars(context, bars, left, full) {
    const widest = bars.reduce((best, bar) => (bar[0] > best[0] ? bar : best));
    context.fillStyle = colour(widest[1]);
    context.beginPath();
    context.roundRect(left, 14, full, 16, 8);
    context.fill();
    let x = left;
    for (const bar of bars) {
      const [width, paint] = bar, end = Math.min(x + width, left + full);
      if (bar !== widest && width > 2) {
        context.fillStyle = colour(paint);
        context.beginPath();
        context.roundRect(x, 14, end - x, 16, [x < left + 8 ? 8 : 0, end > left + full - 8 ? 8 : 0, end > left + full - 8 ? 8 : 0, x < left + 8 ? 8 : 0]);
        context.fill();
      }
      x += width;
    }
  }

  // What to do first, beside what can be pulled.
  drawInvitation(context, box) {
    const { y, down, aside = 0 } = this.hold;
    const x = this.hold.x + aside;
    const side = down || 1;
    const begin = down === 0 ? y + 16 : y + side * (kHead * this.size * 0.6 + 6);
    const size = Math.max(16, Math.min(46, Math.abs((side > 0 ? box.bottom : box.top) - begin)));
    const end = begin + side * size;
    context.strokeStyle = colour("accent");
    Object.assign(context, { lineWidth: 3, lineCap: "round", lineJoin: "round" });
    context.beginPath();
    context.moveTo(x, begin);
    context.lineTo(x, end);
    context.moveTo(x - 8, end - 9 * side);
    context.lineTo(x, end);
    context.lineTo(x + 8, end - 9 * side);
    context.stroke();
    context.lineCap = "butt";
    const letters = Math.round(14 + 10 * this.size);
    context.font = `italic ${letters}px ${kTitles}`;
    const isRoom = down > 0 && aside === 0 && box.bottom - end > letters; // below the arrow: a shank is beside it
    const wide = context.measureText("pull me").width;
    const beside = x + 18 + wide < this.canvas.clientWidth - 4 ? x + 18 : x - 18 - wide;
    const [left, base] = isRoom ? [Math.max(12, x - wide / 2), end + letters] : [beside, (begin + end) / 2 + 8];
    this.invited = { left, right: left + wide };
    this.write(context, "pull me", left, base, "accent", context.font);
  }

  write(context, text, x, y, paint, font = "12px system-ui") {
    context.fillStyle = colour(paint);
    context.font = font;
    context.fillText(text, x, y);
  }

  // The radius of a drum or a gong.
  radiusIn(top, bottom, width) {
    return Math.min(width / 2, kDiscOverHeight * (bottom - top));
  }

  // The part of the box where an item is drawn.
  slotOf(box, { kind, slot, row }) {
    if (this.discs.length === 0) return row ? { ...box, middle: box.middle + row * kStringsApart * this.size } : box;
    const half = this.radiusIn(box.top, box.bottom, box.right - box.left);
    const middle = (box.left + box.right) / 2;
    const number = slot ?? (kind === "string" || kind === "touch" ? this.slots - 1 : 0);
    const size = Math.min((box.bottom - box.top) / this.slots, kDeepest * half); // between two heads
    const top = (box.top + box.bottom - this.slots * size) / 2 + number * size;
    return { ...box, left: middle - half, right: middle + half, top, middle: top + size / 2 + (row ?? 0) * kStringsApart * this.size, bottom: top + size };
  }

  // A displacement as a height on the canvas.
  height(box, displacement) {
    return box.middle - displacement * box.unit;
  }

  drawItem(context, box, item, i, part, value) {
    const across = (at) => box.left + (box.right - box.left) * at;
    const { kind } = item;
    const curve = item.points && this.curve(item, i, part);
    if (kind === "wall") this.drawWall(context, box);
    if (kind === "string") this.drawString(context, box, item, curve, value);
    if (kind === "surface") this.drawSurface(context, box, item, curve);
    if (kind === "bar") this.drawBar(context, box, curve);
    if (kind === "tine") this.drawTine(context, box, curve);
    if (kind === "tube") this.drawTube(context, box, across(item.at), curve[0]);
    if (kind === "board") this.drawBoard(context, box, across(item.at), item, curve[0]);
    if (kind === "weight") this.drawWeight(context, across(item.at), this.height(box, this.stringAt(item.at, i, part)), item);
    if (kind === "hammer") this.drawHammer(context, box, item, across(item.at), value, this.shape(i, part));
    if (kind === "bow") this.drawBow(context, box, item, across(item.at), i, part);
    if (kind === "stop" && !this.bridge?.includes(item)) {
      this.drawStop(context, across(item.at), this.height(box, item.height), item, value(item.forces), box);
    }
    if (kind === "touch") this.drawTouch(context, across(item.at), this.string ? this.height(box, this.stringAt(item.at, i, part)) : box.middle, value(item.forces));
  }

  // The displacement of the string that is played, at a part of its length.
  stringAt(at, i, part) {
    const curve = this.curve(this.string, i, part);
    const p = at * (curve.length - 1), k = Math.min(curve.length - 2, Math.floor(p));
    return curve[k] + (curve[k + 1] - curve[k]) * (p - k);
  }

  // The displacements of an item, between two frames. Several things that are drawn ask for them.
  curve(item, i, part) {
    const { column, points } = item;
    if (item.curveAt === i + part) return item.curve;
    item.curve ??= new Float64Array(points);
    const now = this.study.points(i, column, points);
    const next = this.study.points(i + 1, column, points);
    for (let p = 0; p < points; ++p) item.curve[p] = now[p] + (next[p] - now[p]) * part;
    item.curveAt = i + part;
    return item.curve;
  }

  drawString(context, box, item, curve, value) {
    const across = (p) => box.left + ((box.right - box.left) * p) / (curve.length - 1);
    context.strokeStyle = colour("blue");
    context.lineJoin = "round";
    if (!this.pulled) this.drawTraces(context, box, item, across);
    const path = new Path2D();
    const { plucks } = this.study.scene;
    const key = item.hz ? keyOf(item.hz) : this.key;
    const finger = plucks?.column === item.column ? across(plucks.at * (curve.length - 1)) : null;
    if (this.pulled && finger !== null) {
      path.moveTo(box.left, box.middle);
      path.lineTo(finger, box.middle + this.pulled.power * this.pulled.side * this.wayOf(box));
      path.lineTo(box.right, box.middle);
    } else {
      curve.forEach((y, p) => path.lineTo(across(p), this.height(box, y)));
    }
    const { count = 1 } = item;
    for (let k = 0; k < count; ++k) {
      context.save();
      context.translate(0, (k - (count - 1) / 2) * kStringsApart * this.size);
      this.strokeString(context, path, key, count > 1);
      context.restore();
    }
    const ends = [[box.left, -1], [box.right, 1]].filter(([, out]) => !(out > 0 && item.boards) && !this.isNeck(out));
    if (item.row === 0) for (const [x, out] of ends) this.drawEnd(context, x, box.middle, out);
    if (item.boards) this.drawBoard(context, box, box.right, item, value(item.boards));
    if (finger !== null) this.drawFinger(context, box, finger, curve[Math.round(plucks.at * (curve.length - 1))]);
  }

  // A path as a string: thicker the lower its key, the lowest with windings, with light on it but where it is one of several that move alike. Wires of a drum are thin.
  strokeString(context, path, key, isPlain = false) {
    const size = this.discs.length > 0 ? 2 : key === null ? 5 : 3.5 + 0.07 * Math.max(0, 96 - key);
    const isWound = key !== null && key < kFirstPlain && this.discs.length === 0;
    context.save();
    Object.assign(context, { lineWidth: size, strokeStyle: isWound ? this.windings(context) : colour("blue"), lineJoin: "round" });
    context.stroke(path);
    if (this.discs.length === 0 && !isPlain) {
      context.translate(0, -size / 5);
      Object.assign(context, { strokeStyle: "#ffffff", globalAlpha: 0.4, lineWidth: 1 });
      context.stroke(path);
    }
    context.restore();
  }

  // Turns of wire as a pattern, which costs less than dashes.
  windings(context) {
    const paints = ["blue", "paper"].map(colour);
    if (this.wound?.paints.every((paint, k) => paint === paints[k])) return this.wound.pattern;
    const turn = Object.assign(document.createElement("canvas"), { width: 4, height: 1 });
    const one = turn.getContext("2d");
    one.fillStyle = paints[0];
    one.fillRect(0, 0, 4, 1);
    Object.assign(one, { fillStyle: paints[1], globalAlpha: 0.45 }).fillRect(0, 0, 1, 1);
    this.wound = { paints, pattern: context.createPattern(turn, "repeat") };
    return this.wound.pattern;
  }

  // What a string lies on, out: to which side it goes on.
  drawEnd(context, x, y, out) {
    context.fillStyle = colour("soft");
    context.beginPath();
    context.moveTo(x - 2 * out, y + 2);
    context.lineTo(x + 16 * out, y + 24);
    context.lineTo(x - 7 * out, y + 24);
    context.fill();
    context.fillStyle = colour("ink");
    context.beginPath();
    context.arc(x, y, 5, 0, 2 * Math.PI);
    context.fill();
  }

  // Where a string has just been, paler the longer ago.
  drawTraces(context, box, { column, points }, across) {
    const now = Math.floor(this.at * this.study.sampleRate);
    context.lineWidth = 1; // hairlines cost little
    for (let k = kTraces; k > 0; --k) {
      const i = now - Math.round(k * kTrace * this.study.sampleRate);
      if (i < 0) continue;
      context.globalAlpha = 0.6 / k;
      context.beginPath();
      const shape = this.study.points(i, column, points);
      for (let p = 0; p < points; p += kTraced) context.lineTo(across(p), this.height(box, shape[p]));
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  // Where a string is plucked: a ring to pull at, and the finger while it pulls or shall be pulled.
  drawFinger(context, box, x, displacement) {
    const y = this.pulled ? box.middle + this.pulled.power * this.pulled.side * this.wayOf(box) : this.height(box, displacement);
    if (this.pulled || this.isInviting) {
      context.save();
      context.translate(x, y - 4);
      context.scale(this.size, this.size);
      context.beginPath();
      context.rect(-60, -20, 120, 90);
      context.clip();
      drawFingertip(context, 0);
      context.restore();
    }
    context.strokeStyle = colour("accent");
    context.lineWidth = 2;
    context.beginPath();
    context.arc(x, y, 9, 0, 2 * Math.PI);
    context.stroke();
    if (this.pulled) this.write(context, this.pulled.text, x + 24 * this.size, y + 5, "ink", "600 14px system-ui");
    this.hold = { x, y, down: 0 };
  }

  // A membrane or a plate seen from the side, blue where its displacement is positive, in the accent's colour where it is negative.
  drawSurface(context, box, { quads, slot, isPlate }, curve) {
    const { rims } = quads;
    const [rx, cx] = [(box.right - box.left) / 2, (box.left + box.right) / 2];
    const ry = Math.min(kTilt * rx, 0.36 * (box.bottom - box.top));
    const rim = { x: cx, y: box.middle, rx, ry };
    const lower = { ...rim, y: box.middle + box.bottom - box.top };
    const hasShell = slot === 0 && this.slots > 1;
    const height = ({ at }) => (at === null ? 0 : curve[at]);
    const x = (corner) => cx + corner.x * rx, y = (corner) => box.middle + corner.y * ry - height(corner) * box.unit;
    if (hasShell) drawShell(context, [rim, lower]);
    if (isPlate) this.drawEdge(context, rims, x, y);
    const shades = this.shades(isPlate ? "bronze" : "panel");
    this.fillRim(context, rims, { x, y }, shades[kShades]);
    if (slot === 0) this.fillQuads(context, quads, { x, y, height }, shades); // behind the shell lines suffice
    context.strokeStyle = colour(isPlate ? "ink" : "soft");
    Object.assign(context, { lineWidth: 0.5, globalAlpha: isPlate ? 0.35 : 0.7 });
    context.beginPath();
    for (const ring of quads.rings) this.trace(context, ring, x, y);
    context.stroke();
    context.globalAlpha = 1;
    if (isPlate) return;
    Object.assign(context, { strokeStyle: colour("ink"), lineWidth: slot === 0 ? 4 : 2 });
    context.beginPath();
    context.ellipse(cx, box.middle, rx, ry, 0, 0, 2 * Math.PI);
    context.stroke();
  }

  // All of a disc in the colour of rest.
  fillRim(context, rims, { x, y }, paint) {
    context.fillStyle = paint;
    context.beginPath();
    this.trace(context, rims, x, y);
    context.fill();
  }

  // A smooth closed line along corners of a disc.
  trace(context, corners, x, y) {
    corners.forEach((corner, k) => {
      const next = corners[(k + 1) % corners.length];
      const middle = [(x(corner) + x(next)) / 2, (y(corner) + y(next)) / 2];
      if (k === 0) context.moveTo((x(corners.at(-1)) + x(corner)) / 2, (y(corners.at(-1)) + y(corner)) / 2);
      context.quadraticCurveTo(x(corner), y(corner), ...middle);
    });
    context.closePath();
  }

  // The edge of a plate, which is as thick as its rim looks.
  drawEdge(context, rims, x, y) {
    context.fillStyle = colour("wood");
    context.beginPath();
    this.trace(context, rims, x, (corner) => y(corner) + 7 * this.size);
    context.fill();
  }

  // Quadrilaterals from back to front that are not as at rest, of which neighbours of one shade are filled at once.
  fillQuads(context, quads, { x, y, height }, shades) {
    const shadeOf = ([a, b, c, d]) => Math.round(kShades + kShades * Math.max(-1, Math.min(1, (0.4 * (height(a) + height(b) + height(c) + height(d))) / this.reach)));
    let last = null;
    for (const corners of quads) {
      const shade = shadeOf(corners);
      if (shade === kShades) continue;
      if (shade !== last) {
        if (last !== null) context.fill();
        context.fillStyle = shades[(last = shade)];
        context.beginPath();
      }
      context.moveTo(x(corners[0]), y(corners[0]));
      for (const k of [1, 2, 3]) context.lineTo(x(corners[k]), y(corners[k]));
    }
    if (last !== null) context.fill();
  }

  // Colours of a disc from its lowest to its highest place.
  shades(middle) {
    const paints = ["accent", middle, "blue"].map((name) => colour(name));
    if (this.painted?.paints.every((paint, k) => paint === paints[k])) return this.painted.shades;
    const parts = paints.map((paint) => [1, 3, 5].map((at) => parseInt(paint.slice(at, at + 2), 16)));
    const mixed = (k) => parts[k < 0 ? 0 : 2].map((to, c) => Math.round(parts[1][c] + (to - parts[1][c]) * Math.min(0.9, 0.06 + Math.abs(k) / kShades)));
    const shades = Array.from({ length: 2 * kShades + 1 }, (_, i) => `rgb(${mixed(i - kShades).join(" ")})`);
    this.painted = { paints, shades };
    return shades;
  }

  // A bridge on its board, which moves too little to be seen: it is drawn larger, up to a fifth of the height.
  drawBoard(context, box, x, item, now) {
    item.zoom ??= roundDown((0.45 * this.reach) / Math.max(largest(item.boards || this.study.column(item.column)), 1e-12));
    const below = 26 * this.size;
    const y = item.boards ? this.height(box, now * item.zoom) : box.middle - now * item.zoom * box.unit;
    const left = x - 0.22 * (box.right - box.left), right = Math.min(x + 0.1 * (box.right - box.left), box.right + 20);
    drawBridgeFoot(context, x, y, below, this.size);
    drawPlank(context, left, right, y + below, 11 * this.size);
    const told = `board × ${readable(item.zoom)}`;
    context.font = "12px system-ui";
    this.write(context, told, right - context.measureText(told).width, y + below + 11 * this.size + 18, "soft");
  }

  // A bar, free at both ends, on the cords of its nodes.
  drawBar(context, box, curve) {
    const across = (p) => box.left + ((box.right - box.left) * p) / (curve.length - 1);
    const thick = 20 * this.size;
    drawWoodenBar(context, Array.from(curve, (y, p) => [across(p), this.height(box, y)]), thick);
    for (const node of [0.224, 0.776]) {
      const x = box.left + node * (box.right - box.left);
      context.fillStyle = colour("paper");
      context.beginPath();
      context.ellipse(x, box.middle + thick / 2, 3, 4, 0, 0, 2 * Math.PI);
      context.fill();
    }
  }

  // A strip of steel that is clamped at one end.
  drawTine(context, box, curve) {
    const across = (p) => box.left + ((box.right - box.left) * p) / (curve.length - 1);
    const thick = 9 * this.size;
    drawSteelStrip(context, Array.from(curve, (y, p) => [across(p), this.height(box, y) - thick / 2]), thick);
    const isLeft = Math.abs(curve[0]) <= Math.abs(curve.at(-1));
    const x = isLeft ? box.left - 20 : box.right;
    drawPlank(context, x, x + 20, box.middle - 15 * this.size, 30 * this.size);
  }

  drawTube(context, box, x, displacement) {
    const half = 46 * this.size;
    const top = box.middle + 44 * this.size;
    drawMetalTube(context, x, top, box.bottom + 8, half, Math.max(-20, Math.min(20, displacement * Math.abs(box.unit))));
  }

  // A mass that lies on a string, or is held around it.
  drawWeight(context, x, y, { isAround }) {
    const { size } = this;
    if (isAround) drawBolt(context, x, y, size);
    else drawSteel(context, x, y - 17 * size, 15 * size);
  }

  // A bow under which the string moves up and down. Its hair holds the string, or the string slips along it.
  drawBow(context, box, { at, string, slid }, x, i, part) {
    const item = this.items.find((other) => other.kind === "string" && other.column === string);
    const curve = this.curve(item, i, part);
    const y = this.height(box, curve[Math.round(at * (curve.length - 1))]);
    const way = slid[i] + (slid[i + 1] - slid[i]) * part;
    const sticks = this.sticks(slid, i);
    drawBowHair(context, { x, y, top: box.top - 4, bottom: box.bottom, moved: -way * box.unit, sticks });
    context.save(); // the string lies on the hair
    context.beginPath();
    context.rect(x - 12, box.top, 24, box.bottom - box.top);
    context.clip();
    const path = new Path2D();
    curve.forEach((displacement, p) => path.lineTo(box.left + ((box.right - box.left) * p) / (curve.length - 1), this.height(box, displacement)));
    this.strokeString(context, path, keyOf(item.hz));
    context.restore();
    this.write(context, sticks ? "sticks" : "slips", x + 90 < this.canvas.clientWidth ? x + 40 : x - 64, box.top + 14, sticks ? "blue" : "accent", `italic 16px ${kTitles}`);
  }

  // Hair that slips goes past the string faster than it creeps while it sticks.
  sticks(slid, i) {
    this.fastest ??= slid.reduce((most, way, k) => (k === 0 ? 0 : Math.max(most, Math.abs(way - slid[k - 1]))), 0);
    return Math.abs(slid[i + 1] - slid[i]) < kSticks * this.fastest;
  }

  drawWall(context, box) {
    context.fillStyle = colour("soft");
    context.fillRect(box.left, box.middle - 14, box.right - box.left, 14);
    this.write(context, "rigid barrier", box.left + 8, box.middle - 20, "soft");
  }

  // What a string meets. It is in the accent's colour while it pushes.
  drawStop(context, x, y, { side }, force, box) {
    drawFretWire(context, x, y, Math.sign(side * -box.unit), force > 0); // to where the stop continues on the canvas
  }

  // Is the end to the left, -1, or to the right, 1, that of a neck with frets?
  isNeck(out) {
    return this.frets.length > 0 && out > 0 === this.frets[0].at > 0.5;
  }

  // The wood in which frets stand.
  drawFingerboard(context, box) {
    if (this.frets.length === 0) return;
    const { side } = this.frets[0];
    const away = Math.sign(side * -box.unit);
    const places = this.frets.map(({ at }) => at);
    const heights = this.frets.map(({ height }) => this.height(box, height));
    const edge = (away > 0 ? Math.max(...heights) : Math.min(...heights)) + 7 * away;
    const across = (at) => box.left + (box.right - box.left) * at;
    // A single fret is where the neck ends, at one side or the other.
    const [first, last] = [Math.min(...places), Math.max(...places)];
    const [left, right] = first > 0.5 ? [across(first) - 60, box.right + 20] : [box.left - 20, across(last) + 60];
    const thick = 24 * this.size;
    drawPlank(context, left, right, away > 0 ? edge : edge - thick, thick);
  }

  drawTouch(context, x, y, force) {
    context.fillStyle = colour(force > 0 ? "accent" : "line");
    context.beginPath();
    context.arc(x, y, 5, 0, 2 * Math.PI);
    context.fill();
  }

  // What strikes yields where it meets something: its top stays there. Far away it waits where it is seen.
  drawHammer(context, box, item, x, value, string) {
    const place = this.pulled?.place ?? null;
    if (place !== null) x = box.left + (box.right - box.left) * place;
    const down = Math.sign(box.unit); // on the canvas
    const { size, pulled } = this;
    const compression = Math.max(0, value(item.compressions));
    const squeezed = pulled ? 0 : Math.min(0.5 * kFelt, (compression * Math.abs(box.unit)) / size);
    const rest = this.height(box, 0);
    const farthest = down > 0 ? box.bottom - kHead * size : box.top + kHead * size;
    const seen = this.height(box, value(item.values) + (item.surface ?? 0) - compression);
    const top = pulled ? rest + pulled.power * this.wayOf(box) * down : down > 0 ? Math.min(seen, farthest) : Math.max(seen, farthest);
    const shape = this.shapeOf(item);
    const hasShank = down > 0 && string !== null && shape === "hammer";
    if (hasShank) this.drawShank(context, box, x, top - squeezed * size, rest);
    else if (shape === "hammer") this.drawStick(context, box, x, top + down * (kFelt - squeezed) * size, down);
    context.save();
    if (!hasShank) this.clipTo(context, box);
    context.translate(x, top);
    context.scale(size, down * size);
    if (shape === "hammer") drawHammerHead(context, kFelt - squeezed, squeezed);
    if (shape === "ball") drawBall(context, squeezed);
    if (shape === "stick") drawDrumStick(context);
    if (shape === "finger") drawFingertip(context, squeezed);
    context.restore();
    if (hasShank) this.coverAbove(context, box, string, x, top);
    this.hold = { x, y: top + down * 0.4 * kHead * size, down, aside: hasShank ? 0 : 34 * size, top: Math.min(top, top + down * kHead * size), bottom: Math.max(top, top + down * kHead * size) };
    if (pulled) this.write(context, pulled.text, x + 34 * size, top + down * 20, "ink", "600 14px system-ui");
  }

  // What strikes, by the name of what it is thrown by; drums are struck by sticks.
  shapeOf({ name }) {
    const known = name.replace("strike_", "").split("_")[0];
    return kBlow[known] ?? (this.discs.length > 0 ? "stick" : "hammer");
  }

  clipTo(context, box) {
    context.beginPath();
    context.rect(0, box.top - 8, this.canvas.clientWidth, box.bottom - box.top + 14);
    context.clip();
  }

  // The displacements of the string that is played, or null.
  shape(i, part) {
    return this.string ? this.curve(this.string, i, part) : null;
  }

  // Felt takes the shape of the string that it meets: what is drawn of it above the string is covered. A clip would cost more.
  coverAbove(context, box, curve, x, top) {
    const across = (p) => box.left + ((box.right - box.left) * p) / (curve.length - 1);
    const half = kHeadHalf * this.size;
    const [first, last] = [x - half, x + half].map((at) => Math.max(0, Math.min(curve.length - 1, Math.round(((at - box.left) / (box.right - box.left)) * (curve.length - 1)))));
    const above = top - 3;
    context.fillStyle = colour("paper");
    context.beginPath();
    context.moveTo(across(first), above);
    let isHigher = false;
    for (let p = first; p <= last; ++p) {
      const y = this.height(box, curve[p]);
      isHigher ||= y > above;
      context.lineTo(across(p), Math.max(above, y));
    }
    context.lineTo(across(last), above);
    if (isHigher) context.fill();
  }

  // Pixels by which something is pulled for all of its power.
  wayOf(box) {
    if (this.depth === null) return Math.max(kLeastReach, Math.min(kReach, (box.bottom - box.top) / 2 - 12));
    const room = (box.unit > 0 ? box.bottom - box.middle : box.middle - box.top) - kHead * this.size;
    return Math.max(kLeastReach, Math.min(kReach, room));
  }

  // From the head along the string to where it turns, which stays in its place.
  drawShank(context, box, x, top, rest) {
    const { size } = this;
    const way = Math.min(kShank * size, 0.45 * (box.right - box.left));
    const pivot = { x: x + way < box.right ? x + way : x - way, y: rest + (kFelt + 26) * size };
    Object.assign(context, { strokeStyle: colour("wood"), lineWidth: 8 * size, lineCap: "round" });
    context.beginPath();
    context.moveTo(x, top + (kFelt + 26) * size);
    context.lineTo(pivot.x, pivot.y);
    context.stroke();
    context.lineCap = "butt";
    context.fillStyle = colour("soft");
    context.beginPath();
    context.arc(pivot.x, pivot.y, 9 * size, 0, 2 * Math.PI);
    context.fill();
    context.fillStyle = colour("paper");
    context.beginPath();
    context.arc(pivot.x, pivot.y, 3 * size, 0, 2 * Math.PI);
    context.fill();
  }

  drawStick(context, box, x, y, down) {
    context.save();
    this.clipTo(context, box);
    context.fillStyle = colour("wood");
    context.fillRect(x - 5 * this.size, down > 0 ? y : y - 400, 10 * this.size, 400);
    context.restore();
  }

  // The points of a bridge near the end of the string, larger in both directions.
  drawBridge(context, box, i, part) {
    const end = this.bridge.at(-1).at * 1.4;
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
    const tops = this.bridge.map((stop) => [across(stop.at), this.height(inner, stop.height), stop.forces[i] > 0]);
    context.fillStyle = colour("felt");
    context.beginPath();
    context.moveTo(inset.left, inset.bottom);
    context.lineTo(inset.left, tops[0][1]);
    for (const [x, y] of tops) context.lineTo(x, y);
    context.lineTo(tops.at(-1)[0] + 14, inset.bottom);
    context.fill();
    const path = new Path2D();
    for (let p = 0; p <= 60; ++p) path.lineTo(across((end * p) / 60), this.height(inner, this.stringAt((end * p) / 60, i, part)));
    this.strokeString(context, path, null);
    for (const [x, y, pushes] of tops) {
      context.fillStyle = colour(pushes ? "accent" : "soft");
      context.beginPath();
      context.arc(x, y + 2, pushes ? 4 : 2.5, 0, 2 * Math.PI);
      context.fill();
    }
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

  // The force of the note, filled up to the time that is shown.
  drawForce(context, { left, right, top, bottom }, frame) {
    const ratio = window.devicePixelRatio || 1;
    [left, top] = [left, top].map((at) => Math.round(at * ratio) / ratio);
    const { picture, peak } = this.pictureOf(right - left, bottom - top, ratio);
    const x = left + ((right - left) * frame) / (this.frames - 1);
    const part = Math.round(Math.max(0, Math.min(1, (x - left) / (right - left))) * picture[0].width);
    const [now, later] = picture; // of the same pixels as the canvas: both are copied, none is blended
    if (part > 0) context.drawImage(now, 0, 0, part, now.height, left, top, part / ratio, now.height / ratio);
    if (part < now.width) context.drawImage(later, part, 0, now.width - part, now.height, left + part / ratio, top, (now.width - part) / ratio, now.height / ratio);
    context.fillStyle = colour("ink");
    context.fillRect(left, bottom, right - left, 1);
    context.fillRect(x - 1, top - 4, 2, bottom - top + 8);
    const told = `force, up to ${readable(Number(peak.toPrecision(3)))} N`;
    context.font = "12px system-ui";
    this.write(context, told, right - context.measureText(told).width, top + 10, "soft");
    const text = `${readable(Number((1000 * this.length()).toPrecision(2)))} ms`;
    this.write(context, "0 ms", left, bottom + 15, "soft");
    this.write(context, text, right - context.measureText(text).width, bottom + 15, "soft");
  }

  // All of the force as two pictures of this size, which are drawn once: what has been, and paler what will be; and the largest
  // force.
  pictureOf(width, height, ratio) {
    const of = [this.study, width, height, ratio, colour("accent"), colour("paper")];
    if (this.picture?.of.every((part, k) => part === of[k])) return this.picture;
    const peak = largest(this.forces.subarray(0, this.frames)) || 1;
    const [w, h] = [Math.ceil(width * ratio), Math.ceil(height * ratio)];
    const pieces = Math.min(this.frames - 1, w);
    const path = new Path2D();
    path.moveTo(0, h);
    for (let i = 0; i <= pieces; ++i) path.lineTo((w * i) / pieces, h * (1 - this.forces[Math.round((i * (this.frames - 1)) / pieces)] / peak));
    path.lineTo(w, h);
    this.pictures ??= [0, 1].map(() => document.createElement("canvas"));
    const bow = this.items.find(({ kind }) => kind === "bow");
    this.pictures.forEach((picture, k) => {
      if (picture.width !== w || picture.height !== h) Object.assign(picture, { width: w, height: h });
      const context = picture.getContext("2d", { alpha: false });
      Object.assign(context, { fillStyle: colour("paper"), globalAlpha: 1 }).fillRect(0, 0, w, h);
      Object.assign(context, { fillStyle: colour("accent"), globalAlpha: k === 0 ? 1 : 0.3 });
      if (bow) this.fillSlips(context, bow, { w, h, peak });
      else context.fill(path);
    });
    return (this.picture = { of, picture: this.pictures, peak });
  }

  // The force of a bow in the colours of its hair, which holds the string or slips along it.
  fillSlips(context, { slid }, { w, h, peak }) {
    for (let i = 0; i < this.frames - 1; ++i) {
      const high = (h * this.forces[i]) / peak;
      context.fillStyle = colour(this.sticks(slid, i) ? "blue" : "accent");
      context.fillRect((w * i) / (this.frames - 1), h - high, w / (this.frames - 1) + 0.5, high);
    }
  }

  // Pulling a hammer back sets its speed, moving it along the string its place; letting go throws it. Pulling a string sets
  // the force of its pluck.
  listenToPointers() {
    const { canvas } = this;
    const at = ({ clientX, clientY }) => {
      const { left, top } = canvas.getBoundingClientRect();
      return { x: clientX - left, y: clientY - top };
    };
    // A finger that has taken hold of something, which pointerdown tells first, does not scroll the page.
    canvas.addEventListener("touchstart", (event) => this.pulled && event.preventDefault(), { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      const { x, y } = at(event);
      if (!this.isNear({ x, y })) return;
      event.preventDefault();
      canvas.setPointerCapture(event.pointerId);
      this.setPlaying(false);
      this.at = 0;
      this.from = { x, y, down: this.hold.down };
      this.pull({ x, y });
    });
    canvas.addEventListener("pointermove", (event) => {
      this.pointer = at(event);
      if (this.pulled) this.pull(this.pointer);
      this.showHand();
    });
    canvas.addEventListener("pointerup", () => {
      if (!this.pulled) return;
      const { power, place } = this.pulled;
      this.isInviting = false;
      this.wake();
      this.endPull();
      this.thrown({ power: power > 0.03 ? power : null, place });
    });
    canvas.addEventListener("pointercancel", () => {
      if (!this.pulled) return;
      this.endPull();
      if (this.isAwake) this.setPlaying(true);
      else this.rest();
    });
  }

  // Shows what came meanwhile.
  endPull() {
    const { next } = this;
    this.slip();
    if (next) this.show(next.study, next.key);
  }

  isNear({ x, y }) {
    return this.hold && Math.hypot(x - this.hold.x, y - this.hold.y) <= kNear;
  }

  // The pointer is a hand where it can take hold.
  showHand() {
    const hand = this.pulled ? "grabbing" : this.pointer && this.isNear(this.pointer) ? "grab" : "";
    if (hand !== this.hand) this.canvas.style.cursor = this.hand = hand;
  }

  // A hammer is pulled back, a string to both sides.
  pull({ x, y }) {
    const { left, right } = this.box;
    const way = (y - this.from.y) / this.wayOf(this.box);
    const { down } = this.from;
    const power = Math.max(0, Math.min(1, down === 0 ? Math.abs(way) : way * down));
    const moves = down !== 0 && this.study.scene.moves !== null && Math.abs(x - this.from.x) > 6;
    const place = moves || this.pulled?.place ? Math.max(0.02, Math.min(0.98, (x - left) / (right - left))) : null;
    this.pulled = { power, place, side: Math.sign(way), text: this.tell(power, place) };
    this.drawSoon();
  }
}
