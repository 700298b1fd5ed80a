// SPDX-License-Identifier: MIT
// What instruments are made of, as the stage draws it: heads that strike, boards, bars, shells, frets, bows. All lengths are pixels;
// `size` scales what does not depend on displacements.
import { colour } from "./plots.js";

export const kFelt = 50, kHead = 88; // lengths of a hammer's felt, and of a whole head, which is drawn larger or smaller
const kEdge = "#33241a"; // of wood and felt
const kRods = 8; // around the shell of a drum

const fill = (context, paint, alpha = 1) => {
  Object.assign(context, { fillStyle: paint.startsWith("#") ? paint : colour(paint), globalAlpha: alpha }).fill();
  context.globalAlpha = 1;
};

const path = (context, draw) => {
  context.beginPath();
  draw(context);
  return context;
};

// Light from above on a part between two heights.
function shaded(context, paint, top, bottom) {
  const shade = context.createLinearGradient(0, top, 0, bottom);
  const parts = [[0, "#ffffff59"], [0.35, "#ffffff00"], [1, "#00000059"]];
  fill(context, paint);
  for (const [at, tint] of parts) shade.addColorStop(at, tint);
  Object.assign(context, { fillStyle: shade }).fill();
}

/** Felt of so much depth around a wooden core: layers that lie closer when they are pressed. The string is at (0, 0), the shank is
 * below. */
export function drawHammerHead(context, depth, squeezed) {
  const layer = (part) => {
    const [w, top, base] = [part * (22 + 0.3 * squeezed), depth * (1 - part) * 0.72, depth + 9];
    const flat = part * (2 + 0.4 * squeezed);
    context.beginPath();
    context.moveTo(-flat, top);
    context.lineTo(flat, top);
    context.bezierCurveTo(0.8 * w, top, w, top + 0.28 * (base - top), w, top + 0.5 * (base - top));
    context.bezierCurveTo(w, base - 6, 0.7 * w, base, 8, base);
    context.lineTo(-8, base);
    context.bezierCurveTo(-0.7 * w, base, -w, base - 6, -w, top + 0.5 * (base - top));
    context.bezierCurveTo(-w, top + 0.28 * (base - top), -0.8 * w, top, -flat, top);
    context.closePath();
  };
  layer(1);
  fill(context, "felt");
  Object.assign(context, { strokeStyle: kEdge, lineWidth: 0.8 });
  for (const part of [0.88, 0.76, 0.64, 0.52]) {
    layer(part);
    context.globalAlpha = 0.25 + squeezed / 100;
    context.stroke();
  }
  layer(0.42);
  fill(context, "accent");
  context.beginPath();
  context.moveTo(0, 0.62 * depth);
  context.lineTo(9, depth + 2);
  context.lineTo(8, depth + 34);
  context.quadraticCurveTo(0, depth + 40, -8, depth + 34);
  context.lineTo(-9, depth + 2);
  context.closePath();
  fill(context, "wood");
  context.globalAlpha = 0.35;
  context.stroke();
  context.globalAlpha = 1;
}

/** A ball of yarn or cloth on a handle, flatter the more it is squeezed. It touches at (0, 0). */
export function drawBall(context, squeezed) {
  path(context, () => context.rect(-4, 30, 8, 400));
  fill(context, "wood");
  const [w, h] = [24 + 0.35 * squeezed, (kFelt - squeezed) / 2];
  path(context, () => context.ellipse(0, h, w, h, 0, 0, 2 * Math.PI));
  fill(context, "felt");
  Object.assign(context, { strokeStyle: kEdge, lineWidth: 0.8, globalAlpha: 0.35 });
  for (const part of [0.3, 0.65]) {
    path(context, () => context.ellipse(0, h, part * w, h, 0, 0, 2 * Math.PI)).stroke();
    path(context, () => context.ellipse(0, h, w, part * h, 0, 0, 2 * Math.PI)).stroke();
  }
  context.globalAlpha = 1;
}

/** A drum stick that leans to the right, with its tip at (0, 0). */
export function drawDrumStick(context) {
  context.save();
  context.rotate(-0.42);
  path(context, () => {
    context.moveTo(-3, 16);
    context.lineTo(-7, 420);
    context.lineTo(7, 420);
    context.lineTo(3, 16);
  });
  fill(context, "wood");
  path(context, () => context.ellipse(0, 11, 7, 12, 0, 0, 2 * Math.PI));
  fill(context, "wood");
  Object.assign(context, { strokeStyle: kEdge, lineWidth: 0.8, globalAlpha: 0.5 }).stroke();
  context.restore();
}

/** The end of a finger, flatter the more it is squeezed. It touches at (0, 0); toSide: by how much it leans. */
export function drawFingertip(context, squeezed, toSide = -0.3) {
  const [w, h] = [13 + 0.2 * squeezed, 30 - 0.4 * squeezed];
  context.save();
  context.transform(1, 0, toSide, 1, 0, 0);
  path(context, () => {
    context.moveTo(-w, 400);
    context.lineTo(-w, h);
    context.bezierCurveTo(-w, 0.25 * h, -0.5 * w, 0, 0, 0);
    context.bezierCurveTo(0.5 * w, 0, w, 0.25 * h, w, h);
    context.lineTo(w, 400);
  });
  fill(context, "skin");
  Object.assign(context, { strokeStyle: kEdge, lineWidth: 1, globalAlpha: 0.5 }).stroke();
  context.globalAlpha = 1;
  path(context, () => context.roundRect(-0.62 * w, 7, 1.24 * w, 0.72 * h, 7));
  fill(context, "#ffffff", 0.35);
  for (const y of [1.7 * h, 1.85 * h]) path(context, () => (context.moveTo(-0.5 * w, y), context.lineTo(0.5 * w, y)));
  context.restore();
}

/** A plank with its grain, from left to right, `thick` high below y. */
export function drawPlank(context, left, right, y, thick) {
  path(context, () => context.roundRect(left, y, right - left, thick, 3));
  shaded(context, "wood", y, y + thick);
  Object.assign(context, { strokeStyle: kEdge, lineWidth: 0.7, globalAlpha: 0.3 });
  for (const part of [0.35, 0.62, 0.85]) path(context, () => (context.moveTo(left + 4, y + part * thick), context.lineTo(right - 4, y + part * thick))).stroke();
  context.globalAlpha = 1;
}

/** The bridge that carries a string at (x, y) on a board, which is `below` it. */
export function drawBridgeFoot(context, x, y, below, size) {
  path(context, () => {
    context.moveTo(x - 4 * size, y);
    context.lineTo(x + 4 * size, y);
    context.lineTo(x + 13 * size, y + below);
    context.lineTo(x - 13 * size, y + below);
    context.closePath();
  });
  shaded(context, "felt", y, y + below);
  Object.assign(context, { strokeStyle: kEdge, lineWidth: 0.8, globalAlpha: 0.5 }).stroke();
  context.globalAlpha = 1;
}

// The path of a bar by the points of its upper side.
function strip(context, points, thick) {
  path(context, () => {
    for (const [x, y] of points) context.lineTo(x, y);
    for (const [x, y] of points.toReversed()) context.lineTo(x, y + thick);
    context.closePath();
  });
}

/** A strip of steel by the points of its upper side. */
export function drawSteelStrip(context, points, thick) {
  strip(context, points, thick);
  const tops = points.map(([, y]) => y), top = Math.min(...tops), bottom = Math.max(...tops) + thick;
  const shade = context.createLinearGradient(0, top, 0, bottom);
  for (const [at, tint] of [[0, "#dedad2"], [0.5, "#a8a49c"], [1, "#6a665f"]]) shade.addColorStop(at, tint);
  Object.assign(context, { fillStyle: shade }).fill();
  Object.assign(context, { strokeStyle: kEdge, lineWidth: 1, globalAlpha: 0.6 }).stroke();
  context.globalAlpha = 1;
}

/** A wooden bar along points (x, y) of its upper side. */
export function drawWoodenBar(context, points, thick) {
  const tops = points.map(([, y]) => y);
  strip(context, points, thick);
  shaded(context, "wood", Math.min(...tops), Math.max(...tops) + thick);
  Object.assign(context, { strokeStyle: kEdge, lineWidth: 1, globalAlpha: 0.5 }).stroke();
  for (const part of [0.4, 0.7]) {
    path(context, () => points.forEach(([x, y]) => context.lineTo(x, y + part * thick)));
    context.globalAlpha = 0.2;
    context.stroke();
  }
  context.globalAlpha = 1;
}

/** An open metal tube with its mouth at (x, top). air: by how much the air stands above it. */
export function drawMetalTube(context, x, top, bottom, half, air) {
  path(context, () => context.rect(x - half, top, 2 * half, bottom - top));
  const shade = context.createLinearGradient(x - half, 0, x + half, 0);
  for (const [at, tint] of [[0, "#7d7a74"], [0.3, "#dedad2"], [0.6, "#a8a49c"], [1, "#6a665f"]]) shade.addColorStop(at, tint);
  Object.assign(context, { fillStyle: shade }).fill();
  path(context, () => context.ellipse(x, top, half, 0.18 * half, 0, 0, 2 * Math.PI));
  fill(context, "#3c3933");
  path(context, () => context.ellipse(x, top - air, 0.94 * half, 0.16 * half, 0, 0, 2 * Math.PI));
  fill(context, "blue", 0.45);
}

/** The wall of a drum between the rims of its two heads, through which one looks, and the rods that stretch them. rims: [{ x, y, rx,
 * ry }], the upper one first. */
export function drawShell(context, [upper, lower]) {
  path(context, () => {
    context.ellipse(upper.x, upper.y, upper.rx, upper.ry, 0, Math.PI, 0, true);
    context.ellipse(lower.x, lower.y, lower.rx, lower.ry, 0, 0, Math.PI);
    context.closePath();
  });
  fill(context, "wood", 0.7);
  Object.assign(context, { strokeStyle: colour("soft"), lineWidth: 2 });
  context.beginPath();
  for (let k = 0; k < kRods; ++k) {
    const [x, y] = [Math.cos, Math.sin].map((part) => part((Math.PI * (k + 0.5)) / kRods));
    context.moveTo(upper.x + upper.rx * x, upper.y + upper.ry * y);
    context.lineTo(lower.x + lower.rx * x, lower.y + lower.ry * y);
  }
  context.stroke();
}

/** A fret of metal with its crown at (x, y), down: 1 or -1, to where it stands. */
export function drawFretWire(context, x, y, down, pushes) {
  path(context, () => {
    context.moveTo(x - 6, y + 9 * down);
    context.quadraticCurveTo(x - 5, y, x, y);
    context.quadraticCurveTo(x + 5, y, x + 6, y + 9 * down);
    context.closePath();
    context.rect(x - 1.5, y + 8 * down - (down < 0 ? 8 : 0), 3, 8);
  });
  fill(context, pushes ? "accent" : "soft");
}

/** A round bar of steel seen from its end. */
export function drawSteel(context, x, y, radius) {
  const shade = context.createRadialGradient(x - 0.35 * radius, y - 0.4 * radius, 0.1 * radius, x, y, radius);
  for (const [at, tint] of [[0, "#ffffff"], [0.5, "#b9b6b0"], [1, "#6c6963"]]) shade.addColorStop(at, tint);
  path(context, () => context.arc(x, y, radius, 0, 2 * Math.PI));
  Object.assign(context, { fillStyle: shade }).fill();
  Object.assign(context, { strokeStyle: colour("soft"), lineWidth: 1 }).stroke();
}

/** A bolt around a string at (x, y). */
export function drawBolt(context, x, y, size) {
  path(context, () => context.roundRect(x - 5 * size, y - 17 * size, 10 * size, 34 * size, 2));
  shaded(context, "soft", y - 17 * size, y + 17 * size);
  Object.assign(context, { strokeStyle: colour("paper"), lineWidth: 1, globalAlpha: 0.7 });
  for (let k = -12; k <= 12; k += 4) path(context, () => (context.moveTo(x - 5 * size, y + k * size + 1), context.lineTo(x + 5 * size, y + k * size - 1))).stroke();
  context.globalAlpha = 1;
  path(context, () => context.roundRect(x - 10 * size, y - 25 * size, 20 * size, 9 * size, 2));
  shaded(context, "soft", y - 25 * size, y - 16 * size);
}

/** The hair and the stick of a bow that crosses a string at (x, y), from top to bottom, moved by so many pixels. sticks: does the
 * hair hold the string? */
export function drawBowHair(context, { x, y, top, bottom, moved, sticks }) {
  const half = 11;
  path(context, () => context.rect(x + half + 12, top, 8, bottom - top));
  fill(context, "wood");
  path(context, () => context.rect(x - half, top, 2 * half, bottom - top));
  fill(context, "key");
  Object.assign(context, { strokeStyle: colour("soft"), lineWidth: 0.8, globalAlpha: 0.55 });
  for (let k = 1 - half; k < half; k += 3) path(context, () => (context.moveTo(x + k, top), context.lineTo(x + k, bottom))).stroke();
  // Marks on the hair, by which one sees it move.
  const apart = 46;
  context.globalAlpha = 1;
  for (let mark = top + ((((moved + y - top) % apart) + apart) % apart); mark < bottom; mark += apart) {
    path(context, () => context.rect(x - half, mark - 1.5, 2 * half, 3));
    fill(context, sticks ? "blue" : "accent");
  }
}
