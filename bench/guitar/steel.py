#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fits the losses of the steel strings guitar_e2 to guitar_e4, and how strongly the modes of guitar_body sound outside, to recorded notes.

    steel.py fit PROGRAM RECORDINGS FOLDER
    steel.py distance PROGRAM FOLDER FITTED KEPT

PROGRAM is contactspline. FOLDER holds files of resonators; `fit` writes them there: those of data/resonators with other losses of
strings and other pickup shapes of the body. RECORDINGS, FITTED and KEPT hold SOURCE/KEY.wav, notes of open strings. What is made small
is that of bench/strings.py without loudness. The search begins at the numbers below, so that a second one
ends where the first did. The modes of the body below 600 Hz have numbers of their own, the others a curve over the frequency. All
are then multiplied by SCALE, so that the scores that ship are as loud as before.

Fitted: E2, A2, D3, G3, B3 and E4 of Steel Guitar of FluidR3 GM (fluid-soundfont-gm, MIT) and of tonejs-instrument-guitar-acoustic
(npm; CC-BY 3.0). Kept: Steel Guitar of freepats (GPL-2 with an exception for music).
"""
import json
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

sys.path.insert(0, str(Path(__file__).parents[1]))
import strings
from notes import read, rounded

SHIPPED = Path(__file__).parents[2] / "data" / "resonators"
STRINGS = {40: "guitar_e2", 45: "guitar_a2", 50: "guitar_d3", 55: "guitar_g3", 59: "guitar_b3", 64: "guitar_e4"}
# Inharmonicity of these strings.
OF = {"seconds": 1.8, "top": 12000, "tops": {}, "inharmonicity": {40: 5.1e-5, 45: 5e-5, 50: 4.3e-5, 55: 4.4e-5, 59: 3e-5, 64: 1.9e-5}}
KNOTS = [600, 1000, 1700, 2800, 4600]
PRIOR = 0.5
SCALE = 0.65
# Of each mode of the body, its pickup shape before the fit.
SHAPES = [1.5, 1, 0.5, -0.3, 0.5, -0.4, 0.4, -0.4, -0.49, 0.38, -0.41, -0.31, -0.6, 0.54, 0.38, 0.41, 0.54, 0.57, 0.56, -0.58, -0.33, 0.58, -0.56,
          -0.44, -0.36, -0.58, -0.41, 0.45, -0.32, 0.48, 0.58, -0.41, -0.32, -0.45, 0.36, -0.4, -0.59, -0.41, 0.33, 0.34, 0.58, 0.44, -0.58, -0.51,
          0.4, -0.32, 0.38, -0.48, 0.52, -0.34, 0.53, 0.36, 0.54, -0.32, 0.47, -0.55, -0.57, -0.46, -0.38, 0.4, -0.43, 0.53, -0.45, 0.34, -0.37,
          -0.55, -0.59, -0.41, -0.45, -0.42, -0.52, -0.32, -0.34, 0.47, -0.42, -0.49, -0.31, 0.56, -0.48, 0.43, -0.45, 0.34, -0.36, 0.56]


def text(name, folder=SHIPPED):
    return (Path(folder) / f"{name}.json").read_text(encoding="utf-8")


def json_of(name):
    return json.loads(re.sub(r"^//.*$", "", text(name), flags=re.M))


MODES = [mode["frequency_hz"] for mode in json_of("guitar_body")["modes"]]
PICKUP = dict(zip(MODES, SHAPES, strict=True))
LOW = [f for f in MODES if f < 600]
USUAL = {**{f"{loss}_{name}": value for name in STRINGS.values() for loss, value in (("constant", 1.2), ("quadratic", 3e-4))},
         **{f"heard_{f}": 1 for f in LOW + KNOTS}}
RANGES = {"constant": (0.4, 5), "quadratic": (2e-5, 3e-3), "heard": (0.02, 50)}


def files(p):
    """Text of each file by name."""
    found = {}
    for name in STRINGS.values():
        losses = f'"constant_loss_per_s": {rounded(p[f"constant_{name}"], 3):g}, "quadratic_loss_m2_per_s": {rounded(p[f"quadratic_{name}"], 3):g}'
        found[name] = re.sub(r'"constant_loss_per_s": \S+ "quadratic_loss_m2_per_s": [^\s,}]+', losses, text(name))

    def heard(match):
        f = float(match[2])
        factor = p[f"heard_{match[2]}"] if f < 600 else np.exp(np.interp(np.log(f), np.log(KNOTS), [np.log(p[f"heard_{k}"]) for k in KNOTS]))
        return f"{match[1]}{match[2]}{match[3]}{rounded(SCALE * PICKUP[f] * factor, 3):g}"

    found["guitar_body"] = re.sub(r'("frequency_hz": )(\d[\d.]*)(,[^\n]*"pickup_shape": )-?[\d.]+', heard, text("guitar_body"))
    return found


def note(program, folder, key):
    folder = Path(folder).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        string = {"name": "string", "bodies": [{"name": "string", "resonator": f"{folder}/{STRINGS[key]}.json"}],
                  "places": [{"name": "plucked", "body": "string", "position_m": 0.52}],
                  "controls": [{"name": "pick", "force_n": "plucked", "min": -5, "max": 5}],
                  "outputs": [{"name": "string", "end_force_n": "string"}]}
        score = {"instrument": string, "duration_s": OF["seconds"] + 0.1, "events": [{"time_s": 0.05, "pick_release_n": 3}]}
        Path(f"{scratch}/score.json").write_text(json.dumps(score), encoding="utf-8")
        subprocess.run([program, "render", f"{scratch}/score.json", "--no-figure", "-o", f"{scratch}/note.wav"], check=True, capture_output=True)
        return strings.Note(on_body(read(f"{scratch}/note.wav"), Path(f"{folder}/guitar_body.json").read_text(encoding="utf-8")), key, OF)


def on_body(force, told):
    """The velocity of the body, by its modes, under the force of the string on its bridge."""
    length = 2 * len(force)  # the body rings behind the note, not into its beginning
    w = 2 * np.pi * np.fft.rfftfreq(length, 1 / 44100)
    modes = re.findall(r'"frequency_hz": (\S+), "decay_per_s": (\S+), "mass_kg": (\S+), "strike_shape": (\S+), "pickup_shape": ([-\d.e]+)', told)
    mobility = sum(strike * pickup * 1j * w / (mass * ((2 * np.pi * f) ** 2 + decay ** 2 - w**2 + 2j * decay * w))
                   for f, decay, mass, strike, pickup in np.array(modes, float))
    return np.fft.irfft(np.fft.rfft(force, length) * mobility, length)[: len(force)]


def write(p, folder):
    for name, told in files(p).items():
        (Path(folder) / f"{name}.json").write_text(told, encoding="utf-8")


def fit(program, recordings, folder):
    theirs = strings.notes_of(recordings, OF)
    names = list(USUAL)
    low, high = np.log([RANGES[name.split("_")[0]] for name in names]).T
    usual = np.log(list(USUAL.values()))

    def all_at(places):
        with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(2) as pool:
            jobs = []
            for i, x in enumerate(places):
                at = Path(scratch) / str(i)
                at.mkdir()
                write(dict(zip(names, np.exp(x))), at)
                jobs += [(at, key) for key in STRINGS]
            ours = list(pool.map(lambda job: note(program, *job), jobs))
        found = []
        for i, x in enumerate(places):
            here = dict(zip(STRINGS, ours[i * len(STRINGS):]))
            found.append(np.concatenate([strings.residuals(here[key], other) for (_, key), other in theirs.items()] + [PRIOR * (x - usual)]))
        return found

    def slopes(x):
        here, *beside = all_at([x] + list(x + 0.05 * np.eye(len(x))))
        print(f"{np.sum(here ** 2):.3f}", {name: rounded(value, 3) for name, value in zip(names, np.exp(x))}, flush=True)
        write(dict(zip(names, np.exp(x))), folder)
        return np.array([(there - here) / 0.05 for there in beside]).T

    best = least_squares(lambda x: all_at([x])[0], usual, slopes, bounds=(low, high), max_nfev=10, ftol=2e-3)
    write(dict(zip(names, np.exp(best.x))), folder)


def distance(program, folder, *recordings):
    ours = {key: note(program, folder, key) for key in STRINGS}
    strings.shown(ours, recordings, OF)


if __name__ == "__main__":
    if len(sys.argv) == 5 and sys.argv[1] == "fit":
        fit(*sys.argv[2:])
    elif len(sys.argv) == 6 and sys.argv[1] == "distance":
        distance(*sys.argv[2:])
    else:
        sys.exit(__doc__)
