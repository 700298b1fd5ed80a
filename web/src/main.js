// SPDX-License-Identifier: MIT
// The page: puts instrument, figures, editor, comparison and story together.
import { blobUrl, jsonAsset, moduleAsset, scriptUrl } from "./assets.js";
import { Audio, kSampleRate, renderOffline } from "./audio.js";
import { Background } from "./background.js";
import { Clip } from "./clip.js";
import { Comparison } from "./compare.js";
import { fillSelect, readable, slider, whenChosen } from "./controls.js";
import { Editor } from "./editor.js";
import { startEngine } from "../../hosts/npm/src/engine.js";
import { startGenerator } from "../../hosts/npm/src/generator.js";
import { Keys, keyName } from "./keys.js";
import { Figures } from "./figures.js";
import { Fitting } from "./fitting.js";
import { InstrumentEditor } from "./instrument_editor.js";
import { redrawPlots } from "./plots.js";
import { noteGain } from "./note_gain.js";
import { kPresets } from "./presets.js";
import { download, wavOf } from "./save.js";
import { Stage, strongest, toldOf } from "./stage.js";
import { Story } from "./story.js";
import { addressOf, embeddedOf, kOwn, stateOf } from "./state.js";
import { instrumentOf, performance as performanceOf, readScore, scoreOfMidi } from "./scores.js";
import { startStudies, studyOf } from "./studies.js";

const kFirst = "hammer_on_string";
const kMiddleC = 60; // the key of the first event, too
const kSustain = 64; // controller of MIDI
const kStrikeHold = 1500; // milliseconds that the button holds a key
const kShortest = 60; // milliseconds from a strike on that its key is held at least
const kSettled = 250; // milliseconds after the last change
const kScoreStudies = 1500; // milliseconds between two notes of a score that are shown in slow motion
const kFirstScore = "fur_elise";
const kMaxPast = 100;
const kFirstFrames = 50; // milliseconds in which the stage begins to move
const kChannels = Array.from({ length: 16 }, (_, i) => i + 1); // of MIDI
const kDrums = 10;

const byId = (id) => document.getElementById(id);

// Has an instrument a key of MIDI? One without keys takes any.
function hasKey({ keys, ranges }, key) {
  if (!keys) return true;
  return (ranges.length > 0 ? ranges : [keys]).some(([first, last]) => key >= first && key <= last);
}

// How many notes of MIDI messages an instrument has no keys for, in words, if there are some.
function lacking(instrument, messages) {
  const { length } = messages.filter(({ bytes: [status, key, velocity] }) => (status & 0xf0) === 0x90 && velocity > 0 && !hasKey(instrument, key));
  return length > 0 ? [`left out: notes that ${instrument.title} has no key for (${length})`] : [];
}

// What a browser keeps for its user, where it keeps something at all.
const kStore = "contactspline.";
function kept(name) {
  try {
    return localStorage.getItem(kStore + name);
  } catch {
    return null;
  }
}
function keep(name, value) {
  try {
    localStorage.setItem(kStore + name, value);
  } catch {
    // then only until the page is closed
  }
}

const capital = (text) => text[0].toUpperCase() + text.slice(1);

const joined = (first, second) => {
  const all = new Uint8Array(first.length + second.length);
  all.set(first);
  all.set(second, first.length);
  return all;
};

// When a key that is being struck may be let go.
const heldFor = (struck) => struck.then(() => new Promise((done) => setTimeout(done, kShortest)));

class Page {
  constructor() {
    this.instruments = new Map(); // what engine.cpp says of each, by name
    this.instrument = kFirst;
    this.controls = new Map(); // sliders by the names of their parameters
    this.gains = new Map();
    this.past = [];
    this.begun = new Map(); // of each key: when its last strike has begun
    this.studied = Promise.resolve(); // when the last slow motion that was asked for is shown
    this.run = this.run.bind(this);
    this.figures = new Figures(this.run);
    this.audio = new Audio({
      report: (report) => {
        this.figures.report(report);
        this.audio.restIfHidden(report.peak, Boolean(this.score ?? this.clip.recorder));
      },
      played: (key) => this.heard(key),
      moved: ({ parameter, value }) => this.parameterMoved(parameter, value),
      ended: () => this.stopScore(),
    });
    this.stage = new Stage(
      byId("stage"),
      { play: byId("stage-play"), time: byId("stage-time"), speed: byId("stage-speed") },
      {
        thrown: (thrown) => this.throwHammer(thrown),
        tell: (power, place) => toldOf(this.stage.study.scene, this.played().parameters, power, place),
        energyOf: (power) => this.energyOf(power),
        moves: this.run,
      },
    );
    this.keys = new Keys(byId("keys"), {
      strike: (key, velocity) => this.strike(key, velocity),
      release: (key) => this.release(key),
      midi: (bytes) => this.takeMidi(bytes),
      moved: () => this.changed(),
    });
    this.connectButtons();
    this.clip = new Clip(byId("record-clip"), this.stage, this.audio);
    this.embed(embeddedOf(location.search));
  }

  /** Shows the stage or one chapter alone, with a link to all. */
  embed(part) {
    if (part === null) return;
    document.body.classList.add("embed", part === "stage" ? "embed-stage" : "embed-chapter");
    if (part !== "stage") byId(`chapter-${part}`).classList.add("embedded");
    const link = Object.assign(document.createElement("a"), { href: location.pathname, target: "_blank", textContent: "Contact Spline: the whole page" });
    document.querySelector("footer").replaceChildren(link);
  }

  connectButtons() {
    fillSelect(byId("preset"), { "": "choose …", ...Object.fromEntries(Object.keys(kPresets).map((title) => [title, title])) });
    byId("instrument").addEventListener("change", ({ target }) => this.play(target.value, {}));
    byId("preset").addEventListener("change", ({ target }) => target.value && this.show(kPresets[target.value]));
    byId("piece").addEventListener("click", () => this.playOrStop(kFirstScore));
    byId("scores").addEventListener("change", ({ target }) => (target.value ? this.playScore(target.value) : this.stopScore()));
    byId("letters").checked = this.keys.hasLetters = kept("letters") !== "off";
    byId("letters").addEventListener("change", ({ target }) => keep("letters", (this.keys.hasLetters = target.checked) ? "on" : "off"));
    byId("undo").addEventListener("click", () => this.undo());
    byId("midi-connect").addEventListener("click", async () => (byId("midi").textContent = await this.keys.listenToMidi()));
    byId("midi-file").addEventListener("click", () => (this.score ? this.stopScore() : byId("midi-input").click()));
    whenChosen(byId("midi-input"), (file) => this.playMidi(file));
    // Text that is dragged goes where the browser puts it.
    const hasFiles = ({ dataTransfer }) => dataTransfer.types.includes("Files");
    addEventListener("dragover", (event) => hasFiles(event) && event.preventDefault());
    addEventListener("drop", (event) => hasFiles(event) && this.takeDropped(event));
    byId("record").addEventListener("click", () => this.record());
    byId("octave-down").addEventListener("click", () => this.keys.shift(-1));
    byId("octave-up").addEventListener("click", () => this.keys.shift(1));
    byId("pedal").addEventListener("change", ({ target }) => this.setPedal(target.checked));
    byId("share").addEventListener("click", () => this.copyLink());
    byId("theme").addEventListener("click", () => this.chooseTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
    this.setTheme(matchMedia("(prefers-color-scheme: dark)").matches);
  }

  /** Plays a MIDI file that was dropped, or makes a material of a CSV file, once the page is loaded. */
  async takeDropped(event) {
    event.preventDefault();
    const [file] = event.dataTransfer.files;
    await contactSpline.loaded;
    if (/\.csv$/i.test(file.name)) this.editor.loadCurve(file);
    else this.playMidi(file);
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
    this.story?.draw();
  }

  /** Loads what sounds and what is drawn first, and lets it move; the rest follows when that has been seen. */
  async load() {
    const [engine, studies, generator] = ["engine", "studies", "generator"].map(moduleAsset);
    this.engine = startEngine(await engine, kSampleRate);
    this.studies = startStudies(await studies, kSampleRate);
    this.engine.instruments().forEach((instrument, number) => {
      let bytes; // of a file, packed when it is first drawn
      const packed = () => (bytes ??= this.packed(number, instrument.name));
      const tuned = (cents) => this.editor.generator.tuned(instrument.name, cents, kSampleRate);
      this.instruments.set(instrument.name, { ...instrument, number, packed, tuned });
    });
    this.offerInstruments();
    const first = stateOf(location.hash);
    this.play(this.instruments.has(first.instrument) ? first.instrument : kFirst, first.controls); // on the felt of C4
    await new Promise((seen) => setTimeout(seen, kFirstFrames));
    this.background = await this.startBackground({ studies: await studies, generator: await generator });
    this.editor = new Editor(startGenerator(await generator), this.background, (design) => this.useDesign(design));
    this.editor.load({ name: "felt_c4" });
    this.fitting = new Fitting(this.editor.generator, (text) => this.editor.load({ text }));
    this.instrumentEditor = new InstrumentEditor(this.editor.generator, (instrument) => this.playOwn(instrument));
    this.comparison = new Comparison(this.background, kSampleRate, (samples) => this.audio.play(samples), () => this.changed());
    this.story = new Story({
      background: this.background,
      instruments: this.instruments,
      stiffness: this.comparison.stiffness,
      hear: (state, velocity, key) => this.show(state).then(() => this.hearNote(velocity, key)),
      piece: () => this.playOrStop(kFirstScore),
      at: () => this.changed(),
      moves: this.run,
    });
    this.comparison.draw();
    await this.show(first);
    await Promise.all([this.comparison.drawn, this.offerScores(), scriptUrl("processor")]); // the last for the first strike
    this.gainOf(this.instrument); // which the first strike need not measure
    this.address = addressOf(this.state());
    this.settle();
    // The link to the instrument, for who reads by ear, is no state.
    addEventListener("hashchange", () => location.hash !== "#play" && this.show(stateOf(location.hash)));
  }

  /** The thread of worker.js. */
  async startBackground(modules) {
    const [url, fd, description] = await Promise.all([blobUrl("worker"), moduleAsset("fd_hammer_c4-wasm"), jsonAsset("fd_hammer_c4-json")]);
    const background = new Background(url);
    const [mass, hammer] = ["mass_barrier", kFirst].map((name) => this.instruments.get(name).parameters);
    background.ask("start", { modules: { ...modules, fd }, description, parameters: { mass, hammer }, sampleRate: kSampleRate });
    return background;
  }

  // The bytes of the instrument of a file that ships, with what is drawn of it, once the generator has started.
  packed(number, name) {
    const file = this.editor && this.engine.packed(number);
    return file && joined(file, this.editor.generator.drawn(name, kSampleRate));
  }

  /** Sets the page to a state (state.js). What is no state is left out, and one line says so. */
  async show({ instrument, file, material, controls, octave, key, compare, step, theme, leftOut = [] }) {
    const without = [...leftOut];
    const kept = this.editor.state();
    const error = material ? this.editor.load(material) : null;
    if (error !== null) {
      without.push(`material: ${error}`);
      this.editor.load(kept);
    }
    const broken = instrument === kOwn && file !== undefined ? this.instrumentEditor.load(file) : null;
    if (broken !== null) without.push(`file: ${broken}`);
    const isKnown = broken === null && this.instruments.has(instrument ?? kFirst);
    if (!isKnown && broken === null) without.push(`instrument ${instrument}`);
    const unknown = this.play(isKnown ? (instrument ?? kFirst) : this.instrument, controls);
    without.push(...unknown.map((name) => `control ${name}`));
    if (octave !== undefined) this.keys.goTo(12 * (octave + 1));
    if (key !== undefined) this.lastKey = key;
    if (compare !== undefined) this.comparison.setStiffness(compare);
    if (theme !== undefined) this.chooseTheme(theme);
    if (step !== undefined && step !== this.story.chapter) this.story.go(step);
    this.notice(without);
  }

  // One line, however much was left out.
  notice(without) {
    const text = `Left out of the link: ${without.join("; ")}`;
    byId("notice").textContent = text.length > 200 ? `${text.slice(0, 199)}…` : text;
    byId("notice").hidden = without.length === 0;
  }

  /** What engine.cpp says of the instrument that is played. */
  played() {
    return this.instruments.get(this.instrument);
  }

  offerInstruments() {
    fillSelect(byId("instrument"), Object.fromEntries([...this.instruments.values()].map(({ name, title }) => [name, capital(title)])));
  }

  /** Plays the instrument of the user's own file; parameters that it had before keep their values. */
  playOwn({ bytes, text }) {
    const values = this.instrument === kOwn ? this.sound().controls : {};
    this.engine.takeInstrument(bytes);
    this.audio.send({ do: kOwn, bytes });
    const all = this.engine.instruments();
    const { title, ...described } = all.at(-1);
    this.instruments.set(kOwn, { ...described, name: kOwn, title: `my own: ${title}`, number: all.length - 1, text, packed: () => bytes });
    this.gains.delete(kOwn);
    this.offerInstruments();
    this.play(kOwn, values);
  }

  /** Changes the instrument; values: { name: value } of the parameters that differ from the initial ones. Returns the
   * names that it lacks. */
  play(name, values = {}) {
    this.stopScore();
    this.stage.slip();
    this.instrument = name;
    byId("instrument").value = name;
    const { parameters, keys, events } = this.played();
    this.controls = new Map(parameters.map((shape, number) => [shape.name, slider(shape, () => this.controlMoved(number))]));
    const isShown = ({ controller }) => controller !== kSustain || !keys; // keys have a pedal of their own
    byId("controls").replaceChildren(...parameters.filter(isShown).map((shape) => this.controls.get(shape.name).box));
    this.audio.send(this.instrumentMessage(name));
    for (const [parameter, value] of Object.entries(values)) this.controls.get(parameter)?.set(value);
    parameters.forEach((_, number) => this.sendControl(number));
    byId("pedal").checked = this.value("sustain") >= 0.5;
    this.showButtons(events);
    this.lastEvent = undefined;
    if (!this.hasKey(this.keys.first)) this.keys.goTo(12 * Math.floor(this.nearestKey() / 12));
    for (const id of ["keys", "octave-down", "octave-up", "pedal-box"]) byId(id).hidden = keys === null;
    byId("keys-note").textContent = keys
      ? "The middle row of them is the white keys, the row above it the black ones; the first two of the lowest row change the octave."
      : events.length > 1 ? "Those of the two upper rows strike, each its own." : "Any of the two upper rows strikes.";
    this.figures.reset();
    this.showTitle();
    this.study();
    this.changed();
    return Object.keys(values).filter((parameter) => !this.controls.has(parameter));
  }

  // The sentence at the top fits what is played.
  showTitle() {
    const isHammer = [kFirst, "piano"].includes(this.instrument);
    const words = isHammer ? "A piano hammer touches its string for two thousandths of a second." : `${capital(this.played().title)}: one note, a thousand times slower.`;
    byId("play-title").replaceChildren(`${words} `, Object.assign(document.createElement("em"), { textContent: "Watch." }));
  }

  // One button for each event, or one for the key that was struck last.
  showButtons(events) {
    const labels = events.length > 0 ? events.map(({ label }) => label) : ["strike"];
    byId("events").replaceChildren(
      ...labels.map((label, number) => {
        const button = document.createElement("button");
        button.textContent = capital(label);
        button.className = number === 0 ? "primary" : "";
        button.addEventListener("click", () => (events.length > 0 ? this.playEvent(number) : this.strikeOnce()));
        return button;
      }),
    );
    byId("events").firstChild.id = "strike";
  }

  /** A line of the menu for each score that ships and that the page has the instrument for. */
  async offerScores() {
    const packed = Object.entries(await jsonAsset("scores"));
    this.levels = await jsonAsset("levels"); // dB
    const scores = packed.map(([name, score]) => [name, readScore(score, name, this.editor.generator)]).filter(([, score]) => instrumentOf(score, this.instruments));
    this.scores = new Map(scores);
    byId("piece").disabled = false;
    const title = ([name, score]) => (score.instrument === "piano" ? score.description.replace(/,[^,]*$/, "") : capital(name.replaceAll("_", " ")));
    byId("scores").append(...scores.map((one) => new Option(title(one), one[0])));
  }

  playOrStop(score) {
    return this.score ? this.stopScore() : this.playScore(score);
  }

  /** By how much a score is turned up or down, so that all are equally loud (web/levels.mjs). */
  gainOfScore(name) {
    return 10 ** (this.levels[name] / 20);
  }

  /** Plays a score that ships on its instrument, with the first values of all controls. */
  async playScore(name) {
    const score = this.scores.get(name);
    const instrument = instrumentOf(score, this.instruments);
    await this.perform(name, instrument, { ...performanceOf(score, this.instruments.get(instrument)), gain: this.gainOfScore(name) });
  }

  // The instrument of the menu, if its keys have pitches; the first one, which nobody chose, gives way to the piano.
  playerOfMidi() {
    return this.instrument !== kFirst && this.played().isTunable ? this.instrument : "piano";
  }

  // A MIDI file by its parts: what plays it, and the kit where there are drums.
  midiParts(bytes, name) {
    const read = (channels) => this.editor.generator.readMidi(bytes, name, { channels });
    const all = read(kChannels); // says what is wrong with the file
    const isDrum = ({ channel }) => channel === kDrums;
    const hasOthers = all.channels.some((one) => !isDrum(one)), others = hasOthers ? read([]) : null;
    const drums = others?.unchosen === 0 ? [] : [{ ...read([kDrums]), instrument: "kit" }];
    return { ...all, parts: [...(others ? [{ ...others, instrument: this.playerOfMidi() }] : []), ...drums] };
  }

  /** Plays a standard MIDI file, its drums on the kit. One line says what is wrong with it, or left out. */
  async playMidi(file) {
    try {
      const { parts, ...read } = this.midiParts(new Uint8Array(await file.arrayBuffer()), file.name);
      const [{ instrument }, ...others] = parts;
      await this.perform(file.name, instrument, { ...scoreOfMidi({ ...read, parts }).played, parts: others.map((part) => this.instrumentMessage(part.instrument)) });
      const lack = parts.flatMap(({ instrument, messages }) => lacking(this.instruments.get(instrument), messages));
      byId("midi").textContent = `${[`Plays ${file.name}`, ...read.remarks, ...lack].join("; ")}.`;
    } catch (error) {
      byId("midi").textContent = error.message;
    }
  }

  async perform(name, instrument, messages) {
    this.play(instrument);
    this.markScore(name);
    const started = this.audio.start();
    this.audio.send({ do: "score", ...messages });
    await started;
  }

  markScore(name) {
    this.score = name;
    byId("story-piece").textContent = name ? "Stop the piece" : "Play Für Elise";
    byId("midi-file").textContent = name ? "Stop the piece" : "MIDI file";
    byId("piece").textContent = name ? "Stop" : "Für Elise";
    byId("piece").classList.toggle("plays", Boolean(name));
    byId("scores").value = this.scores?.has(name) ? name : "";
  }

  /** Ends a score: its keys are let go, and the pedals are where the page shows them. */
  stopScore() {
    if (!this.score) return;
    this.audio.send({ do: "stop" });
    this.played().parameters.forEach((_, number) => this.sendControl(number));
    byId("midi").textContent = "";
    this.markScore(null);
    this.keys.unmark();
    this.changed();
  }

  /** A message of MIDI, for the audio thread, which says what it has played and moved. A note is not let go before it has
   * begun; one that is struck again meanwhile stays down. */
  async takeMidi(bytes) {
    const [status, key, velocity] = bytes;
    const note = `MIDI ${status & 15}, ${key}`;
    const isOn = (status & 0xf0) === 0x90 && velocity > 0;
    if (!isOn && [0x80, 0x90].includes(status & 0xf0)) {
      const begun = this.begun.get(note);
      await begun;
      if (this.begun.get(note) !== begun) return;
    }
    const sent = this.audio.start().then(() => this.audio.send({ do: "midi", bytes }));
    if (isOn) this.begun.set(note, heldFor(sent));
    await sent;
  }

  // A key of a score or of MIDI lights up until it is let go (velocity 0). Of a score now and then one is shown in slow motion.
  heard({ key, velocity, isOfScore }) {
    if (isOfScore && !this.score) return;
    this.keys.mark(key, velocity > 0);
    if (velocity === 0) return;
    const now = performance.now();
    const isShown = this.hasKey(key) && !(isOfScore && now - this.studiedAt < kScoreStudies);
    if (isOfScore && isShown) this.studiedAt = now;
    if (isShown) this.struck(key, velocity);
    else this.figures.struck();
  }

  // The force is drawn, and the slow motion is of this key.
  struck(key, velocity) {
    Object.assign(this, { lastKey: key, lastVelocity: velocity, lastEvent: undefined });
    this.changed();
    this.figures.struck();
    this.stage.wake();
    this.studySoon();
  }

  hasKey(key) {
    return hasKey(this.played(), key);
  }

  /** The key that was struck last, or the one of the instrument that is nearest to it, or to middle C. */
  nearestKey() {
    const wanted = this.lastKey ?? kMiddleC, { ranges } = this.played();
    if (this.hasKey(wanted) || ranges.length === 0) return wanted;
    const near = ranges.map(([first, last]) => Math.max(first, Math.min(last, wanted)));
    return near.reduce((best, key) => (Math.abs(key - wanted) < Math.abs(best - wanted) ? key : best));
  }

  // MIDI has moved a parameter: its slider follows.
  parameterMoved(number, value) {
    const { name, controller } = this.played().parameters[number];
    this.controls.get(name).set(value);
    if (controller === kSustain) byId("pedal").checked = value >= 0.5;
    this.changed();
    this.studySoon();
  }

  /** The message that makes the audio thread play an instrument, as loud as all others: measured when it is sent. */
  instrumentMessage(name) {
    const { number } = this.instruments.get(name);
    const gain = () => this.gainOf(name);
    return { do: "instrument", number, get gain() { return gain(); } };
  }

  gainOf(name) {
    if (this.gains.has(name)) return this.gains.get(name);
    this.gains.set(name, noteGain(this.engine, this.instruments.get(name), kSampleRate));
    return this.gains.get(name);
  }

  controlMoved(number) {
    this.sendControl(number);
    this.changed();
    this.studySoon();
  }

  // What another thread computes while the page goes on; nothing when it is of an instrument, or of values, that were left.
  async studySoon() {
    const asked = this.note();
    if (!this.background) return this.study();
    const answer = this.background.latest("study", "play", asked);
    const { begun } = this.studies;
    this.studied = answer.then((played) => {
      if (played !== undefined && begun === this.studies.begun) this.showStudy(played, asked);
    });
    await this.studied;
  }

  value(name) {
    return this.controls.get(name)?.get();
  }

  values() {
    return [...this.controls.values()].map((control) => control.get());
  }

  sendControl(number) {
    this.audio.send({ do: "set", parameter: number, value: this.values()[number] });
  }

  useDesign(design) {
    const { table, memory, mass_kg, loss_s_per_m } = design;
    if (!this.studies.useMaterial(design)) {
      byId("design-note").append(" The keyboard plays up to 128 segments, and keeps the last material.");
      return;
    }
    this.engine.useMaterial(design);
    this.audio.send({ do: "material", design: { table, memory, mass_kg, loss_s_per_m } });
    this.background.ask("material", { table, memory, mass_kg, loss_s_per_m });
    this.changed();
    if (this.instrument === kFirst && this.controls.size > 0) this.studySoon();
  }

  // The slow motion of the note that was played last, with the controls of now.
  study() {
    const asked = this.note();
    this.studies.begun = asked;
    const played = this.studies.play(asked.instrument, asked.values, asked.note, asked);
    if (played || this.background) this.showStudy(played, asked);
  }

  /** The note that was played last, or the first one. */
  note() {
    const { keys, velocity, events } = this.played();
    const isEvent = this.lastEvent !== undefined; // which no key need play
    const key = isEvent ? -1 : this.nearestKey();
    const event = isEvent ? this.lastEvent : keys ? 0 : Math.max(0, key - kMiddleC) % Math.max(1, events.length);
    return { instrument: this.instrument, bytes: this.played().packed(), values: this.values(), note: { key, velocity: this.lastVelocity ?? velocity, event } };
  }

  showStudy(played, asked) {
    const { keys, description } = this.played();
    const { key } = asked.note;
    if (!played) byId("stage-caption").textContent = `${capital(description)}: it has no note to show.`;
    if (!played) return;
    const study = studyOf(played);
    byId("stage-caption").textContent = `${capital(description)}${keys && key >= 0 ? `, ${keyName(key)}` : ""}; one note from rest. ${this.balance(study)}`;
    this.shown = asked;
    this.stage.show(study, keys && key >= 0 ? key : null);
  }

  // How many times the energy that is shown a throw has of this part of the highest speed.
  energyOf(power) {
    const { throws } = this.stage.study.scene;
    if (throws === null) return null;
    const { values, note } = this.shown;
    const speed = power * strongest(this.played().parameters[throws]) * this.played().velocity;
    return values[throws] * note.velocity === 0 ? null : (speed / (values[throws] * note.velocity)) ** 2;
  }

  balance({ scene, column }) {
    if (scene.imbalance === undefined || !(scene.work > 0)) return "";
    const worst = column(scene.imbalance).reduce((max, value) => Math.max(max, Math.abs(value)), 0) / scene.work;
    return `Energy is balanced within ${readable(worst)}.`;
  }

  throwHammer({ power, place }) {
    const { throws, moves } = this.stage.study.scene;
    const controls = [...this.controls.values()];
    if (place !== null && moves !== null) this.setTo(moves, controls[moves], place);
    if (power !== null && throws !== null) this.setTo(throws, controls[throws], power * strongest(this.played().parameters[throws]));
    if (this.lastEvent === undefined) this.strikeOnce(undefined, throws === null ? power : null);
    else this.playEvent(this.lastEvent, throws === null ? power : undefined);
  }

  setTo(number, control, value) {
    control.set(value);
    this.controlMoved(number);
  }

  /** velocity: 0 to 1, or null where the player has none. */
  async strike(key, velocity = null) {
    if (!this.hasKey(key)) return;
    const struck = this.audio.start().then(() => {
      this.audio.send({ do: "noteOn", key, velocity: velocity ?? this.played().velocity });
      this.struck(key, velocity ?? undefined);
    });
    this.begun.set(key, heldFor(struck));
    await struck;
  }

  /** Lets a key go, but not before its strike has begun. One that is struck again meanwhile stays down. */
  async release(key) {
    const begun = this.begun.get(key);
    await begun;
    if (this.begun.get(key) === begun) this.audio.send({ do: "noteOff", key });
  }

  /** Plays an event. Of an instrument with keys it plays without one; a bow is lifted a while later. */
  async playEvent(number, velocity = 1) {
    const { keys, events, parameters } = this.played();
    if (!keys) return this.strikeOnce(kMiddleC + number);
    await this.audio.start();
    const event = { do: "strike", event: number, value: velocity * this.value(parameters[events[number].parameter].name) };
    this.audio.send(event);
    if (events[number].name.startsWith("bow_")) setTimeout(() => this.audio.send({ ...event, value: 0 }), kStrikeHold);
    this.lastEvent = number;
    this.figures.struck();
    this.stage.wake();
    this.studySoon();
  }

  /** Plays a key, or else the first event of a file, or middle C. */
  hearNote(velocity, key) {
    if (key === undefined && this.played().ranges.length > 0) return this.playEvent(0, velocity ?? undefined);
    return this.strikeOnce(key ?? kMiddleC, velocity);
  }

  /** Strikes a key and lets it go a while after it has begun. */
  async strikeOnce(key = this.nearestKey(), velocity = null) {
    await this.strike(key, velocity);
    setTimeout(() => this.audio.send({ do: "noteOff", key }), kStrikeHold);
  }

  /** Records what is played until it is called again, and saves it. */
  async record() {
    const isOn = byId("record").getAttribute("aria-pressed") === "true";
    byId("record").setAttribute("aria-pressed", String(!isOn));
    byId("record").textContent = isOn ? "Record WAV" : "Stop and save";
    if (!isOn) return this.audio.record();
    download(`${this.instrument}.wav`, wavOf(this.audio.stopRecording(), kSampleRate), "audio/wav");
  }

  setPedal(down) {
    byId("pedal").checked = down;
    const pedal = this.played().parameters.find(({ controller }) => controller === kSustain);
    this.controls.get(pedal?.name)?.part(down ? 1 : 0);
  }

  /** What sounds, as presets have it: of the controls those that differ from the initial ones. A pedal is no state. */
  sound() {
    const controls = {};
    for (const { name, controller, init } of this.played().parameters)
      if (controller !== kSustain && this.value(name) !== init) controls[name] = this.value(name);
    const { text } = this.played();
    const file = text === undefined ? {} : { file: text };
    return { instrument: this.instrument, ...file, material: this.editor.state(), controls };
  }

  /** The state in a link. */
  state() {
    const state = { ...this.sound(), octave: this.keys.first / 12 - 1, compare: this.comparison.stiffness.get() };
    if (this.lastKey !== undefined) state.key = this.lastKey;
    if (this.story.chapter > 0) state.step = this.story.chapter;
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
    // To read on and to strike is no change that Undo takes back.
    const lasting = (one) => one.replace(/&(step|key)=\d+/g, "");
    if (lasting(address) !== lasting(this.address)) this.past = [...this.past, lasting(this.address)].slice(-kMaxPast);
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
    await this.show(stateOf(address));
    this.goTo(addressOf(this.state()));
  }

  async copyLink() {
    this.settle();
    history.replaceState(null, "", this.address);
    try {
      await navigator.clipboard.writeText(location.href);
      byId("told").textContent = "Link copied";
    } catch {
      byId("told").textContent = "Link in the address bar";
    }
    setTimeout(() => (byId("told").textContent = ""), 2500);
  }

  /** Draws frames of the screen as long as something moves; call when it may begin to. */
  run() {
    this.frame ??= requestAnimationFrame((now) => {
      this.frame = undefined;
      const { stage, story, figures, audio } = this;
      const moves = [stage.frame(now / 1000), story?.frame(now / 1000), figures.draw(audio.analyser, now / 1000)];
      if (moves.some(Boolean)) this.run();
    });
  }
}

const page = new Page();
// For tests, and for the curious at the console.
globalThis.contactSpline = { page, presets: kPresets, renderOffline, stateOf, instrumentOf, performanceOf, loaded: page.load() };
contactSpline.loaded.catch((error) => {
  byId("stage-caption").textContent = `This browser cannot play the page: ${error.message}`;
});
