#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes the files of the drums, with parts that are fitted to recorded strokes.

    make.py fit PROGRAM tom|snare RECORDINGS FILE
    make.py distance PROGRAM FILE FITTED KEPT

PROGRAM is contactspline. RECORDINGS, FITTED and KEPT hold SOURCE/LAYER.wav, single strokes at 44.1 kHz; LAYER is soft, loud, or
one where a source has no layers. `fit` writes FILE: what DRUMS calls `fitted`, with the range of each, is searched (Nelder and
Mead, from what it calls `begin`, where coarser searches ended) for the least mean over the drums of

    DISTANCE + t60 times |log2 of the ratio of T60| by octave, at most 2, + BANDS times |difference of octaves|, 50 to 350 ms
    + glide times |difference of the falls of pitch|, in cents: of toms only, as the strongest partial of a snare drum changes

SPEEDS are those of the stick; a single stroke counts as loud.

DISTANCE is the mean difference of log-mel spectrograms: 48 bands from 60 Hz to 16 kHz, each stroke of the same A-weighted
loudness, down to 60 dB below the recording's largest value. T60 by octave from 125 Hz to 8 kHz is that of the first 20 dB, of
both sounds cut to the length of the shorter. The fall of pitch is that of the strongest
partial from 50 to 250 ms after the stroke.

Fitted: Sonic Pi's drum_tom_lo, _mid, _hi and drum_snare, soft and hard (Debian's sonic-pi-samples, CC0); of FluidR3 GM
(fluid-soundfont-gm, MIT) the toms of keys 45 and 47 of Standard and 45 of Power, the snares of keys 38 and 40 of Standard and
Standard 1. Kept: toms and snares of Black Pearl and Red Zeppelin (avldrums.lv2-soundfont), ForzeeStereo, Millo, BJA and Colombo
(hydrogen-drumkits), whose licences ask for the same licence.

`distance` prints the medians over pairs of ours and a recorded drum of these, for recordings that were fitted and that were
kept, and of pairs of recorded drums.
"""
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.signal import butter, sosfilt

sys.path.insert(0, str(Path(__file__).parents[1]))
from notes import RATE, a_weighting, from_onset, mel, read, recorded, rounded, text_of

SPEEDS = {"soft": 2.15, "loud": 4}  # [m/s]: 5.4 dB, the median of recorded toms
BANDS, TOP = 0.1, 16000
# Of the tom's contact [s/m], fitted after the rest to the octave of 8 kHz in the first 15 ms: medians of the fitted strokes are -39 dB
# soft and -22 dB loud, ours -30 and -33. Without it the tip rings on the head's last modes, at -7 and -11 dB, where the rate moves it.
TIP_LOSS = 0.03
OCTAVES = (125, 250, 500, 1000, 2000, 4000, 8000)
MYLAR = {"youngs_modulus_pa": 4900000000, "poisson_ratio": 0.38}
HEADER = """\
// Written by bench/drums/make.py, which says how:
// {fitted}
// are fitted to recorded strokes of Sonic Pi (CC0) and of FluidR3 GM (MIT). Heads of Mylar: 1390 kg/m^3, Young's modulus 490 to 510
// kg/mm^2, Poisson's ratio 0.38 (DuPont Teijin Films, H-37232).
"""


def number(x, digits=5):
    x = rounded(x, digits)
    return int(x) if x == int(x) else x


def head(name, radius_m, thickness_m, tension, constant, quadratic, max_modes, stretches=True):
    return {"name": name,
            "membrane": {"radius_m": radius_m, "mass_per_area_kg_m2": number(1390 * thickness_m, 3), "tension_n_per_m": number(tension, 3),
                         "constant_loss_per_s": number(constant, 3), "quadratic_loss_m2_per_s": number(quadratic, 3)},
            **({"stretch": {**MYLAR, "thickness_m": thickness_m}} if stretches else {}), "max_modes": max_modes}


def tom(p):
    radius, depth = 0.1524, 0.229
    air = 1.2 * 343 ** 2 * np.pi * radius ** 2 / depth
    return {"name": "tom", "description": "drum with two heads that stretch and the air between them",
            "bodies": [head("batter", radius, 1.905e-4, p["tension"], p["constant"], p["quadratic"], 500),
                       head("lower", radius, 1.905e-4, p["ratio"] * p["tension"], p["constant"], p["quadratic"], 60),
                       {"name": "stick", "mass_kg": number(p["stick"], 3)}],
            "places": [{"name": "struck", "body": "batter", "position_m": number(p["place"], 3)},
                       {"name": "pickup", "body": "batter", "position_m": 0.09, "angle_rad": 0.7},
                       {"name": "batter_mean", "body": "batter", "mean_radius_m": radius},
                       {"name": "lower_mean", "body": "lower", "mean_radius_m": radius}],
            "contacts": [{"name": "tip", "between": ["stick", "struck"], "material": "felt_over_wood", "weight": number(p["weight"], 2),
                          "gap_m": 0.004}],
            "springs": [{"name": "air", "between": ["batter_mean", "lower_mean"], "stiffness_n_per_m": number(air, 3),
                         "resistance_n_s_per_m": number(p["resistance"], 3)}],
            "controls": [{"name": "air", "stiffness_n_per_m": "air", "max": 100000},
                         {"name": "hand", "damping_per_s": ["batter", "lower"], "max": 1000},
                         {"name": "tip", "loss_s_per_m": "tip", "initial": TIP_LOSS, "max": 2}],
            "strikes": ["stick"],
            "outputs": [{"name": "microphone", "pressure_pa": "batter", "distance_m": number(p["distance"], 2), "angle_rad": 0.6, "full_scale": 60},
                        {"name": "batter", "velocity_m_per_s": "pickup", "full_scale": 3},
                        {"name": "lower", "velocity_m_per_s": "lower_mean", "full_scale": 2}],
            "keys": [{"key": key, "event": "strike_stick"} for key in (41, 43, 45, 47, 48, 50)]}


def snare(p):
    radius, depth = 0.165, 0.14
    air = 1.2 * 343 ** 2 * np.pi * radius ** 2 / depth
    points = [-0.1225, -0.0875, -0.0525, -0.0175, 0.0175, 0.0525, 0.0875, 0.1225]
    wires = [1, 2, 3]
    string = {"length_m": 0.33, "mass_kg": 0.0011, "tension_n": number(p["wire"], 3), "bending_stiffness_n_m2": 2e-5,
              "constant_loss_per_s": number(p["wire_loss"], 3), "quadratic_loss_m2_per_s": 5e-5}
    return {"name": "snare", "description": "drum with two heads and three wires that rattle along the lower one",
            "bodies": [head("head", radius, 2.54e-4, p["tension"], p["constant"], p["quadratic"], 120, stretches=False),
                       head("lower", radius, 7.62e-5, p["lower"], p["lower_constant"], p["quadratic"], 500, stretches=False)]
            + [{"name": f"wire_{i}", "tuning_cents": [0, 60, 130][i - 1], "string": string, "max_modes": 60} for i in wires]
            + [{"name": "stick", "mass_kg": number(p["stick"], 3)}],
            "places": [{"name": "struck", "body": "head", "position_m": number(p["place"], 3)},
                       {"name": "pickup", "body": "head", "position_m": 0.09, "angle_rad": 0.7},
                       {"name": "head_mean", "body": "head", "mean_radius_m": radius},
                       {"name": "lower_mean", "body": "lower", "mean_radius_m": radius},
                       {"name": "over_wires", "body": "lower", "positions_m": points}]
            + [{"name": f"on_wire_{i}", "body": f"wire_{i}", "positions_m": [number(x + radius) for x in points]} for i in wires],
            "contacts": [{"name": "tip", "between": ["stick", "struck"], "material": "felt_over_wood", "gap_m": 0.004}]
            + [{"name": f"rattle_{i}", "between": ["over_wires", f"on_wire_{i}"], "material": "steel_on_steel", "weight": 0.01,
                "gap_m": -number(p["pressed"], 2)} for i in wires],
            "springs": [{"name": "air", "between": ["head_mean", "lower_mean"], "stiffness_n_per_m": number(air, 3),
                         "resistance_n_s_per_m": number(p["resistance"], 3)}],
            "controls": [{"name": "strainer", "gap_shift_m": [f"rattle_{i}" for i in wires], "min": -1e-5, "max": 0.002},
                         {"name": "hand", "damping_per_s": ["head", "lower"], "max": 1000}],
            "strikes": ["stick"],
            "outputs": [{"name": "microphone", "pressure_pa": "lower", "distance_m": number(p["distance"], 2), "angle_rad": 0.6, "full_scale": 70},
                        {"name": "head", "velocity_m_per_s": "pickup", "full_scale": 2},
                        {"name": "wires", "force_n": [f"rattle_{i}" for i in wires]}],
            "keys": [{"key": key, "event": "strike_stick"} for key in (38, 40)]}


DRUMS = {  # fitted: range of each, searched by ratios
    "tom": {"of": tom, "seconds": 1.0, "weights": {"t60": 5, "glide": 0.02}, "steps": 200, "names": "tensions, losses, the stick, its contact and place, the resistance of the air and the distance of the microphone",
            "fitted": {"tension": (250, 900), "ratio": (0.5, 2), "constant": (2, 8), "quadratic": (1e-5, 6e-4), "stick": (0.006, 0.06),
                       "place": (0.004, 0.09), "weight": (5e-4, 1), "resistance": (0.5, 200), "distance": (0.06, 0.5)},
            "begin": {"tension": 405, "ratio": 0.72, "constant": 5.8, "quadratic": 5.2e-5, "stick": 0.0092, "place": 0.072, "weight": 0.08,
                      "resistance": 3.5, "distance": 0.27}, "about": """\
// A tom of 12 inches, 9 inches deep, with two heads of Mylar of 7.5 mil. The air between them is a spring between their mean
// displacements: rho c^2 A^2/V = 1.2 kg/m^3 (343 m/s)^2 0.073 m^2/0.229 m. Its resistance is what the drum radiates as its heads
// move against each other. Two masses and three springs describe the lowest modes of such drums (Rossing, Bork, Zhao and Fystrom,
// J. Acoust. Soc. Am. 92, 1992). As the heads move, their tension rises, so that loud strokes begin sharp.
"""},
    "snare": {"of": snare, "seconds": 0.6, "weights": {"t60": 2, "glide": 0}, "steps": 100, "names": "tensions, losses, the stick and its place, how the wires lie, the resistance of the air and the distance of the microphone",
              "fitted": {"tension": (700, 4000), "lower": (800, 4000), "constant": (3, 30), "lower_constant": (3, 30), "quadratic": (3e-5, 6e-4),
                         "stick": (0.008, 0.06), "place": (0.004, 0.09), "resistance": (0.5, 200), "wire": (8, 60), "wire_loss": (3, 30),
                         "pressed": (3e-7, 9e-6), "distance": (0.06, 0.5)},
              "begin": {"tension": 1800, "lower": 1900, "constant": 9.4, "lower_constant": 9.4, "quadratic": 2e-4, "stick": 0.018, "place": 0.033,
                        "resistance": 20, "wire": 24, "wire_loss": 9.4, "pressed": 2e-6, "distance": 0.2}, "about": """\
// A snare drum of 13 inches, 14 cm deep, heard from below: a head of 10 mil is struck, and three wires rattle along a diameter of the
// lower one, of 3 mil, each at eight points, where it lies with some pressure. The air between the heads is a spring, as in `tom`.
// Heads that stretch take 2.4 times as long here, and were farther from recorded drums.
"""}}


def rendered(program, file, seconds):
    """Our strokes by layer. file: a dict or a path."""
    with tempfile.TemporaryDirectory() as folder:
        path = file
        if isinstance(file, dict):
            path = f"{folder}/drum.json"
            Path(path).write_text(text_of(file), encoding="utf-8")
        sounds = {}
        for layer, speed in SPEEDS.items():
            score = {"instrument": os.path.abspath(path), "duration_s": max(seconds, 1) + 0.2, "events": [{"time_s": 0.05, "stick_speed_m_per_s": speed}]}
            Path(f"{folder}/score.json").write_text(json.dumps(score), encoding="utf-8")
            subprocess.run([program, "render", f"{folder}/score.json", "--no-figure", "-o", f"{folder}/{layer}.wav"], check=True,
                           capture_output=True)
            sounds[layer] = Stroke(read(f"{folder}/{layer}.wav"), seconds)
    return {**sounds, "one": sounds["loud"]}


def decays(sound):
    """T60 by octave [s], by backward integration without the noise of the last 50 ms, from -5 to -25 dB."""
    times = []
    for octave in OCTAVES:
        y = sosfilt(butter(3, [octave / 2 ** 0.5, min(octave * 2 ** 0.5, 20000)], "band", fs=RATE, output="sos"), sound)
        energy = np.cumsum((y ** 2)[::-1])[::-1] - np.mean(y[-int(0.05 * RATE):] ** 2) * np.arange(len(y), 0, -1) * 0.9
        level = 10 * np.log10(np.maximum(energy / energy[0], 1e-9))
        times.append(3 * (np.argmax(level < -25) - np.argmax(level < -5)) / RATE)
    return np.maximum(times, 1e-3)


def pitch(sound, at, begin_s):
    part = sound[int(begin_s * RATE):int(begin_s * RATE) + 4096]
    power = np.abs(np.fft.rfft(part * np.hanning(len(part)), 1 << 17)) ** 2
    f = np.fft.rfftfreq(1 << 17, 1 / RATE)
    near = (f > 0.85 * at) & (f < 1.25 * at)
    return f[near][np.argmax(power[near])]


class Stroke:
    def __init__(self, sound, seconds):
        sound = from_onset(sound)
        spectrum = np.abs(np.fft.rfft(sound[:int(0.6 * RATE)], RATE)) ** 2
        f = np.fft.rfftfreq(RATE, 1 / RATE)
        self.loudness = 10 * np.log10((spectrum * 10 ** (a_weighting(f) / 10)).sum())
        self.mel = 10 * np.log10(mel(sound, min(seconds, len(sound) / RATE), TOP) + 1e-30)
        self.sound, self.cut = sound, {}
        at = np.argmax(np.where((f > 40) & (f < 1500), spectrum, 0))
        self.glide = 1200 * np.log2(pitch(sound, f[at], 0.005) / pitch(sound, f[at], 0.2))
        later = sound[int(0.05 * RATE):int(0.35 * RATE)]
        power, f = np.abs(np.fft.rfft(later)) ** 2, np.fft.rfftfreq(len(later), 1 / RATE)
        self.bands = np.array([10 * np.log10(power[(f >= o / 2 ** 0.5) & (f < o * 2 ** 0.5)].sum() / power[f > 30].sum() + 1e-12)
                               for o in OCTAVES])
        begin = sound[:int(0.015 * RATE)]
        power, f = np.abs(np.fft.rfft(begin * np.hanning(len(begin)), RATE)) ** 2, np.fft.rfftfreq(RATE, 1 / RATE)
        self.click = 10 * np.log10(power[(f >= 8000 / 2 ** 0.5) & (f < 8000 * 2 ** 0.5)].sum() / power.sum() + 1e-12)

    def distance(self, other):
        """Of log-mel spectrograms; other is the recording [dB]."""
        n, floor = min(len(self.mel), len(other.mel)), other.mel.max() - 60
        ours = self.mel[:n] - self.loudness + other.loudness
        return np.abs(np.maximum(ours, floor) - np.maximum(other.mel[:n], floor)).mean()

    def t60(self, length):
        """Of the sound cut to this length [s]: where a recording ends early, its decays look shorter."""
        length = min(length, len(self.sound))
        if length not in self.cut:
            self.cut[length] = decays(self.sound[:length])
        return self.cut[length]

    def t60_apart(self, other):
        length = min(len(self.sound), len(other.sound))
        return np.abs(np.log2(self.t60(length) / other.t60(length)))

    def apart(self, other, weights):
        """What a fit makes small."""
        return (self.distance(other) + weights["t60"] * np.minimum(self.t60_apart(other), 2).mean() + BANDS * np.abs(self.bands - other.bands).mean()
                + weights["glide"] * abs(self.glide - other.glide))


def strokes(folder, seconds):
    return {at: Stroke(sound, seconds) for at, sound in recorded(folder).items()}


def fit(program, kind, folder, path):
    drum = DRUMS[kind]
    theirs = strokes(folder, drum["seconds"])
    drums = sorted({source for source, _ in theirs})
    names, ranges = list(drum["fitted"]), np.log(list(drum["fitted"].values()))

    least = [math.inf]

    def file_of(x):
        return drum["of"](dict(zip(names, np.exp(np.clip(x, ranges[:, 0], ranges[:, 1])))))

    def error(x):
        try:
            ours = rendered(program, file_of(x), drum["seconds"])
        except subprocess.CalledProcessError as failed:
            print(failed.stderr)
            return 1e3
        found = np.mean([np.mean([ours[layer].apart(stroke, drum["weights"]) for (source, layer), stroke in theirs.items() if source == of]) for of in drums])
        if found < least[0]:
            least[0] = found
            print(f"{found:.3f}", dict(zip(names, np.exp(x).round(7))), flush=True)
        return found

    begin = np.log([drum["begin"][name] for name in names])
    best = minimize(error, begin, method="Nelder-Mead", options={"maxfev": drum["steps"], "adaptive": True, "initial_simplex": np.vstack(
        [begin] + [begin + 0.1 * (ranges[i, 1] - ranges[i, 0]) * np.eye(len(names))[i] for i in range(len(names))])})
    print(f"from {error(begin):.3f} to {best.fun:.3f}")
    Path(path).write_text(drum["about"] + HEADER.format(fitted=drum["names"]) + text_of(file_of(best.x)), encoding="utf-8")


def shown(name, pairs):
    """pairs: of lists of pairs of strokes, ours first, a list for each pair of drums."""
    rows = [[np.mean([a.distance(b) for a, b in drum]), 2 ** np.median([a.t60_apart(b) for a, b in drum])] for drum in pairs]
    print(f"{name}: log-mel {np.median(rows, 0)[0]:.2f} dB, T60 by octave x {np.median(rows, 0)[1]:.2f}, {len(rows)} pairs of drums")


def distance(program, path, *folders):
    kind = json.loads("\n".join(line for line in Path(path).read_text(encoding="utf-8").splitlines() if not line.startswith("//")))["name"]
    seconds = DRUMS[kind]["seconds"]
    ours = rendered(program, path, seconds)
    for layer in ("soft", "loud"):
        print(f"ours, {layer}: falls by {ours[layer].glide:.0f} cents; T60 [s] {ours[layer].t60(RATE).round(2)}; octaves [dB] {ours[layer].bands.round()}, "
              f"8 kHz of the first 15 ms {ours[layer].click:.0f} dB")
    for name, folder in zip(("fitted", "kept"), folders):
        theirs = strokes(folder, seconds)
        drums = sorted({source for source, _ in theirs})
        shown(name, [[(ours[layer], stroke) for (source, layer), stroke in theirs.items() if source == drum] for drum in drums])
        shown(f"{name}, from each other", [[(theirs[a, la], theirs[b, lb]) for la in ours for lb in ours
                                           if (a, la) in theirs and (b, lb) in theirs and (la == lb or "one" in (la, lb))]
                                          for i, a in enumerate(drums) for b in drums[i + 1:]])
        for layer in ours:
            glides = [stroke.glide for (_, at), stroke in theirs.items() if at == layer]
            if glides:
                print(f"{name}, {layer}: fall by {min(glides):.0f} to {max(glides):.0f} cents, 8 kHz {min(s.bands[6] for (_, at), s in theirs.items() if at == layer):.0f} "
                      f"to {max(s.bands[6] for (_, at), s in theirs.items() if at == layer):.0f} dB")


if __name__ == "__main__":
    if len(sys.argv) == 6 and sys.argv[1] == "fit" and sys.argv[3] in DRUMS:
        fit(*sys.argv[2:])
    elif len(sys.argv) == 6 and sys.argv[1] == "distance":
        distance(*sys.argv[2:])
    else:
        sys.exit(__doc__)
