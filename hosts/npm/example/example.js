// SPDX-License-Identifier: MIT
import { ContactSpline, instruments, loadGenerator } from "../contactspline.js";

const byId = (id) => document.getElementById(id);
const context = new AudioContext();
let node = null;
let changed = Promise.resolve(); // when the last choice is made

/** Plays an instrument, by its name or { text } of a file, instead of the one before. */
function play(instrument) {
  context.resume(); // in the click that browsers wait for
  changed = changed.then(() => change(instrument)); // in the order of the choices
}

async function change(instrument) {
  try {
    const next = await ContactSpline.create(context, instrument, { report, isLimited: true });
    node?.close();
    node = next;
    node.connect(context.destination);
    byId("error").textContent = "";
    showKeys();
    showParameters();
  } catch (error) {
    byId("error").textContent = error.message;
  }
}

function report({ force, energy }) {
  byId("force").textContent = `${Math.max(...force).toPrecision(3)} N`;
  byId("energy").textContent = `${energy.toExponential(2)} J`;
}

/** An octave from middle C, or the keys that there are, or one button for each event. */
function showKeys() {  const { keys, ranges, events } = node.description;
  const all = (ranges.length > 0 ? ranges : keys ? [keys] : []).flatMap(([first, last]) => Array.from({ length: last - first + 1 }, (_, i) => first + i));
  const from = Math.max(0, Math.min(all.indexOf(60), all.length - 13));
  const shown = all.slice(from, from + 13);
  const names = keys ? shown.map((key) => "C C# D D# E F F# G G# A A# B".split(" ")[key % 12]) : events.map(({ label }) => label);
  byId("keys").replaceChildren(
    ...names.map((name, i) => {
      const button = Object.assign(document.createElement("button"), { textContent: name });
      button.addEventListener("pointerdown", () => (keys ? node.noteOn(shown[i], 0.7) : node.strike(events[i].name)));
      for (const end of ["pointerup", "pointerleave"]) button.addEventListener(end, () => keys && node.noteOff(shown[i]));
      return button;
    }),
  );
}

/** A slider for each parameter, which moves its AudioParam. */
function showParameters() {
  byId("parameters").dataset.instrument = node.description.name;
  byId("parameters").replaceChildren(
    ...node.description.parameters.map(({ name, label, min, max, init, unit, factor }) => {
      const slider = Object.assign(document.createElement("input"), { type: "range", min, max, step: "any", value: init });
      const row = document.createElement("label");
      const show = () => (row.firstChild.textContent = `${label}: ${Number((factor * slider.value).toPrecision(3))} ${unit}`);
      slider.addEventListener("input", () => {
        node.parameters.get(name).setTargetAtTime(Number(slider.value), context.currentTime, 0.02);
        show();
      });
      row.append("", slider);
      row.prepend(document.createElement("span"));
      show();
      return row;
    }),
  );
}

byId("instrument").append(...(await instruments()).map(({ name, title }) => new Option(title, name, name === "piano", name === "piano")));
byId("start").addEventListener("click", () => play(byId("instrument").value));
byId("instrument").addEventListener("change", () => play(byId("instrument").value));
byId("text").value = (await loadGenerator()).instruments().tanpura;
byId("play-text").addEventListener("click", () => play({ text: byId("text").value }));
