// SPDX-License-Identifier: MIT
// What the figures of the story show, computed by the thread of worker.js.
import { energiesFd } from "./fd_hammer.js";
import { withKnots } from "./material.js";
import { studyOf } from "./studies.js";

export const kMass = 0.00297; // [kg] of the hammer C4
export const kSoft = 0.5, kHard = 4; // [m/s]
const kHalf = 5e-4; // [m] compression at which the force stays when the exponent changes
const kForceAtHalf = 4.5e9 * kHalf ** 2.5; // [N] of felt_c4
const kMiddleC = 60;
const kFine = 8; // times the rate: durations are within 0.01 % of the exact ones, as `contactspline impact` shows
const kCurve = 80; // points of a curve
const kShown = 300; // of a blow
const kGongHeard = 0.4, kGongPitch = 0.06; // seconds that are followed, and in which a pitch is told
const kLowest = 60, kHighest = 200; // [Hz] between which the lowest partial of the gong is
const kBand = 25, kGongShown = 4000; // [Hz] of its spectrum
const kQuietest = -80; // [dB]
const kMostShown = 2.5; // times the energy that was thrown

/** The file of a felt that has this exponent, and so many uniform pieces. */
function felt(exponent, segments) {
  return JSON.stringify({
    name: "felt",
    contact: { stiffness_n_per_m_alpha: kForceAtHalf / kHalf ** exponent, exponent },
    impact: { mass_kg: kMass, max_speed_m_per_s: 6, min_speed_m_per_s: 0.1 },
    spline: { knots: "uniform", segments },
  });
}

/** The energy of a table's spline at a compression; a row: knot, energy, force, half curvature. */
function energyAt(table, y) {
  if (y <= table[0][0]) return 0;
  const [knot, energy, force, curvature] = table.findLast(([begin]) => begin <= y);
  const d = y - knot;
  return energy + d * (force + d * curvature);
}

// The frequency of the lowest partial of a gong [Hz] in a Hann window of kGongPitch seconds, as its spectrum has its maximum.
function lowestPartial(samples, from, sampleRate) {
  const count = Math.round(kGongPitch * sampleRate);
  let best = { level: 0, frequency: NaN };
  for (let frequency = kLowest; frequency <= kHighest; frequency += 0.5) {
    let [re, im] = [0, 0];
    for (let i = 0; i < count; ++i) {
      const x = samples[from + i] * (1 - Math.cos((2 * Math.PI * i) / count)), phase = (2 * Math.PI * frequency * i) / sampleRate;
      re += x * Math.cos(phase);
      im += x * Math.sin(phase);
    }
    const level = Math.hypot(re, im);
    if (level > best.level) best = { level, frequency };
  }
  return best.frequency;
}

// The largest level in each band of kBand Hz, over the largest of all [dB], of a Hann window of all samples.
function bandsOf(samples, sampleRate) {
  const size = 2 ** Math.floor(Math.log2(samples.length));
  const [re, im] = [Float64Array.from({ length: size }, (_, i) => samples[i] * (1 - Math.cos((2 * Math.PI * i) / size))), new Float64Array(size)];
  transform(re, im);
  const bands = new Float64Array(Math.round(kGongShown / kBand));
  for (let bin = 1; bin < size / 2; ++bin) {
    const band = Math.floor((bin * sampleRate) / size / kBand);
    if (band < bands.length) bands[band] = Math.max(bands[band], Math.hypot(re[bin], im[bin]));
  }
  const most = Math.max(...bands);
  return Array.from(bands, (level) => Math.max(kQuietest, 20 * Math.log10(level / most)));
}

// Fourier's transform in place, of a power of two of samples.
function transform(re, im) {
  const size = re.length;
  for (let i = 1, j = 0; i < size; ++i) {
    for (let bit = size >> 1; (j ^= bit) < bit; bit >>= 1);
    if (i < j) [re[i], re[j], im[i], im[j]] = [re[j], re[i], im[j], im[i]];
  }
  for (let half = 1; half < size; half *= 2)
    for (let k = 0; k < half; ++k) {
      const [c, s] = [Math.cos((Math.PI * k) / half), -Math.sin((Math.PI * k) / half)];
      for (let i = k; i < size; i += 2 * half) {
        const j = i + half, a = re[j] * c - im[j] * s, b = re[j] * s + im[j] * c;
        [re[j], im[j], re[i], im[i]] = [re[i] - a, im[i] - b, re[i] + a, im[i] + b];
      }
    }
}

// How long a mass touches [s]: between two samples it moves in a straight line.
function contactTime({ compressions, step }) {
  const first = compressions.findIndex((y) => y > 0);
  const last = compressions.findIndex((y, i) => i > first && y <= 0);
  const crossing = (i) => i - compressions[i] / (compressions[i] - compressions[i - 1]);
  return first < 1 || last < 0 ? NaN : (crossing(last) - crossing(first)) * step;
}

// The largest force [N], between samples, too: of the parabola through the largest sample and its neighbours.
function peakOf(forces) {
  const n = forces.indexOf(Math.max(...forces));
  const [left, middle, right] = [forces[n - 1] ?? 0, forces[n], forces[n + 1] ?? 0];
  const curvature = 2 * middle - left - right;
  return curvature > 0 ? middle + (right - left) ** 2 / (8 * curvature) : middle;
}

export class StoryNumbers {
  /** studies: for the story alone. mass, hammer: the parameters of the instruments mass_barrier and hammer_on_string. */
  constructor(studies, generator, { mass, hammer }, sampleRate) {
    Object.assign(this, { studies, generator, mass, hammer, sampleRate });
    this.shipped = generator.design(generator.materials().felt_c4, "felt_c4.json");
  }

  /** A note of an instrument with the felt of C4. */
  scene(instrument, values, note, bytes) {
    this.studies.useMaterial(this.shipped);
    return this.studies.play(instrument, values, note, { bytes });
  }

  /** A mass thrown at a material: compressions [m] and forces [N] of all samples, and its design. */
  blow(text, speed, { mass = kMass, ratio = 1, finer = kFine, design = this.generator.design(text, "felt.json") } = {}) {
    this.studies.useMaterial(design);
    const set = { mass_kg: mass, speed_m_per_s: speed, stiffness_ratio: ratio, gravity_m_per_s2: 0, loss_s_per_m: design.loss_s_per_m, start_m: 0 };
    const values = this.mass.map(({ name, init }) => set[name] ?? init);
    const { column, sampleRate } = studyOf(this.studies.play("mass_at_material", values, { key: kMiddleC, velocity: 1, event: 0 }, { rate: finer * this.sampleRate }));
    return { design, compressions: column(0), forces: column(2), step: 1 / sampleRate };
  }

  /** What is told of a blow: duration [s], largest force [N]. */
  told(blow) {
    return { duration: contactTime(blow), force: peakOf(blow.forces) };
  }

  /** Of a soft and a hard blow: { told, data of the plot }. */
  blows(exponent) {
    const text = felt(exponent, 40);
    const soft = this.blow(text, kSoft);
    const hard = this.blow(text, kHard, { design: soft.design });
    const told = [soft, hard].map((blow) => this.told(blow));
    const seconds = 1.1 * Math.max(...told.map(({ duration }) => duration));
    const at = Array.from({ length: kShown }, (_, i) => Math.round((seconds * i) / kShown / soft.step));
    const shown = ({ forces }, { force }) => at.map((i) => forces[i] / force);
    return { told, data: [at.map((i) => 1000 * i * soft.step), shown(soft, told[0]), shown(hard, told[1])] };
  }

  /** Of a felt of so many pieces: its error over the largest force, and { data }. */
  spline(pieces) {
    const { curve, quality, table } = this.generator.design(felt(2.5, pieces), "felt.json");
    return { error: quality.force, data: withKnots(curve, table) };
  }

  /** The sample of a blow that has the largest force: what is known before and its solution, and { data }. */
  step(ratio) {
    this.pieces ??= this.generator.design(felt(2.5, 15), "felt.json");
    const { design, compressions, forces, step } = this.blow(null, 2.5, { ratio, finer: 1, design: this.pieces });
    const n = forces.indexOf(Math.max(...forces));
    const [before, end, force] = [compressions[n - 1], compressions[n], forces[n]];
    const receptance = step ** 2 / (2 * kMass);
    const free = end + receptance * force;
    const energy = energyAt(design.table, before);
    const mean = (y) => (ratio * (energyAt(design.table, y) - energy)) / (y - before);
    // As far to both sides as the force takes from the free way.
    const reach = free - end;
    const points = Array.from({ length: kCurve }, (_, i) => end + reach * ((2 * i + 1) / kCurve - 1));
    const curves = points.map((y) => [y, mean(y), (free - y) / receptance, null]);
    const rows = [...curves, [end, null, null, force]].toSorted(([a], [b]) => a - b);
    const data = [rows.map(([y]) => 1000 * y), ...[1, 2, 3].map((k) => rows.map((row) => row[k]))];
    return { before, end, free, force, mean: mean(end), data };
  }

  /** A blow on the gong at each of the speeds [m/s]: lowest partial [Hz] at the blow and kLater after it, and { data }: spectra over
   * their largest [dB]. values: of the gong's parameters, of which speeds take the one that is `null`. */
  gong(bytes, values, speeds) {
    const blows = speeds.map((speed) => {
      const samples = this.studies.follow(bytes, values.map((value) => value ?? speed), Math.round(kGongHeard * this.sampleRate));
      const first = samples.findIndex((x) => x !== 0);
      const [begins, later] = [first, Math.round((kGongHeard - kGongPitch) * this.sampleRate)].map((from) => lowestPartial(samples, from, this.sampleRate));
      return { begins, later, spectrum: bandsOf(samples.subarray(first), this.sampleRate) };
    });
    return { told: blows.map(({ begins, later }) => ({ begins, later })), data: [blows[0].spectrum.map((_, k) => (k + 0.5) * kBand), ...blows.map(({ spectrum }) => spectrum)] };
  }

  /** The strike of the comparison by the contact step: displacement of the string [m]. */
  strike(ratio, seconds) {
    this.studies.useMaterial(this.shipped);
    return this.studies.strikeC4(ratio, Math.round(seconds * this.sampleRate));
  }

  /** Energies of the strike of the comparison, over what was thrown: of the contact step and of fd.hammer, whose string moves by
   * theirs; by how much the first changes, the last of the second; and { data }. */
  energies(ratio, theirs) {
    const set = { speed_m_per_s: 2.5, stiffness_ratio: ratio, strike_position: 0.12 };
    const values = this.hammer.map(({ name, init }) => set[name] ?? init);
    const { scene, column, frames } = studyOf(this.scene("hammer_on_string", values, { key: kMiddleC, velocity: 1, event: 0 }));
    const ours = column(scene.imbalance).map((difference) => 1 + difference / scene.work);
    const others = energiesFd(theirs, ratio, this.sampleRate).map((energy) => energy / scene.work);
    const at = Array.from({ length: Math.min(frames, others.length) }, (_, i) => i);
    const leaves = others.findIndex((energy) => Math.abs(energy) > kMostShown); // the figure, and does not come back
    const within = ours.reduce((worst, energy) => Math.max(worst, Math.abs(energy - 1)), 0);
    const end = others[at.length - 1];
    return { work: scene.work, within, end, data: [at.map((i) => (1000 * i) / this.sampleRate), at.map((i) => 100 * ours[i]), at.map((i) => (leaves < 0 || i <= leaves ? 100 * others[i] : null))] };
  }
}
