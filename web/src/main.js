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
const kStrikeHold = 1500; // milliseconds that the button holds a key
const kSettled = 250; // milliseconds after the last change
const kMaxPast = 100;
const [kFirstKey, kLastKey] = [21, 108]; // of the piano, whose strings the keyboard has

const byId = (id) => document.getElementById(id);
const compile = async (name) => WebAssembly.compile(await asset(name));

class Page {
  constructor() {
    this.instrument = "keyboard";
    this.controls = new Map();
    this.releases = new Map();
    this.past = [];
    this.turn = 0;
    this.figures = new Figures();
    this.audio = new Audio((report) => this.figures.report(report));
    this.stage = new Stage(byId("stage"), { play: byId("stage-play"), time: byId("stage-time"), speed: byId("stage-speed") });
    this.keys = new Keys(byId("keys"), {
      strike: (key, velocity) => this.strike(key, velocity),
      release: (key) => this.audio.send({ do: "release", key }),
      pedal: (down) => this.setPedal(down),
      moved: () => this.changed(),
    });
    this.connectButtons();
  }

  connectButtons() {
    fillSelect(byId("instrument"), Object.fromEntries(Object.entries(kInstruments).map(([name, { title, by }]) => [name, `${title} (${by})`])));
    fillSelect(byId("preset"), { "": "choose …", ...Object.fromEntries(Object.keys(kPresets).map((title) => [title, title])) });
    byId("instrument").addEventListener("change", ({ target }) => this.play(target.value, {}));
    byId("preset").addEventListener("change", ({ target }) => target.value && this.show(kPresets[target.value]));
    byId("undo").addEventListener("click", () => this.undo());
    byId("midi-connect").addEventListener("click", async () => (byId("midi").textContent = await this.keys.listenToMidi()));
    byId("octave-down").addEventListener("click", () => this.keys.shift(-1));
    byId("octave-up").addEventListener("click", () => this.keys.shift(1));
    byId("pedal").addEventListener("change", ({ target }) => this.setPedal(target.checked));
    byId("strike").addEventListener("click", () => this.strikeOnce());
    byId("share").addEventListener("click", () => this.copyLink());
    byId("theme").addEventListener("click", () => this.chooseTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
    this.setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
  }

  chooseTheme(theme) {
    this.theme = theme;
    this.setTheme(theme === "dark");
    this.changed();
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
    this.comparison = new Comparison(this.reference, kSampleRate, (samples) => this.audio.play(samples), () => this.changed());
    this.tour = new Tour({
      show: (state) => this.show(state),
      strike: () => this.strikeOnce(),
      compare: (ratio) => this.comparison.setStiffness(ratio),
      change: () => this.changed(),
    });
    await this.comparison.load(); // a link may set its stiffness
    await this.show(stateOf(location.hash));
    this.address = addressOf(this.state());
    addEventListener("hashchange", () => this.show(stateOf(location.hash)));
  }

  /** Sets the page to a state (state.js). What is no state is left out, and one line says so. */
  async show({ instrument, material, controls, octave, key, compare, step, theme, leftOut = [] }) {
    const without = [...leftOut];
    const kept = this.editor.state();
    const error = material ? this.editor.load(material) : null;
    if (error !== null) {
      without.push(`material: ${error}`);
      this.editor.load(kept);
    }
    const isKnown = Object.hasOwn(kInstruments, instrument ?? "keyboard");
    if (!isKnown) without.push(`instrument ${instrument}`);
    const unknown = await this.play(isKnown ? (instrument ?? "keyboard") : this.instrument, controls);
    without.push(...unknown.map((label) => `control ${label}`));
    if (octave !== undefined) this.keys.goTo(12 * (octave + 1));
    if (key !== undefined) this.lastKey = key;
    if (compare !== undefined) this.comparison.setStiffness(compare);
    if (theme !== undefined) this.chooseTheme(theme);
    if (step !== undefined) await this.tour.go(step - 1, true);
    this.notice(without);
  }

  // One line, however much was left out.
  notice(without) {
    const text = `Left out of the link: ${without.join("; ")}`;
    byId("notice").textContent = text.length > 200 ? `${text.slice(0, 199)}…` : text;
    byId("notice").hidden = without.length === 0;
  }

  /** Changes the instrument; controls: { label: value } of those that differ from the initial ones. Returns the labels
   * that it lacks. */
  async play(name, values = {}) {
    const turn = ++this.turn;
    const [message, description] = await Promise.all([instrumentMessage(name), name === "keyboard" ? null : jsonAsset(`${name}-json`)]);
    if (turn !== this.turn) return []; // another one was chosen meanwhile
    this.instrument = name;
    byId("instrument").value = name;
    this.setPedal(false);
    const isKeyboard = name === "keyboard";
    const shapes = isKeyboard
      ? kKeyboardControls
      : controlsOf(description).filter(({ type, label }) => type === "hslider" && !["freq", "gain", "sustain pedal"].includes(label));
    this.controls = new Map(shapes.map((shape) => [shape.label, slider(shape, () => this.controlMoved(shape.label))]));
    byId("controls").replaceChildren(...[...this.controls.values()].map(({ box }) => box));
    this.audio.send(message);
    for (const [label, value] of Object.entries(values)) this.controls.get(label)?.set(value);
    for (const label of this.controls.keys()) this.sendControl(label);
    byId("stage-figure").hidden = !["keyboard", "mass_barrier"].includes(name);
    const { button } = kInstruments[name];
    byId("strike").textContent = button ? button[0].toUpperCase() + button.slice(1) : "Strike";
    for (const id of ["keys", "octave-down", "octave-up", "keys-note", "midi-connect", "pedal-box"]) byId(id).hidden = button !== undefined;
    this.figures.reset(isKeyboard);
    this.study(kStudyKey);
    this.changed();
    return Object.keys(values).filter((label) => !this.controls.has(label));
  }

  controlMoved(label) {
    this.sendControl(label);
    this.changed();
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
    this.changed();
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
    clearTimeout(this.releases.get(key)); // of the note before
    await this.audio.start();
    // A soft key of MIDI strikes at a tenth of the speed of the slider, the hardest at its double.
    const speed = this.value("speed") * (velocity === null ? 1 : 0.1 * 20 ** velocity);
    this.audio.send({ do: "strike", key, velocity: velocity ?? 0.7, speed });
    this.lastKey = key;
    this.changed();
    this.figures.struck();
    if (this.instrument === "keyboard" || this.instrument === "mass_barrier") setTimeout(() => this.study(key), 0);
  }

  strikeOnce() {
    const key = this.lastKey ?? kStudyKey;
    this.strike(key, null);
    this.releases.set(key, setTimeout(() => this.audio.send({ do: "release", key }), kStrikeHold));
  }

  setPedal(down) {
    byId("pedal").checked = down;
    this.audio.send({ do: "pedal", down });
  }

  /** What sounds, as presets have it: of the controls those that differ from the initial ones. */
  sound() {
    const controls = {};
    for (const [label, control] of this.controls) if (control.get() !== control.init) controls[label] = control.get();
    return { instrument: this.instrument, material: this.editor.state(), controls };
  }

  /** The state in a link. */
  state() {
    const state = { ...this.sound(), octave: this.keys.first / 12 - 1, compare: this.comparison.stiffness.get() };
    if (this.lastKey !== undefined) state.key = this.lastKey;
    if (this.tour.isOpen()) state.step = this.tour.step + 1;
    if (this.theme) state.theme = this.theme;
    return state;
  }

  /** Call after every change: when it has settled, the address and the menu of presets follow, and Undo can take it back. */
  changed() {
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.settle(), kSettled);
  }

  settle() {
    clearTimeout(this.settling);
    if (this.address === undefined) return; // not loaded yet
    const sound = addressOf(this.sound());
    const preset = Object.entries(kPresets).find(([, state]) => addressOf(state) === sound);
    byId("preset").value = preset ? preset[0] : "";
    const address = addressOf(this.state());
    if (address === this.address) return;
    this.past = [...this.past, this.address].slice(-kMaxPast);
    this.goTo(address);
  }

  goTo(address) {
    this.address = address;
    history.replaceState(null, "", address);
    byId("undo").disabled = this.past.length === 0;
  }

  async undo() {
    this.settle();
    const address = this.past.pop();
    if (address === undefined) return;
    const state = stateOf(address);
    if (state.step === undefined && this.tour.isOpen()) this.tour.end();
    await this.show(state);
    this.goTo(addressOf(this.state()));
  }

  async copyLink() {
    this.settle();
    history.replaceState(null, "", this.address);
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
globalThis.contactSpline = { page, presets: kPresets, renderOffline, instrumentMessage, stateOf, loaded: page.load().then(() => page.run()) };
contactSpline.loaded.catch((error) => {
  byId("stage-caption").textContent = `This browser cannot play the page: ${error.message}`;
});
