# SPDX-License-Identifier: MIT
"""What the fits of strings to recorded notes share: how a note is compared, a search by least squares, and distances.

A kind of instrument is a dict:

    of              makes its file, from numbers and what `strings` says of a key
    strings         that, of each key that is fitted
    usual, begin    numbers that are usual, and where a search ended that began there
    ranges          of the numbers, by their name or by what stands before its last _
    about           comment at the head of the file
    events          of the score, before each note, whose `velocity` is that
    inharmonicity   of the partials of a key, for all that are compared
    seconds, top    how long, and up to which frequency [Hz]; `tops`: of single keys
    prior           how much a distance from the usual number counts
    loudness        how much a decibel of it counts, between the keys that are `compared`
    sound           if there, makes the sound of a file, a key and seconds, in place of the program

What is made small is, for each note,

    differences of log-mel spectrograms: 48 bands from 60 Hz to `top`, each note of the same A-weighted loudness, down to 60 dB below
        the recording's largest value, means over 46 ms
    differences of the levels of partials 1 to 20 over 0.7 s, less their median
    logarithms of the ratios of the decays of these partials from 40 to 500 ms
"""
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.signal import fftconvolve

from notes import RATE, from_onset, loudness, mel, named, recorded, rendered, rounded, text_of

LEVELS, DECAYS = 1.5, 3.5  # how much a decibel of a partial and an octave of its decay count beside a decibel of the spectrograms
DAMPINGS, ENOUGH = (0.03, 0.1, 0.3, 1, 3, 10), 0.002  # of the steps of a search, which ends at one that gains less than this part
FAR = 4  # differences of partials beyond these decibels count by their size, not by its square


def number(x, digits=3):
    x = rounded(x, digits)
    return int(x) if x == int(x) else x


class Note:
    def __init__(self, sound, key, of):
        self.loudness = loudness(sound)
        sound = from_onset(sound)
        self.power = mel(sound, min(of["seconds"], len(sound) / RATE), of["tops"].get(key, of["top"]))
        self.mel = 10 * np.log10(self.power + 1e-30)
        n = 1 << 15
        part = sound[int(0.03 * RATE):int(0.03 * RATE) + n]
        power, f = np.abs(np.fft.rfft(part * np.blackman(len(part)), n)) ** 2, np.fft.rfftfreq(n, 1 / RATE)
        b = of["inharmonicity"][key]
        f0 = 440 * 2 ** ((key - 69) / 12)
        self.levels, self.sound, self.at = [], sound, []
        for k in range(1, 21):
            at = k * f0 * np.sqrt(1 + b * k * k)
            if at > 0.45 * RATE:
                self.levels.append(-300)
                continue
            near = (f > at - 0.15 * f0 - 0.01 * at) & (f < at + 0.15 * f0 + 0.01 * at)
            self.at.append(f[near][np.argmax(power[near])])
            self.levels.append(10 * np.log10(power[near].max() + 1e-30))
        self.levels, self.width = np.array(self.levels), min(0.5 * f0, 60)

    def differences(self, other):
        """Of log-mel spectrograms, by window and band; other is the recording [dB]."""
        n, floor = min(len(self.mel), len(other.mel)), other.mel.max() - 60
        ours = self.mel[:n] - self.loudness + other.loudness
        return np.maximum(ours, floor) - np.maximum(other.mel[:n], floor)

    def levels_apart(self, other):
        """Of partials that the recording has within 50 dB, less their median [dB]."""
        d = (self.levels - other.levels)[other.levels > other.levels.max() - 50]
        return d - np.median(d)

    @cached_property
    def decays(self):
        """Of the partials, 40 to 500 ms after the onset [dB/s]."""
        sound = self.sound[:int(0.56 * RATE)]
        found, t = [], np.arange(len(sound)) / RATE
        half = int(RATE / self.width)
        window = np.hanning(2 * half + 1)
        for f in self.at:
            level = 20 * np.log10(np.abs(fftconvolve(sound * np.exp(-2j * np.pi * f * t), window / window.sum(), "same")[::441]) + 1e-30)
            found.append(-100 * np.polyfit(np.arange(4, 50), level[4:50], 1)[0])
        return np.pad(found, (0, 20 - len(found)), constant_values=np.nan)


def notes_of(folder, of):
    return {(source, int(key)): Note(sound, int(key), of) for (source, key), sound in recorded(folder).items()}


def robust(d):
    """Differences of partials or of loudness [dB]: beyond FAR they count by their size."""
    return np.sign(d) * FAR * np.sqrt(2 * np.sqrt(1 + (d / FAR) ** 2) - 2)


def louder(notes):
    """By key, how much louder than the mean of the keys [dB(A)], the median over the sources. notes: by source and key."""
    apart = {}
    for source in sorted({source for source, _ in notes}):
        loudness = {key: note.loudness for (at, key), note in notes.items() if at == source}
        for key, level in loudness.items():
            apart.setdefault(key, []).append(level - np.mean(list(loudness.values())))
    return {key: np.median(levels) for key, levels in sorted(apart.items())}


def loudness_apart(levels, expected):
    """levels [dB(A)] by key; expected: what louder() says of recordings. Less their mean."""
    d = np.array([level - np.interp(key, list(expected), list(expected.values())) for key, level in levels.items()])
    return d - d.mean() if len(d) else d


def spectral_residuals(ours, theirs):
    """Of a note, without its decays."""
    n = min(len(ours.mel), len(theirs.mel)) // 4 * 4
    floor = theirs.mel.max() - 60
    mean = [10 * np.log10(np.maximum(of.power[:n].reshape(n // 4, 4, -1).mean(1), 1e-30)) for of in (ours, theirs)]
    d = np.maximum(mean[0] - ours.loudness + theirs.loudness, floor) - np.maximum(mean[1], floor)
    levels = np.zeros(20)
    is_heard = theirs.levels > theirs.levels.max() - 50
    levels[is_heard] = robust(ours.levels_apart(theirs))
    return np.concatenate([d.ravel() / np.sqrt(d.size), LEVELS * levels / np.sqrt(20)])


def residuals(ours, theirs):
    """Of a note."""
    is_heard = theirs.levels > theirs.levels.max() - 50
    ratios = np.log2(np.maximum(ours.decays, 3) / np.maximum(theirs.decays, 3))
    ratios = np.where(is_heard & np.isfinite(ratios), np.clip(ratios, -2, 2), 0)
    return np.concatenate([spectral_residuals(ours, theirs), DECAYS * ratios / np.sqrt(20)])


def fit(program, of, folder, path):
    theirs = {at: note for at, note in notes_of(folder, of).items() if at[1] in of["strings"]}
    expected = louder(theirs)
    names = list(of["begin"])
    ranges = np.array([of["ranges"][name if name in of["ranges"] else name.rsplit("_", 1)[0]] for name in names], float)
    is_ratio = ranges[:, 0] > 0  # searched by ratios
    place = lambda numbers: np.where(is_ratio, np.log(np.where(is_ratio, numbers, 1)), numbers)
    usual, begin = (place([of[at][name] for name in names]) for at in ("usual", "begin"))
    low, high = place(ranges[:, 0]), place(ranges[:, 1])
    begin = np.clip(begin, low + 1e-6, high - 1e-6)
    steps = np.where(is_ratio, np.minimum(0.05, (high - low) / 50), 0.1)

    def numbers(x):
        return dict(zip(names, np.where(is_ratio, np.exp(np.where(is_ratio, x, 0)), x)))

    def sound(x, key, seconds):
        if "sound" in of:
            return of["sound"](of["of"](numbers(x)), key, seconds)
        open_key = max(open_key for open_key in of["strings"] if open_key <= key)
        return rendered(program, {**of, "seconds": seconds}, of["of"](numbers(x), of["strings"][open_key]), key)

    def of_key(job):
        x, key = job
        return Note(sound(x, key, of["seconds"]), key, of)

    def loudness_of_key(job):
        x, key = job
        return loudness(sound(x, key, 0.6))

    def all_at(places):
        with ThreadPoolExecutor(2) as pool:
            ours = list(pool.map(of_key, [(x, key) for x in places for key in of["strings"]]))
            levels = list(pool.map(loudness_of_key, [(x, key) for x in places for key in of["compared"]]))
        found = []
        for i, x in enumerate(places):
            here = dict(zip(of["strings"], ours[i * len(of["strings"]):]))
            apart = loudness_apart(dict(zip(of["compared"], levels[i * len(of["compared"]):])), expected)
            found.append(np.concatenate([residuals(here[key], note) for (_, key), note in theirs.items()]
                                        + [of["loudness"] * robust(apart), of["prior"] * (x - usual)]))
        return found

    x = begin
    while True:
        signed = np.where(x + steps > high, -steps, steps)
        here, *beside = all_at([x] + list(x + np.diag(signed)))
        cost = np.sum(here ** 2)
        print(f"{cost:.3f}", {name: rounded(value, 3) for name, value in numbers(x).items()}, flush=True)
        slopes = np.array([there - here for there in beside]).T * np.sign(signed)
        places = [np.clip(x - steps * np.linalg.solve(slopes.T @ slopes + damping * np.eye(len(x)), slopes.T @ here), low, high) for damping in DAMPINGS]
        costs = [np.sum(there ** 2) for there in all_at(places)]
        if min(costs) < cost:
            x = places[np.argmin(costs)]
        if min(costs) > (1 - ENOUGH) * cost:
            break
    Path(path).write_text(of["about"] + text_of(of["of"](numbers(x), sum(of["strings"].values(), ()))), encoding="utf-8")


def shown(ours, folders, of):
    for name, folder in zip(("fitted", "kept"), folders):
        theirs = notes_of(folder, of)
        for source in sorted({source for source, _ in theirs}):
            pairs = [(ours[key], note) for (at, key), note in theirs.items() if at == source]
            decays = [np.log2(np.maximum(a.decays, 0.5) / np.maximum(b.decays, 0.5)) for a, b in pairs]
            print(f"{name}, {source}: log-mel {np.mean([np.abs(a.differences(b)).mean() for a, b in pairs]):.2f} dB, partials "
                  f"{np.median(np.abs(np.concatenate([a.levels_apart(b) for a, b in pairs]))):.1f} dB, decays x {2 ** np.nanmedian(np.abs(np.concatenate(decays))):.2f}"
                  f" ({2 ** np.nanmedian(np.concatenate(decays)):.2f})")
        expected = louder(theirs)
        apart = loudness_apart({key: ours[key].loudness for key in expected}, expected)
        print(f"{name}: louder than recorded beside the others, by key:", ", ".join(f"{key} {d:+.1f}" for key, d in zip(expected, apart)), "dB(A)")


def distance(program, kinds, path, *folders):
    """kinds: by the name of the file."""
    of = named(path, kinds)
    shown({key: Note(rendered(program, of, path, key), key, of) for key in of["inharmonicity"]}, folders, of)
