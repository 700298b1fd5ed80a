#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Prints how loud the scores that ship are, and the `level_db` with which they are alike.

    levels.py PROGRAM SCORE ...

PROGRAM is contactspline. Loudness is that of web/src/loudness.js: the A-weighted mean power of parts of 0.4 s, without those that are 10 dB
below the mean of all. Scores become as loud as GOAL, or as their peak allows.
"""
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy.io import wavfile

from notes import a_weighting

GOAL, PEAK = -29, -0.5  # dB(A), dB
PART, GATE = 0.4, 10  # s, dB


def decibels(power):
    return 10 * np.log10(power)


def loudness_of(sound, rate):
    """Of samples by channels [dB(A) of full scale]."""
    n = len(sound)
    weights = 10 ** (a_weighting(np.fft.rfftfreq(2 * n, 1 / rate)) / 20)
    weighted = np.fft.irfft(np.fft.rfft(sound, 2 * n, axis=0) * weights[:, None], axis=0)[:n]
    size = round(PART * rate)
    power = np.pad((weighted ** 2).sum(1), (0, -n % size)).reshape(-1, size).mean(1)
    return decibels(power[decibels(power + 1e-30) > decibels(power.mean()) - GATE].mean())


def measured(program, score):
    """Loudness and peak of a score [dB]."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "render", score, "--no-figure", "--bits", "32", "-o", f"{folder}/sound.wav"], check=True, capture_output=True)
        rate, sound = wavfile.read(f"{folder}/sound.wav")
    sound = sound.astype(float).reshape(len(sound), -1)
    return loudness_of(sound, rate), 2 * decibels(np.abs(sound).max())


def levels(program, scores):
    with ThreadPoolExecutor(2) as pool:
        found = dict(zip(scores, pool.map(lambda score: measured(program, score), scores)))
    for score, (loudness, peak) in found.items():
        level = min(GOAL - loudness + peak, PEAK)
        print(f"{Path(score).name}: {loudness:.1f} dB(A), peak {peak:.1f} dB; level_db {level:.1f}: {loudness + level - peak:.1f} dB(A)", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    levels(sys.argv[1], sys.argv[2:])
