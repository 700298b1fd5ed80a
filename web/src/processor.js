// SPDX-License-Identifier: MIT
// The audio thread: plays an instrument, and reports force, energies and sound to the page.
import { startEngine } from "./engine.js";
import { limited } from "./limiter.js";

const kReport = 1024; // samples between two reports
const kFade = 1 / 882; // of the level, in each sample: 20 ms
const kLetKeysGo = [0xb0, 123, 0]; // of MIDI

class ContactSplineProcessor extends AudioWorkletProcessor {
  constructor({ processorOptions }) {
    super();
    this.engine = startEngine(processorOptions.engine, sampleRate);
    this.isPlaying = false;
    this.isRecording = false;
    this.waiting = []; // messages from the choice of an instrument on, until the one before is silent
    this.level = 1;
    this.gain = 1;
    this.filled = 0;
    this.strikes = 0;
    this.peak = 0;
    this.force = new Float32Array(kReport);
    const messages = processorOptions.messages ?? [];
    this.later = messages.filter(({ at }) => at > 0); // by rising time [s]
    for (const message of messages) if (!(message.at > 0)) this.receive(message);
    this.port.onmessage = ({ data }) => this.receive(data);
  }

  receive(message) {
    if (this.waiting.length > 0 || (message.do === "instrument" && this.isPlaying)) this.waiting.push(message);
    else this.take(message);
  }

  take(message) {
    const { engine } = this;
    if (message.do === "instrument") this.choose(message);
    if (message.do === "own") engine.takeInstrument(message.bytes);
    if (message.do === "material") engine.useMaterial(message.design);
    if (message.do === "set") engine.set(message.parameter, message.value, message.voice);
    if (message.do === "noteOn") this.strike(message);
    if (message.do === "noteOff") engine.noteOff(message.key, message.voice);
    if (message.do === "score") this.begin(message);
    if (message.do === "stop") this.stop();
    if (message.do === "end") this.port.postMessage({ is: "ended" });
    if (message.do === "midi") engine.midi(message.bytes);
    if (message.do === "watchNone") engine.watchNone();
    if (message.do === "record") this.isRecording = message.isOn;
  }

  choose({ number, gain }) {
    this.engine.choose(number);
    this.gain = gain;
    this.isPlaying = true;
  }

  // A score, whose times count from now on. The page is told of its notes.
  begin({ voices, messages }) {
    voices.forEach((voice, i) => {
      this.engine.addVoice(voice);
      this.engine.pan(i + 1, voice.pan);
    });
    this.later = messages.map((message) => ({ ...message, at: message.at + currentTime, isOfScore: true }));
  }

  stop() {
    this.later = [];
    this.engine.midi(kLetKeysGo);
  }

  // The reports of a strike begin with its first sample: they hold nothing of the one before.
  strike({ key, velocity, voice, isOfScore }) {
    this.engine.noteOn(key, velocity, voice);
    if (isOfScore) this.port.postMessage({ is: "played", key, velocity });
    ++this.strikes;
    this.filled = 0;
  }

  process(_, [[left, right]]) {
    while (this.later[0]?.at <= currentTime) this.receive(this.later.shift());
    if (this.waiting.length > 0 && this.level === 0) this.change();
    if (!this.isPlaying) return true;
    const [a, b, force] = this.engine.process(left.length);
    for (let i = 0; i < left.length; ++i) {
      this.level = this.waiting.length > 0 ? Math.max(0, this.level - kFade) : 1;
      this.peak = Math.max(this.peak, this.level * this.gain * Math.max(Math.abs(a[i]), Math.abs(b[i])));
      left[i] = limited(this.level * this.gain * a[i]);
      right[i] = limited(this.level * this.gain * b[i]);
    }
    if (this.isRecording) this.port.postMessage({ is: "sound", channels: [left.slice(), right.slice()] });
    this.report(force);
    return true;
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
    const { strikes, peak } = this;
    this.port.postMessage({ is: "report", time: currentTime, strikes, peak, force: this.force.slice(), books: this.engine.books() });
    this.peak = 0;
  }
}

registerProcessor("contactspline", ContactSplineProcessor);
