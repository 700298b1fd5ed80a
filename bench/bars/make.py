#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes the files of marimba and kalimba, with parts that are fitted to recorded notes.

    make.py write marimba|kalimba FILE
    make.py fit PROGRAM marimba|kalimba RECORDINGS      # prints numbers, which stand below
    make.py distance PROGRAM FILE FITTED KEPT

PROGRAM is contactspline. RECORDINGS, FITTED and KEPT hold SOURCE/KEY.wav, single notes at 44.1 kHz under their keys of MIDI. Fitted
are notes of FluidR3 GM (fluid-soundfont-gm, MIT): of its Marimba C3, C4, C5 and C6, of its Kalimba F4, A4 and F5. `fit` searches by least squares from the numbers below: small are
made, for each note,

    differences of log-mel spectrograms: 48 bands from 60 Hz to 12 kHz, each note of the same A-weighted loudness, down to 60 dB
        below the recording's largest value, means over 46 ms
    of the marimba, differences of the level of the lowest partial, each 10 ms, up to 0.4 s
    of the kalimba, the difference of the level of the first overtone beside the lowest partial, up to 0.1 s
    for more keys, how far their loudness, less the mean, and how much they fall are from lines through those of the recordings [dB(A)]
    for more keys of the kalimba, how far the overtone is from those of the recordings beside

All notes are fitted together, by numbers whose logarithms are polynomials of the key, so that they change smoothly from key to key.

Kept: F#4 and F#5 of Marimba, whose notes are one at several speeds, C4 of 19-marimba of scratch-vm (npm); C6 of Kalimba.

`distance` prints, for each source, the means over its notes of the differences of log-mel spectrograms and of what is compared
beside them, and how loud each note is, less the mean of the source [dB(A)].
"""
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.signal import fftconvolve

sys.path.insert(0, str(Path(__file__).parents[1]))
from notes import RATE, from_onset, loudness, mel, named, recorded, rendered, rounded, text_of

MARIMBA = """\
// Marimba of C3 to C6: six bars, each with its tube and its mallet, of which keys tune one to half an octave. Bars as usual, 0.33 m and
// 0.33 kg at C4; of an octave higher 0.79 times as long and 0.67 times as heavy. An arch over 0.73 of the length, which leaves 0.34 of the
// thickness in the middle, puts the overtones at 4.04 and 9.56; the bending stiffness gives the pitch, with the spring of the air. The air
// of a tube, 48 mm wide at C4 and 0.71 times that an octave higher, is a table of modes: (2 n - 1) times the frequency that the spring of
// the air raises to that of the bar, modal mass rho S L/2, times 64, because its displacement here is that of a piston of 8 S, the bar over
// the mouth; the decay of the first, 30 1/s at C4 and as the frequency, makes notes peak when recorded ones do, after 120 to 30 ms; that of
// the second is by radiation, c (k a)^2/(4 L), and by friction at the wall, c 1.2e-5 sqrt(omega)/a.
// Written by bench/bars/make.py: losses of the bars, where they are heard, the heads' weights and the mallets change smoothly over the
// keys, fitted to recorded notes of FluidR3 GM (MIT) and to how loud these are.
"""
KALIMBA = """\
// Kalimba of C4 to E6: five tines on a box, of which keys tune one to half an octave. A tine is a strip of spring steel, 4 x 0.8 mm with
// 200 GPa and 7850 kg/m^3, clamped 23.6 mm behind the bridge, which is a link to the box; its length gives the pitch. Because a tine
// bends behind its bridge, too, the first overtone is at 6.75 for A4, 5.07 for D6; that of a bar clamped at the bridge at 6.27.
// Recorded are 6.75 for A4 and 5.19 for C6. The box is 0.53 l with a hole of 28 mm: the air in it is a mass, rho S (4 mm + 1.7 a), times
// (A/S)^2, A = 0.009 m^2 of the lid, on the spring rho c^2 A^2/V. The frequencies of its modes are peaks between the partials of recorded
// notes; their quality is 3.5, so that no key stands out. Overtones of F4 to F5 decay by 18 to 23 1/s, as recorded ones do, higher ones faster; modes above 10.5 kHz are left out.
// Written by bench/bars/make.py: how losses and forces change from key to key, and how loud each mode of the box is, are fitted to recorded
// notes of FluidR3 GM (MIT).
"""
C, RHO = 343, 1.2
PRIOR = 0.5  # how much an e-fold from where a search begins counts beside a decibel
EVEN, BRIGHT = 1, 0.3  # how much a decibel of a key's loudness and fall counts, and of its overtone
WIDER = 8  # the bar's surface over the mouth
BARS = {"ds3": (48, 53), "a3": (54, 59), "ds4": (60, 65), "a4": (66, 71), "ds5": (72, 77), "a5": (78, 84)}  # keys
SHARP = {"ds3": 6.43, "a3": 3.87, "ds4": 2.32, "a4": 1.48, "ds5": 0.862, "a5": 0.521}  # cents, as rendered: the air is a spring under the bar
# Of logarithms: coefficients of polynomials of the octaves above F#4.
AIR = [0.0379, 6.5]  # of the springs: their slope from a search; so stiff that the tube lets the lowest bar decay 1.5 times as fast
MARIMBA_NUMBERS = {"constant": [0.455, 1.09], "quadratic": [-0.212, -4.3], "heard": [-0.313, -1.47], "weight": [1.45, 4.34], "mallet": [-0.36, -3.29]}


def at_key(coefficients, key):
    return rounded(np.exp(np.polyval(coefficients, (key - 66) / 12)), 3)


def middle(keys):
    return (keys[0] + keys[1] + 1) // 2


def marimba(numbers=MARIMBA_NUMBERS, sharp=SHARP):
    file = {"name": "marimba", "description": "marimba of three octaves", "bodies": [], "places": [], "contacts": [], "springs": [], "controls": [], "strikes": [],
            "outputs": [], "input": {"force_n": "struck_ds4"}, "keys": []}
    for name in BARS:
        (first, last), key = BARS[name], middle(BARS[name])
        p = {number: at_key(coefficients, key) for number, coefficients in {**numbers, "air": AIR}.items()}
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
                                            "bending_stiffness_n_m2": rounded(608.128 * (f / 261.626 / 2 ** (sharp[name] / 1200)) ** 2 * mass / 0.33 * (length / 0.33) ** 3, 6),
                                            "constant_loss_per_s": p["constant"], "quadratic_loss_m2_per_s": p["quadratic"],
                                            "undercut": {"length_m": rounded(0.24 / 0.33 * length, 4), "thickness_ratio": 0.34}}, "max_modes": 4},
            {"name": f"tube_{name}", "modes": tube}, {"name": f"mallet_{name}", "mass_kg": p["mallet"]}]
        file["places"] += [{"name": f"struck_{name}", "body": f"bar_{name}", "position_m": at["struck"]},
                           {"name": f"over_mouth_{name}", "body": f"bar_{name}", "position_m": at["over_mouth"]},
                           {"name": f"heard_{name}", "body": f"bar_{name}", "position_m": at["heard"]},
                           {"name": f"mouth_{name}", "body": f"tube_{name}", "shapes": [1, 1]},
                           {"name": f"opening_{name}", "body": f"tube_{name}", "shapes": [WIDER, WIDER]}]
        file["contacts"].append({"name": f"head_{name}", "between": [f"mallet_{name}", f"struck_{name}"], "material": "felt_c4", "weight": p["weight"], "gap_m": 0.005})
        file["springs"].append({"name": f"air_{name}", "between": [f"over_mouth_{name}", f"mouth_{name}"], "stiffness_n_per_m": p["air"]})
        file["keys"].append({"first": first, "last": last, "event": f"strike_mallet_{name}", "tuned_key": key, "bodies": [f"bar_{name}", f"tube_{name}"]})
    every = lambda part: [f"{part}_{name}" for name in BARS]
    file["controls"] = [{"name": "tubes", "damping_per_s": every("tube"), "max": 1e4},
                        {"name": "head", "stiffness_ratio": every("head"), "min": 0.01, "max": 100}, {"name": "hand", "damping_per_s": every("bar"), "max": 1000}]
    file["strikes"] = every("mallet")
    file["outputs"] = [{"name": "both", "velocity_m_per_s": every("opening") + every("heard"), "full_scale": 5.5}, {"name": "bars", "velocity_m_per_s": every("heard"), "full_scale": 2}]
    return file


# The kalimba: a strip of spring steel, 4 x 0.8 mm with 200 GPa and 7850 kg/m^3, is clamped 23.6 mm behind the bridge.
TINES = {"ds4": (60, 65), "a4": (66, 71), "ds5": (72, 77), "a5": (78, 83), "d6": (84, 88)}  # keys
FLAT = {"ds4": -0.0809, "a4": -0.159, "ds5": -0.0786, "a5": 0.0193, "d6": -0.0505}  # cents, as rendered
EI, MU, BEHIND, MODES = 0.034133, 0.02512, 0.0236, 8
HIGHEST = 10500  # Hz: higher modes are left out, so that the pitch is the same at all sample rates from 22 kHz on
QUALITY, BRIDGE = 3.5, 0.03  # of the box's modes: so low that no key is 3 dB(A) louder than its neighbour; so small that tines lose little
BOX = [500, 840, 1060, 1235, 1540, 1930, 2600, 3490, 4700]  # Hz: peaks between the partials of the recordings
KALIMBA_NUMBERS = {"constant": [-0.964, 1.82], "stronger": [-1.18], "heard_500": [2.9], "heard_840": [4.31], "heard_1060": [5.58], "heard_1235": [5.66], "heard_1540": [4.39], "heard_1930": [2.88], "heard_2600": [2.77], "heard_3490": [3.92], "heard_4700": [4.51]}
ROOTS = np.array([brentq(lambda z: np.cos(z) + 1 / np.cosh(z), n * np.pi, (n + 1) * np.pi) for n in range(MODES)])


def free(length, modes=MODES):
    """Frequencies of a clamped bar [Hz]."""
    return (ROOTS[:modes] / length) ** 2 * np.sqrt(EI / MU) / (2 * np.pi)


def partials(length, modes=MODES):
    """Of a bar clamped at one end that rests on the bridge [Hz]: of its modes, where none moves there."""
    roots = ROOTS[:modes]
    z, s = roots * BEHIND / length, (np.cosh(roots) + np.cos(roots)) / (np.sinh(roots) + np.sin(roots))
    squares = (np.cosh(z) - np.cos(z) - s * (np.sinh(z) - np.sin(z))) ** 2
    w = 2 * np.pi * free(length, modes)
    return [brentq(lambda x: (squares / (w ** 2 - x ** 2)).sum(), a * (1 + 1e-9), b * (1 - 1e-9)) / (2 * np.pi) for a, b in zip(w, w[1:])]


def kalimba(numbers=KALIMBA_NUMBERS, sharp=FLAT):
    bodies, places, links, controls, keys = [], [], [], [], []
    for name, (first, last) in TINES.items():
        key = middle((first, last))
        p = {number: at_key(coefficients, key) for number, coefficients in numbers.items()}
        hz = 440 * 2 ** ((key - 69 - sharp[name] / 100) / 12)
        length = brentq(lambda l: partials(l)[0] - hz, 1.2 * BEHIND, 0.2)
        modes = int((free(length) * 2 ** ((last - key) / 12) < HIGHEST).sum())
        length = rounded(brentq(lambda l: partials(l, modes)[0] - hz, 1.2 * BEHIND, 0.2))
        bodies.append({"name": f"tine_{name}", "bar": {"length_m": length, "mass_kg": rounded(MU * length), "bending_stiffness_n_m2": EI, "ends": ["clamped", "free"],
                                                       "constant_loss_per_s": p["constant"], "quadratic_loss_m2_per_s": 9e-4}, "max_modes": modes})
        places += [{"name": f"tip_{name}", "body": f"tine_{name}", "position_m": length}, {"name": f"over_bridge_{name}", "body": f"tine_{name}", "position_m": BEHIND}]
        links.append({"name": f"bridge_{name}", "between": [f"over_bridge_{name}", "bridge"]})
        controls.append({"name": f"thumb_{name}", "force_n": f"tip_{name}", "min": -20, "max": 20, "release_n": rounded(3 * p["stronger"] ** ((key - 66) / 12), 3)})
        keys.append({"first": first, "last": last, "event": f"pluck_thumb_{name}", "tuned_key": key, "per_octave": p["stronger"], "bodies": f"tine_{name}"})
    bodies += [{"name": "box", "modes": [{"frequency_hz": f, "decay_per_s": rounded(np.pi * f / QUALITY, 3), "mass_kg": 0.1} for f in BOX]}, {"name": "air", "mass_kg": 0.00438}]
    places += [{"name": "bridge", "body": "box", "shapes": [BRIDGE] * len(BOX)}, {"name": "inwards", "body": "box", "shapes": [-1] + [0] * (len(BOX) - 1)},
               {"name": "heard", "body": "box", "shapes": [rounded((-1) ** n * p[f"heard_{f}"], 3) for n, f in enumerate(BOX)]}]
    return {"name": "kalimba", "description": "kalimba, tines on a box", "bodies": bodies, "places": places,
            "springs": [{"name": "cavity", "between": ["inwards", "air"], "stiffness_n_per_m": 21580}, {"name": "hole", "between": ["air", "ground"], "resistance_n_s_per_m": 2}],
            "links": links, "controls": controls + [{"name": "hand", "damping_per_s": [f"tine_{name}" for name in TINES], "max": 1000}],
            "outputs": [{"name": "box", "velocity_m_per_s": ["heard", "air"], "full_scale": 0.08}, {"name": "bridge", "force_n": [f"bridge_{name}" for name in TINES], "full_scale": 40}],
            "input": {"force_n": "bridge", "full_scale": 10}, "keys": keys}


# Of each: its file, the numbers that are searched, the seconds and notes that are fitted, what is compared beside spectrograms, and the
# keys whose loudness and whose overtones are.
KINDS = {"marimba": {"about": MARIMBA, "file": marimba, "numbers": MARIMBA_NUMBERS, "sharp": SHARP, "keys": BARS, "events": [], "velocity": 0.5, "seconds": 0.8, "notes": (48, 60, 72, 84),
                     "beside": "rise", "even": (48, 53, 54, 59, 60, 65, 66, 71, 72, 77, 78, 84), "bright": ()},
         "kalimba": {"about": KALIMBA, "file": kalimba, "numbers": KALIMBA_NUMBERS, "sharp": FLAT, "keys": TINES, "events": [], "velocity": 0.5, "seconds": 0.3, "notes": (65, 69, 77),
                     "beside": "overtone", "even": (*range(60, 87, 2), 71, 87, 88), "bright": (60, 61, 62, 63, 64, 67, 71, 73)}}


def fall(sound, seconds):
    """How much softer the last third is than one that begins after the first sixth [dB(A)]."""
    return loudness(sound, seconds / 6, seconds / 2) - loudness(sound, seconds * 2 / 3, seconds)


class Note:
    def __init__(self, sound, key, seconds):
        sound = from_onset(sound)
        sound = np.pad(sound, (0, max(0, int(seconds * RATE) - len(sound))))
        self.loudness, self.fall = loudness(sound), fall(sound, seconds)
        hz = 440 * 2 ** ((key - 69) / 12)
        window = np.hanning(int(4 / hz * RATE))
        rise = np.abs(fftconvolve(sound * np.exp(-2j * np.pi * hz * np.arange(len(sound)) / RATE), window, "same"))[:int(0.4 * RATE):441]
        self.rise = np.maximum(20 * np.log10(rise / rise.max() + 1e-30), -30)  # of the lowest partial, each 10 ms [dB]
        power = np.abs(np.fft.rfft(sound[:RATE // 10] * np.hanning(RATE // 10), RATE)) ** 2
        highest = [power[int(low * hz):int(high * hz)].max() for low, high in ((0.9, 1.1), (4.5, 7.5))]
        self.overtone = 10 * np.log10(highest[1] / highest[0])  # of a tine, beside its lowest partial [dB]
        power = mel(sound, seconds, 12000)
        n = len(power) // 4 * 4
        self.mel = 10 * np.log10(power[:n].reshape(n // 4, 4, -1).mean(1) + 1e-30)

    def differences(self, recording):
        """Of log-mel spectrograms of the same loudness, down to 60 dB below the recording's largest value [dB]."""
        floor = recording.mel.max() - 60
        return np.maximum(self.mel - self.loudness + recording.loudness, floor) - np.maximum(recording.mel, floor)


def notes_of(folder, seconds):
    return {(source, int(key)): Note(sound, int(key), seconds) for (source, key), sound in recorded(folder).items()}


def fit(program, kind, folder):
    of = KINDS[kind]
    recordings = {key: note for (_, key), note in notes_of(folder, of["seconds"]).items() if key in of["notes"]}
    ends = np.cumsum([len(coefficients) for coefficients in of["numbers"].values()])[:-1]
    usual = np.concatenate(list(of["numbers"].values()))
    keys = sorted({*of["notes"], *of["even"], *of["bright"]})
    line, of_fall = (np.polyfit(list(recordings), [vars(recording)[name] for recording in recordings.values()], 1) for name in ("loudness", "fall"))

    def numbers(x):
        return dict(zip(of["numbers"], np.split(x, ends)))

    def residuals(x):
        file = of["file"](numbers(x))
        with ThreadPoolExecutor(2) as pool:
            sounds = dict(zip(keys, pool.map(lambda key: rendered(program, of, file, key), keys)))
        notes = {key: Note(sounds[key], key, of["seconds"]) for key in keys}
        found = [PRIOR * (x - usual)]
        for key, recording in recordings.items():
            apart = [notes[key].differences(recording), vars(notes[key])[of["beside"]] - vars(recording)[of["beside"]]]
            found += [np.ravel(d) / np.sqrt(np.size(d)) for d in apart]
        louder = np.array([notes[key].loudness - np.polyval(line, key) for key in of["even"]])
        shorter = np.array([notes[key].fall - np.polyval(of_fall, key) for key in of["even"]])
        brighter = np.array([notes[key].overtone - np.interp(key, list(recordings), [r.overtone for r in recordings.values()]) for key in of["bright"]])
        return np.concatenate([*found, EVEN * (louder - louder.mean()), EVEN * shorter, BRIGHT * brighter])

    best = least_squares(lambda z: residuals(usual + z - 1), np.ones(len(usual)), diff_step=0.02, max_nfev=10)
    found = {name: [rounded(c, 3) for c in coefficients] for name, coefficients in numbers(usual + best.x - 1).items()}
    print(found, tuned(program, of, found))


def distance(program, path, *folders):
    of = named(path, KINDS)
    for name, folder in zip(("fitted", "kept"), folders):
        theirs = notes_of(folder, of["seconds"])
        for source in sorted({source for source, _ in theirs}):
            pairs = [(key, Note(rendered(program, of, path, key), key, of["seconds"]), note) for (at, key), note in theirs.items() if at == source]
            apart = [vars(ours)[of["beside"]] - vars(note)[of["beside"]] for _, ours, note in pairs]
            louder = np.array([ours.loudness - note.loudness for _, ours, note in pairs])
            print(f"{name}, {source}: log-mel {np.mean([np.abs(ours.differences(note)).mean() for _, ours, note in pairs]):.2f} dB, {of['beside']} "
                  f"{np.mean(np.abs(apart)):.1f} dB; louder than recorded beside the others, by key:",
                  ", ".join(f"{key} {d:+.1f}" for (key, *_), d in zip(pairs, louder - louder.mean())), "dB(A)")


def tuned(program, of, numbers):
    """By how many cents bars and tines would be sharp."""
    sharp = dict(of["sharp"])
    for _ in range(3):
        for name, keys in of["keys"].items():
            hz = 440 * 2 ** ((middle(keys) - 69) / 12)
            sound = rendered(program, {**of, "seconds": 1}, of["file"](numbers, sharp), middle(keys))[RATE // 4:]
            f = np.fft.rfftfreq(1 << 19, 1 / RATE)
            near = (f > 0.95 * hz) & (f < 1.05 * hz)
            heard = f[near][np.argmax(np.abs(np.fft.rfft(sound * np.hanning(len(sound)), 1 << 19))[near])]
            sharp[name] = rounded(sharp[name] + 1200 * np.log2(heard / hz), 3)
    return sharp


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "write" and sys.argv[2] in KINDS:
        about, file = KINDS[sys.argv[2]]["about"], KINDS[sys.argv[2]]["file"]
        Path(sys.argv[3]).write_text(about + text_of(file()), encoding="utf-8")
    elif len(sys.argv) == 5 and sys.argv[1] == "fit" and sys.argv[3] in KINDS:
        fit(*sys.argv[2:])
    elif len(sys.argv) == 6 and sys.argv[1] == "distance":
        distance(*sys.argv[2:])
    else:
        sys.exit(__doc__)
