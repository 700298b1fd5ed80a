# SPDX-License-Identifier: MIT
"""Notes of classical and steel guitar by Laplace transforms, which take a tenth of the time of rendered ones: their files are linear.

All strings push the body at the saddle. With Z the sum of their impedances there, Y the mobility of the body and G the ratio of a
string's mobility from finger to saddle over that at the saddle, a finger's force F moves the saddle by Y G F/(1 + Y Z).
The sum is taken on the line Re s = DECAY over the time, so that what sounds longer wraps around 80 dB softer.
"""
import json
from functools import lru_cache

import numpy as np

from notes import RATE

BEGIN_S, RISE_S = 0.05, 0.004  # of the pluck
DECAY, TOP_HZ = 9, 12500  # nothing is computed above


@lru_cache(8)
def line(rate, count):
    f = np.fft.rfftfreq(count, 1 / rate)
    return DECAY * rate / count + 2j * np.pi * f[f < TOP_HZ]


@lru_cache(256)
def string_at_saddle(body, saddle_m, plucked_m, semitones, rate, count):
    """Impedance at the saddle, and G."""
    body, s = json.loads(body), line(rate, count)
    string, length = body["string"], body["string"]["length_m"]
    k = np.arange(1, body["max_modes"] + 1) * np.pi / length
    bending = string["bending_stiffness_n_m2"] * k ** 2
    tension = (string["tension_n"] + bending[0]) * 2 ** (semitones / 6) - bending[0]
    squares = (tension + bending) * k ** 2 * length / string["mass_kg"]
    decays = string["constant_loss_per_s"] + string["quadratic_loss_m2_per_s"] * k ** 2
    at_saddle, over = np.zeros(len(s), complex), np.zeros(len(s), complex)
    for square, decay, there, here in zip(squares, decays, np.sin(k * saddle_m), np.sin(k * plucked_m)):
        mobility = there * s / (string["mass_kg"] / 2 * (s * s + 2 * decay * s + square))
        at_saddle += there * mobility
        over += here * mobility
    return 1 / at_saddle, over / at_saddle


@lru_cache(512)
def mode_of_1_kg(frequency, decay, rate, count):
    """Mobility."""
    s = line(rate, count)
    return s / (s * s + 2 * decay * s + (2 * np.pi * frequency) ** 2)


@lru_cache(8)
def body_at_saddle(text, rate, count):
    """Mobility at the saddle, and what is heard of a force there."""
    modes, saddle, heard, *of_cavity = json.loads(text)
    s = line(rate, count)
    mobility, radiated = np.zeros(len(s), complex), np.zeros(len(s), complex)
    for i, (mode, shape, outside) in enumerate(zip(modes, saddle, heard)):
        of_mode = mode_of_1_kg(mode["frequency_hz"], mode["decay_per_s"], rate, count) / mode["mass_kg"]
        if i == 0 and of_cavity:  # the one on the spring of the air
            air, stiffness, resistance = of_cavity
            of_air = air * s * s + resistance * s + stiffness
            of_mode = of_mode / (1 + of_mode * (stiffness - stiffness ** 2 / of_air) / s)
            outside = outside - stiffness / of_air
        mobility += shape * shape * of_mode
        radiated += outside * shape * of_mode
    return mobility, radiated


def note(file, key, seconds, rate=RATE):
    """The sound of the first output at `rate` [Hz], times a constant, for `seconds` or up to twice as long. file: of make.py, some strings or all."""
    count = 1 << int(np.ceil(np.log2((seconds + 0.1) * rate)))
    bodies, places, springs = ({part["name"]: part for part in file.get(name, [])} for name in ("bodies", "places", "springs"))
    row = next(row for row in file["keys"] if row["first"] <= key <= row["last"])
    impedance = 0
    for name, body in bodies.items():
        if "string" not in body:
            continue
        at = [places[f"{name}_{place}"]["position_m"] for place in ("over_saddle", "plucked")]
        z, gain = string_at_saddle(json.dumps(body), *at, key - row["tuned_key"] if name == row["string"] else 0, rate, count)
        impedance = impedance + z
        if name == row["string"]:
            over = gain
    force = next(control["release_n"] for control in file["controls"] if control.get("force_n") == f"{row['string']}_plucked")
    modes = next(body["modes"] for body in bodies.values() if "modes" in body)
    cavity = [bodies["air"]["mass_kg"], springs["cavity"]["stiffness_n_per_m"], springs["hole"]["resistance_n_s_per_m"]] if springs else []
    parts = [modes, places["saddle"]["shapes"], places["heard"]["shapes"], *cavity]
    mobility, radiated = body_at_saddle(json.dumps(parts), rate, count)
    s = line(rate, count)
    pluck = force * np.exp(-s * BEGIN_S) * (1 - np.exp(-s * RISE_S) * (1 + s * RISE_S)) / (s * s * RISE_S)
    sound = np.fft.irfft(radiated * over * pluck / (1 + mobility * impedance) * rate, count)
    return sound * np.exp(DECAY * np.arange(count) / count)
