#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes the files of bowed instruments, with a body that is fitted to recorded notes.

    make.py fit PROGRAM violin|cello RECORDINGS FILE
    make.py distance PROGRAM FILE RECORDINGS

PROGRAM is contactspline. RECORDINGS holds SOURCE/KEY.wav, notes that are held, by the key of MIDI. `fit` writes FILE:

1. strings: impedances and tensions of INSTRUMENTS below; losses of equal quality on all strings; torsion with 2.5 times the
   impedance and 5.5 times the frequencies, at each key, quality 30; a bow of POINTS over HAIR_M, 0.12 of the length from the bridge, with a force
   over speed of 4.8 to 12 times the impedance: the lower half of the range, in dB, over which bench/bowing found Helmholtz motion on
   the violin's D string with assumed losses;
2. body: the low modes of INSTRUMENTS, and above them modes at equal ratios of frequency, `spacing`, with the factor `loss`.
   They are those of a plate whose single resonances nobody hears: on the violin, each as wide as it is far from the next. Their
   masses give each the `admittance` at its resonance, and both instruments the same mean;
3. what the body radiates, `wood`: the shapes of these modes with which the levels of partials up to TOP Hz are those of the
   recordings, where the force on the bridge is that of PROGRAM. Least is the sum of squares of the differences in dB of each
   note from its median, robustly (soft L1 beyond 3 dB), of PULL times each mode's level in dB less the mean of its neighbours', and
   of `even` times how far the loudness of all keys, in dB(A) less the mean, is from a line as steep as that of the recordings.
   Every second note of each source is kept from the fit.

`distance` prints the median and the 90 % limit of the differences of partials 1 to 15 below 10 kHz from each note's median,
for notes that were fitted and for those that were kept, and between the recordings themselves. It needs Debian's
python3-numpy and python3-scipy.
"""
import json
import math
import os
import re
import subprocess
import sys
import tempfile

import numpy as np
from scipy.optimize import least_squares

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from notes import RATE, a_weighting, read, recorded, rounded, text_of  # noqa: E402

BOW, POINTS, HAIR_M = 0.12, 4, 0.01
ABOVE = 15  # semitones from the highest string up, over which keys tune it
TOP, PULL, TRIALS = 12000, 0.3, 6
INSTRUMENTS = {
    # strings: name, open key, tension [N], bending stiffness [N m^2]. low: frequency [Hz], decay [1/s], mass [kg].
    "violin": {
        "description": "four strings of a violin under a bow", "length_m": 0.325, "behind_m": 0.012,
        "strings": [("g", 55, 46, 6e-5), ("d", 62, 47.7198, 5e-5), ("a", 69, 55, 3e-5), ("e", 76, 76, 4.5e-5)],
        "low": [(275, 29, 0.6), (405, 30, 0.5), (455, 35, 0.2), (540, 42, 0.15)],
        "from_hz": 600, "spacing": 1.06, "loss": 0.06, "admittance": 0.005, "even": 3, "force_n": 0.5, "full_scale": 0.01, "about": """\
// A violin under four points of hair of a rigid bow. The D string has the impedance of a steel D string, 0.25 kg/s (Schoonderwaldt,
// Guettler and Askenfelt, Acta Acustica united with Acustica 94, 2008); the tensions of the others are typical ones. Lowest modes of
// the body about A0, CBR, B1- and B1+.
"""},
    "cello": {
        "description": "four strings of a cello under a bow", "length_m": 0.69, "behind_m": 0.025,
        "strings": [("c", 36, 132, 5e-4), ("g", 43, 134, 4e-4), ("d", 50, 111, 3e-4), ("a", 57, 160, 3e-4)],
        "low": [(60, 10, 3), (102, 13, 2), (145, 16, 1.5), (175, 20, 1.1), (197, 22, 1.1), (240, 25, 1.2), (300, 28, 1)],
        "from_hz": 350, "spacing": 1.12, "loss": 0.04, "admittance": 0.015, "even": 1.5, "force_n": 1, "full_scale": 0.02, "about": """\
// A cello under four points of hair of a rigid bow. The D string has the tension and the stiffness of Mansour, Woodhouse and Scavone
// (Acta Acustica united with Acustica 102, 2016); those of the others are typical ones. Lowest modes of the body about A0, CBR, B1-
// and B1+. Its `wood` is fitted to keys about as loud as their neighbours, too.
"""}}
HEADER = """\
// Written by bench/bowed/make.py, which says how: the shapes of `wood` are fitted to recorded notes of FluidR3 GM (MIT) and of
// tonejs-instruments (CC BY 3.0). Losses of the strings, torsion and the mobility of the body are assumed, not measured.
"""


def hz(key):
    return 440 * 2 ** ((key - 69) / 12)


def modes(rows):
    return [{"frequency_hz": rounded(f), "decay_per_s": rounded(s, 4), "mass_kg": rounded(m, 4)} for f, s, m in rows]


def body_of(kind):
    """Rows of frequency, decay and mass."""
    instrument = INSTRUMENTS[kind]
    rows = list(instrument["low"])
    f = instrument["from_hz"]
    while f < TOP:
        decay = math.pi * f * instrument["loss"]
        rows.append((f, decay, 1 / (2 * decay * instrument["admittance"])))
        f *= instrument["spacing"]
    return rows


def string_parts(instrument, name, key, tension_n, stiffness):
    """Bodies and places of a string."""
    length, whole, f = instrument["length_m"], instrument["length_m"] + instrument["behind_m"], hz(key)
    per_m = tension_n / (2 * length * f) ** 2
    count = min(16, int(21000 / (5.5 * f)))
    string = {"length_m": whole, "mass_kg": rounded(per_m * whole), "tension_n": tension_n, "bending_stiffness_n_m2": stiffness,
              "constant_loss_per_s": rounded(1.5 * f / 293.66, 3),
              "quadratic_loss_m2_per_s": rounded(0.0025 * f / 293.66 * (length / 0.325) ** 2, 3)}
    torsion = [(5.5 * f * n, math.pi * 5.5 * f * n / 30, 2.5 / 5.5 * per_m * length / 2) for n in range(1, count + 1)]
    shapes = [rounded(math.sin(math.pi * n * BOW)) for n in range(1, count + 1)]
    bodies = [{"name": name, "string": string, "max_modes": min(70, int(21000 / f))},
              {"name": f"{name}_torsion", "modes": modes(torsion)}]
    middle = rounded(length * (1 - BOW), 4)
    hair = [rounded(middle + ((point + 0.5) / POINTS - 0.5) * HAIR_M) for point in range(POINTS)]
    places = [{"name": f"{name}_bowed", "body": name, "positions_m": hair},
              {"name": f"{name}_over_bridge", "body": name, "position_m": length},
              {"name": f"{name}_surface", "body": f"{name}_torsion", "shapes": shapes}]
    return bodies, places, math.sqrt(tension_n * per_m)


def instrument_of(kind, wood):
    """The file, as a dict. wood: shapes."""
    instrument, box = INSTRUMENTS[kind], body_of(kind)
    names = [string[0] for string in instrument["strings"]]
    length = instrument["length_m"]
    file = {"name": kind, "description": instrument["description"], "bodies": [], "places": [],
            "links": [{"name": f"{name}_foot", "between": [f"{name}_over_bridge", "bridge"]} for name in names],
            "frictions": [{"name": f"on_{name}", "between": [f"{name}_surface", f"{name}_bowed"], "material": "rosin"} for name in names],
            "bows": [],
            "controls": [
                {"name": "bow", "normal_force_n": [f"on_{name}" for name in names], "initial": instrument["force_n"],
                 "max": 10 * instrument["force_n"], "controller": "pressure"},
                {"name": "bow", "surface_speed_m_per_s": [f"on_{name}" for name in names], "initial": 0.2, "min": 0, "max": 1, "controller": 2},
                {"name": "bow", "place_m": [f"{name}_bowed" for name in names], "min": rounded(0.6 * length), "max": rounded(0.97 * length)},
                {"name": "hand", "damping_per_s": names, "max": 500}],
            "outputs": [{"name": "wood", "velocity_m_per_s": "wood", "full_scale": instrument["full_scale"]},
                        {"name": "bridge", "force_n": [f"{name}_foot" for name in names], "full_scale": 6 * instrument["force_n"]}],
            "input": {"force_n": "bridge", "full_scale": rounded(6 * instrument["force_n"])},
            "keys": [], "polyphony": 1, "damper": {"bodies": names, "damping_per_s": 15},
            "presets": [{"name": "bowed"},
                        {"name": "near the bridge", "bow_normal_force_n": 2 * instrument["force_n"], "bow_place_m": rounded(0.925 * length)},
                        {"name": "over the fingerboard", "bow_normal_force_n": 0.6 * instrument["force_n"], "bow_place_m": rounded(0.815 * length)}]}
    for index, (name, key, tension_n, stiffness) in enumerate(instrument["strings"]):
        bodies, places, impedance = string_parts(instrument, name, key, tension_n, stiffness)
        file["bodies"] += bodies
        file["places"] += places
        file["bows"].append({"friction": f"on_{name}", "min_n_s_per_m": rounded(4.8 * impedance, 3), "max_n_s_per_m": rounded(12 * impedance, 3)})
        last = instrument["strings"][index + 1][1] - 1 if index < 3 else key + ABOVE
        file["keys"].append({"first": key, "last": last, "event": f"bow_on_{name}", "tuned_key": key, "bodies": [name, f"{name}_torsion"]})
    file["bodies"].append({"name": "box", "modes": modes(box)})
    file["places"] += [{"name": "bridge", "body": "box", "shapes": [1] * len(box)}, {"name": "wood", "body": "box", "shapes": wood}]
    return file


def written(kind, file):
    """The text of a file."""
    return INSTRUMENTS[kind]["about"] + HEADER + text_of(file)


def held(folder):
    """Recorded sounds by source and key."""
    return {(source, int(note)): sound for (source, note), sound in recorded(folder).items()}


def rendered(program, file, keys, signal):
    """0.65 s of each key, half a second after it has begun."""
    with tempfile.TemporaryDirectory() as folder:
        score = {"instrument": os.path.abspath(file), "duration_s": 1.4 * len(keys) + 0.2,
                 "events": [{"time_s": 0.05 + 1.4 * i, "key": key, "velocity": 0.8, "hold_s": 1.2} for i, key in enumerate(keys)]}
        with open(f"{folder}/score.json", "w", encoding="utf-8") as out:
            json.dump(score, out)
        subprocess.run([program, "render", f"{folder}/score.json", "--signal", signal, "-o", f"{folder}/notes.wav"], check=True,
                       stdout=subprocess.DEVNULL)
        sound = read(f"{folder}/notes.wav")
    return {key: sound[int((0.55 + 1.4 * i) * RATE):int((1.2 + 1.4 * i) * RATE)] for i, key in enumerate(keys)}


def levels(sound, key):
    """Frequencies [Hz] and levels [dB] of the partials of a note, which may have a vibrato of 3 %."""
    power = np.abs(np.fft.rfft(sound * np.hanning(len(sound)), 4 * len(sound))) ** 2
    f = np.fft.rfftfreq(4 * len(sound), 1 / RATE)
    pitches = hz(key) * 2 ** (np.arange(-60, 61, 2) / 1200)
    pitch = max(pitches, key=lambda p: sum(np.interp(p * n, f, power) for n in range(1, 7)))
    partials = pitch * np.arange(1, min(60, int(TOP / pitch)) + 1)
    widths = np.minimum(0.03 * partials, 0.45 * pitch)
    return partials, np.array([10 * np.log10(power[np.abs(f - p) < w].sum() + 1e-20) for p, w in zip(partials, widths)])


def radiated(modes_of, levels_of, f):
    """Magnitude of velocity over force. levels_of: of each mode at its resonance."""
    w = 2 * np.pi * f[:, None]
    rows = np.array(modes_of)
    w0, decay = 2 * np.pi * rows[:, 0], rows[:, 1]
    return np.abs((levels_of * 2j * decay * w / (w0 ** 2 + decay ** 2 - w ** 2 + 2j * decay * w)).sum(1))


def loudness(f, level):
    """Of partials [dB(A)]."""
    return 10 * np.log10((10 ** ((level + a_weighting(f)) / 10)).sum())


def steepness(sounds):
    """Of the loudness of recorded notes [dB(A) a key], the mean of the sources."""
    notes = {at: loudness(*levels(sound, at[1])) for at, sound in sounds.items()}
    return np.mean([np.polyfit(*zip(*[(key, level) for (s, key), level in notes.items() if s == source]), 1)[0] for source in {source for source, _ in notes}])


def fit_wood(kind, sounds, forces):
    """Shapes of the modes with which the body radiates. forces: on the bridge, of all keys."""
    partials = {key: levels(force, key) for key, force in forces.items()}
    keys, rise = np.array(list(partials)), steepness(sounds)
    rows = []
    for source in sorted({source for source, _ in sounds}):
        for key in sorted(key for s, key in sounds if s == source)[::2]:
            f, level = levels(sounds[source, key], key)
            _, force = partials[key]
            n = min(len(level), len(force))
            heard = force[:n] > force.max() - 45
            rows.append((f[:n][heard], level[:n][heard] - force[:n][heard]))
    box = body_of(kind)

    def errors(x):
        result = []
        for f, difference in rows:
            error = difference - 20 * np.log10(radiated(box, x, f) + 1e-9)
            result.append((error - np.median(error)) * math.sqrt(8 / len(error)))
        louder = np.array([loudness(f, force + 20 * np.log10(radiated(box, x, f) + 1e-9)) for f, force in partials.values()]) - rise * keys
        result.append(INSTRUMENTS[kind]["even"] * (louder - louder.mean()))
        level = 20 * np.log10(np.abs(x) + 1e-3)
        padded = np.concatenate([level[:1], level, level[-1:]])
        return np.concatenate(result + [PULL * (level - np.convolve(padded, [0.25, 0.5, 0.25], "valid"))])

    random = np.random.default_rng(1)
    begins = [random.choice([-1, 1], len(box)) * random.uniform(0.3, 1, len(box)) for _ in range(TRIALS)]
    best = min((least_squares(errors, x, loss="soft_l1", f_scale=3, max_nfev=60) for x in begins), key=lambda s: s.cost)
    shapes = best.x * [2 * decay * mass for _, decay, mass in box]
    return [rounded(x, 4) for x in shapes / np.abs(shapes).max()]


def write(kind, wood, path):
    with open(path, "w", encoding="utf-8") as out:
        out.write(written(kind, instrument_of(kind, wood)))


def fit(program, kind, folder, path):
    keys = [(row[1], row[1]) for row in INSTRUMENTS[kind]["strings"]]
    lowest, highest = keys[0][0], keys[-1][0] + ABOVE
    sounds = {at: sound for at, sound in held(folder).items() if lowest <= at[1] <= highest}
    write(kind, [1] * len(body_of(kind)), path)
    forces = rendered(program, path, list(range(lowest, highest + 1)), "bridge")
    write(kind, fit_wood(kind, sounds, forces), path)


def apart(a, b):
    n = min(15, len(a[1]), len(b[1]), int(10000 / a[0][0]))
    error = a[1][:n] - b[1][:n]
    return list(np.abs(error - np.median(error)))


def distance(program, path, folder):
    with open(path, encoding="utf-8") as file:
        keys = json.loads(re.sub(r"^//.*$", "", file.read(), flags=re.M))["keys"]
    sounds = {at: sound for at, sound in held(folder).items() if keys[0]["first"] <= at[1] <= keys[-1]["last"]}
    ours = {key: levels(sound, key) for key, sound in rendered(program, path, sorted({k for _, k in sounds}), "wood").items()}
    theirs = {at: levels(sound, at[1]) for at, sound in sounds.items()}
    sources = sorted({source for source, _ in sounds})
    columns = {"fitted": [], "kept": [], "recordings": []}
    for source in sources:
        for index, key in enumerate(sorted(key for s, key in sounds if s == source)):
            columns["kept" if index % 2 else "fitted"] += apart(ours[key], theirs[source, key])
    for (source, key), level in theirs.items():
        near = [k for s, k in theirs if s == sources[-1] and abs(k - key) <= 1]
        if source == sources[0] and near:
            columns["recordings"] += apart(level, theirs[sources[-1], min(near, key=lambda k: abs(k - key))])
    for name, values in columns.items():
        print(f"{name}: median {np.median(values):.1f} dB, 90 % {np.percentile(values, 90):.1f} dB, {len(values)} partials")


if __name__ == "__main__":
    if len(sys.argv) == 6 and sys.argv[1] == "fit" and sys.argv[3] in INSTRUMENTS:
        fit(*sys.argv[2:])
    elif len(sys.argv) == 5 and sys.argv[1] == "distance":
        distance(*sys.argv[2:])
    else:
        sys.exit(__doc__)
