#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fits `frequency_ratio` and `output_ratio` of a keyboard's `longitudinal` to recorded bass notes.

    phantoms.py RECORDINGS CS KEYBOARD

RECORDINGS is a folder as `compare.py fetch` makes it. CS is the program, KEYBOARD a keyboard file with `longitudinal`. Prints both
numbers, by the keys A and C from A0 to C3; with CONTACTSPLINE_KEYS=judge by D sharp and F sharp, which are for judging.

Phantom partials are the sums of the frequencies of partials m and n from 300 Hz to 3 kHz, where no partial lies within 6 Hz and where
the spectrum from 0.1 to 1.6 s stands 10 dB out of what is beside it. Partials are 13 dB above the median around them. Pairs have
2 <= m < n and 6 <= m + n < 40. A pair whose sum is less than 1.5 Hz above the one before counts with it as one.

frequency_ratio: the longitudinal mode |m - n| of frequency |m - n| ratio f0 is in resonance with a pair of m + n = ratio |m - n|. For
each ratio the power of a phantom partial follows from those of its partials and the response of the modes |m - n| and m + n (LOSS_PER_S
matters little), but for a factor for each note. The best ratio has the least mean deviation in dB of all phantom partials, each
held at 25 dB.

output_ratio: the power of all phantom partials over that of all partials is compared with that of the same notes as the program plays
them. The median over notes and layers of the difference in dB is the correction.
"""
import os
import sys
import tempfile

import numpy as np

import compare
from fit import read

SIZE, BEGIN_S = 1 << 16, 0.1
BELOW_HZ, APART_HZ, TOGETHER_HZ, OUT_DB, HELD_DB = 3000, 6, 1.5, 10, 25
LOSS_PER_S = 30
RATIOS = np.arange(9, 22, 0.1)
NOTES = [note for note in compare.NOTES if compare.key_of(note) <= 48]


def decibels(power):
    return 10 * np.log10(power + 1e-30)


class Note:
    """f0, the power of all partials in dB, and phantom partials: their level in dB, and (m, n, hz, product of powers in dB) of each pair."""

    def __init__(self, path, note):
        sound = compare.load(path)
        pitch = 440 * 2**((compare.key_of(note) - 69) / 12)
        _, self.f0, b = compare.partials(sound, pitch, 40)
        self.power, self.hz = compare.power(sound, BEGIN_S, SIZE), np.fft.rfftfreq(SIZE, 1 / compare.RATE)
        at = {k: k * self.f0 * np.sqrt(1 + b * k * k) for k in range(1, 81)}
        found = {k: self.peak(hz, 0.12 * pitch) for k, hz in at.items() if k <= 60 and hz < 4000}
        partials = {k: (hz, power) for k, (hz, power) in found.items()
                    if power > 20 * np.median(self.power[np.abs(self.hz - at[k]) < 0.45 * pitch])}
        self.partials_db = decibels(sum(power for _, power in partials.values()))
        pairs = sorted((partials[m][0] + partials[n][0], m, n, decibels(partials[m][1]) + decibels(partials[n][1]))
                       for n in partials for m in partials if 2 <= m < n and 6 <= m + n < 40)
        self.phantoms, last = [], -1e9
        for hz, m, n, product in pairs:
            if not 300 < hz < BELOW_HZ or min(abs(hz - other) for other in at.values()) < APART_HZ:
                continue
            beside = self.power[(np.abs(self.hz - hz) > 3) & (np.abs(self.hz - hz) < 6)]
            level = decibels(self.power[np.abs(self.hz - hz) < 1].max())
            pair = m, n, hz, product - 2 * self.partials_db
            if hz - last < TOGETHER_HZ:
                self.phantoms[-1][0] = max(self.phantoms[-1][0], level)
                self.phantoms[-1][1] = max(self.phantoms[-1][1], level - decibels(np.median(beside)))
                self.phantoms[-1][2].append(pair)
            else:
                self.phantoms.append([level, level - decibels(np.median(beside)), [pair]])
            last = hz
        self.phantoms = [(level - self.partials_db, pairs) for level, out, pairs in self.phantoms if out > OUT_DB]
        self.phantoms_db = decibels(sum(10**(level / 10) for level, _ in self.phantoms))

    def peak(self, hz, width):
        """Frequency and power of the largest peak near a frequency, by a parabola."""
        i = int(np.argmax(np.where(np.abs(self.hz - hz) < width, self.power, 0)))
        left, middle, right = np.log(self.power[i - 1:i + 2] + 1e-30)
        return (i + 0.5 * (left - right) / (left - 2 * middle + right)) * self.hz[1], self.power[i]

    def deviations(self, ratio):
        """Returns how far the levels of phantom partials are from those that a ratio predicts [dB]; the median is 0."""
        def response(m, n, hz):
            w, modes = 2 * np.pi * hz, np.array([n - m, n + m])
            own = 2 * np.pi * modes * ratio * self.f0
            return abs(((-1.0)**modes * (1 - own**2 / (own**2 - w**2 + 2j * LOSS_PER_S * w))).sum())
        off = np.array([level - decibels(sum(10**(product / 10) * response(m, n, hz)**2 for m, n, hz, product in pairs))
                        for level, pairs in self.phantoms])
        return off - np.median(off)


def notes_of(folder):
    return {(note, layer): Note(f'{folder}/{note}v{layer}.wav', note) for note in NOTES for layer in compare.SPEEDS}


def fit_ratio(notes):
    """The best ratio, its mean deviation and the median of those of all ratios [dB], and the number of phantom partials."""
    known = [note for note in notes.values() if len(note.phantoms) >= 5]
    if not known:
        sys.exit('no note has five phantom partials: give other recordings')
    mean = [np.mean(np.minimum(np.abs(np.concatenate([note.deviations(r) for note in known])), HELD_DB)) for r in RATIOS]
    return RATIOS[np.argmin(mean)], min(mean), np.median(mean), sum(len(note.phantoms) for note in known)


def main(recordings, program, keyboard):
    longitudinal = read(keyboard)['keyboard']['body']['longitudinal']
    recorded = notes_of(recordings)
    ratio, best, usual, count = fit_ratio(recorded)
    print(f'frequency_ratio {ratio:.1f}: mean deviation {best:.1f} dB of {count} phantom partials, median over all ratios {usual:.1f} dB')
    with tempfile.TemporaryDirectory() as folder:
        compare.score(folder, program, os.path.abspath(keyboard), notes=NOTES)
        ours = notes_of(folder)
    off = np.array([recorded[i].phantoms_db - ours[i].phantoms_db for i in recorded])
    for i, db in zip(recorded, off):
        print(f'{i[0]} layer {i[1]}: {len(recorded[i].phantoms)} and {len(ours[i].phantoms)} phantom partials, '
              f'recorded {recorded[i].phantoms_db:.1f} dB, ours {ours[i].phantoms_db:.1f} dB')
    soft, loud = compare.SPEEDS
    for whose, notes in (('recorded', recorded), ('ours', ours)):
        gains = [notes[note, loud].phantoms_db - notes[note, soft].phantoms_db for note in NOTES]
        print(f'{whose}: from layer {soft} to {loud} phantom partials gain {min(gains):.0f} to {max(gains):.0f} dB on the partials')
    print(f'output_ratio {longitudinal["output_ratio"] * 10**(np.median(off) / 20):.2g}: median difference {np.median(off):.1f} dB, '
          f'median deviation from it {np.median(np.abs(off - np.median(off))):.1f} dB')


if __name__ == '__main__':
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
