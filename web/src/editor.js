// SPDX-License-Identifier: MIT
// The editor of a material: fields or text in, design out, with its curves, errors and files to download.
import { choice, fillSelect, readable, slider, whenChosen } from "./controls.js";
import { materialFields, materialText, measuredText, withKnots } from "./material.js";
import { linePlot } from "./plots.js";
import { download } from "./save.js";

const kSliders = {
  force: { label: "force at 0.5 mm", unit: "N", min: 1e-3, max: 1e7, isLogarithmic: true },
  exponent: { label: "exponent a", min: 1, max: 5, step: 0.01 },
  loss: { label: "loss", unit: "s/m", min: 0, max: 2, step: 0.01 },
  segments: { label: "segments", min: 1, max: 128, step: 1 },
  mass: { label: "hammer mass", unit: "g", factor: 1000, min: 1e-4, max: 0.1, isLogarithmic: true },
  slowest: { label: "slowest impact", unit: "m/s", min: 0.01, max: 2, isLogarithmic: true },
  fastest: { label: "fastest impact", unit: "m/s", min: 1, max: 20, isLogarithmic: true },
};
/** The compression [m] at which the force stays when the exponent changes. */
const kHeldAt = 5e-4;
const kKnots = { uniform: "uniform", graded: "graded", optimal: "optimal" };
const kMinimise = { contact_duration: "contact duration", force: "force", spectrum: "spectrum" };

const byId = (id) => document.getElementById(id);

export class Editor {
  /** background: designs what a field moves to (worker.js). change(design) is called with every new design. */
  constructor(generator, background, change) {
    Object.assign(this, { generator, background, change, loads: 0 });
    this.shipped = generator.materials();
    fillSelect(byId("material"), { ...Object.fromEntries(Object.keys(this.shipped).map((name) => [name, name])), "": "my own" });
    byId("material").addEventListener("change", ({ target }) => target.value && this.load({ name: target.value }));
    byId("curve-file").addEventListener("click", () => byId("curve-input").click());
    whenChosen(byId("curve-input"), (file) => this.loadCurve(file));
    byId("use-text").addEventListener("click", () => this.load({ text: byId("text").value }));
    this.controls = Object.fromEntries(
      Object.entries(kSliders).map(([key, shape]) => [key, slider({ ...shape, init: shape.min }, () => this.edited(key))]),
    );
    this.controls.knots = choice({ label: "knots", choices: kKnots, init: "uniform" }, () => this.edited("knots"));
    this.controls.minimise = choice({ label: "optimal knots minimise the error of", choices: kMinimise, init: "spectrum" }, () => this.edited("minimise"));
    byId("fields").append(...Object.values(this.controls).map(({ box }) => box));
    this.curve = linePlot(byId("curve"), {
      x: "compression [mm]",
      y: "force [N]",
      lines: [
        { label: "exact law", colour: "orange", width: 5 },
        { label: "spline", colour: "blue", width: 2 },
        { label: "knots", colour: "ink", isPoints: true },
      ],
    });
    this.error = linePlot(byId("error"), { x: "compression [mm]", y: "error [%]", lines: [{ label: "spline less law", colour: "blue" }] });
  }

  /** Makes a material of a measured curve, a CSV file. What is wrong with it is said as of any material. */
  async loadCurve(file) {
    try {
      this.generator.takeFile(file.name, await file.text());
      this.load({ text: measuredText(file.name) });
    } catch (error) {
      this.refuse(`${file.name} cannot be read: ${error.message}`);
    }
  }

  /** Shows a material: { name } of one that ships, or { text } of a file. Returns what is wrong with it, or null. */
  load(material) {
    const name = material.text === undefined ? String(material.name) : null;
    if (name !== null && !Object.hasOwn(this.shipped, name)) return `no material ${name} ships`;
    byId("material").value = name ?? "";
    byId("text").value = name === null ? material.text : this.shipped[name];
    const error = this.design(name);
    if (error === null) this.showFields();
    return error;
  }

  showFields() {
    this.fields = materialFields(byId("text").value, this.current.table.length);
    byId("fields").hidden = this.fields === null;
    if (!this.fields) return;
    const force = this.fields.stiffness * kHeldAt ** this.fields.exponent;
    for (const [key, control] of Object.entries(this.controls)) control.set(key === "force" ? force : this.fields[key]);
  }

  // A field moved: the material is the user's own from now on. Another exponent keeps the force at kHeldAt.
  edited(moved) {
    for (const [key, control] of Object.entries(this.controls)) if (key !== "force") this.fields[key] = control.get();
    if (moved === "force" || moved === "exponent")
      this.fields.stiffness = Number((this.controls.force.get() / kHeldAt ** this.fields.exponent).toPrecision(6));
    if (this.source.name) this.fields.name = `my_${this.source.name}`.replace(/^my_my_/, "my_");
    byId("material").value = "";
    byId("text").value = materialText(this.fields);
    this.designSoon(byId("text").value);
  }

  // By another thread, while the page goes on. What was loaded meanwhile stays.
  async designSoon(text) {
    const [began, { loads }] = [performance.now(), this];
    const design = await this.background.latest("design", "design", { text, name: "material.json" }).catch((error) => error);
    if (design === undefined || loads !== this.loads) return;
    if (design instanceof Error) this.refuse(design.message);
    else this.take(design, text, { text }, performance.now() - began);
  }

  /** What a link says of the material that plays. */
  state() {
    return this.source;
  }

  // Designs the text; name: of a material that ships. Returns what is wrong with it, or null.
  design(name) {
    const text = byId("text").value;
    ++this.loads;
    try {
      const began = performance.now();
      const design = this.generator.design(text, `${name ?? "material"}.json`);
      this.take(design, text, name === null ? { text } : { name }, performance.now() - began);
      return null;
    } catch (error) {
      this.refuse(error.message);
      return error.message;
    }
  }

  // text: of its file; source: what a link says of it.
  take(design, text, source, milliseconds) {
    this.showDesign(design, milliseconds);
    this.offer(design, text);
    byId("design-note").className = "";
    this.source = source;
    this.current = design;
    this.change(design);
  }

  // What is wrong, in one line.
  refuse(line) {
    Object.assign(byId("design-note"), { className: "error", textContent: line });
  }

  showDesign({ curve, quality, law, table, title }, milliseconds) {
    const millimetres = curve.compression_m.map((y) => 1000 * y);
    const largest = curve.law_n[curve.law_n.length - 1];
    this.curve.set(withKnots(curve, table));
    this.error.set([millimetres, curve.spline_n.map((force, i) => (100 * (force - curve.law_n[i])) / largest)]);
    const percent = (value) => `${readable(100 * value)} %`;
    const errors = [`force at most ${percent(quality.force)}`];
    if (quality.contact_duration !== undefined) errors.push(`contact duration at most ${percent(quality.contact_duration)}`);
    if (quality.spectrum_db !== undefined) errors.push(`spectrum ${readable(quality.spectrum_db)} dB on average`);
    byId("design-note").textContent =
      `${title}: ${law.replace(/(?<![\w.])\d+\.?\d*(e[+-]?\d+)?(?!\w|\.\d)/g, (number) => (number.length < 6 ? number : readable(Number(number))))}. ${table.length} segments; errors: ${errors.join(", ")}. Designed in ${milliseconds.toFixed(0)} ms.`;
  }

  offer(design, text) {
    const files = { ...design.files, [`${design.name}_material.json`]: text };
    const isSame = this.files && Object.keys(files).join() === Object.keys(this.files).join();
    this.files = files;
    if (isSame) return; // the buttons stay: new ones would lay the page out again
    const titles = { lib: "Faust library", hpp: "C++ header", json: "JSON" };
    byId("downloads").replaceChildren(
      ...Object.keys(files).map((name) => {
        const button = document.createElement("button");
        const kind = name.endsWith("_material.json") ? "material file" : titles[name.split(".").pop()];
        button.textContent = `Download ${kind}`;
        button.dataset.file = name;
        button.addEventListener("click", () => download(name, this.files[name]));
        return button;
      }),
    );
  }
}
