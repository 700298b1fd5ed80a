// SPDX-License-Identifier: MIT
// Sliders and lists with a label and their value.

const kSteps = 1000;

const kRaised = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** A number as people read it: at most four digits, or as 4.5 × 10⁹. */
export function readable(value) {
  const size = Math.abs(value);
  if (value === 0) return "0";
  if (size < 1e5 && size >= 1e-3) return String(Number(value.toPrecision(4)));
  const [digits, power] = value.toExponential(2).split("e");
  const raised = String(Math.abs(power)).replace(/\d/g, (digit) => kRaised[digit]);
  return `${Number(digits)} × 10${power < 0 ? "⁻" : ""}${raised}`;
}

/** Hands every file that a user chooses to take(file, all that were chosen), the same one again, too. */
export function whenChosen(input, take) {
  input.addEventListener("change", () => {
    const files = [...input.files];
    input.value = "";
    if (files.length > 0) take(files[0], files);
  });
}

/** A slider for { label, unit, min, max, step, init, isLogarithmic }; change(value) on every move. Values are shown `factor`
 * times as large, in their unit. */
export function slider({ label, unit = "", factor = 1, min, max, step = (max - min) / kSteps, init, isLogarithmic }, change) {
  const box = document.createElement("label");
  box.className = "control";
  const name = document.createElement("span");
  const shown = document.createElement("output");
  const text = shown.appendChild(new Text()); // a text that changes costs less than a new one
  const input = document.createElement("input");
  input.type = "range";
  name.textContent = label;
  const logarithmic = isLogarithmic && min > 0;
  Object.assign(input, logarithmic ? { min: 0, max: kSteps, step: 1 } : { min, max, step });
  input.setAttribute("aria-label", unit ? `${label} [${unit}]` : label);
  const valueOf = () => {
    if (!logarithmic) return Number(Number(input.value).toPrecision(6));
    const value = min * (max / min) ** (input.value / kSteps);
    return Number(value.toPrecision(3));
  };
  let value = init;
  const show = () => {
    text.data = `${readable(factor * value)} ${unit}`.trim();
    input.setAttribute("aria-valuetext", text.data);
  };
  const set = (to) => {
    value = Math.max(min, Math.min(max, to));
    input.value = logarithmic ? (kSteps * Math.log(value / min)) / Math.log(max / min) : value;
    show();
  };
  input.addEventListener("input", () => {
    value = valueOf();
    show();
    change(value);
  });
  // 0 to 1 along its way, as a controller of MIDI moves it.
  const part = (to) => {
    input.value = Number(input.min) + to * (input.max - input.min);
    input.dispatchEvent(new Event("input"));
  };
  set(init);
  box.append(name, shown, input);
  return { box, set, get: () => value, part, label, init };
}

/** A list for { label, choices: { value: text } }. */
export function choice({ label, choices, init }, change) {
  const box = document.createElement("label");
  box.className = "control";
  const name = document.createElement("span");
  name.textContent = label;
  const select = document.createElement("select");
  fillSelect(select, choices);
  select.value = init;
  select.addEventListener("change", () => change(select.value));
  box.append(name, select);
  return { box, set: (value) => (select.value = value), get: () => select.value, label, init };
}

export function fillSelect(select, choices) {
  select.replaceChildren(...Object.entries(choices).map(([value, text]) => new Option(text, value)));
}
