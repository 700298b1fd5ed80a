// SPDX-License-Identifier: MIT
// The audio thread: plays an instrument, and reports force, energies and sound.
import { Centre } from "./centre.js";
import { startEngine } from "./engine.js";
import { limited } from "./limiter.js";
import { play } from "./messages.js";

const kReport = 1024; // samples between two reports
const kFade = 1 / 882; // of the level, in each sample: 20 ms
const kBalanced = 1 / 22050; // of the way to the gain without a score, in each sample
const kSounding = 0.05; // seconds after the last block in which an instrument still counts as sounding

// Its name and its parameters stand behind the # of the address (contactspline.js).
const { name: kName, parameters: kParameters } = JSON.parse(decodeURIComponent(import.meta.url.split("#")[1]));

// Engines that no instrument has. A browser may keep closed nodes for long; their memory is used again.
const idle = (globalThis.contactsplineEngines ??= []);

const sampleOf = ({ at = 0 }) => Math.round(at * sampleRate);

class ContactSplineProcessor extends AudioWorkletProcessor {
  static get parameterDescriptors() {
    return kParameters;
  }

  constructor({ processorOptions }) {
    super();
    this.engine = idle.pop() ?? startEngine(processorOptions.engine, sampleRate);
    this.values = kParameters.map(({ defaultValue }) => Math.fround(defaultValue)); // of the AudioParams
    this.shaped = processorOptions.isLimited ? limited : (sample) => sample;
    this.isReported = processorOptions.isReported;
    this.isCentred = processorOptions.isCentred;
    this.centre();
    this.isClosed = false;
    this.playedAt = -Infinity; // seconds
    this.isPlaying = false;
    this.isRecording = false;
    this.waiting = []; // messages from the choice of an instrument on, until the one before is silent
    this.level = 1;
    this.gain = 1;
    this.scoreGain = 1;
    this.isScore = false;
    this.filled = 0;
    this.strikes = 0;
    this.peak = 0;
    this.force = new Float32Array(kReport);
    this.sample = currentFrame; // that is played next
    const messages = processorOptions.messages ?? [];
    this.later = []; // messages by rising time [s]
    for (const message of messages) this.receive(message);
    this.port.onmessage = ({ data }) => this.receive(data);
  }

  receive(message) {
    const ends = message.do === "instrument" || (message.do === "close" && message.fades);
    if (this.isClosed) this.answer(message);
    else if (sampleOf(message) > this.sample) this.later.splice(this.later.findLastIndex(({ at }) => at <= message.at) + 1, 0, message);
    else if (this.waiting.length > 0 || (ends && this.isSounding())) this.waiting.push(message);
    else this.take(message);
  }

  isSounding() {
    return this.isPlaying && currentTime - this.playedAt < kSounding;
  }

  take(message) {
    if (message.do === "instrument") this.choose(message);
    else if (message.do === "score") this.begin(message);
    else if (message.do === "stop") this.stop();
    else if (message.do === "end") this.port.postMessage({ is: "ended" });
    else if (message.do === "record") this.isRecording = message.isOn;
    else if (message.do === "close") this.close();
    else this.play(message);
    this.answer(message);
  }

  answer(message) {
    if (message.do === "answer" || message.do === "close") this.port.postMessage({ is: "answer" });
  }

  close() {
    this.engine.restart();
    idle.push(this.engine);
    this.engine = null;
    this.isClosed = true;
  }

  choose({ number, gain, oversample }) {
    this.engine.choose(number, sampleRate, oversample);
    this.gain = gain;
    this.scoreGain = 1;
    this.isScore = false;
    this.isPlaying = true;
    this.centre();
  }

  centre() {
    const none = { next: (sample) => sample };
    this.centres = [0, 1].map(() => (this.isCentred ? new Centre(sampleRate) : none));
  }

  // A score, whose times count from now on, with other instruments as its parts. The page is told of its notes.
  begin({ voices, parts = [], messages, gain = 1 }) {
    Object.assign(this, { scoreGain: gain, isScore: true });
    for (const part of parts) this.engine.addPart(part.number, part.gain / this.gain);
    voices.forEach((voice, i) => {
      this.engine.addVoice(voice);
      this.engine.pan(i + 1, voice.pan);
    });
    const now = this.sample / sampleRate;
    this.later = messages.map((message) => ({ ...message, at: message.at + now, isOfScore: true }));
  }

  stop() {
    this.later = [];
    this.isScore = false;
    this.engine.letGo();
  }

  // Tells which keys a score or MIDI plays, and which parameters MIDI moves. The reports of a strike begin with its first
  // sample: they hold nothing of the one before.
  play(message) {
    const { isOfScore } = message;
    const isLive = message.do === "midi" && !isOfScore;
    const before = isLive ? this.engine.targets() : [];
    play(this.engine, message);
    const heard = this.engine.heard();
    const begun = heard.filter(({ velocity }) => velocity > 0).length;
    this.strikes += begun;
    if (begun > 0) this.filled = 0;
    if (isLive || isOfScore) for (const key of heard) this.port.postMessage({ is: "played", ...key, isOfScore });
    if (!isLive) return;
    this.engine.targets().forEach((value, parameter) => value !== before[parameter] && this.port.postMessage({ is: "moved", parameter, value }));
  }

  // A block in parts, so that each message comes before its sample.
  process(_, [[left, right]], parameters) {
    for (let done = 0; done < left.length; ) {
      this.sample = currentFrame + done;
      while (this.later.length > 0 && sampleOf(this.later[0]) <= this.sample) this.receive(this.later.shift());
      if (this.waiting.length > 0 && this.level === 0) this.change();
      if (this.isClosed) return false;
      const next = this.later.length > 0 ? sampleOf(this.later[0]) - currentFrame : left.length;
      const end = Math.min(left.length, next, done + kReport - this.filled);
      if (this.isPlaying && done === 0) this.follow(parameters);
      if (this.isPlaying) this.fill(left.subarray(done, end), right.subarray(done, end));
      done = end;
    }
    this.sample = currentFrame + left.length;
    if (this.isPlaying && this.isRecording) this.port.postMessage({ is: "sound", channels: [left.slice(), right.slice()] });
    return true;
  }

  fill(left, right) {
    this.playedAt = currentTime;
    const [a, b, force] = this.engine.process(left.length);
    for (let i = 0; i < left.length; ++i) {
      this.level = this.waiting.length > 0 ? Math.max(0, this.level - kFade) : 1;
      if (!this.isScore) this.scoreGain += kBalanced * (1 - this.scoreGain);
      const gain = this.level * this.gain * this.scoreGain;
      const [one, other] = [gain * this.centres[0].next(a[i]), gain * this.centres[1].next(b[i])];
      this.peak = Math.max(this.peak, Math.abs(one), Math.abs(other));
      left[i] = this.shaped(one);
      right[i] = this.shaped(other);
    }
    if (this.isReported) this.report(force);
  }

  // An AudioParam acts when it moves: until then, what a message has set stays.
  follow(parameters) {
    kParameters.forEach(({ name }, k) => {
      const [value] = parameters[name];
      if (value === this.values[k]) return;
      this.values[k] = value;
      this.engine.set(k, value);
    });
  }

  // The instrument before is silent: the next one begins. If another one was chosen meanwhile, it fades, too.
  change() {
    const messages = this.waiting;
    this.waiting = [];
    this.isPlaying = false;
    this.level = 1;
    for (const message of messages) this.receive(message);
  }

  report(force) {
    this.force.set(force, this.filled);
    this.filled += force.length;
    if (this.filled < kReport) return;
    this.filled = 0;
    const { strikes, peak, engine } = this;
    const report = { time: currentTime, strikes, peak, force: this.force.slice(), energy: engine.energy(), books: engine.books() };
    this.port.postMessage({ is: "report", ...report });
    this.peak = 0;
  }
}

registerProcessor(kName, ContactSplineProcessor);
