// SPDX-License-Identifier: MIT
// A clip of the stage with the sound of the page, where the browser can record one.
import { download } from "./save.js";

const kFrames = 30; // per second
const kLength = 4000; // milliseconds
const kFormats = ["video/webm;codecs=vp9,opus", "video/webm;codecs=vp8,opus", "video/mp4"];

const format = () => kFormats.find((name) => globalThis.MediaRecorder?.isTypeSupported(name));

export class Clip {
  /** button records a clip of kLength of a stage, or ends it before; the stage then moves out of view, too; audio: audio.js. It is hidden where the browser records none. */
  constructor(button, stage, audio) {
    Object.assign(this, { button, stage, audio, recorder: null });
    button.hidden = !format() || !stage.canvas.captureStream;
    button.addEventListener("click", () => (this.recorder ? this.recorder.stop() : this.start()));
  }

  async start() {
    this.button.disabled = true; // until it records
    const sound = await this.audio.stream().finally(() => (this.button.disabled = false));
    const stream = new MediaStream([...this.stage.canvas.captureStream(kFrames).getVideoTracks(), ...sound.getAudioTracks()]);
    const parts = [];
    this.recorder = new MediaRecorder(stream, { mimeType: format() });
    this.recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
    this.recorder.addEventListener("stop", () => this.save(parts));
    this.recorder.start();
    const { recorder } = this;
    setTimeout(() => recorder.state === "recording" && recorder.stop(), kLength);
    this.show(true);
  }

  save(parts) {
    const type = this.recorder.mimeType;
    for (const track of this.recorder.stream.getVideoTracks()) track.stop();
    this.recorder = null;
    this.show(false);
    download(`contact_spline.${type.includes("mp4") ? "mp4" : "webm"}`, new Blob(parts, { type }), type);
  }

  show(isOn) {
    this.stage.isKept = isOn;
    this.stage.moves();
    this.button.setAttribute("aria-pressed", String(isOn));
    this.button.textContent = isOn ? "Stop and save" : "Save 4 s as video";
  }
}
