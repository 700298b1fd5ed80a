#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes the files of marimba and kalimba, with parts that are fitted to recorded notes.

    make.py write marimba|kalimba FILE
    make.py fit PROGRAM marimba|kalimba RECORDINGS      # prints numbers, which stand below

PROGRAM is contactspline. RECORDINGS/KEY.wav are notes of FluidR3 GM (fluid-soundfont-gm, MIT) at 44.1 kHz, under their keys of
MIDI: of its Marimba C3, C4, C5 and C6, of its Kalimba F4, A4 and F5. `fit` searches by least squares from the numbers below: small are
made, for each note,

    differences of log-mel spectrograms: 48 bands from 60 Hz to 12 kHz, each note of the same A-weighted loudness, down to 60 dB
        below the recording's largest value, means over 46 ms
    of the marimba, differences of the level of the lowest partial, each 10 ms, up to 0.4 s

Kept: F#4 and F#5 of Marimba, whose notes are one at several speeds, C4 of 19-marimba of scratch-vm (npm); C6 of Kalimba.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.signal import fftconvolve

sys.path.insert(0, str(Path(__file__).parents[1]))
from notes import RATE, a_weighting, from_onset, mel, read, rounded, text_of

MARIMBA = """\
// Marimba of C3 to C6: six bars, each with its tube and its mallet, of which keys tune one to half an octave. Bars as usual, 0.33 m and
// 0.33 kg at C4; of an octave higher 0.79 times as long and 0.67 times as heavy. An arch over 0.73 of the length, which leaves 0.34 of the
// thickness in the middle, puts the overtones at 4.04 and 9.56; the bending stiffness gives the pitch, with the spring of the air. The air
// of a tube, 48 mm wide at C4 and 0.71 times that an octave higher, is a table of modes: (2 n - 1) times the frequency that the spring of
// the air raises to that of the bar, modal mass rho S L/2, times 64, because its displacement here is that of a piston of 8 S, the bar over
// the mouth; the decay of the first, 30 1/s at C4 and as the frequency, makes notes peak when recorded ones do, after 120 to 30 ms; that of
// the second is by radiation, c (k a)^2/(4 L), and by friction at the wall, c 1.2e-5 sqrt(omega)/a.
// Written by bench/bars/make.py: losses of the bars, springs of air, where bars are heard and the heads' weights are fitted to recorded
// notes of FluidR3 GM (MIT).
"""
KALIMBA = """\
// Kalimba of C4 to E6: five tines on a box, of which keys tune one to half an octave. A tine is a strip of spring steel, 4 x 0.8 mm with
// 200 GPa and 7850 kg/m^3, clamped 23.6 mm behind the bridge, which is a link to the box; its length gives the pitch. Because a tine
// bends behind its bridge, too, the first overtone is at 6.72 for A4, 5.03 for D6; that of a bar clamped at the bridge at 6.27.
// Recorded are 6.75 for A4 and 5.19 for C6. The box is 0.53 l with a hole of 28 mm: the air in it is a mass, rho S (4 mm + 1.7 a), times
// (A/S)^2, A = 0.009 m^2 of the lid, on the spring rho c^2 A^2/V. The frequencies of its modes are peaks between the partials of recorded
// notes; that modes are heard as frequency^0.6 puts the overtone of A4 27 dB below its fundamental, 29 as recorded.
// Written by bench/bars/make.py: the losses of three tines and how loud the lid is beside the air are fitted to recorded notes of
// FluidR3 GM (MIT).
"""
C, RHO = 343, 1.2
PRIOR = 0.5  # how much an e-fold from where a search begins counts beside a decibel
WIDER = 8  # the bar's surface over the mouth
BARS = {"ds3": (48, 53), "a3": (54, 59), "ds4": (60, 65), "a4": (66, 71), "ds5": (72, 77), "a5": (78, 84)}  # keys
SHARP = {"ds3": 7, "a3": 5.2, "ds4": 4.3, "a4": 2.8, "ds5": 1.9, "a5": 1}  # cents, as rendered: the air is a spring under the bar
NOTES = {"ds3": 48, "ds4": 60, "ds5": 72, "a5": 84}  # that are fitted
NUMBERS = ["constant", "quadratic", "air", "heard", "weight"]
# Where searches ended; then constant and air of a5 were changed: at the middle of its keys it had sounded 0.6 s.
FITTED = {"ds3": [0.848, 0.0262, 649, 0.312, 28.2], "ds4": [0.101, 0.0202, 1100, 0.281, 53],
          "ds5": [1.17, 0.0122, 1360, 0.221, 138], "a5": [3.9, 0.00921, 1600, 0.253, 110]}


def middle(name):
    first, last = BARS[name]
    return (first + last + 1) // 2


def numbers_of(name):
    """By the key's place between the bars that are fitted."""
    keys = [middle(of) for of in FITTED]
    return {n: rounded(np.exp(np.interp(middle(name), keys, np.log([of[i] for of in FITTED.values()]))), 3) for i, n in enumerate(NUMBERS)}


def marimba(fitted=None):
    """fitted: numbers of one bar, which is alone then."""
    bars = list(fitted or BARS)
    file = {"name": "marimba", "description": "marimba of three octaves", "bodies": [], "places": [], "contacts": [], "springs": [], "controls": [], "strikes": [],
            "outputs": [], "input": {"force_n": f"struck_{bars[len(bars) // 3]}"}, "keys": []}
    for name in bars:
        (first, last), key, p = BARS[name], middle(name), dict(zip(NUMBERS, fitted[name])) if fitted else numbers_of(name)
        octaves = (key - 60) / 12
        f = 440 * 2 ** ((key - 69) / 12)
        length, mass = rounded(0.33 * 2 ** (-0.345 * octaves), 4), rounded(0.33 * 2 ** (-0.57 * octaves), 4)
        a = 0.024 * 2 ** (-octaves / 2)
        tube_mass = RHO * np.pi * a * a * C / (4 * f) / 2 * WIDER ** 2
        w = np.sqrt((2 * np.pi * f) ** 2 - p["air"] / tube_mass)
        tube = []
        for n in (1, 3):
            w_n = n * w
            decay = C * (w_n * a / C) ** 2 * (f / C) + C * 1.2e-5 * np.sqrt(w_n) / a
            tube.append({"frequency_hz": rounded(w_n / (2 * np.pi)), "decay_per_s": rounded(30 * f / 262 if n == 1 else decay, 3), "mass_kg": rounded(tube_mass)})
        at = {n: rounded(part * length, 4) for n, part in (("struck", 0.4), ("over_mouth", 0.5), ("heard", p["heard"]))}
        file["bodies"] += [
            {"name": f"bar_{name}", "bar": {"length_m": length, "mass_kg": mass,
                                            "bending_stiffness_n_m2": rounded(608.128 * (f / 261.626 / 2 ** (SHARP[name] / 1200)) ** 2 * mass / 0.33 * (length / 0.33) ** 3, 6),
                                            "constant_loss_per_s": p["constant"], "quadratic_loss_m2_per_s": p["quadratic"],
                                            "undercut": {"length_m": rounded(0.24 / 0.33 * length, 4), "thickness_ratio": 0.34}}, "max_modes": 4},
            {"name": f"tube_{name}", "modes": tube}, {"name": f"mallet_{name}", "mass_kg": 0.02}]
        file["places"] += [{"name": f"struck_{name}", "body": f"bar_{name}", "position_m": at["struck"]},
                           {"name": f"over_mouth_{name}", "body": f"bar_{name}", "position_m": at["over_mouth"]},
                           {"name": f"heard_{name}", "body": f"bar_{name}", "position_m": at["heard"]},
                           {"name": f"mouth_{name}", "body": f"tube_{name}", "shapes": [1, 1]},
                           {"name": f"opening_{name}", "body": f"tube_{name}", "shapes": [WIDER, WIDER]}]
        file["contacts"].append({"name": f"head_{name}", "between": [f"mallet_{name}", f"struck_{name}"], "material": "felt_c4", "weight": p["weight"], "gap_m": 0.005})
        file["springs"].append({"name": f"air_{name}", "between": [f"over_mouth_{name}", f"mouth_{name}"], "stiffness_n_per_m": p["air"]})
        file["keys"].append({"first": first, "last": last, "event": f"strike_mallet_{name}", "tuned_key": key, "bodies": [f"bar_{name}", f"tube_{name}"]})
    every = lambda part: [f"{part}_{name}" for name in bars]
    file["controls"] = [{"name": "tubes", "damping_per_s": every("tube"), "max": 1e4},
                        {"name": "head", "stiffness_ratio": every("head"), "min": 0.01, "max": 100}, {"name": "hand", "damping_per_s": every("bar"), "max": 1000}]
    file["strikes"] = every("mallet")
    file["outputs"] = [{"name": "both", "velocity_m_per_s": every("opening") + every("heard"), "full_scale": 10}, {"name": "bars", "velocity_m_per_s": every("heard"), "full_scale": 1.5}]
    return file


# The kalimba: a strip of spring steel, 4 x 0.8 mm with 200 GPa and 7850 kg/m^3, is clamped 23.6 mm behind the bridge.
# Keys, and cents, as rendered: the modes that are left out would make the bridge stiffer.
TINES = {"ds4": (60, 65, 0.5), "a4": (66, 71, 0.5), "ds5": (72, 77, 1.2), "a5": (78, 83, 2.5), "d6": (84, 88, 2.5)}
EI, MU, BEHIND, MODES = 0.034133, 0.02512, 0.0236, 8
BOX = [500, 840, 1060, 1235, 1540, 1930, 2600, 3490, 4700]  # Hz: peaks between the partials of the recordings
TINE = {"ds4": 9.85, "a4": 1.81, "ds5": 2.25, "heard": 18.7}  # fitted
ROOTS = np.array([brentq(lambda z: np.cos(z) + 1 / np.cosh(z), n * np.pi, (n + 1) * np.pi) for n in range(MODES)])


def partials(length):
    """Of a bar clamped at one end that rests on the bridge [Hz]: of its modes, where none moves there."""
    z, s = ROOTS * BEHIND / length, (np.cosh(ROOTS) + np.cos(ROOTS)) / (np.sinh(ROOTS) + np.sin(ROOTS))
    squares = (np.cosh(z) - np.cos(z) - s * (np.sinh(z) - np.sin(z))) ** 2
    w = (ROOTS / length) ** 2 * np.sqrt(EI / MU)
    return [brentq(lambda x: (squares / (w ** 2 - x ** 2)).sum(), a * (1 + 1e-9), b * (1 - 1e-9)) / (2 * np.pi) for a, b in zip(w, w[1:])]


def kalimba(p=TINE):
    bodies, places, links, controls, keys = [], [], [], [], []
    for name, (first, last, sharp) in TINES.items():
        key = (first + last + 1) // 2
        length = rounded(brentq(lambda l: partials(l)[0] - 440 * 2 ** ((key - 69 - sharp / 100) / 12), 1.2 * BEHIND, 0.2))
        bodies.append({"name": f"tine_{name}", "bar": {"length_m": length, "mass_kg": rounded(MU * length), "bending_stiffness_n_m2": EI, "ends": ["clamped", "free"],
                                                       "constant_loss_per_s": p.get(name, p["ds5"]), "quadratic_loss_m2_per_s": 0.002}, "max_modes": MODES})
        places += [{"name": f"tip_{name}", "body": f"tine_{name}", "position_m": length}, {"name": f"over_bridge_{name}", "body": f"tine_{name}", "position_m": BEHIND}]
        links.append({"name": f"bridge_{name}", "between": [f"over_bridge_{name}", "bridge"]})
        controls.append({"name": f"thumb_{name}", "force_n": f"tip_{name}", "min": -20, "max": 20, "release_n": 3})
        keys.append({"first": first, "last": last, "event": f"pluck_thumb_{name}", "tuned_key": key, "bodies": f"tine_{name}"})
    bodies += [{"name": "box", "modes": [{"frequency_hz": f, "decay_per_s": rounded(np.pi * f / 12, 3), "mass_kg": 0.1} for f in BOX]}, {"name": "air", "mass_kg": 0.00438}]
    places += [{"name": "bridge", "body": "box", "shapes": [0.1] * len(BOX)}, {"name": "inwards", "body": "box", "shapes": [-1] + [0] * (len(BOX) - 1)},
               {"name": "heard", "body": "box", "shapes": [rounded((-1) ** n * p["heard"] * (f / 1000) ** 0.6, 3) for n, f in enumerate(BOX)]}]
    return {"name": "kalimba", "description": "kalimba, tines on a box", "bodies": bodies, "places": places,
            "springs": [{"name": "cavity", "between": ["inwards", "air"], "stiffness_n_per_m": 21580}, {"name": "hole", "between": ["air", "ground"], "resistance_n_s_per_m": 2}],
            "links": links, "controls": controls + [{"name": "hand", "damping_per_s": [f"tine_{name}" for name in TINES], "max": 1000}],
            "outputs": [{"name": "box", "velocity_m_per_s": ["heard", "air"], "full_scale": 0.5}, {"name": "bridge", "force_n": [f"bridge_{name}" for name in TINES], "full_scale": 30}],
            "input": {"force_n": "bridge", "full_scale": 10}, "keys": keys}


class Note:
    def __init__(self, sound, key, seconds):
        sound = from_onset(sound)
        sound = np.pad(sound, (0, max(0, int(seconds * RATE) - len(sound))))
        f = np.fft.rfftfreq(RATE, 1 / RATE)
        self.loudness = 10 * np.log10((np.abs(np.fft.rfft(sound[:int(0.6 * RATE)], RATE)) ** 2 * 10 ** (a_weighting(f) / 10)).sum())
        hz = 440 * 2 ** ((key - 69) / 12)
        window = np.hanning(int(4 / hz * RATE))
        rise = np.abs(fftconvolve(sound * np.exp(-2j * np.pi * hz * np.arange(len(sound)) / RATE), window, "same"))[:int(0.4 * RATE):441]
        self.rise = np.maximum(20 * np.log10(rise / rise.max() + 1e-30), -30)  # of the lowest partial, each 10 ms [dB]
        power = mel(sound, seconds, 12000)
        n = len(power) // 4 * 4
        self.mel = 10 * np.log10(power[:n].reshape(n // 4, 4, -1).mean(1) + 1e-30)

    def differences(self, recording):
        """Of log-mel spectrograms of the same loudness, down to 60 dB below the recording's largest value [dB]."""
        floor = recording.mel.max() - 60
        return np.maximum(self.mel - self.loudness + recording.loudness, floor) - np.maximum(recording.mel, floor)


def rendered(program, file, key, seconds):
    with tempfile.TemporaryDirectory() as folder:
        Path(f"{folder}/file.json").write_text(text_of(file), encoding="utf-8")
        score = {"instrument": "file.json", "duration_s": seconds + 0.1, "events": [{"time_s": 0.05, "key": key, "velocity": 0.5}]}
        Path(f"{folder}/score.json").write_text(json.dumps(score), encoding="utf-8")
        subprocess.run([program, "render", f"{folder}/score.json", "--no-figure", "-o", f"{folder}/note.wav"], check=True, capture_output=True)
        return Note(read(f"{folder}/note.wav"), key, seconds)


def searched(usual, residuals):
    """By ratios."""
    return np.exp(least_squares(lambda x: np.concatenate([*residuals(np.exp(x)), PRIOR * (x - np.log(usual))]), np.log(usual), diff_step=0.02, max_nfev=8).x)


def fit_marimba(program, recordings):
    for name, key in NOTES.items():
        recording = Note(read(f"{recordings}/{key}.wav"), key, 0.8)

        def residuals(numbers):
            note = rendered(program, marimba({name: numbers}), key, 0.8)
            for d in note.differences(recording), note.rise - recording.rise:
                yield d.ravel() / np.sqrt(d.size)

        print(f'"{name}": {[rounded(x, 3) for x in searched(FITTED[name], residuals)]},', flush=True)


def fit_kalimba(program, recordings):
    notes = {key: Note(read(f"{recordings}/{key}.wav"), key, 0.3) for key in (65, 69, 77)}

    def residuals(numbers):
        file = kalimba(dict(zip(TINE, numbers)))
        for key, recording in notes.items():
            d = rendered(program, file, key, 0.3).differences(recording)
            yield d.ravel() / np.sqrt(d.size)

    print({name: rounded(x, 3) for name, x in zip(TINE, searched(list(TINE.values()), residuals))})


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "write":
        about, file = {"marimba": (MARIMBA, marimba), "kalimba": (KALIMBA, kalimba)}[sys.argv[2]]
        Path(sys.argv[3]).write_text(about + text_of(file()), encoding="utf-8")
    elif len(sys.argv) == 5 and sys.argv[1] == "fit":
        {"marimba": fit_marimba, "kalimba": fit_kalimba}[sys.argv[3]](sys.argv[2], sys.argv[4])
    else:
        sys.exit(__doc__)
