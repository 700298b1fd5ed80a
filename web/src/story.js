// SPDX-License-Identifier: MIT
// The story: chapters to scroll, each with one idea, one live figure and one control.
import { readable, slider } from "./controls.js";
import { withKnots } from "./material.js";
import { linePlot } from "./plots.js";
import { Stage, strongest, toldOf } from "./stage.js";

export const kChapters = 7;

const kMass = 0.00297; // [kg] of the hammer C4
const kHalf = 5e-4; // [m] compression at which the force stays when the exponent changes
const kForceAtHalf = 4.5e9 * kHalf ** 2.5; // [N] of felt_c4
const kSoft = 0.5, kHard = 4; // [m/s]
const kMiddleC = 60;
const kCurve = 80; // points of a curve
const kHeight = 280; // pixels of a plot
const kEnergyHeight = 200;
const kSlowed = 1000; // times, in all scenes
const kMargin = "300px"; // figures are made before they are in view

/** A number as people read it, with so many digits. */
const rounded = (value, digits) => readable(Number(value.toPrecision(digits)));

/** The file of a felt that has this exponent, and so many uniform pieces. */
function felt(exponent, segments) {
  return JSON.stringify({
    name: "felt",
    contact: { stiffness_n_per_m_alpha: kForceAtHalf / kHalf ** exponent, exponent },
    impact: { mass_kg: kMass, max_speed_m_per_s: 6, min_speed_m_per_s: 0.1 },
    spline: { knots: "uniform", segments },
  });
}

/** The energy of a table's spline at a compression; a row: knot, energy, force, half curvature. */
function energyAt(table, y) {
  if (y <= table[0][0]) return 0;
  const [knot, energy, force, curvature] = table.findLast(([begin]) => begin <= y);
  const d = y - knot;
  return energy + d * (force + d * curvature);
}

// The plot of a chapter.
const plotOf = (article, x, y, lines) => linePlot(article.querySelector("figure > .plot"), { x, y, height: kHeight, lines });

// The line that says what a figure shows, at the end of a chapter.
function noteOf(article) {
  const note = Object.assign(document.createElement("p"), { className: "note" });
  note.setAttribute("role", "status");
  article.querySelector(".live").append(note);
  return note;
}

// Dragging to the left or right on a figure moves its slider.
function dragMoves(element, control) {
  const input = control.box.querySelector("input");
  let from = null;
  element.classList.add("drags");
  element.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button")) return;
    from = { x: event.clientX, part: (input.value - input.min) / (input.max - input.min) };
    element.setPointerCapture(event.pointerId);
  });
  element.addEventListener("pointermove", ({ clientX }) => {
    if (from) control.part(Math.max(0, Math.min(1, from.part + (clientX - from.x) / element.clientWidth)));
  });
  for (const end of ["pointerup", "pointercancel"]) element.addEventListener(end, () => (from = null));
}

export class Story {
  /** studies: of the story alone. instruments: what engine.cpp says of each, by name. stiffness: the slider of the
   * comparison. hear(state, velocity) sets the page and strikes; piece() plays one; at(chapter) is told of the chapter in
   * view, 0 before the first. */
  constructor({ studies, generator, instruments, stiffness, hear, piece, at }) {
    Object.assign(this, { studies, generator, instruments, stiffness, hear, at, chapter: 0, stages: new Map(), made: new Set() });
    this.chapters = [...document.querySelectorAll("#story .chapter")];
    document.getElementById("story-piece").addEventListener("click", piece);
    document.getElementById("story-start").addEventListener("click", () => this.go(1));
    const makeNear = (list) => list.forEach(({ target, isIntersecting }) => isIntersecting && this.make(target));
    const near = new IntersectionObserver(makeNear, { rootMargin: kMargin });
    this.inView = new Set();
    const seen = new IntersectionObserver((list) => this.see(list), { threshold: [0, 0.3, 0.6] });
    for (const chapter of this.chapters) {
      near.observe(chapter);
      seen.observe(chapter);
    }
  }

  /** Scrolls to a chapter, 1 to kChapters. */
  go(chapter) {
    const article = this.chapters[chapter - 1];
    for (const other of this.chapters.slice(0, chapter)) this.make(other); // so that nothing above grows later
    article.scrollIntoView({ block: "start" });
    const title = article.querySelector("h3");
    title.tabIndex = -1;
    title.focus({ preventScroll: true });
  }

  // The chapter in view is the one of which most is seen.
  see(list) {
    for (const { target, intersectionRatio, isIntersecting } of list) {
      target.seen = intersectionRatio;
      if (isIntersecting) this.inView.add(target);
      else this.inView.delete(target);
    }
    const best = [...this.inView].toSorted((a, b) => b.seen - a.seen)[0];
    const chapter = best ? this.chapters.indexOf(best) + 1 : 0;
    if (chapter === this.chapter) return;
    this.chapter = chapter;
    this.at(chapter);
  }

  make(article) {
    if (this.made.has(article)) return;
    this.made.add(article);
    const makers = ["collision", "blows", "spline", "step", "energy", "contacts", "piano"];
    this[makers[this.chapters.indexOf(article)]](article);
  }

  /** Draws what moves; call on every frame of the screen. */
  frame(now) {
    for (const article of this.inView) this.stages.get(article)?.frame(now);
  }

  draw() {
    for (const stage of this.stages.values()) stage.draw();
  }

  // The one control of a chapter, and the line that says what the figure shows. change(value) returns that line.
  control(article, shape, change) {
    const control = slider(shape, (value) => (note.textContent = change(value)));
    article.querySelector(".live").append(control.box);
    const note = noteOf(article);
    dragMoves(article.querySelector("figure > .plot"), control);
    note.textContent = change(shape.init);
  }

  /** A mass thrown at felt: compressions [m] and forces [N] of all samples, and the design of the felt. */
  blow(text, speed, ratio = 1) {
    const design = this.generator.design(text, "felt.json");
    this.studies.useMaterial(design);
    const { parameters } = this.instruments.get("mass_barrier");
    const set = { mass_kg: kMass, speed_m_per_s: speed, stiffness_ratio: ratio, gravity_m_per_s2: 0, loss_s_per_m: 0, start_m: -1e-5 };
    const values = parameters.map(({ name, init }) => set[name] ?? init);
    const study = this.studies.play("mass_at_material", values, { key: kMiddleC, velocity: 1, event: 0 });
    return { design, compressions: study.column(0), forces: study.column(2), step: 1 / study.sampleRate };
  }

  // The figure is that of the comparison (compare.js).
  collision() {
    dragMoves(document.getElementById("comparison"), this.stiffness);
  }

  blows(article) {
    const plot = plotOf(article, "time [ms]", "force over its largest", [
      { label: `soft, ${kSoft} m/s`, colour: "blue", width: 3 },
      { label: `hard, ${kHard} m/s`, colour: "orange", dash: [8, 4], width: 3 },
    ]);
    this.control(article, { label: "exponent a", min: 1, max: 4, step: 0.05, init: 2.5 }, (a) => {
      const [soft, hard] = [kSoft, kHard].map((speed) => this.blow(felt(a, 40), speed));
      const lasts = ({ forces, step }) => forces.filter((force) => force > 0).length * step * 1000;
      const peak = ({ forces }) => Math.max(...forces);
      const end = Math.ceil((1.1 * Math.max(lasts(soft), lasts(hard))) / 1000 / soft.step);
      const shown = ({ forces }) => Array.from(forces.slice(0, end), (force) => force / Math.max(...forces));
      plot.set([Array.from({ length: end }, (_, i) => i * soft.step * 1000), shown(soft), shown(hard)]);
      const told = (blow) => `${rounded(lasts(blow), 3)} ms, at most ${rounded(peak(blow), 3)} N`;
      return `Soft: ${told(soft)}. Hard: ${told(hard)}.`;
    });
  }

  spline(article) {
    const plot = plotOf(article, "compression [mm]", "force [N]", [
      { label: "law", colour: "orange", width: 5 },
      { label: "spline", colour: "blue", width: 2 },
      { label: "knots", colour: "ink", isPoints: true, size: 9 },
    ]);
    this.control(article, { label: "pieces", min: 1, max: 20, step: 1, init: 2 }, (pieces) => {
      const { curve, quality, table } = this.generator.design(felt(2.5, pieces), "felt.json");
      plot.set(withKnots(curve, table));
      return `The spline is within ${rounded(100 * quality.force, 2)} % of the largest force.`;
    });
  }

  step(article) {
    const plot = plotOf(article, "compression at the end of the sample [mm]", "force [N]", [
      { label: "felt: mean force on the way there", colour: "orange", width: 3 },
      { label: "hammer: how far it gets", colour: "blue", width: 3 },
      { label: "solution of the contact step", colour: "ink", isPoints: true, size: 12 },
    ]);
    this.control(article, { label: "stiffness ratio", min: 1, max: 3000, init: 300, isLogarithmic: true }, (ratio) => {
      const { design, compressions, forces, step } = this.blow(felt(2.5, 15), 2.5, ratio);
      const n = forces.indexOf(Math.max(...forces));
      const [before, end, force] = [compressions[n - 1], compressions[n], forces[n]];
      const admittance = step ** 2 / (2 * kMass);
      const free = end + admittance * force;
      const energy = energyAt(design.table, before);
      const mean = (y) => (ratio * (energyAt(design.table, y) - energy)) / (y - before);
      // As far to both sides as the force takes from the free way.
      const reach = free - end;
      const points = Array.from({ length: kCurve }, (_, i) => end + reach * ((2 * i + 1) / kCurve - 1));
      const curves = points.map((y) => [y, mean(y), (free - y) / admittance, null]);
      const rows = [...curves, [end, null, null, force]].toSorted(([a], [b]) => a - b);
      plot.set([rows.map(([y]) => 1000 * y), ...[1, 2, 3].map((k) => rows.map((row) => row[k]))]);
      this.solved = { mean: mean(end), force };
      const millimetres = (y) => `${rounded(1000 * y, 4)} mm`;
      return (
        `The sample begins at ${millimetres(before)}. Without force the hammer would get to ${millimetres(free)}, ` +
        `with ${rounded(force, 4)} N it gets to ${millimetres(end)}.`
      );
    });
  }

  energy(article) {
    this.scene(article, { instrument: "hammer_on_string", parameter: "stiffness_ratio", label: "A hammer on a string, with its energies" });
  }

  contacts(article) {
    const plot = (this.energies = linePlot(document.getElementById("story-contacts"), {
      x: "time [ms]",
      height: kEnergyHeight,
      y: "energy [% of the pluck]",
      lines: [
        { label: "all", colour: "ink", width: 3 },
        { label: "string", colour: "blue" },
        { label: "contacts", colour: "orange", isFilled: true },
        { label: "lost", colour: "green", dash: [2, 3] },
      ],
      range: (_, low, high) => [0, Math.max(1, high ?? 0) * 1.08],
    }));
    const drawn = ({ scene, column, frames, sampleRate }) => {
      const parts = scene.books.map(([, number]) => Array.from(column(number), (energy) => (100 * energy) / scene.work));
      const all = parts[0].map((_, i) => parts.reduce((sum, part) => sum + part[i], 0));
      plot.set([Array.from({ length: frames }, (_, i) => (1000 * i) / sampleRate), all, ...parts]);
    };
    this.scene(article, { instrument: "tanpura", parameter: "bridge_gap_shift_m", label: "The string of a tanpura over its bridge", drawn });
  }

  piano(article) {
    this.scene(article, { instrument: "piano", parameter: "stiffness_ratio", label: "A hammer of the piano, its string and the board" });
  }

  // A stage of an instrument with one of its parameters. What is thrown or pulled there is heard, too.
  // drawn(study): of each new note.
  scene(article, { instrument, parameter, label, drawn = () => {} }) {
    const live = article.querySelector(".live");
    const make = (tag, set) => Object.assign(document.createElement(tag), set);
    const canvas = make("canvas", { className: "stage" });
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", label);
    const play = make("button", { textContent: "Pause" });
    const time = make("input", { type: "range", min: 0, max: 1, step: 0.001, value: 0 });
    time.setAttribute("aria-label", `Time: ${label}`);
    const hear = make("button", { textContent: "Hear it", className: "primary" });
    const row = make("div", { className: "row" });
    row.append(play, Object.assign(make("label", { className: "grow" })), hear);
    row.querySelector("label").append("Time", time);
    const figure = make("figure");
    figure.append(canvas, row);
    live.prepend(figure);

    const { parameters, velocity } = this.instruments.get(instrument);
    const values = parameters.map(({ init }) => init);
    const state = { power: null };
    const stage = new Stage(canvas, { play, time, speed: { value: kSlowed } }, {
      thrown: ({ power, place }) => {
        const { throws, moves } = stage.study.scene;
        if (place !== null && moves !== null) values[moves] = place;
        if (power !== null && throws !== null) values[throws] = power * strongest(parameters[throws]);
        if (power !== null && throws === null) state.power = power;
        study();
        sound();
      },
      tell: (power, place) => toldOf(stage.study.scene, parameters, power, place),
    });
    stage.wake();
    const study = () => {
      this.studies.useMaterial(this.shipped());
      stage.show(this.studies.play(instrument, values, { key: kMiddleC, velocity: state.power ?? velocity, event: 0 }));
      const { scene, column } = stage.study;
      drawn(stage.study);
      const peak = rounded(Math.max(...stage.forces), 3);
      const told = [`${rounded(1000 * stage.length(), 3)} ms, ${kSlowed} times slower; at most ${peak} N.`];
      if (scene.imbalance !== undefined && scene.work > 0) {
        const worst = column(scene.imbalance).reduce((max, x) => Math.max(max, Math.abs(x)), 0);
        told.push(`Energy balances within ${rounded(worst / scene.work, 2)} of the total.`);
      }
      note.textContent = told.join(" ");
    };
    const sound = () => {
      const changed = parameters.map(({ name }, p) => [name, values[p]]).filter(([, value], p) => value !== parameters[p].init);
      const controls = Object.fromEntries(changed);
      this.hear({ instrument, material: { name: "felt_c4" }, controls }, state.power);
    };
    hear.addEventListener("click", sound);
    const number = parameters.findIndex(({ name }) => name === parameter);
    let waiting = 0;
    const control = slider(parameters[number], (value) => {
      values[number] = value;
      clearTimeout(waiting);
      waiting = setTimeout(study, 60);
    });
    live.append(control.box);
    const note = noteOf(article);
    this.stages.set(article, stage);
    study();
  }

  // The felt of C4, which all scenes of the story have.
  shipped() {
    return (this.felt ??= this.generator.design(this.generator.materials().felt_c4, "felt_c4.json"));
  }
}
