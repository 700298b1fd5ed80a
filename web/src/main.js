// SPDX-License-Identifier: MIT
// The page: puts instrument, figures, editor, comparison and tour together.
import { asset, jsonAsset } from "./assets.js";
import { Audio, instrumentMessage, kSampleRate, renderOffline } from "./audio.js";
import { Comparison } from "./compare.js";
import { fillSelect, readable, slider } from "./controls.js";
import { Editor } from "./editor.js";
import { startEngine } from "./engine.js";
import { controlsOf } from "./faust_program.js";
import { startGenerator } from "./generator.js";
import { kInstruments, kKeyboardControls } from "./instruments.js";
import { Keys, keyName } from "./keys.js";
import { Figures } from "./figures.js";
import { redrawPlots } from "./plots.js";
import { kPresets } from "./presets.js";
import { Stage } from "./stage.js";
import { addressOf, stateOf } from "./state.js";
import { Tour } from "./tour.js";

const kStudyFrames = 530; // 12 ms
const kStudyKey = 60;
const [kFirstKey, kLastKey] = [21, 108]; // of the piano, whose strings the keyboard has

const byId = (id) => document.getElementById(id);
const compile = async (name) => WebAssembly.compile(await asset(name));

class Page {
  constructor() {
    this.instrument = "keyboard";
    this.controls = new Map();
    this.figures = new Figures();
    this.audio = new Audio((report) => this.figures.report(report));
    this.stage = new Stage(byId("stage"), { play: byId("stage-play"), time: byId("stage-time"), speed: byId("stage-speed") });
    this.keys = new Keys(byId("keys"), {
      strike: (key, velocity) => this.strike(key, velocity),
      release: (key) => this.audio.send({ do: "release", key }),
      pedal: (down) => this.setPedal(down),
    });
    this.connectButtons();
  }

  connectButtons() {
    fillSelect(byId("instrument"), Object.fromEntries(Object.entries(kInstruments).map(([name, { title, by }]) => [name, `${title} (${by})`])));
    fillSelect(byId("preset"), { "": "choose …", ...Object.fromEntries(Object.keys(kPresets).map((title) => [title, title])) });
    byId("instrument").addEventListener("change", ({ target }) => this.play(target.value, {}));
    byId("preset").addEventListener("change", ({ target }) => target.value && this.show(kPresets[target.value]));
    byId("octave-down").addEventListener("click", () => this.keys.shift(-1));
    byId("octave-up").addEventListener("click", () => this.keys.shift(1));
    byId("pedal").addEventListener("change", ({ target }) => this.setPedal(target.checked));
    byId("strike").addEventListener("click", () => this.strikeOnce());
    byId("share").addEventListener("click", () => this.copyLink());
    byId("theme").addEventListener("click", () => this.setTheme(document.documentElement.dataset.theme !== "dark"));
    this.setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
  }

  setTheme(isDark) {
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    byId("theme").setAttribute("aria-pressed", String(isDark));
    redrawPlots();
    this.stage.draw();
  }

  /** Loads what sounds and what is drawn; the rest follows when the page has been seen. */
  async load() {
    const [engine, generator] = await Promise.all([compile("engine"), compile("generator")]);
    this.studio = startEngine(engine, kSampleRate);
    this.reference = startEngine(engine, kSampleRate);
    this.editor = new Editor(startGenerator(generator), (design) => this.useDesign(design));
    this.editor.load({ name: "felt_c4" });
    this.reference.useMaterial(this.editor.current);
    await this.show(stateOf(location.hash));
    this.comparison = new Comparison(this.reference, kSampleRate, (samples) => this.audio.play(samples));
    await this.comparison.load();
    this.tour = new Tour({
      show: (state) => this.show(state),
      strike: () => this.strikeOnce(),
      compare: (ratio) => this.comparison.setStiffness(ratio),
    });
    addEventListener("hashchange", () => this.show(stateOf(location.hash)));
  }

  /** Sets the page to a state: { instrument, material, controls }. */
  async show({ instrument, material, controls }) {
    if (material) this.editor.load(material);
    await this.play(kInstruments[instrument] ? instrument : "keyboard", controls);
  }

  /** Changes the instrument; controls: { label: value } of those that differ from the initial ones. */
  async play(name, values) {
    this.instrument = name;
    byId("instrument").value = name;
    const isKeyboard = name === "keyboard";
    const shapes = isKeyboard
      ? kKeyboardControls
      : controlsOf(await jsonAsset(`${name}-json`)).filter(({ type, label }) => type === "hslider" && !["freq", "gain", "sustain pedal"].includes(label));
    this.controls = new Map(shapes.map((shape) => [shape.label, slider(shape, () => this.controlMoved(shape.label))]));
    byId("controls").replaceChildren(...[...this.controls.values()].map(({ box }) => box));
    this.audio.send(await instrumentMessage(name));
    for (const [label, value] of Object.entries(values ?? {})) this.controls.get(label)?.set(value);
    for (const label of this.controls.keys()) this.sendControl(label);
    byId("stage-figure").hidden = !["keyboard", "mass_barrier"].includes(name);
    const { button } = kInstruments[name];
    byId("strike").textContent = button ? button[0].toUpperCase() + button.slice(1) : "Strike";
    for (const id of ["keys", "octave-down", "octave-up"]) byId(id).hidden = button !== undefined;
    this.figures.reset(isKeyboard);
    this.study(kStudyKey);
  }

  controlMoved(label) {
    this.sendControl(label);
    clearTimeout(this.studying);
    this.studying = setTimeout(() => this.study(this.lastKey ?? kStudyKey), 60);
  }

  value(label) {
    return this.controls.get(label)?.get();
  }

  sendControl(label) {
    if (this.instrument !== "keyboard") return this.audio.send({ do: "set", label, value: this.value(label) });
    const controls = {
      stiffness: this.value("stiffness ratio"),
      mass: this.value("mass ratio"),
      loss: this.editor.current.loss_s_per_m,
      position: this.value("strike position"),
    };
    this.studio.control(controls);
    this.audio.send({ do: "control", controls });
  }

  useDesign(design) {
    const { table, mass_kg, loss_s_per_m } = design;
    if (!this.studio.useMaterial(design)) {
      byId("design-note").append(" The keyboard plays up to 128 segments, and keeps the last material.");
      return;
    }
    this.audio.send({ do: "material", design: { table, mass_kg, loss_s_per_m } });
    if (this.instrument === "keyboard" && this.controls.size > 0) this.controlMoved("speed");
  }

  // The slow motion of a strike of this key with the controls of now.
  study(key) {
    if (this.instrument === "keyboard") {
      const study = this.studio.studyString(key, this.value("speed"), kStudyFrames);
      this.stage.show(study, "string", this.value("strike position"));
      this.caption(study, `${keyName(key)} struck from rest`);
    } else if (this.instrument === "mass_barrier") {
      this.reference.control({ stiffness: this.value("stiffness ratio"), mass: 1, loss: this.value("loss"), position: 0.12 });
      const study = this.reference.studyBarrier(this.value("mass"), this.value("speed"), kStudyFrames);
      this.stage.show(study, "barrier", 0.5);
      this.caption(study, "the mass without gravity,");
    }
  }

  caption({ imbalance, hammer }, name) {
    const worst = imbalance.reduce((max, value) => Math.max(max, Math.abs(value)), 0) / hammer[0];
    byId("stage-caption").textContent =
      `Slow motion: ${name} at ${readable(this.value("speed"))} m/s. Energy balanced within ${readable(worst)}.`;
  }

  async strike(key, velocity) {
    if (key < kFirstKey || key > kLastKey) return;
    await this.startSound();
    // A soft key of MIDI strikes at a tenth of the speed of the slider, the hardest at its double.
    const speed = this.value("speed") * (velocity === null ? 1 : 0.1 * 20 ** velocity);
    this.audio.send({ do: "strike", key, velocity: velocity ?? 0.7, speed });
    this.lastKey = key;
    this.figures.struck();
    if (this.instrument === "keyboard" || this.instrument === "mass_barrier") setTimeout(() => this.study(key), 0);
  }

  strikeOnce() {
    const key = this.lastKey ?? kStudyKey;
    this.strike(key, null);
    setTimeout(() => this.audio.send({ do: "release", key }), 1500);
  }

  async startSound() {
    const first = !this.audio.starting;
    await this.audio.start();
    if (first) byId("midi").textContent = await this.keys.listenToMidi();
  }

  setPedal(down) {
    byId("pedal").checked = down;
    this.audio.send({ do: "pedal", down });
  }

  /** The state in a link: what differs from the initial controls. */
  state() {
    const controls = {};
    for (const [label, control] of this.controls) if (control.get() !== control.init) controls[label] = control.get();
    return { instrument: this.instrument, material: this.editor.state(), controls };
  }

  async copyLink() {
    const address = addressOf(this.state());
    history.replaceState(null, "", address);
    try {
      await navigator.clipboard.writeText(location.href);
      byId("share").textContent = "Link copied";
    } catch {
      byId("share").textContent = "Link in the address bar";
    }
    setTimeout(() => (byId("share").textContent = "Copy link"), 2500);
  }

  run() {
    const frame = (now) => {
      this.stage.frame(now / 1000);
      this.figures.draw(this.audio.analyser, now / 1000);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }
}

const page = new Page();
// For tests, and for the curious at the console.
globalThis.contactSpline = { page, presets: kPresets, renderOffline, instrumentMessage, loaded: page.load().then(() => page.run()) };
contactSpline.loaded.catch((error) => {
  byId("stage-caption").textContent = `This browser cannot play the page: ${error.message}`;
});
