#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes the files of the guitars, with parts that are fitted to recorded notes.

    make.py write INSTRUMENT FILE
    make.py fit PROGRAM INSTRUMENT RECORDINGS FILE
    make.py strings RECORDINGS
    make.py place RECORDINGS
    make.py distance PROGRAM FILE FITTED KEPT

PROGRAM is contactspline; INSTRUMENT is classical_guitar, steel_guitar, fret_guitar, slap_bass or lap_steel. RECORDINGS, FITTED and KEPT
hold SOURCE/KEY.wav, single notes of open strings at 44.1 kHz under their keys of MIDI. `write` writes FILE from the numbers below, `fit`
from those that it finds and prints. It searches by least squares from where a search ended: of the classical guitar forces of the
fingers, masses, decays and shapes of the body's modes and how strongly they sound outside, above 1.3 kHz a curve over the frequency; of
the steel guitar losses and where each string is plucked, too, but no shapes, and a curve from 600 Hz on; of the fret guitar, which
buzzes as it ships, losses, where it is plucked and where its magnet is, and how the modes of the amplifier sound; of the slap bass the
place of its magnet and these modes; of the lap steel the places of pick and magnet and these modes. Least squares leave a place near where
they begin, for it moves the zeros of the spectrum from partial to partial. So `strings` searches losses of the nylon strings and where
each is plucked, one string after the other on the body as it is, and prints them; this search and `fit` were run in turn, twice. `place`
compares places of all steel strings together, from 60 to 220 mm from the saddle: it ends at 90 mm, from where `fit` moves each string's.
What is made small is that of bench/strings.py and, for all keys of the classical guitar and many of the steel guitar, how much louder they
are than the mean of them, less the median of that over the sources [dB(A)], between the keys that were recorded on a line. Notes of both
are those of linear.py. A decay of up to four times that of a usual body keeps keys beside a mode of it as loud as others, and in tune. The
string of the fret guitar is plucked as fast on all keys.

Fitted: E2, A2, D3, G3, B3 and E4 of Nylon Guitar of FluidR3 GM (fluid-soundfont-gm, MIT) and of tonejs-instrument-guitar-nylon
(npm; CC-BY 3.0); the same strings of Steel Guitar of FluidR3 GM and of tonejs-instrument-guitar-acoustic (CC-BY 3.0); E2, D3, G3 and E4
of Clean Guitar and C2, D#2, G2 and C3 of Slap Bass 1 of FluidR3 GM; of the lap steel five strings of Clean Guitar and A2, D#3, A3 and D#4
of tonejs-instrument-guitar-electric. Kept: Nylon Guitar, Steel Guitar and Clean Electric Guitar of freepats (GPL-2 with an exception for
music), of the fret guitar A2 and B3 of Clean Guitar, other notes of tonejs-instrument-guitar-electric; Pop Bass of FluidR3 GM, Slap
Bass 2 of freepats, tonejs-instrument-bass-electric.

`distance` prints medians over the notes: of log-mel spectrograms, of levels of partials and of the ratios of the decays of
partials from 40 to 500 ms, for the recordings that were fitted and for those that were kept.
"""
import json
import re
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

sys.path.insert(0, str(Path(__file__).parents[1]))
import linear
from notes import text_of
from strings import Note, distance, fit, notes_of, number, residuals

LENGTH, SADDLE = 0.66, 0.648


def json_of(path):
    return json.loads(re.sub(r"^//.*$", "", Path(path).read_text(encoding="utf-8"), flags=re.M))


# Of each string: key, mass [kg/m] of a usual set, modes, and the inharmonicity of its partials in the recordings that are fitted.
STRINGS = {"e2": (40, 6.24e-3, 60, 2.8e-5), "a2": (45, 3.61e-3, 50, 1.67e-5), "d3": (50, 1.95e-3, 42, 1.32e-5),
           "g3": (55, 9.0e-4, 34, 1.55e-4), "b3": (59, 5.2e-4, 30, 6.3e-5), "e4": (64, 3.8e-4, 26, 3.6e-5)}
SHARP = {"e2": 4, "a2": 6, "d3": 4, "g3": 9, "b3": 8.5, "e4": 10.5}  # cents, as rendered: few modes make the support at the saddle soft
# Of each low mode: frequency [Hz], decay [1/s], mass [kg], shape at the saddle.
LOW = [(170, 17.8, 0.1, 1), (245, 19.2, 0.25, 0.25), (320, 25.1, 0.2, -0.7), (390, 30.6, 0.2, 0.5), (470, 36.9, 0.25, -0.4),
       (560, 39.1, 0.2, 0.6), (680, 47.5, 0.25, -0.5), (830, 57.9, 0.25, 0.45), (1010, 70.5, 0.25, -0.4), (1230, 85.9, 0.3, 0.35)]
KNOTS = [1300, 1800, 2600, 3700, 5300]  # of the curve [Hz]
USUAL = {**{f"release_{s}": 4 for s in STRINGS}, "low_mass": 1, "high_mass": 1,
         **{f"decay_{f}": 1 for f in [*(f for f, *_ in LOW), "high"]}, **{f"shape_{f}": abs(shape) for f, _, _, shape in LOW}, **{f"heard_{f}": 1 for f in [f for f, *_ in LOW] + KNOTS}}
# Of the strings: where `strings` ended that began at usual numbers.
OF_STRINGS = {"constant_e2": 0.489, "constant_a2": 0.486, "constant_d3": 0.244, "constant_g3": 0.62, "constant_b3": 2, "constant_e4": 2.89,
              "quadratic_e2": 0.000335, "quadratic_a2": 0.000561, "quadratic_d3": 0.000677, "quadratic_g3": 0.00149, "quadratic_b3": 0.000556,
              "quadratic_e4": 0.000185, "plucked_e2": 0.0901, "plucked_a2": 0.117, "plucked_d3": 0.121, "plucked_g3": 0.192, "plucked_b3": 0.0875,
              "plucked_e4": 0.101}
# Of fingers and body: where a search ended.
BEGIN = {"release_e2": 5.4, "release_a2": 5.1, "release_d3": 3.71, "release_g3": 3.23, "release_b3": 4.68, "release_e4": 4.58, "low_mass": 1.13,
         "high_mass": 3.19, "decay_170": 4, "decay_245": 4, "decay_320": 3.98, "decay_390": 3.99, "decay_470": 4, "decay_560": 3.99, "decay_680": 4,
         "decay_830": 1.64, "decay_1010": 4, "decay_1230": 2.6, "decay_high": 1.23, "shape_170": 0.537, "shape_245": 0.233, "shape_320": 0.25,
         "shape_390": 0.457, "shape_470": 0.436, "shape_560": 1.03, "shape_680": 0.891, "shape_830": 0.2, "shape_1010": 0.342, "shape_1230": 1.01,
         "heard_170": 1.74, "heard_245": 8.99, "heard_320": 12.2, "heard_390": 4.28, "heard_470": 12.9, "heard_560": 6.79, "heard_680": 7.75,
         "heard_830": 6.18, "heard_1010": 19, "heard_1230": 2.74, "heard_1300": 2.74, "heard_1800": 8.07, "heard_2600": 22.4, "heard_3700": 1.17,
         "heard_5300": 5.02}
RANGES = {"release": (2, 8), "low_mass": (0.4, 4), "high_mass": (0.3, 6), "decay": (0.5, 4),
          "shape": (0.05, 3), "heard": (0.003, 300)}
INHARMONICITY = {of[0]: of[3] for of in STRINGS.values()}  # where partials are looked for; those of the fret guitar are near enough
CONE = [120, 250, 600, 1400, 2800, 5000]  # modes of the amplifier [Hz]
# Of each steel string: key, mass [kg/m] and inharmonicity of guitar_e2 to guitar_e4, whose cores are 0.4 mm thick, or which are plain, and modes.
STEEL_STRINGS = {name: (key, string["mass_kg"] / string["length_m"], modes, np.pi ** 2 * string["bending_stiffness_n_m2"] / (string["tension_n"] * string["length_m"] ** 2))
                 for name, key, modes in (("e2", 40, 90), ("a2", 45, 70), ("d3", 50, 54), ("g3", 55, 42), ("b3", 59, 34), ("e4", 64, 26))
                 for string in [json_of(Path(__file__).parents[2] / f"data/resonators/guitar_{name}.json")["string"]]}
STEEL_SHARP = {"e2": 0, "a2": 2.5, "d3": 0.5, "g3": 2.5, "b3": 6.5, "e4": 9}  # cents, as SHARP
STEEL_LOW = [100, 200, 235, 290, 385, 440, 520, 580]  # modes that have numbers of their own [Hz]
STEEL_KNOTS = [643.7, 1000, 1700, 2800, 4600]
# They are plucked where `place` ends.
STEEL_USUAL = {**{f"release_{s}": 4 for s in STEEL_STRINGS}, **{f"constant_{s}": 1 for s in STEEL_STRINGS}, **{f"quadratic_{s}": 3e-4 for s in STEEL_STRINGS},
               **{f"plucked_{s}": 0.09 for s in STEEL_STRINGS},
               "low_mass": 1, "high_mass": 1, "decay": 1, **{f"heard_{f}": 1 for f in STEEL_LOW + STEEL_KNOTS}}
STEEL_BEGIN = {"release_e2": 5.04, "release_a2": 4.31, "release_d3": 4.6, "release_g3": 3.7, "release_b3": 3.75, "release_e4": 3.97,
               "constant_e2": 0.479, "constant_a2": 0.636, "constant_d3": 0.206, "constant_g3": 0.424, "constant_b3": 0.95, "constant_e4": 1.4,
               "quadratic_e2": 0.000203, "quadratic_a2": 0.000171, "quadratic_d3": 0.000223, "quadratic_g3": 0.000288, "quadratic_b3": 0.000392,
               "quadratic_e4": 0.000418, "low_mass": 7.32, "high_mass": 4.71, "decay": 3.58, "heard_100": 2.49, "heard_200": 4.11,
               "heard_235": 2.24, "heard_290": 0.605, "heard_385": 1.02, "heard_440": 4.34, "heard_520": 0.94, "heard_580": 5.27,
               "heard_643.7": 4.03, "heard_1000": 2.14, "heard_1700": 3.34, "heard_2800": 5.79, "heard_4600": 1.05, "plucked_e2": 0.101,
               "plucked_a2": 0.0913, "plucked_d3": 0.0891, "plucked_g3": 0.0952, "plucked_b3": 0.0962, "plucked_e4": 0.0912}
STEEL_HEADER = """\
// Six steel strings of a light set on a guitar's body, each plucked by a finger; they also sound with each other. A string runs over the
// saddle, 0.648 m from its end, to the pin behind it. Strings and modes of the body are those of guitar_e2 to guitar_e4 and guitar_body.
// Written by bench/guitar/make.py, which says how: losses of the strings, where and how hard they are plucked, masses, decays and
// how the modes are heard are fitted to recorded notes of FluidR3 GM (MIT) and of tonejs-instrument-guitar-acoustic (CC-BY 3.0).
"""
FRET_USUAL = {"constant": 2, "quadratic": 3e-4, "plucked": 0.5, "magnet": 0.6, **{f"cone_{f}": 1 for f in CONE}}
FRET_BEGIN = {"constant": 1.58, "quadratic": 0.000486, "plucked": 0.423, "magnet": 0.607, "cone_120": -1.53, "cone_250": -6.31,
              "cone_600": 6.05, "cone_1400": -0.587, "cone_2800": 3.79, "cone_5000": -0.503}
FRET_RANGES = {"constant": (0.5, 6), "quadratic": (2e-5, 2e-3), "plucked": (0.38, 0.61), "magnet": (0.47, 0.63), "cone": (-8, 8)}
FRET_HEADER = """\
// The D string of a guitar, 146.8 Hz, which buzzes on a stiff fret near its end: the louder the note, the longer it buzzes. Keys
// tune it by its tension, and pluck it twice as hard for each octave, so that it moves as fast on all. A magnet near the bridge moves
// the modes of an amplifier, which is so light that the string does not feel it: pickup, filter and loudspeaker in one. Fitted to
// E2, D3, G3 and E4 of Clean Guitar of FluidR3 GM (MIT), by least squares of differences of log-mel spectrograms, partials and
// decays, with its buzz: losses of the string, the places of finger and magnet, and how each mode sounds.
"""
BASS_USUAL = {"pickup": 0.72, **{f"cone_{f}": 1 for f in CONE}}
BASS_BEGIN = {"pickup": 0.716, "cone_120": 0.663, "cone_250": -0.403, "cone_600": 0.159, "cone_1400": -0.169, "cone_2800": 0.106, "cone_5000": -0.0543}
BASS_RANGES = {"pickup": (0.66, 0.83), "cone": (-8, 8)}
BASS_HEADER = """\
// The G string of a bass guitar, 98 Hz, over its 20 frets. Fingers press it down behind frets 2, 5, 7 and 9; a thumb hits it and
// flies off, another finger pulls it up. The string moves towards the frets where displacements are positive.
// Fitted by `contactspline fit` to C2, D#2, G2 and C3 of Slap Bass 1 of FluidR3 GM (MIT), with 95 % intervals: the losses (0.328 to
// 0.510 and 2.25e-4 to 2.90e-4). By bench/guitar/make.py, to the same notes: the place of the pickup, whose magnet moves the modes of an
// amplifier, which is so light that the string does not feel it, and how each mode sounds.
// With `stretch` (a steel core of 0.46 mm) it takes 3.5 times as long, and its pitch falls by less than 2 cents after a pop.
"""
LAP_BEGIN = {"plucked": 0.534, "magnet": 0.602, "cone_120": -1.19, "cone_250": -1.98, "cone_600": 3.61, "cone_1400": -2.38, "cone_2800": 3.68, "cone_5000": -1.19}
LAP_HEADER = """\
// The G string of a lap steel guitar under a steel bar at a quarter of its length, where it sounds C4. The hand presses the bar on
// the string with 3 N, and the string, which it bends, pulls back as much. Displacements count from there, so that nothing moves
// before the first note: the springs `hand` and `bend` push bar and string together with 300 N/m times 10 mm, and the contact is
// compressed by what 3 N need. Where a pluck pulls harder than the hand presses, the bar rattles. The mass of the bar makes
// notes 3 cents sharp, which the tuning makes good. Fingers rest on the string behind the bar. An octave higher, keys pluck 1.8 times
// as hard, so that all are about as loud. A magnet moves the modes of an amplifier, which is so light that the string does not feel it.
// The places of pick and magnet and how each mode sounds are fitted by bench/guitar/make.py to notes of Clean Guitar of FluidR3 GM (MIT)
// and of tonejs-instrument-guitar-electric (CC-BY 3.0), for no recorded lap steel was found.
"""
# Of the lap steel: inharmonicity, near enough, of keys that are fitted or kept.
ELECTRIC = dict.fromkeys((45, 48, 50, 51, 54, 55, 57, 59, 60, 63, 64), 6e-5)
HEADER = """\
// Six nylon strings on a guitar's body, each plucked by a finger; they also sound with each other. A string runs over the saddle,
// 0.648 m from its end, to the tie behind it. Masses are those of a usual set. Body after Christensen and Vistisen
// (J. Acoust. Soc. Am. 68, 1980): the lowest mode of the top and the air in the sound hole are two masses
// on the spring of the enclosed air, rho c^2 A^2/V, V = 14 l, A = 0.05 m^2 of the top. The mass of the air, rho S (0.0025 m + 1.7 a)
// for a hole of a = 43 mm, counts times (A/S)^2, because its displacement here is that of a piston as large as the top. The higher
// modes of the top stand for such bodies in general; from 1.3 kHz on there is one for each 90 Hz.
// Written by bench/guitar/make.py, which says how: stiffness and losses of the strings, where they are plucked, masses, decays and
// shapes of the modes, how they are heard, and the force of each finger are fitted to recorded notes of FluidR3 GM (MIT) and of
// tonejs-instrument-guitar-nylon (CC-BY 3.0).
"""


def modes():
    """Frequency, decay, mass, shape at the saddle and sign outside of each mode."""
    random = np.random.default_rng(1)
    found = [(f, decay, mass, shape, 1 if shape > 0 else -1) for f, decay, mass, shape in LOW]
    f = 1230
    while f < 5200:
        f += 90 * random.uniform(0.7, 1.3)
        found.append((f, np.pi * f / random.uniform(30, 50), 0.2, random.choice([-1, 1]) * random.uniform(0.35, 0.75), random.choice([-1, 1])))
    return found


def heard(p, f):
    """How strongly a mode sounds outside. The low ones have numbers of their own."""
    if f"heard_{f}" in p:
        return p[f"heard_{f}"]
    return np.exp(np.interp(np.log(f), np.log(KNOTS), [np.log(p[f"heard_{k}"]) for k in KNOTS]))


def six_strings(p, names, table, sharp):
    """Bodies, places, links, controls and keys of strings that run over a saddle."""
    bodies, places, links, controls, keys = [], [], [], [], []
    lows = [table[s][0] for s in names]
    for i, s in enumerate(names):
        key, mass_per_m, max_modes, b = table[s]
        f = 440 * 2 ** ((key - 69) / 12)
        tension = mass_per_m * (2 * SADDLE * f) ** 2 * 2 ** (-sharp[s] / 600)
        bodies.append({"name": s, "string": {"length_m": LENGTH, "mass_kg": number(mass_per_m * LENGTH, 5), "tension_n": number(tension / (1 + b), 6),
                                             "bending_stiffness_n_m2": number(b * tension * SADDLE ** 2 / np.pi ** 2),
                                             "constant_loss_per_s": number(p[f"constant_{s}"]), "quadratic_loss_m2_per_s": number(p[f"quadratic_{s}"])},
                       "max_modes": max_modes})
        places += [{"name": f"{s}_plucked", "body": s, "position_m": number(SADDLE - p[f"plucked_{s}"])}, {"name": f"{s}_over_saddle", "body": s, "position_m": SADDLE}]
        links.append({"name": f"{s}_bridge", "between": [f"{s}_over_saddle", "saddle"]})
        controls.append({"name": f"finger_{s}", "force_n": f"{s}_plucked", "min": -20, "max": 20, "release_n": number(p[f"release_{s}"])})
        keys.append({"first": lows[i] - (2 if s == "e2" else 0), "last": lows[i + 1] - 1 if i + 1 < len(names) else lows[i] + 19,
                     "event": f"pluck_finger_{s}", "tuned_key": lows[i], "string": s})
    return bodies, places, links, controls, keys


def guitar(p, names=tuple(STRINGS)):
    bodies, places, links, controls, keys = six_strings({**OF_STRINGS, **p}, names, STRINGS, SHARP)
    table = modes()
    bodies.append({"name": "top", "modes": [{"frequency_hz": number(f, 5), "decay_per_s": number(decay * p.get(f"decay_{f}", p["decay_high"])),
                                             "mass_kg": number(mass * (1 if f == 170 else p["low_mass"] if f <= 1230 else p["high_mass"]))} for f, decay, mass, _, _ in table]})
    bodies.append({"name": "air", "mass_kg": 0.03904})
    half = len(names) // 2  # of the strings, drawn above the body
    bodies = bodies[:half] + bodies[-2:] + bodies[half:-2]
    places += [{"name": "saddle", "body": "top", "shapes": [number(np.sign(shape) * p.get(f"shape_{f}", abs(shape))) for f, _, _, shape, _ in table]},
               {"name": "inwards", "body": "top", "shapes": [-1] + [0] * (len(table) - 1)},
               {"name": "heard", "body": "top", "shapes": [number(sign * heard(p, f)) for f, _, _, _, sign in table]}]
    springs = [{"name": "cavity", "between": ["inwards", "air"], "stiffness_n_per_m": 25210}, {"name": "hole", "between": ["air", "ground"], "resistance_n_s_per_m": 1.25}]
    controls += [{"name": "cavity", "stiffness_n_per_m": "cavity", "max": 100000}, {"name": "hand", "damping_per_s": list(names), "max": 1000}]
    return {"name": "classical_guitar", "description": "six nylon strings on a guitar body", "bodies": bodies, "places": places,
            "springs": springs, "links": links, "controls": controls,
            "outputs": [{"name": "body", "velocity_m_per_s": ["heard", "air"], "full_scale": 0.9},
                        {"name": "bridge", "force_n": [f"{s}_bridge" for s in names], "full_scale": 20}],
            "input": {"force_n": "saddle", "full_scale": 10}, "keys": keys, "polyphony": 2,
            "damper": {"bodies": list(names), "damping_per_s": 30}}


def steel_modes():
    """Frequency, decay, mass, shape at the bridge and pickup shape of the modes of guitar_body."""
    return [(mode["frequency_hz"], mode["decay_per_s"], mode["mass_kg"], mode["strike_shape"], mode["pickup_shape"])
            for mode in json_of(Path(__file__).parents[2] / "data/resonators/guitar_body.json")["modes"]]


def steel_heard(p, f, shape):
    return shape * (p[f"heard_{f}"] if f"heard_{f}" in p else np.exp(np.interp(np.log(f), np.log(STEEL_KNOTS), [np.log(p[f"heard_{k}"]) for k in STEEL_KNOTS])))


def steel_guitar(p, names=tuple(STEEL_STRINGS)):
    bodies, places, links, controls, keys = six_strings(p, names, STEEL_STRINGS, STEEL_SHARP)
    table = steel_modes()
    half = len(names) // 2  # of the strings, drawn above the body
    bodies.insert(half, {"name": "body", "modes": [{"frequency_hz": f, "decay_per_s": number(decay * p["decay"]),
                                                   "mass_kg": number(mass * p["low_mass" if f < 600 else "high_mass"])} for f, decay, mass, *_ in table]})
    places += [{"name": "saddle", "body": "body", "shapes": [shape for *_, shape, _ in table]},
               {"name": "heard", "body": "body", "shapes": [number(steel_heard(p, f, shape)) for f, *_, shape in table]}]
    controls.append({"name": "hand", "damping_per_s": list(names), "max": 1000})
    return {"name": "steel_guitar", "description": "six steel strings on a guitar body", "bodies": bodies, "places": places, "links": links, "controls": controls,
            "outputs": [{"name": "body", "velocity_m_per_s": "heard", "full_scale": 0.11}, {"name": "bridge", "force_n": [f"{s}_bridge" for s in names], "full_scale": 25}],
            "input": {"force_n": "saddle", "full_scale": 10}, "keys": keys, "polyphony": 2, "damper": {"bodies": list(names), "damping_per_s": 30}}


def amplifier(p, frequencies):
    """Its modes, and their shapes at coil and cone."""
    modes = [{"frequency_hz": f, "decay_per_s": number(min(0.7 * np.pi * f, 4000), 4), "mass_kg": number(1e-5 * (120 / f) ** 2, 4)} for f in frequencies]
    return modes, [1] * len(frequencies), [number(300 * p[f"cone_{f}"]) for f in frequencies]


def shipped(name, numbers):
    """A file of data/instruments with other numbers, by place in it."""
    file = json_of(Path(__file__).parents[2] / f"data/instruments/{name}.json")
    parts = {part["name"]: part for group in ("bodies", "places", "controls") for part in file[group] if "name" in part}
    for part, values in numbers.items():
        parts[part].update(values)
    return file


def slap_bass(p, _=None):
    modes, coil, cone = amplifier(p, CONE)
    return shipped("slap_bass", {"pickup": {"position_m": number(p["pickup"])}, "amplifier": {"modes": modes},
                                 "coil": {"shapes": coil}, "cone": {"shapes": cone}})


def lap_steel(p, _=None):
    modes, coil, cone = amplifier(p, CONE)
    return shipped("lap_steel", {"plucked": {"position_m": number(p["plucked"])}, "over_magnet": {"position_m": number(p["magnet"])}, "amplifier": {"modes": modes},
                                 "coil": {"shapes": coil}, "cone": {"shapes": cone}})


def fret_guitar(p, _=None):
    modes, coil, cone = amplifier(p, CONE)
    return {"name": "fret_guitar", "description": "guitar string that buzzes on a fret",
            "bodies": [{"name": "string", "string": {"length_m": 0.648, "mass_kg": 0.00243374, "tension_n": 136, "bending_stiffness_n_m2": 0.000251327,
                                                     "constant_loss_per_s": number(p["constant"]), "quadratic_loss_m2_per_s": number(p["quadratic"])},
                        "max_modes": 80},
                       {"name": "amplifier", "modes": modes}],
            "places": [{"name": "plucked", "body": "string", "position_m": number(p["plucked"])}, {"name": "over_fret", "body": "string", "position_m": 0.635},
                       {"name": "over_magnet", "body": "string", "position_m": number(p["magnet"])},
                       {"name": "coil", "body": "amplifier", "shapes": coil},
                       {"name": "cone", "body": "amplifier", "shapes": cone}],
            "contacts": [{"name": "fret", "between": ["over_fret", "ground"], "material": "steel_on_steel", "gap_m": 2e-05}],
            "springs": [{"name": "magnet", "between": ["over_magnet", "coil"], "stiffness_n_per_m": 0.001}],
            "controls": [{"name": "fret", "place_m": "over_fret", "min": 0.02, "max": 0.64},
                         {"name": "finger", "force_n": "plucked", "min": -20, "max": 20, "release_n": 3},
                         {"name": "fret", "gap_shift_m": "fret", "min": -2e-05, "max": 0.005},
                         {"name": "fret", "loss_s_per_m": "fret", "initial": 0.3, "max": 2}],
            "outputs": [{"name": "amplifier", "velocity_m_per_s": "cone", "full_scale": 3}, {"name": "string", "end_force_n": "string", "full_scale": 10},
                        {"name": "fret", "force_n": "fret", "full_scale": 20}],
            "keys": [{"first": 38, "last": 74, "event": "pluck_finger", "tuned_key": 50, "per_octave": 2}], "polyphony": 4,
            "damper": {"bodies": ["string"], "damping_per_s": 30},
            "presets": [{"name": "buzz"}, {"name": "close fret", "fret_gap_shift_m": -1.5e-05},
                        {"name": "fret in the middle", "fret_place_m": 0.324, "fret_gap_shift_m": 0.0003}, {"name": "no fret", "fret_gap_shift_m": 0.005}]}


def search_strings(folder):
    """Searches losses and places of the nylon strings one after the other, everywhere between ends, and prints them."""
    of = GUITARS["classical_guitar"]
    theirs = notes_of(folder, of)
    for name, (key, *_) in STRINGS.items():
        names = [f"{kind}_{name}" for kind in ("constant", "quadratic", "plucked")]
        numbers = lambda x: dict(zip(names, (np.exp(x[0]), np.exp(x[1]), x[2])))

        def cost(x):
            ours = Note(linear.note(guitar({**OF_STRINGS, **BEGIN, **numbers(x)}, (name,)), key, of["seconds"]), key, of)
            return sum(np.sum(residuals(ours, note) ** 2) for (_, at), note in theirs.items() if at == key)

        found = differential_evolution(cost, [*np.log([(0.1, 6), (5e-5, 5e-3)]), (0.08, 0.22)], maxiter=9, popsize=8, seed=1, polish=False,
                                       x0=[np.log(OF_STRINGS[names[0]]), np.log(OF_STRINGS[names[1]]), OF_STRINGS[names[2]]])
        print(f"{found.fun:.1f}", {at: number(value) for at, value in numbers(found.x).items()}, flush=True)


def search_place(folder):
    """Plucks all steel strings at one place after the other, with usual numbers, and prints how far they are from the recordings there."""
    of = GUITARS["steel_guitar"]
    theirs = notes_of(folder, of)
    for mm in range(60, 225, 5):
        file = steel_guitar({**STEEL_USUAL, **{f"plucked_{s}": mm / 1000 for s in STEEL_STRINGS}})
        ours = {key: Note(linear.note(file, key, of["seconds"]), key, of) for key in of["strings"]}
        print(mm, "mm", round(sum(np.sum(residuals(ours[key], note) ** 2) for (_, key), note in theirs.items())), flush=True)


# As bench/strings.py says.
GUITARS = {
    "classical_guitar": {"of": guitar, "strings": {of[0]: (name,) for name, of in STRINGS.items()}, "usual": USUAL, "begin": BEGIN, "ranges": RANGES,
                         "about": HEADER, "events": [], "velocity": 1, "inharmonicity": INHARMONICITY, "seconds": 1.8, "top": 12000, "tops": {}, "prior": 0.5, "loudness": 3,
                         "compared": range(38, 84), "sound": linear.note},
    "fret_guitar": {"of": fret_guitar, "strings": {key: () for key in (40, 50, 55, 64)}, "usual": FRET_USUAL, "begin": FRET_BEGIN, "ranges": FRET_RANGES,
                    "about": FRET_HEADER, "events": [], "velocity": 0.85, "inharmonicity": INHARMONICITY, "seconds": 1.2, "top": 10000, "tops": {}, "prior": 0.05, "loudness": 0,
                    "compared": []},
    "slap_bass": {"of": slap_bass, "strings": {key: () for key in (36, 39, 43, 48)}, "usual": BASS_USUAL, "begin": BASS_BEGIN, "ranges": BASS_RANGES,
                  "about": BASS_HEADER, "events": [], "velocity": 0.8, "inharmonicity": dict.fromkeys((36, 39, 43, 48), 2.8e-5), "seconds": 2.6, "top": 10000, "tops": {}, "prior": 0.05,
                  "loudness": 0, "compared": []},
    "lap_steel": {"of": lap_steel, "strings": {key: () for key in (45, 50, 51, 55, 57, 59, 63, 64)}, "usual": FRET_USUAL, "begin": LAP_BEGIN, "ranges": FRET_RANGES,
                  "about": LAP_HEADER, "events": [], "velocity": 0.7, "inharmonicity": ELECTRIC, "seconds": 1.2, "top": 10000, "tops": {}, "prior": 0.05, "loudness": 0, "compared": []},
    "steel_guitar": {"of": steel_guitar, "strings": {of[0]: (name,) for name, of in STEEL_STRINGS.items()}, "usual": STEEL_USUAL, "begin": STEEL_BEGIN,
                     "ranges": {**RANGES, "constant": (0.05, 4), "quadratic": (5e-5, 5e-3), "plucked": (0.06, 0.22), "low_mass": (0.4, 10), "heard": (0.02, 50)}, "about": STEEL_HEADER, "events": [], "velocity": 1, "inharmonicity": {of[0]: of[3] for of in STEEL_STRINGS.values()},
                     "seconds": 1.8, "top": 12000, "tops": {}, "prior": 0.5, "loudness": 1, "sound": linear.note,
                     "compared": [40, 42, 43, 45, 47, 48, 50, 52, 53, 54, 55, 56, 57, 58, 59, 61, 63, 64, 66, 67, 68, 71, 74]}}


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "write" and sys.argv[2] in GUITARS:
        kind = GUITARS[sys.argv[2]]
        Path(sys.argv[3]).write_text(kind["about"] + text_of(kind["of"](kind["begin"])), encoding="utf-8")
    elif len(sys.argv) == 6 and sys.argv[1] == "fit" and sys.argv[3] in GUITARS:
        fit(sys.argv[2], GUITARS[sys.argv[3]], *sys.argv[4:])
    elif len(sys.argv) == 3 and sys.argv[1] == "strings":
        search_strings(sys.argv[2])
    elif len(sys.argv) == 3 and sys.argv[1] == "place":
        search_place(sys.argv[2])
    elif len(sys.argv) == 6 and sys.argv[1] == "distance":
        distance(sys.argv[2], GUITARS, *sys.argv[3:])
    else:
        sys.exit(__doc__)
