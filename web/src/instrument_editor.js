// SPDX-License-Identifier: MIT
// The editor of an instrument file: text in, its drawing and parts out, and the instrument plays.
import { kSampleRate } from "./audio.js";
import { fillSelect, whenChosen } from "./controls.js";
import { download } from "./save.js";
import { kMaxFile } from "./state.js";

const kFirst = "tanpura";
const kLeastWidth = 320; // points of the screen that a drawing has
const kSettled = 50; // milliseconds after the last key: with a fade of 20 ms it is heard within 0.1 s
const kMargin = "300px"; // it is drawn before it is in view
const kDot = 4, kMass = 8; // radius, half a side
const kTooLong = `. Links and Undo leave this file out: they take files of up to ${kMaxFile} letters.`;

const byId = (id) => document.getElementById(id);

/** An element of an SVG with attributes and children. */
function svg(tag, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** What the generator drew, as an SVG; its colours are those of the page (style.css). */
function drawn({ width, height, lines, dots, labels }, title) {
  const line = ({ from: [x1, y1], to: [x2, y2], part }) => svg("line", { class: part, x1, y1, x2, y2 });
  const dot = ({ at: [x, y], isMass }) =>
    isMass
      ? svg("rect", { class: "mass", x: x - kMass, y: y - kMass, width: 2 * kMass, height: 2 * kMass })
      : svg("circle", { class: "point", cx: x, cy: y, r: kDot });
  const label = ({ at: [x, y], text, part }) => svg("text", { class: part, x, y }, text);
  const image = { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": `Drawing of ${title}; its parts stand below` };
  return svg("svg", image, ...lines.map(line), ...dots.map(dot), ...labels.map(label));
}

export class InstrumentEditor {
  /** play({ title, bytes, text }) is called with every instrument that can be played. */
  constructor(generator, play) {
    Object.assign(this, { generator, play, shipped: generator.instruments(), text: null, name: "instrument", width: 0 });
    fillSelect(byId("file-start"), { ...Object.fromEntries(Object.keys(this.shipped).map((name) => [name, name])), "": "my own" });
    byId("file-start").addEventListener("change", ({ target }) => target.value && this.load(this.shipped[target.value]));
    byId("file-open").addEventListener("click", () => byId("file-input").click());
    whenChosen(byId("file-input"), (file) => this.loadFile(file));
    byId("file-save").addEventListener("click", () => download(`${this.name}.json`, byId("file-text").value));
    byId("file-text").addEventListener("input", () => {
      clearTimeout(this.settling);
      this.settling = setTimeout(() => this.load(byId("file-text").value), kSettled);
    });
    const near = new IntersectionObserver(([{ isIntersecting }]) => isIntersecting && this.text === null && this.show(this.shipped[kFirst]), { rootMargin: kMargin });
    near.observe(byId("instrument-editor"));
    new ResizeObserver(() => this.text !== null && this.roomFor() !== this.width && this.show(this.text)).observe(byId("file-drawing"));
  }

  roomFor() {
    return Math.max(kLeastWidth, byId("file-drawing").clientWidth);
  }

  async loadFile(file) {
    try {
      this.load(await file.text());
    } catch (error) {
      Object.assign(byId("file-note"), { className: "error", textContent: `${file.name} cannot be read: ${error.message}` });
    }
  }

  /** Shows the text of a file and plays its instrument. Returns what is wrong with it, or null. */
  load(text) {
    const instrument = this.show(text);
    if (instrument.error === undefined) this.play({ ...instrument, text });
    return instrument.error ?? null;
  }

  /** Shows the text of a file with its drawing; what is wrong with it in one line. The last drawing stays, then. */
  show(text) {
    this.text = text;
    this.width = this.roomFor();
    if (byId("file-text").value !== text) byId("file-text").value = text;
    byId("file-start").value = Object.keys(this.shipped).find((name) => this.shipped[name] === text) ?? "";
    const instrument = this.generator.instrument(text, "instrument.json", { width: this.width, sampleRate: kSampleRate });
    const { error, name, title, parts, drawing } = instrument;
    byId("file-note").className = error === undefined ? "" : "error";
    byId("file-note").textContent = error ?? `${title}${text.length > kMaxFile ? kTooLong : ""}`;
    byId("file-text").setAttribute("aria-invalid", String(error !== undefined));
    if (error !== undefined) return instrument;
    this.name = name;
    byId("file-parts").textContent = parts;
    byId("file-drawing").replaceChildren(drawn(drawing, name));
    return instrument;
  }
}
