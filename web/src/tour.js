// SPDX-License-Identifier: MIT
// The tour: six steps for a lecture, each with a state of the page and a place to look at.

const kSteps = [
  {
    title: "1. A contact",
    text: "A hammer of 3 g meets a string. The felt is pressed together for two thousandths of a second, pushes back, and the hammer leaves. Watch it a thousand times slower: the force is never negative, and exactly 0 while they are apart.",
    look: "stage-figure",
    state: { instrument: "hammer_on_string", material: { name: "felt_c4" }, controls: { speed_m_per_s: 2.5 } },
    strike: true,
  },
  {
    title: "2. The power law",
    text: "Felt grows stiffer the more it is pressed: F = k y^a, with a near 2.5. Move the exponent: at 1 the felt is a spring, at 3 it is soft for soft blows and hard for hard ones.",
    look: "editor",
    state: { instrument: "hammer_on_string", material: { name: "felt_c4" }, controls: {} },
  },
  {
    title: "3. The spline",
    text: "Here the potential of the contact is made of five pieces, each a parabola, so the force is a line in each. Raise the number of segments and watch the error fall.",
    look: "editor",
    state: {
      instrument: "hammer_on_string",
      material: {
        text: '{\n  "name": "five_pieces",\n  "contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },\n  "impact": { "mass_kg": 0.00297, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },\n  "spline": { "knots": "uniform", "segments": 5 }\n}\n',
      },
      controls: {},
    },
  },
  {
    title: "4. The step",
    text: "In each piece the force of this sample is the root of a quadratic, found in closed form: no iteration, at any stiffness. A scheme that takes the force of the last sample fails as the stiffness rises: move the slider and play both.",
    look: "compare",
    compare: 200,
  },
  {
    title: "5. Energy",
    text: "Hammer, felt, string and what was lost: the sum stays what the throw put in, to rounding. That is why the model is stable at any stiffness. Strike and watch the flat line.",
    look: "figures",
    state: { instrument: "hammer_on_string", material: { name: "felt_c4" }, controls: { speed_m_per_s: 4 } },
    strike: true,
  },
  {
    title: "6. The piano",
    text: "88 keys: their hammers, some 230 strings, dampers and pedals, and one soundboard that all strings drive and hear. Hold Sustain and play.",
    look: "play",
    state: { instrument: "piano", material: { name: "felt_c4" }, controls: {} },
  },
];

const byId = (id) => document.getElementById(id);

export class Tour {
  /** show(state) sets the page; strike() strikes if sound may play; compare(ratio) sets the stiffness of the comparison;
   * change() after each step. */
  constructor({ show, strike, compare, change }) {
    Object.assign(this, { show, strike, compare, change, step: 0 });
    byId("tour-start").addEventListener("click", () => this.go(0));
    byId("tour-next").addEventListener("click", () => this.go(this.step + 1));
    byId("tour-back").addEventListener("click", () => this.go(this.step - 1));
    byId("tour-end").addEventListener("click", () => this.end());
    addEventListener("keydown", ({ key }) => key === "Escape" && this.isOpen() && this.end());
  }

  isOpen() {
    return !byId("tour").hidden;
  }

  /** Shows a step with its state of the page; `restored`: the page has its state from a link already. */
  async go(step, restored = false) {
    if (step >= kSteps.length) return this.end();
    this.step = Math.max(0, step);
    const { title, text, look, state, strike, compare } = kSteps[this.step];
    byId("tour").hidden = false;
    byId("tour-title").textContent = title;
    byId("tour-text").textContent = text;
    byId("tour-back").disabled = this.step === 0;
    byId("tour-next").textContent = this.step === kSteps.length - 1 ? "End" : "Next";
    if (state && !restored) await this.show(state);
    if (compare && !restored) this.compare(compare);
    this.highlight(byId(look));
    if (strike && !restored) this.strike();
    this.change();
  }

  highlight(element) {
    document.querySelectorAll(".highlight").forEach((other) => other.classList.remove("highlight"));
    if (!element) return;
    element.classList.add("highlight");
    const top = element.getBoundingClientRect().top + scrollY - byId("tour").offsetHeight - 24;
    scrollTo({ top });
  }

  end() {
    byId("tour").hidden = true;
    this.highlight(null);
    byId("tour-start").focus();
    this.change();
  }
}
