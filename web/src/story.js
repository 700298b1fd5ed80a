// SPDX-License-Identifier: MIT
// The story: chapters to scroll, each with one idea, one live figure and one control.
import { readable, slider } from "./controls.js";
import { kForces, kPlaces } from "./bowed_string.js";
import { kMotions, Schelleng } from "./schelleng.js";
import { linePlot } from "./plots.js";
import { Stage, strongest, toldOf } from "./stage.js";
import { kHard, kSoft } from "./story_numbers.js";
import { studyOf } from "./studies.js";

export const kChapters = 9;

const kMiddleC = 60;
const kNoKey = -1; // plays an event of a file at the pitch of the file
const kHeight = 280; // pixels of a plot
const kEnergyHeight = 200;
const kThinned = 4; // frames for a point of energy
const kSlowed = 1000; // times, in all scenes
const kSoftBlow = 0.5, kHardBlow = 4; // [m/s] of the gong's beater
const kBow = { force: 0.3, speed: 0.1, place: 0.12 }; // at first: Helmholtz' motion
const kViolinString = 0.337, kViolinBridge = 0.325; // [m] of the violin that one hears
const kD4 = 62; // its key
const kMargin = "300px"; // figures are made before they are in view

/** A number as people read it, with so many digits. */
const rounded = (value, digits) => readable(Number(value.toPrecision(digits)));

// The plot of a chapter.
const plotOf = (article, x, y, lines, range) => linePlot(article.querySelector("figure > .plot"), { x, y, height: kHeight, lines, range });

// The line that says what a figure shows, at the end of a chapter.
function noteOf(article) {
  const note = Object.assign(document.createElement("p"), { className: "note" });
  note.append(""); // a text that changes costs less than a new one
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
  /** answered: when the last figure that was asked for is shown. background: computes all numbers (worker.js). instruments: what engine.cpp says of each, by name. stiffness: the slider of the
   * comparison. hear(state, velocity, key) sets the page and strikes; piece() plays one; at(chapter) is told of the chapter in
   * view, 0 before the first. moves(): something begins to move, frame() is to be called. */
  constructor({ background, instruments, stiffness, hear, piece, at, moves }) {
    Object.assign(this, { background, instruments, stiffness, hear, at, moves, chapter: 0, stages: new Map(), made: new Set() });
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
    const makers = ["collision", "blows", "spline", "step", "balance", "contacts", "piano", "gong", "bow"];
    this[makers[this.chapters.indexOf(article)]](article);
  }

  /** Draws what moves; call on every frame of the screen. Returns whether it goes on. */
  frame(now) {
    return [...this.inView].map((article) => this.stages.get(article)?.frame(now)).some(Boolean);
  }

  draw() {
    for (const stage of this.stages.values()) stage.draw();
    this.diagram?.draw();
  }

  // The one control of a chapter, and the line that says what the figure shows. change(answer) shows what the background answers
  // to a task with the control's value, and returns that line.
  control(article, shape, task, change) {
    const ask = (value) => {
      this.answered = this.background.latest(task, task, value).then((answer) => answer && (note.firstChild.data = change(answer)));
    };
    const control = slider(shape, ask);
    article.querySelector(".live").append(control.box);
    const note = noteOf(article);
    dragMoves(article.querySelector("figure > .plot"), control);
    ask(shape.init);
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
    this.control(article, { label: "exponent a", min: 1, max: 4, step: 0.05, init: 2.5 }, "blows", ({ told, data }) => {
      plot.set(data);
      const [soft, hard] = told.map(({ duration, force }) => `${rounded(1000 * duration, 3)} ms, at most ${rounded(force, 3)} N`);
      return `Soft: ${soft}. Hard: ${hard}.`;
    });
  }

  spline(article) {
    const plot = plotOf(article, "compression [mm]", "force [N]", [
      { label: "law", colour: "orange", width: 5 },
      { label: "spline", colour: "blue", width: 2 },
      { label: "knots", colour: "ink", isPoints: true, size: 9 },
    ]);
    this.control(article, { label: "pieces", min: 1, max: 20, step: 1, init: 2 }, "spline", ({ error, data }) => {
      plot.set(data);
      return `The spline is within ${rounded(100 * error, 2)} % of the largest force.`;
    });
  }

  step(article) {
    const plot = plotOf(article, "compression at the end of the sample [mm]", "force [N]", [
      { label: "felt: mean force on the way there", colour: "orange", width: 3 },
      { label: "hammer: how far it gets", colour: "blue", width: 3 },
      { label: "solution of the contact step", colour: "ink", isPoints: true, size: 12 },
    ]);
    this.control(article, { label: "stiffness ratio", min: 1, max: 3000, init: 300, isLogarithmic: true }, "step", ({ before, end, free, force, mean, data }) => {
      plot.set(data);
      this.solved = { mean, force };
      const millimetres = (y) => `${rounded(1000 * y, 4)} mm`;
      return (
        `The sample begins at ${millimetres(before)}. Without force the hammer would get to ${millimetres(free)}, ` +
        `with ${rounded(force, 4)} N it gets to ${millimetres(end)}.`
      );
    });
  }

  balance(article) {
    const plot = plotOf(article, "time [ms]", "energy [% of the throw]", [
      { label: "contact step", colour: "blue", width: 3 },
      { label: "fd.hammer", colour: "orange", dash: [6, 3], width: 3 },
    ], (_, low, high) => [0, Math.max(150, Math.min(250, high ?? 0))]);
    this.control(article, { label: "stiffness ratio", min: 1, max: 1000, init: 300, isLogarithmic: true }, "energies", ({ work, within, end, data }) => {
      plot.set(data);
      const other = end < 2.5 ? `${rounded(100 * end, 3)} % of it at the end` : "more and more, from nothing";
      return `Thrown: ${rounded(1000 * work, 3)} mJ. Contact step: the same all along, within ${rounded(within, 2)} of it. fd.hammer: ${other}.`;
    });
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
      const at = Array.from({ length: Math.ceil(frames / kThinned) }, (_, i) => kThinned * i);
      const parts = scene.books.map(([, number]) => {
        const energies = column(number);
        return at.map((i) => (100 * energies[i]) / scene.work);
      });
      const all = at.map((_, i) => parts.reduce((sum, part) => sum + part[i], 0));
      plot.set([at.map((i) => (1000 * i) / sampleRate), all, ...parts]);
    };
    this.scene(article, { instrument: "tanpura", parameter: "bridge_gap_shift_m", least: 0, label: "The string of a tanpura over its bridge", drawn }); // higher, it would bend the string
  }

  piano(article) {
    this.scene(article, { instrument: "piano", parameter: "stiffness_ratio", label: "A hammer of the piano, its string and the board" });
  }

  gong(article) {
    const plot = plotOf(article, "frequency [Hz]", "level over the largest [dB]", [
      { label: `softly, ${kSoftBlow} m/s`, colour: "blue", width: 2 },
      { label: "as it is struck", colour: "orange", width: 2 },
    ], () => [-80, 5]);
    const { parameters, packed } = this.instruments.get("gong");
    const isSpeed = parameters.map(({ name }) => name === "beater_speed_m_per_s");
    const told = noteOf(article);
    const compare = (speed) => {
      const given = { bytes: packed(), values: parameters.map(({ init }, p) => (isSpeed[p] ? null : init)), speeds: [kSoftBlow, speed] };
      this.compared = this.background.latest("gong spectra", "gong", given).then((answer) => {
        if (!answer) return;
        plot.set(answer.data);
        this.glides = answer.told;
        const [soft, hard] = answer.told.map(({ begins, later }) => `${rounded(begins, 3)} Hz at the blow, ${rounded(later, 3)} Hz a third of a second later`);
        told.firstChild.data = `Lowest partial, softly: ${soft}. At ${rounded(speed, 2)} m/s: ${hard}.`;
      });
    };
    const drawn = ({ values }) => compare(values[isSpeed.indexOf(true)]);
    const blows = [["Strike softly", kSoftBlow], ["Strike hard", kHardBlow]];
    this.scene(article, { instrument: "gong", parameter: "beater_speed_m_per_s", least: 0.2, most: 5, label: "A gong and its beater", drawn, blows });
    article.querySelector(".live").append(told);
  }

  // A bow at a place, with a force and a speed, on the stage and in Schelleng's diagram of its speed.
  bow(article) {
    const live = article.querySelector(".live");
    const bow = { ...kBow };
    const { stage, row } = this.stageIn(article, "A string and its bow", {});
    const hear = Object.assign(document.createElement("button"), { textContent: "Hear it", className: "primary" });
    row.append(hear);
    hear.addEventListener("click", () => {
      const controls = { bow_normal_force_n: bow.force, bow_surface_speed_m_per_s: bow.speed, bow_place_m: kViolinBridge - bow.place * kViolinBridge };
      this.hear({ instrument: "violin", material: { name: "felt_c4" }, controls }, null, kD4);
    });
    const columns = [];
    const diagram = new Schelleng(article.querySelector("canvas.diagram"), ({ place, force }) => {
      for (const [name, value] of Object.entries({ place, force })) controls[name].set(value);
      Object.assign(bow, { place, force });
      ask();
    });
    this.diagram = diagram;
    const shapes = {
      force: { label: "force of the bow [N]", min: kForces[0], max: kForces.at(-1), init: bow.force, isLogarithmic: true },
      place: { label: "distance from the bridge, over the length", min: kPlaces[0], max: kPlaces.at(-1), init: bow.place, isLogarithmic: true },
      speed: { label: "speed of the bow [m/s]", min: 0.03, max: 0.6, init: bow.speed, isLogarithmic: true },
    };
    const controls = Object.fromEntries(Object.entries(shapes).map(([name, shape]) => [name, slider(shape, (value) => {
      bow[name] = value;
      stage.giveWay();
      ask();
      if (name === "speed") fill();
    })]));
    live.append(...["speed", "force", "place"].map((name) => controls[name].box));
    const note = noteOf(article);
    const ask = () => {
      diagram.show(columns, bow);
      this.answered = this.background.latest("bow", "bow", { ...bow }).then((played) => {
        if (!played) return;
        stage.show(studyOf(played));
        this.bowed = played.motion;
        note.firstChild.data = `At ${rounded(bow.speed, 2)} m/s, ${rounded(bow.force, 2)} N and ${rounded(bow.place, 2)} of the length from the bridge: ${kMotions[played.motion].told}.`;
      });
    };
    const fill = () => this.fillDiagram(bow, columns);
    stage.wake();
    ask();
    fill();
  }

  // Schelleng's diagram at the speed of now, one column after the other; another speed begins anew.
  async fillDiagram(bow, columns) {
    const { speed } = bow;
    const number = (this.fillings = (this.fillings ?? 0) + 1);
    columns.length = 0;
    for (const place of kPlaces) {
      const column = await this.background.latest("bow column", "bowColumn", { speed, place });
      if (!column || number !== this.fillings) return;
      columns.push(column);
      this.diagram.show(columns, bow);
    }
    this.filled = speed;
  }

  // How long a note is, its largest force, and how well its energy balances.
  toldOfScene(stage, { scene, column }) {
    const told = `${rounded(1000 * stage.length(), 3)} ms, ${kSlowed} times slower; at most ${rounded(Math.max(...stage.forces), 3)} N.`;
    if (scene.imbalance === undefined || !(scene.work > 0)) return told;
    const worst = column(scene.imbalance).reduce((max, x) => Math.max(max, Math.abs(x)), 0);
    return `${told} Energy balances within ${rounded(worst / scene.work, 2)} of the total.`;
  }

  // A stage at the top of a chapter, with a row below it. does: as Stage has it.
  stageIn(article, label, does) {
    const live = article.querySelector(".live");
    const make = (tag, set) => Object.assign(document.createElement(tag), set);
    const canvas = make("canvas", { className: "stage" });
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", label);
    const play = make("button", { className: "stage-play", textContent: "Pause" });
    const time = make("input", { className: "stage-time", type: "range", min: 0, max: 1, step: 0.001, value: 0 });
    time.setAttribute("aria-label", `Time: ${label}`);
    const figure = make("figure", { className: "stage-figure" });
    figure.append(canvas, time, play);
    const row = make("div", { className: "row" });
    live.prepend(figure, row);
    const stage = new Stage(canvas, { play, time, speed: { value: kSlowed } }, { ...does, moves: this.moves });
    this.stages.set(article, stage);
    return { stage, row };
  }

  // A stage of an instrument with one of its parameters, from `least` to `most`. What is thrown or pulled there is heard, too, and
  // each of the blows [label, value of the parameter]. drawn(study): of each new note.
  scene(article, { instrument, parameter, least, most, label, drawn = () => {}, blows = [["Hear it", null]] }) {
    const live = article.querySelector(".live");
    const { parameters, ranges, velocity } = this.instruments.get(instrument);
    const values = parameters.map(({ init }) => init);
    const state = { power: null };
    const { stage, row } = this.stageIn(article, label, {
      thrown: ({ power, place }) => {
        const { throws, moves } = stage.study.scene;
        if (place !== null && moves !== null) values[moves] = place;
        if (power !== null && throws !== null) values[throws] = power * strongest(parameters[throws]);
        if (power !== null && throws === null) state.power = power;
        if (throws === number) control.set(values[number]);
        study();
        sound();
      },
      tell: (power, place) => toldOf(stage.study.scene, parameters, power, place),
      energyOf: (power) => {
        const { throws } = stage.study.scene;
        return throws === null || !values[throws] ? null : ((power * strongest(parameters[throws])) / values[throws]) ** 2;
      },
    });
    stage.wake();
    const study = () => {
      const note = { key: ranges.length > 0 ? kNoKey : kMiddleC, velocity: state.power ?? velocity, event: 0 };
      const played = this.background.latest(instrument, "scene", { instrument, bytes: this.instruments.get(instrument).packed(), values: [...values], note });
      this.answered = played.then((played) => played && show(studyOf(played)));
    };
    const show = (played) => {
      stage.show(played);
      drawn({ ...played, values });
      note.firstChild.data = this.toldOfScene(stage, played);
    };
    const sound = () => {
      const changed = parameters.map(({ name }, p) => [name, values[p]]).filter(([, value], p) => value !== parameters[p].init);
      const controls = Object.fromEntries(changed);
      this.hear({ instrument, material: { name: "felt_c4" }, controls }, state.power);
    };
    for (const [text, value] of blows) {
      const button = Object.assign(document.createElement("button"), { textContent: text, className: value === blows[0][1] ? "primary" : "" });
      button.addEventListener("click", () => {
        if (value !== null) control.set(values[number] = value);
        if (value !== null) study();
        sound();
      });
      row.append(button);
    }
    const number = parameters.findIndex(({ name }) => name === parameter);
    const { min, max } = parameters[number];
    const control = slider({ ...parameters[number], min: least ?? min, max: most ?? max }, (value) => {
      values[number] = value;
      stage.giveWay();
      study();
    });
    live.append(control.box);
    const note = noteOf(article);
    study();
  }
}
