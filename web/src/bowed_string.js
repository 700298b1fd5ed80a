// SPDX-License-Identifier: MIT
// The bowed string of the story: a violin's D string on rigid ends under a rigid bow, and what it does.

const kLength = 0.325; // [m]
const kFrequency = 293.7; // [Hz]
const kImpedance = 0.25; // [kg/s], of a steel D string (Schoonderwaldt, Guettler and Askenfelt 2008)
const kLeast = 0.02, kMost = 0.3; // distances of the bow from the bridge, over the length
const kTorsion = { modes: 12, frequency: 5.5 * kFrequency, mass: 9.674e-5, quality: 30, at: 0.12 }; // assumed
const kBegins = 0.05; // seconds in which the bow comes up to its speed
const kSettles = 0.35, kJudged = 0.25; // seconds before and while the motion is judged

/** Places and forces of the diagram; both rise by equal factors. */
export const kPlaces = Array.from({ length: 14 }, (_, k) => 0.03 * (0.25 / 0.03) ** (k / 13));
export const kForces = Array.from({ length: 16 }, (_, k) => 0.03 * (3 / 0.03) ** (k / 15));

/** The file of the instrument. Its parameters: bow force, speed and place, then how fast the bow begins. */
export const bowedString = () => {
  const mass = kImpedance / (2 * kFrequency);
  const numbers = Array.from({ length: kTorsion.modes }, (_, k) => k + 1);
  const torsion = numbers.map((n) => ({ frequency_hz: n * kTorsion.frequency, decay_per_s: (Math.PI * n * kTorsion.frequency) / kTorsion.quality, mass_kg: kTorsion.mass }));
  const string = { length_m: kLength, mass_kg: mass, tension_n: 2 * kLength * kFrequency * kImpedance, bending_stiffness_n_m2: 5e-5, constant_loss_per_s: 1.5, quadratic_loss_m2_per_s: 0.0025 };
  return JSON.stringify({
    name: "bowed_string",
    bodies: [{ name: "string", string, max_modes: 60 }, { name: "torsion", modes: torsion }],
    places: [
      { name: "bowed", body: "string", position_m: (1 - kTorsion.at) * kLength },
      { name: "surface", body: "torsion", shapes: numbers.map((n) => Number(Math.sin(Math.PI * n * kTorsion.at).toFixed(4))) },
    ],
    frictions: [{ name: "bow", between: ["surface", "bowed"], material: "rosin" }],
    bows: [{ friction: "bow" }],
    controls: [
      { name: "bow", normal_force_n: "bow", initial: 0.3, max: 5 },
      { name: "bow", surface_speed_m_per_s: "bow", initial: 0.1, min: 0, max: 1 },
      { name: "bow", place_m: "bowed", min: (1 - kMost) * kLength, max: (1 - kLeast) * kLength },
    ],
    outputs: [{ name: "bridge", end_force_n: "string" }],
  });
};

/** The values of its parameters. place: distance from the bridge over the length. */
export const bowValues = ({ force, speed, place }) => [force, speed, (1 - place) * kLength, speed / kBegins];

/** What the string does by the slip in each sample [m], at the bow's speed [m/s]: "helmholtz", one slip in a period; "several";
 * "raucous", none that is regular; or "none". A slip counts that follows a stick and is faster than a fifth of Helmholtz'. */
export function motionOf(slips, { speed, place }, sampleRate) {
  const carried = speed / sampleRate, period = sampleRate / kFrequency;
  const begins = [];
  let hasStuck = false;
  for (let n = 0; n < slips.length; ++n) {
    const slip = Math.abs(slips[n]);
    if (hasStuck && slip > (0.2 * carried) / place) {
      begins.push(n);
      hasStuck = false;
    }
    if (slip < 0.05 * carried) hasStuck = true;
  }
  if (begins.length < 3) return "none";
  const mean = (begins.at(-1) - begins[0]) / (begins.length - 1);
  if (mean < 0.8 * period) return "several";
  const square = begins.slice(1).reduce((sum, begin, i) => sum + (begin - begins[i] - mean) ** 2, 0);
  const isRegular = Math.sqrt(square / (begins.length - 1)) < 0.03 * mean + 1;
  return isRegular && mean < 1.2 * period ? "helmholtz" : "raucous";
}

/** A string that studies play and generator writes. */
export class BowedString {
  constructor(studies, generator, sampleRate) {
    const written = generator.instrument(bowedString(), "bowed_string.json", { width: 400, sampleRate });
    if (written.error) throw new Error(written.error);
    Object.assign(this, { studies, sampleRate, bytes: written.bytes });
  }

  /** What it does at these { force, speed, place }. */
  motion(bow) {
    const [settles, judged] = [kSettles, kJudged].map((seconds) => Math.round(seconds * this.sampleRate));
    return motionOf(this.studies.follow(this.bytes, bowValues(bow), settles + judged, { isSlip: true }).subarray(settles), bow, this.sampleRate);
  }

  /** A column of Schelleng's diagram: what it does at each of kForces. */
  column({ speed, place }) {
    return kForces.map((force) => this.motion({ force, speed, place }));
  }

  /** Its slow motion, and what it does. */
  scene(bow) {
    return { ...this.studies.play("bowed_string", bowValues(bow), { key: 62, velocity: 1, event: 0 }, { bytes: this.bytes }), motion: this.motion(bow) };
  }
}
