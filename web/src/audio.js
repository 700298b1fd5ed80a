// SPDX-License-Identifier: MIT
// The sound of the page: the audio thread, an analyser, and messages to and fro.
import { ContactSpline } from "../../hosts/npm/src/contactspline.js";
import { moduleAsset, scriptUrl } from "./assets.js";

/** Everything is computed at this rate; the browser converts it to that of the device. */
export const kSampleRate = 44100;

/** How long a buffer of the device should be [s]. The shortest has gaps when the browser's other threads are busy. */
const kBuffer = 0.02;

const kSilent = 1e-5; // of full scale
const kRest = 5000; // milliseconds of silence

/** A node of the audio thread in any context, with messages that it takes before its first block. */
const makeNode = async (context, messages) =>
  ContactSpline.open(context, await scriptUrl("processor"), await moduleAsset("engine"), messages, { isLimited: true, isReported: true, isCentred: true });

/** The sound, which starts with the first gesture, as browsers demand. `send` before that is kept. */
export class Audio {
  /** hear: of what the audio thread says, { report, played, ended } (processor.js). */
  constructor(hear) {
    this.hear = hear;
    this.waiting = [];
    this.analyser = null;
  }

  /** Starts or resumes; call in a gesture. Does not wait for the device: without one nothing sounds, and the rest works. */
  async start() {
    this.starting ??= this.open();
    await this.starting;
    if (this.context.state !== "running") this.context.resume();
  }

  /** Lets the sound rest in a hidden tab that has been silent for a while, until something is played or the tab is seen. */
  restIfHidden(peak, isNeeded) {
    const now = performance.now();
    if (!document.hidden || peak > kSilent || isNeeded || this.isRecording) this.heardAt = now;
    else if (now - this.heardAt > kRest && this.context.state === "running") this.context.suspend();
  }

  async open() {
    document.addEventListener("visibilitychange", () => !document.hidden && this.context.resume());
    this.context = new AudioContext({ sampleRate: kSampleRate, latencyHint: kBuffer });
    this.context.resume();
    this.node = await makeNode(this.context, this.waiting);
    this.analyser = new AnalyserNode(this.context, { fftSize: 2048, smoothingTimeConstant: 0 });
    this.node.connect(this.analyser).connect(this.context.destination);
    this.node.heard = { ...this.hear, sound: ({ channels }) => this.recorded.push(channels) };
    this.waiting = null;
  }

  // Before the first sound an instrument replaces the one before it, with all that was set there.
  send(message) {
    if (this.waiting && message.do === "instrument")
      this.waiting.splice(0, Infinity, ...this.waiting.filter((other) => other.do === "material" || other.do === "own"));
    if (this.waiting) this.waiting.push(message);
    else this.node.send(message);
  }

  /** Begins to keep what the instrument plays. */
  async record() {
    this.recorded = [];
    this.isRecording = true;
    await this.start();
    this.send({ do: "record", isOn: true });
  }

  /** Ends it. Returns blocks of samples, each with its channels. */
  stopRecording() {
    this.isRecording = false;
    this.send({ do: "record", isOn: false });
    return this.recorded;
  }

  /** What sounds, as a stream to record. */
  async stream() {
    await this.start();
    this.out ??= new MediaStreamAudioDestinationNode(this.context);
    this.analyser.connect(this.out);
    return this.out.stream;
  }

  /** Plays samples, as those of a comparison, beside the instrument. */
  async play(samples) {
    await this.start();
    const buffer = new AudioBuffer({ length: samples.length, sampleRate: kSampleRate });
    buffer.copyToChannel(samples, 0);
    const source = new AudioBufferSourceNode(this.context, { buffer });
    source.connect(this.analyser);
    source.start();
  }
}

/** Renders messages offline: [left, right] of so many seconds. A message with a time `at` [s] comes before the first block that
 * begins then or later, by rising times; those without come first. */
export async function renderOffline(messages, seconds) {
  const context = new OfflineAudioContext(2, Math.round(seconds * kSampleRate), kSampleRate);
  const node = await makeNode(context, messages);
  node.connect(context.destination);
  const buffer = await context.startRendering();
  return [buffer.getChannelData(0), buffer.getChannelData(1)];
}
