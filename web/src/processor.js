// SPDX-License-Identifier: MIT
// The audio thread: plays the C++ keyboard or a program of Faust, and reports force, energies and sound to the page.
import { startEngine } from "./engine.js";
import { startProgram } from "./faust_program.js";
import { frequencyOf, kInstruments } from "./instruments.js";

const kReport = 1024; // samples between two reports
const kSleep = 0.5; // seconds of silence after which a voice of Faust rests

const start = ({ description, bytes }) => startProgram(new WebAssembly.Module(bytes), description, sampleRate);

/** A Faust program with one voice, or with several for the keys of a keyboard; its effect plays their sum. */
class FaustInstrument {
  constructor(voice, effect) {
    this.kind = kInstruments[voice.description.name];
    this.voices = Array.from({ length: this.kind.voices ?? 1 }, () => ({
      program: start(voice),
      key: null,
      age: 0,
      quiet: Infinity,
    }));
    this.effect = effect && start(effect);
    this.clock = 0;
  }

  set(label, value) {
    for (const { program } of this.voices) program.set(label, value);
  }

  strike(key, velocity) {
    const voice = this.voiceFor(key);
    Object.assign(voice, { key, age: ++this.clock, quiet: 0 });
    if (this.kind.button) return this.press(voice, this.kind.button);
    voice.program.set("freq", frequencyOf(key));
    voice.program.set("gain", velocity);
    this.press(voice, "gate");
  }

  // A button that is down already is let go for one sample: only a rise strikes.
  press({ program }, button) {
    program.set(button, 0);
    program.process(1);
    program.set(button, 1);
  }

  release(key) {
    for (const voice of this.voices) {
      if (voice.key !== key) continue;
      voice.program.set(this.kind.button ?? "gate", 0);
      voice.key = null;
    }
  }

  pedal(down) {
    if (!this.kind.button) this.set("sustain pedal", down ? 1 : 0);
  }

  // The voice that has this key, else a resting one, else the one struck first.
  voiceFor(key) {
    const rank = (voice) => (voice.key === key ? -2 : voice.quiet > kSleep ? -1 : voice.age);
    return this.voices.reduce((best, voice) => (rank(voice) < rank(best) ? voice : best));
  }

  process(left, right, force) {
    force.fill(0);
    left.fill(0);
    right.fill(0);
    for (const voice of this.voices) {
      if (this.voices.length > 1 && voice.quiet > kSleep && voice.key === null) continue;
      const outputs = voice.program.process(left.length);
      const a = outputs[this.kind.output ?? 0];
      const b = outputs[this.kind.output ?? 1];
      let peak = 0;
      for (let i = 0; i < left.length; ++i) {
        left[i] += a[i];
        right[i] += b[i];
        peak = Math.max(peak, Math.abs(a[i]));
      }
      voice.quiet = peak > 1e-5 ? 0 : voice.quiet + left.length / sampleRate;
      if (this.kind.force !== undefined) force.set(outputs[this.kind.force].subarray(0, left.length));
    }
    const channels = [left, right];
    if (this.effect) {
      channels.forEach((channel, k) => this.effect.inputs[k].set(channel));
      const outputs = this.effect.process(left.length);
      channels.forEach((channel, k) => channel.set(outputs[k].subarray(0, left.length)));
    }
    for (const channel of channels) for (let i = 0; i < channel.length; ++i) channel[i] *= this.kind.gain;
  }
}

class ContactSplineProcessor extends AudioWorkletProcessor {
  constructor({ processorOptions }) {
    super();
    this.engine = startEngine(processorOptions.engine, sampleRate);
    this.engine.makeKeyboard();
    this.faust = null;
    this.filled = 0;
    this.strikes = 0;
    this.force = new Float32Array(kReport);
    this.block = new Float32Array(128);
    for (const message of processorOptions.messages ?? []) this.receive(message);
    this.port.onmessage = ({ data }) => this.receive(data);
    this.port.postMessage({ is: "ready" });
  }

  receive(message) {
    const { engine, faust } = this;
    const playing = faust ?? engine;
    if (message.do === "material") engine.useMaterial(message.design);
    if (message.do === "control") engine.control(message.controls);
    if (message.do === "instrument") this.choose(message);
    if (message.do === "set") faust?.set(message.label, message.value);
    if (message.do === "strike") this.strike(playing, message);
    if (message.do === "release") playing.release(message.key);
    if (message.do === "pedal") playing.pedal(message.down);
    if (message.do === "watchNone") engine.watchNone();
  }

  // The reports of a strike begin with its first sample: they hold nothing of the one before.
  strike(playing, { key, speed, velocity }) {
    playing.strike(key, this.faust ? velocity : speed);
    ++this.strikes;
    this.filled = 0;
  }

  choose({ voice, effect }) {
    this.engine.silence();
    this.faust = voice ? new FaustInstrument(voice, effect) : null;
  }

  process(_, [[left, right]]) {
    const force = this.block.subarray(0, left.length);
    if (this.faust) {
      this.faust.process(left, right, force);
    } else {
      const played = this.engine.process(left.length);
      left.set(played[0]);
      right.set(played[1]);
      force.set(played[2]);
    }
    for (const channel of [left, right])
      for (let i = 0; i < channel.length; ++i) channel[i] = Math.max(-1, Math.min(1, channel[i])) || 0;
    this.report(force);
    return true;
  }

  report(force) {
    this.force.set(force, this.filled);
    this.filled += force.length;
    if (this.filled < kReport) return;
    this.filled = 0;
    const books = this.faust ? null : this.engine.books();
    this.port.postMessage({ is: "report", time: currentTime, strikes: this.strikes, force: this.force.slice(), books });
  }
}

registerProcessor("contactspline", ContactSplineProcessor);
