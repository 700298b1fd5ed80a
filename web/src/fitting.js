// SPDX-License-Identifier: MIT
// A material from measurements: data files in; the fitted material, its report and figures of data and model out.
import { readable, whenChosen } from "./controls.js";
import { linePlot } from "./plots.js";

const kShown = 30; // milliseconds in which the browser shows that it works

const byId = (id) => document.getElementById(id);
const capital = (text) => text[0].toUpperCase() + text.slice(1);

export class Fitting {
  /** take(text) is called with the file of every fitted material. Returns what is wrong with it in one line, or null. */
  constructor(generator, take) {
    Object.assign(this, { generator, take, plots: new Map() });
    byId("fit-choose").addEventListener("click", () => byId("fit-input").click());
    whenChosen(byId("fit-input"), (_, files) => this.fit(files));
  }

  /** Fits a material to data files; one of them may be a fit file, which names the others. */
  async fit(files) {
    this.tell(`Fitting ${files.map(({ name }) => name).join(", ")} …`);
    await new Promise((shown) => setTimeout(shown, kShown));
    try {
      const began = performance.now();
      const texts = await Promise.all(files.map((file) => file.text()));
      files.forEach(({ name }, i) => this.generator.takeFile(name, texts[i]));
      const own = files.findIndex(({ name }) => /\.json$/i.test(name));
      const mass = Number(byId("fit-mass").value) / 1000;
      const text = own < 0 ? this.generator.fitFile(files.map(({ name }) => name), mass) : texts[own];
      const { material, report, panels } = this.generator.fit(text, own < 0 ? "measurements" : files[own].name);
      const wrong = this.take(material);
      if (wrong) throw new Error(wrong);
      this.show(panels);
      byId("fit-report").textContent = report;
      byId("fit-details").hidden = false;
      const found = report.slice(0, report.indexOf("\n")).replace(/mass ([\d.e-]+) kg/, (_, kg) => `mass ${readable(1000 * kg)} g`);
      this.tell(`${capital(found)}: the material below, with its intervals in the report. Fitted in ${((performance.now() - began) / 1000).toFixed(1)} s.`);
    } catch (error) {
      this.tell(error.message, "error");
    }
  }

  tell(line, className = "") {
    Object.assign(byId("fit-note"), { className, textContent: line });
  }

  // A figure for each kind of data; those of an earlier fit are used again.
  show(panels) {
    for (const { figure } of this.plots.values()) figure.hidden = true;
    for (const { quantity, at, value, isLine, columns } of panels) {
      if (!this.plots.has(quantity)) this.plots.set(quantity, this.figureOf(quantity, at, value, isLine));
      const { figure, plot } = this.plots.get(quantity);
      figure.hidden = false;
      plot.set(columns);
    }
  }

  figureOf(quantity, at, value, isLine) {
    const [figure, caption, title, note, box] = ["figure", "figcaption", "b", "span", "div"].map((tag) => document.createElement(tag));
    title.textContent = `Fit: ${quantity}`;
    Object.assign(note, { className: "note", textContent: at.startsWith("time") ? "data and model, one pulse after another" : "data and model" });
    box.className = "plot";
    caption.append(title, " ", note);
    figure.append(caption, box);
    byId("fit-figures").append(figure);
    const data = { label: "measured", colour: "orange", isPoints: true, size: 5 };
    const plot = linePlot(box, { x: at, y: value, lines: [data, { label: "model", colour: "blue", width: 1.5, isPoints: !isLine, size: 3 }] });
    return { figure, plot };
  }
}
