// SPDX-License-Identifier: MIT
// Schelleng's diagram: what a bowed string does at places and forces of its bow, with a point that one moves.
import { kForces, kPlaces } from "./bowed_string.js";
import { readable } from "./controls.js";
import { colour } from "./plots.js";

/** What a string does: its colour and its words. */
export const kMotions = {
  helmholtz: { paint: "blue", told: "one slip in each period: Helmholtz' motion" },
  several: { paint: "felt", told: "several slips in each period: too little force" },
  raucous: { paint: "accent", told: "no regular motion: too much force" },
  none: { paint: "line", told: "the bow only slides" },
};

const kMargin = { left: 52, right: 10, top: 10, bottom: 38 };
const kMarkedPlaces = [0.03, 0.05, 0.1, 0.2], kMarkedForces = [0.03, 0.1, 0.3, 1, 3];

export class Schelleng {
  /** moved({ place, force }): the point is moved. */
  constructor(canvas, moved) {
    Object.assign(this, { canvas, moved, columns: [], point: null });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.isHeld = true;
      this.move(event);
    });
    canvas.addEventListener("pointermove", (event) => this.isHeld && this.move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (this.isHeld = false));
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** columns: of the first places, a name of kMotions for each force. point: { place, force }. */
  show(columns, point) {
    Object.assign(this, { columns, point });
    this.draw();
  }

  // Parts of the way along an axis, whose cells have the values in their middles.
  part(values, value) {
    const step = Math.log(values[1] / values[0]);
    return (Math.log(value / values[0]) / step + 0.5) / values.length;
  }
  value(values, part) {
    const step = values[1] / values[0];
    return values[0] * step ** (Math.max(0, Math.min(1, part)) * values.length - 0.5);
  }

  area() {
    const { clientWidth, clientHeight } = this.canvas;
    return { width: clientWidth - kMargin.left - kMargin.right, height: clientHeight - kMargin.top - kMargin.bottom };
  }

  move({ clientX, clientY }) {
    const { left, top } = this.canvas.getBoundingClientRect(), { width, height } = this.area();
    this.moved({ place: this.value(kPlaces, (clientX - left - kMargin.left) / width), force: this.value(kForces, 1 - (clientY - top - kMargin.top) / height) });
  }

  draw() {
    const { canvas, point } = this;
    const ratio = devicePixelRatio || 1;
    const [w, h] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.round(size * ratio));
    if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
    const context = canvas.getContext("2d", { alpha: false });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = colour("panel");
    context.fillRect(0, 0, w, h);
    const { width, height } = this.area();
    const x = (place) => kMargin.left + width * this.part(kPlaces, place), y = (force) => kMargin.top + height * (1 - this.part(kForces, force));
    const [wide, high] = [width / kPlaces.length, height / kForces.length];
    this.columns.forEach((column, k) =>
      column.forEach((motion, f) => {
        context.fillStyle = colour(kMotions[motion].paint);
        context.fillRect(kMargin.left + k * wide, kMargin.top + height - (f + 1) * high, wide - 1, high - 1);
      }),
    );
    context.fillStyle = colour("soft");
    context.font = "12px system-ui";
    for (const place of kMarkedPlaces) context.fillText(String(place), x(place) - 10, h / ratio - 22);
    for (const force of kMarkedForces) context.fillText(`${readable(force)} N`, 8, y(force) + 4);
    context.fillText("bow's distance from the bridge, of the length", kMargin.left, h / ratio - 5);
    if (!point) return;
    Object.assign(context, { strokeStyle: colour("panel"), fillStyle: colour("ink"), lineWidth: 2.5 });
    context.beginPath();
    context.arc(x(point.place), y(point.force), 9, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }
}
