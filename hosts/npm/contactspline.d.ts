// SPDX-License-Identifier: MIT
// Types of the package contactspline. Values are in SI units, times in seconds of the context. What cannot be used is an Error
// with one line: what, what is wrong, what is allowed.

/** What can be set while an instrument plays. */
export interface Parameter {
  /** Ends with the unit: hammer_mass_kg. */
  name: string;
  /** As people read it: hammer mass, in a unit that shows a value `factor` times as large. */
  label: string;
  unit: string;
  factor: number;
  /** Where it is played, within `allowed`. */
  min: number;
  max: number;
  /** Other values are moved into this range. */
  allowed: [min: number, max: number];
  init: number;
  isLogarithmic: boolean;
  /** Of MIDI; 0: none. */
  controller: number;
}

/** A strike, a pluck or a stroke of a bow, which the value 0 lifts. */
export interface InstrumentEvent {
  name: string;
  label: string;
  /** Index of the parameter that holds its usual speed [m/s] or force [N]. */
  parameter: number;
}

/** What an instrument is called, plays and has to set. */
export interface Description {
  name: string;
  title: string;
  description: string;
  /** Of an instrument file with keys: first, last, and the number of the event that they play. */
  ranges: [number, number, number][];
  /** The first and the last key of MIDI; null where the keys from 60 on play the events. */
  keys: [first: number, last: number] | null;
  /** Of a key that is struck without one. */
  velocity: number;
  /** Of the softest and the loudest key [m/s], where it has them. */
  speeds: [softest: number, loudest: number] | null;
  /** Does useMaterial() work? */
  takesMaterial: boolean;
  /** Does tune() work? */
  isTunable: boolean;
  parameters: Parameter[];
  events: InstrumentEvent[];
  presets: { name: string; values: number[] }[];
}

/** An instrument that ships, by its name, or the text of an instrument file; messages call it `file`. */
export type Source = string | { text: string; file?: string };

/** What ContactSpline.create() calls every 1024 samples. */
export interface Report {
  /** Of the context, at the end of the samples. */
  time: number;
  /** The sum of the contact forces at each of the last 1024 samples [N]; begins anew with each note and strike. */
  force: Float32Array;
  /** Stored in the instrument [J]. */
  energy: number;
  /** The largest sample since the last report. */
  peak: number;
  /** How many notes and strikes there were. */
  strikes: number;
  /** Energies of the last strike [J], where the instrument keeps them. */
  books: { hammer: number; felt: number; string: number; dissipated: number; work: number } | null;
}

export interface Options {
  report?: (report: Report) => void;
  /** Bend samples beyond half of full scale, so that none is beyond it? */
  isLimited?: boolean;
  oversample?: Oversample;
}

/** How many times finer than its host an instrument runs, for contacts that are too short for the rate. */
export type Oversample = 1 | 2 | 4 | 8;

/** What plays an instrument. A time that has passed, as 0, is now. */
interface Playable {
  readonly description: Description;
  /** How late it is, because it is oversampled [samples]: 0, 34, 37 or 38. */
  readonly latency: number;
  /** velocity: 0 to 1. Keys that the instrument lacks do nothing. */
  noteOn(key: number, velocity?: number, time?: number): void;
  noteOff(key: number, time?: number): void;
  /** Plays an event of the description by a speed [m/s] or a force [N], or by that of its parameter. */
  strike(event: string, value?: number, time?: number): void;
  /** Messages of MIDI, or pieces of a stream; damaged and unknown ones do nothing. */
  midi(bytes: ArrayLike<number>, time?: number): void;
  /** Tunes the 128 keys of MIDI by so many cents, from the next notes on: readTuning() gives them, null is equal temperament. */
  tune(cents: ArrayLike<number> | null): void;
  set(parameter: string, value: number): void;
  loadPreset(name: string): void;
  /** The material of all later strikes. */
  useMaterial(design: Design): void;
  /** Lets the instrument of another text take the place of this one, also while it sounds: what rings fades out within 10 ms,
   * parameters that have been set stay. The description stays, too: what both have by the same name is played. */
  replace(instrument: { text: string; file?: string }): Promise<void>;
}

/** An instrument as a node, whose `parameters` are those of its description, by their names. */
export interface ContactSpline extends Playable {}
export class ContactSpline extends AudioWorkletNode {
  private constructor();
  static create(context: BaseAudioContext, instrument: Source, options?: Options): Promise<ContactSpline>;
  /** Resolves when the audio thread has taken what was sent: await it before an OfflineAudioContext starts. */
  sent(): Promise<void>;
  /** Ends it, within 20 ms if it sounds. */
  close(): Promise<void>;
}

/** An instrument without Web Audio, in Node or anywhere: blocks of samples, when they are asked for. Times do nothing. */
export interface Player extends Playable {}
export class Player {
  private constructor();
  static create(instrument: Source, sampleRate?: number, options?: { oversample?: Oversample }): Promise<Player>;
  readonly sampleRate: number;
  /** Samples, left and right, and the sum of the contact forces [N]. Up to 128 are views that the next call changes. */
  process(samples?: number): [left: Float32Array, right: Float32Array, force: Float32Array];
  /** Stored [J]. */
  energy(): number;
  close(): void;
}

/** A material as the generator designed it. */
export interface Design {
  name: string;
  title: string;
  law: string;
  loss_s_per_m: number;
  mass_kg?: number;
  /** Of each segment: knot [m], energy [J], force [N], half curvature [N/m]. */
  table: number[][];
  /** Of each memory: weight, relaxation time [s]. */
  memory: number[][];
  /** What `contactspline generate` writes, by the names of the files. */
  files: Record<string, string>;
  curve: { compression_m: number[]; law_n: number[]; spline_n: number[] };
  quality: { force: number; energy: number; contact_duration?: number; max_compression?: number; spectrum_db?: number };
}

/** A material that was fitted to measurements. */
export interface FittedMaterial {
  /** The text of its file. */
  material: string;
  /** As `contactspline fit` prints it. */
  report: string;
  /** Data and model of each kind, as columns: where, measured, modelled; with the labels of their axes. */
  panels: { quantity: string; at: string; value: string; isLine: boolean; columns: number[][] }[];
}

/** What is played of a MIDI file, in seconds. */
export interface MidiFile {
  /** Of the first track; empty where it has none. */
  title: string;
  /** What was not read as it stands, with track and byte. */
  remarks: string[];
  /** Of the last track. */
  end: number;
  /** With notes: the number of each, 1 to 16, the program of its first note, 1 to 128, and how many there are. */
  channels: { channel: number; program: number; notes: number }[];
  /** Notes of other channels. */
  unchosen: number;
  /** For midi(), by rising time. The last ones let all keys go. */
  messages: MidiMessages;
}

export type MidiMessages = { time: number; bytes: number[] }[];

/** A MIDI file in parts: what each instrument plays. */
export interface MidiParts<I> {
  title: string;
  remarks: string[];
  end: number;
  parts: { instrument: I; channels: number[]; messages: MidiMessages }[];
}

/** An instrument file as the generator read it. */
export interface ReadInstrument {
  name: string;
  title: string;
  /** As `contactspline inspect` prints them. */
  parts: string;
  drawing: object;
  error?: undefined;
}

export interface Generator {
  /** The text of every material and instrument file that ships, by name. */
  materials(): Record<string, string>;
  instruments(): Record<string, string>;
  /** Takes a file that materials, instrument files and fit files may name: a measured curve or data in CSV, a material. */
  takeFile(name: string, text: string): void;
  /** The text of a fit file for data files that takeFile was given, of impacts of this mass [kg] on a wall. Throws one line. */
  fitFile(names: string[], mass: number): string;
  /** Fits a material as `contactspline fit` does. Throws one line, which calls the text of the fit file `file`. */
  fit(text: string, file: string): FittedMaterial;
  /** Designs the material of a file's text. Messages call it `file`. */
  design(text: string, file: string): Design;
  /** Reads a MIDI file: of the channels, all but the tenth, which is for drums. Throws one line, which calls it `file`. */
  readMidi(bytes: Uint8Array, file: string, options?: { channels?: number[] }): MidiFile;
  /** Reads a MIDI file for several instruments: by channel, by the program of a channel's first note (p1 to p128), or all others
   * but the tenth (*), as { 1: "trichord_c4", 10: "kit", "*": "piano" }. */
  readMidi<I>(bytes: Uint8Array, file: string, options: { instruments: Record<string, I> }): MidiParts<I>;
  /** The cents of the 128 keys of MIDI above equal temperament, by the texts of files of Scala (.scl, .kbm) and the pitch of A4 [Hz].
   * NaN: the key does not sound. Throws one line. */
  readTuning(files?: { scale?: string; keymap?: string; a4?: number }): Float64Array;
  /** Reads an instrument file; what is wrong with it is one line. */
  instrument(text: string, file: string, options?: { width?: number; sampleRate?: number }): ReadInstrument | { error: string };
}

/** The generator, loaded once. */
export function loadGenerator(): Promise<Generator>;

/** The descriptions of all instruments that ship. */
export function instruments(): Promise<Description[]>;
