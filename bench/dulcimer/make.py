#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes the file of the dulcimer, with parts that are fitted to recorded notes.

    make.py write FILE
    make.py heard PROGRAM RECORDINGS                # prints what stands below as HEARD
    make.py fit PROGRAM RECORDINGS                  # prints what stands below as NUMBERS
    make.py distance PROGRAM FILE FITTED KEPT

PROGRAM is contactspline. RECORDINGS, FITTED and KEPT hold SOURCE/KEY.wav, single notes at 44.1 kHz under their keys of MIDI. `fit`
searches NUMBERS from where they are, one at a time, by factors: losses of the strings, how far the two of a course are apart, where they
are struck, hammer and its face, how much stronger it strikes an octave higher and how strongly each course drives the board, masses and
decays of its modes. `heard` searches by least squares how strongly each of these modes sounds outside, where neighbours are alike, with the
forces on the board that are rendered. What is made small is that of bench/strings.py, in `heard` without the decays, and EVEN times how
much louder the keys are than recorded ones, less the mean [dB(A)]. In turns, from 1 and usual numbers on, the searches came to where they
are; the last were `fit` and `heard`, from 0.7 for each octave and courses that drive the board 1.3 to 0.75 times. Chosen, not fitted:
strings that nobody strikes are in tune within 2 cents and weigh 200 kg in the table, so that they move no key by more than 3 cents; above
2 kHz the signs of the right side are drawn at random.

Fitted: C4, G4, G5 and C6 of Dulcimer of FluidR3 GM (fluid-soundfont-gm, MIT), each channel as a source. Kept: its C5, and D4, G4, C5,
G5 and C6 of Dulcimer of freepats (GPL-2 with an exception for music).
"""
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

sys.path.insert(0, str(Path(__file__).parents[1]))
from notes import RATE, a_weighting, loudness, mel_bank, onset, rendered, text_of, windows
from strings import LEVELS, Note, distance, louder, loudness_apart, notes_of, number, residuals, robust

COURSES = {"e4": (60, 64, 68, 40), "cs5": (69, 73, 77, 26), "as5": (78, 82, 86, 17)}  # first key, that of the file, last, modes of a string
SHARP = {"e4": 4.2, "cs5": 6, "as5": 15.6}  # cents, as rendered: few modes make the support at the bridge soft
FITTED = (60, 67, 79, 84)
ENDS = (60, 84)  # keys between which numbers of strings and hammers go by ratios
WIRE = 1.2485e-3  # kg/m: steel of 0.45 mm
BEHIND = 0.03  # of the length: from the bridge to the pin behind it
WIDE = 2000  # Hz: modes below sound alike to the left and right
SCALE = [0, 1, 2, 4, 6, 7, 9, 11]  # of D and G major
KEYS = range(60, 87)
INHARMONICITY = {60: 1e-4, 62: 2.2e-4, 67: 2.3e-4, 72: 2.2e-4, 79: 1.8e-4, 84: 4.8e-4}  # where partials are looked for
EVEN = 1  # how much a decibel of a key's loudness counts
ALIKE = (1.5, 3)  # how much an e-fold between neighbouring modes counts beside a decibel: first less
HEADER = """\
// Hammered dulcimer of C4 to D6: three courses of two steel strings of 0.45 mm under a hammer, of which keys tune one over nine semitones.
// Strings run over a bridge to a pin behind it. The board is a table of modes, one for each 45 Hz up to 900 Hz and one for each 5 % of the
// frequency above; behind them stand, a mode each, strings of the scales of D and G, which nobody strikes or damps and which ring along.
// Written by bench/dulcimer/make.py: losses of the strings, how far the two of a course are apart, where they are struck, the mass of the
// hammer, the stiffness of its face and how strongly it strikes each key, how each course drives the board, masses and decays of the modes
// and how they sound outside are fitted to C4, G4, G5 and C6 of Dulcimer of FluidR3 GM (MIT), and to keys as loud as these. Log-mel
// spectrograms are 4.3 to 6.9 dB from these notes, 5.4 and 6 dB from both channels of its C5 and 6.3 to 9 dB from Dulcimer of freepats,
// which were not fitted; these two are 5.5 to 9.1 dB from each other. Steps between keys are up to 3.9 dB(A); C4 is 4 dB(A)
// softer than recorded beside the others.
"""


def modes():
    """Frequency, distance of the next one [Hz], 0 of strings that nobody strikes, shapes at the bridge under each course, signs outside."""
    random = np.random.default_rng(1)
    at, f = [], 110
    while f < 11000:
        apart = max(45, 0.05 * f)
        f += apart * random.uniform(0.7, 1.3)
        at.append((number(f, 4), apart))
    at += [(number(440 * 2 ** ((key - 69) / 12 + random.uniform(-0.0017, 0.0017)), 5), 0) for key in range(62, 122) if key % 12 in SCALE]
    found = [(f, apart, random.choice([-1, 1], len(COURSES)) * random.uniform(0.4, 1, len(COURSES)), *random.choice([-1, 1], 2)) for f, apart in at]
    return [(*mode[:4], mode[3] if mode[0] < WIDE else mode[4]) for mode in found if mode[1] or mode[0] < 6000]


MODES = modes()
DECAYS = [200, 800, 2500, 9000]  # Hz
NUMBERS = {"constant_low": 1.45, "constant_high": 0.305, "quadratic_low": 0.000248, "quadratic_high": 0.000613, "apart_low": 1.77, "apart_high": 2.16,
           "struck_low": 0.119, "struck_high": 0.185, "weight_low": 10.8, "weight_high": 41.7, "hammer": 0.00579, "stronger": 0.7, "coupled_low":
           1.46, "coupled_high": 0.871, "mass_low": 5.36, "mass_high": 0.189, "decay_200": 15.9, "decay_800": 171, "decay_2500": 129, "decay_9000":
           14, "ringing_low": 2.45, "ringing_high": 3.28}
HEARD = [1.16, 1.56, 2.85, 3.04, 5.08, 7.68, 4.91, 3.78, 4.08, 4.95, 6.67, 6.8, 8.35, 9.12, 7.94, 21.3, 20.6, 12.5, 7.14, 7.16, 13.4, 10.9, 6.62,
         4.65, 4.55, 5.83, 3.78, 3.32, 2.73, 2.43, 2.45, 2.35, 2.56, 1.82, 1.54, 1.34, 1.23, 1.1, 1.26, 1.08, 0.927, 0.929, 0.928, 0.645, 0.385,
         0.427, 0.526, 0.839, 0.703, 0.861, 1.27, 1.67, 0.799, 0.6, 0.43, 0.477, 0.809, 0.941, 1.05, 2.04, 2.24, 1.24, 2, 1.11, 0.685, 0.728, 0.891,
         1.91, 2.62, 4.52, 3.97, 3.97, 4.82, 6.04, 8.29, 12.9, 21, 26.7, 39.6, 44.5, 37.3, 39, 49.7, 66.3, 87.9, 75.9, 83.2, 88.6, 97.5, 79.2, 84.1,
         105, 164, 277, 237, 302, 208, 175, 94.8, 61.7, 117, 226, 759, 443]


def between(p, name, at):
    return p[f"{name}_low"] ** (1 - at) * p[f"{name}_high"] ** at


def table(p):
    """Of the board: its own modes, and strings of the scale that nobody strikes, which ring along."""
    found = []
    for f, apart, *_ in MODES:
        at = np.clip(np.log(f / 200) / np.log(6000 / 200), 0, 1)
        if apart:
            decay = np.exp(np.interp(np.log(f), np.log(DECAYS), np.log([p[f"decay_{k}"] for k in DECAYS])))
            mass = between(p, "mass", at) * 45 / apart
        else:
            decay, mass = between(p, "ringing", at), 200
        found.append({"frequency_hz": f, "decay_per_s": number(decay), "mass_kg": number(mass)})
    return found


def dulcimer(p=NUMBERS, heard=HEARD):
    bodies, places, contacts, links, keys = [], [], [], [], []
    for i, (course, (first, key, last, count)) in enumerate(COURSES.items()):
        at = (key - ENDS[0]) / (ENDS[1] - ENDS[0])
        f = 440 * 2 ** ((key - 69) / 12)
        speaking = 0.45 * (392 / f) ** 0.8
        length = number(speaking * (1 + BEHIND), 4)
        b = 1e-4 * 5 ** at  # about that of recorded notes
        tension = WIRE * (2 * speaking * f) ** 2 * 2 ** (-SHARP[course] / 600)
        string = {"length_m": length, "mass_kg": number(WIRE * length, 5), "tension_n": number(tension / (1 + b), 6),
                  "bending_stiffness_n_m2": number(b * tension * speaking ** 2 / np.pi ** 2),
                  "constant_loss_per_s": number(between(p, "constant", at)), "quadratic_loss_m2_per_s": number(between(p, "quadratic", at))}
        apart = number(between(p, "apart", at) / 2)
        for side, cents in (("1", -apart), ("2", apart)):
            name = f"{course}_{side}"
            bodies.append({"name": name, "tuning_cents": cents, "string": string, "max_modes": count})
            places += [{"name": f"{name}_struck", "body": name, "position_m": number(speaking * (1 - between(p, "struck", at)))},
                       {"name": f"{name}_over_bridge", "body": name, "position_m": number(speaking, 4)}]
            contacts.append({"name": f"{name}_head", "between": [f"{course}_hammer", f"{name}_struck"], "material": "felt_c4", "weight": number(between(p, "weight", at)),
                             "gap_m": 0.003})
            links.append({"name": f"{name}_bridge", "between": [f"{name}_over_bridge", f"bridge_{course}"]})
        bodies.insert(-1, {"name": f"{course}_hammer", "mass_kg": number(p["hammer"])})  # drawn between its strings
        places.append({"name": f"bridge_{course}", "body": "board", "shapes": [number(between(p, "coupled", at) * shapes[i]) for _, _, shapes, _, _ in MODES]})
        keys.append({"first": first, "last": last, "event": f"strike_{course}_hammer", "tuned_key": key, "per_octave": number(p["stronger"]), "bodies": [f"{course}_1", f"{course}_2"]})
    bodies.append({"name": "board", "modes": table(p)})
    places += [{"name": side, "body": "board", "shapes": [number(h * mode[sign]) for h, mode in zip(heard, MODES)]} for side, sign in (("left", 3), ("right", 4))]
    strings = [f"{course}_{side}" for course in COURSES for side in ("1", "2")]
    heads, bridges = ([f"{name}_{part}" for name in strings] for part in ("head", "bridge"))
    return {"name": "dulcimer", "description": "hammered dulcimer, courses of two strings on a board", "bodies": bodies, "places": places, "contacts": contacts, "links": links,
            "controls": [{"name": "head", "stiffness_ratio": heads, "min": 0.01, "max": 100}, {"name": "head", "loss_s_per_m": heads, "initial": 0.1, "max": 2},
                         {"name": "hand", "damping_per_s": strings, "max": 1000}],
            "strikes": [f"{course}_hammer" for course in COURSES],
            "outputs": [{"name": "left", "velocity_m_per_s": "left", "full_scale": 0.22}, {"name": "right", "velocity_m_per_s": "right", "full_scale": 0.22},
                        {"name": "bridge", "force_n": bridges, "full_scale": 40}, {"name": "hammer", "force_n": heads}],
            "input": {"force_n": "bridge_cs5", "full_scale": 10}, "keys": keys, "polyphony": 8, "damper": {"bodies": strings, "damping_per_s": 8}}


# As bench/strings.py says. C6 has nothing above 6 kHz in FluidR3 GM, whose C7 is the same sound: it was recorded at a lower rate.
DULCIMER = {"events": [], "velocity": 0.7, "inharmonicity": INHARMONICITY, "seconds": 1.2, "top": 12000, "tops": {84: 6000}}


def velocities(program, key, seconds=DULCIMER["seconds"]):
    """Of the modes of the board in a note, up to one factor."""
    file = dulcimer()
    file["outputs"] = [{"name": f"under_{course}", "force_n": [f"{course}_1_bridge", f"{course}_2_bridge"]} for course in COURSES]
    forces = [rendered(program, {**DULCIMER, "seconds": seconds}, file, key, "--bits", "32", "--signal", f"under_{course}") for course in COURSES]
    found = []
    for mode, (_, _, shapes, _, _) in zip(table(NUMBERS), MODES):
        w, decay = 2 * np.pi * mode["frequency_hz"], mode["decay_per_s"]
        turn = np.exp((1j * w - decay) / RATE)
        found.append(lfilter([1, -turn.real - decay / w * turn.imag], [1, -2 * turn.real, abs(turn) ** 2], shapes @ forces) / mode["mass_kg"])
    return np.array(found)


class Parts:
    """What each mode of the board adds to the spectra of a note, which depend on the vector `heard` linearly."""

    def __init__(self, of_modes, key, heard):
        sound = heard @ of_modes
        note, begin = Note(sound, key, DULCIMER), onset(sound)
        of_modes = of_modes[:, begin:]
        bank = mel_bank(DULCIMER["tops"].get(key, DULCIMER["top"]))
        self.bank = bank[:, bank.any(0)]
        self.windows = np.array([windows(of, DULCIMER["seconds"]) for of in of_modes]).astype(np.complex64)[:, :, bank.any(0)]
        self.whole = np.fft.rfft(of_modes[:, :int(0.6 * RATE)], RATE) * 10 ** (a_weighting(np.fft.rfftfreq(RATE, 1 / RATE)) / 20)
        n = 1 << 15
        part = of_modes[:, int(0.03 * RATE):int(0.03 * RATE) + n]
        self.partials = np.fft.rfft(part * np.blackman(part.shape[1]), n)[:, [round(f * n / RATE) for f in note.at]]

    @staticmethod
    def levels(spectra, heard, summed):
        """Levels [dB] of the sum of spectra, of which `summed` makes few powers, and their slopes over the logarithms of `heard`."""
        spectrum = np.tensordot(heard, spectra, 1)
        power = summed(np.abs(spectrum) ** 2)
        slopes = np.array([summed(2 * h * (np.conj(spectrum) * of).real) for h, of in zip(heard, spectra)])
        return 10 * np.log10(power + 1e-30), 10 / np.log(10) * slopes / (power + 1e-30)

    def residuals(self, heard, note):
        """As strings.residuals, without decays, and slopes."""
        n = min(self.windows.shape[1], len(note.power)) // 4 * 4
        mean = lambda power: power.reshape(n // 4, 4, -1).mean(1)
        ours, slopes = self.levels(self.windows[:, :n], heard, lambda power: mean(power @ self.bank.T))
        loudness, of_loudness = self.levels(self.whole, heard, lambda power: power.sum())
        floor = note.mel.max() - 60
        ours += note.loudness - loudness
        slopes = np.where(ours > floor, slopes - of_loudness[:, None, None], 0)
        d = np.maximum(ours, floor) - np.maximum(10 * np.log10(mean(note.power[:n])), floor)
        levels, of_levels = self.levels(self.partials, heard, lambda power: power)
        is_heard = (note.levels > note.levels.max() - 50)[:len(levels)]
        apart = (levels - note.levels[:len(levels)])[is_heard]
        middle = np.argsort(apart)[len(apart) // 2]
        apart, of_levels = apart - apart[middle], (of_levels - of_levels[:, is_heard][:, [middle]])[:, is_heard]
        gain = (robust(apart + 1e-3) - robust(apart - 1e-3)) / 2e-3
        scale = LEVELS / np.sqrt(20)
        return (np.concatenate([d.ravel() / np.sqrt(d.size), scale * robust(apart)]),
                np.concatenate([slopes.reshape(len(heard), -1) / np.sqrt(d.size), scale * gain * of_levels], 1).T)


def powers(of_modes):
    """Matrix whose quadratic form of `heard` is the A-weighted power of 0.6 s of a note, as in notes.loudness."""
    begin = onset(HEARD @ of_modes)
    spectra = np.fft.rfft(of_modes[:, begin:begin + int(0.6 * RATE)], RATE) * 10 ** (a_weighting(np.fft.rfftfreq(RATE, 1 / RATE)) / 20)
    return (spectra @ spectra.conj().T).real


def search_heard(program, recordings):
    theirs = notes_of(recordings, DULCIMER)
    expected = louder(theirs)
    signs = np.array([mode[3] for mode in MODES])
    every = {key: powers(velocities(program, key, 0.6) * signs[:, None]) for key in KEYS}
    aims = np.interp(KEYS, list(expected), list(expected.values()))

    def apart(x):
        """How much louder than recorded keys are, less the mean [dB(A)], and slopes."""
        h = np.exp(x)
        found = [h @ of @ h for of in every.values()]
        slopes = np.array([20 / np.log(10) * h * (of @ h) / power for of, power in zip(every.values(), found)])
        d = 10 * np.log10(found) - aims
        return d - d.mean(), slopes - slopes.mean(0)

    parts = {key: Parts(velocities(program, key), key, signs * HEARD) for key in FITTED}
    pairs = (np.eye(len(MODES), k=1) - np.eye(len(MODES)))[[bool(a[1]) == bool(b[1]) for a, b in zip(MODES, MODES[1:])] + [False]]
    x = np.log(HEARD)
    for alike in ALIKE:
        def found(x):
            both = [parts[key].residuals(signs * np.exp(x), note) for (_, key), note in theirs.items()]
            both.append(tuple(EVEN * of for of in apart(x)))
            return np.concatenate([d for d, _ in both] + [alike * pairs @ x]), np.concatenate([slopes for _, slopes in both] + [alike * pairs])

        best = least_squares(lambda x: found(x)[0], x, lambda x: found(x)[1], max_nfev=20, ftol=1e-3)
        x = best.x
        print(f"{2 * best.cost:.3f}", flush=True)
    return [number(h) for h in np.exp(x + np.mean(np.log(HEARD) - x))]  # as loud as before


def search_numbers(program, recordings):
    theirs = notes_of(recordings, DULCIMER)
    expected = louder(theirs)
    best, p = np.inf, dict(NUMBERS)

    def is_better(q):
        nonlocal best, p
        file = dulcimer(q)
        ours = {key: Note(rendered(program, DULCIMER, file, key), key, DULCIMER) for key in FITTED}
        with ThreadPoolExecutor(2) as pool:
            levels = dict(zip(KEYS, pool.map(lambda key: loudness(rendered(program, {**DULCIMER, "seconds": 0.6}, file, key)), KEYS)))
        cost = sum((residuals(ours[key], note) ** 2).sum() for (_, key), note in theirs.items())
        cost += EVEN ** 2 * (loudness_apart(levels, expected) ** 2).sum()
        if cost > best - 0.3:
            return False
        best, p = cost, q
        print(f"{best:.3f}", p, flush=True)
        return True

    is_better(p)
    for step in (1.3, 1.12):
        for name in p:
            for factor in (step, 1 / step):
                is_moved = False
                while is_better({**p, name: number(p[name] * factor)}):
                    is_moved = True
                if is_moved:
                    break
    return p


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "write":
        Path(sys.argv[2]).write_text(HEADER + text_of(dulcimer()), encoding="utf-8")
    elif len(sys.argv) == 4 and sys.argv[1] in ("heard", "fit"):
        print({"heard": search_heard, "fit": search_numbers}[sys.argv[1]](*sys.argv[2:]))
    elif len(sys.argv) == 6 and sys.argv[1] == "distance":
        distance(sys.argv[2], {"dulcimer": {**DULCIMER, "tops": {}}}, *sys.argv[3:])
    else:
        sys.exit(__doc__)
