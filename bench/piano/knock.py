#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fits the table of modes that keys strike when they are played, as a resonator file.

    knock.py RECORDINGS OURS KNOCK > FITTED

RECORDINGS and OURS are folders as `compare.py` makes them: the recorded notes, and the same ones as the program plays them with the
table KNOCK ("-" writes the table to begin with). Below the pitch of a treble key a recorded note holds no partial: what is there is
the noise of key, action, case and room. It is measured in third octaves from FIRST_HZ on up to 3/4 of the pitch, in the keys A and C
from C5 to C8: its level in the first 0.19 s, and how much it has fallen 0.2 s later. Both are medians over keys and layers. OURS has
the knock in the same bands, 30 dB above what else it has there, so that its masses are divided by the square root of the ratio of
powers. There is a mode for each GAP_HZ or, where that is more, for each 3 % of the frequency: several for each band of hearing.
Frequencies and signs are scattered as in board.py. All modes have one decay.
"""
import math
import sys

import numpy as np

import board
import compare
import fit

GAP_HZ, GAP = 12, 0.03
BANDS = 20
FIRST_HZ = 28.1
NOTES = ('C5', 'A5', 'C6', 'A6', 'C7', 'A7', 'C8')

HEADER = """\
// What the keys of a piano strike when they are played, written by bench/piano/knock.py: key, action, case and room, as a grand's
// recorded treble keys sound below their pitch (Salamander Grand Piano V3, a Yamaha C5, by Alexander Holm, CC BY 3.0).
{
  "name": "piano_case",
  "description": "key, action and case of a piano",
  "modes": ["""


def edges(band):
    return FIRST_HZ * 2**(band / 3), FIRST_HZ * 2**((band + 1) / 3)


def levels(x, begin):
    """Of the bands, in dB, from `begin` on."""
    p, f = compare.power(x, begin, 8192), np.fft.rfftfreq(8192, 1 / compare.RATE)
    return np.array([10 * np.log10(p[(f >= low) & (f < high)].sum() + 1e-30) for low, high in map(edges, range(BANDS))])


def notes(folder):
    return {(note, layer): compare.load(f'{folder}/{note}v{layer}.wav') for note in NOTES for layer in compare.SPEEDS}


def bands_below(note):
    pitch = 440 * 2**((compare.key_of(note) - 69) / 12)
    return np.array([edges(band)[1] < 0.75 * pitch for band in range(BANDS)])


def median(columns):
    """Over notes, of the bands that lie below their pitch."""
    return np.array([np.median([values[band] for values, below in columns if below[band]]) for band in range(BANDS)])


def smooth(values):
    return np.convolve(np.pad(values, 1, 'edge'), np.ones(3) / 3, 'valid')


def gain(ours, recorded):
    """Between the two folders, as `compare.py distance` finds it."""
    return np.median([compare.loudness_dba(ours[i][:compare.RATE]) - compare.loudness_dba(recorded[i][:compare.RATE]) for i in ours])


def places():
    hz, i = FIRST_HZ, 0
    while hz < edges(BANDS - 1)[1]:
        i += 1
        gap = max(GAP_HZ, GAP * hz)
        yield i, gap, hz + gap / 4 * board.scattered(i, math.sqrt(2))
        hz += gap


def row(i, hz, decay_per_s, mass_kg):
    left, right = (1 if board.scattered(i, math.sqrt(p)) < 0 else -1 for p in (3, 7))
    return (f'    {{ "frequency_hz": {hz:.1f}, "decay_per_s": {decay_per_s:.3g}, "mass_kg": {mass_kg:.3g}, '
            f'"strike_shape": 1, "pickup_shape": {left}, "right_shape": {right} }}')


def main(recordings, ours, knock):
    recorded = notes(recordings)
    below = {note: bands_below(note) for note in NOTES}
    fall = median([((levels(x, 0) - levels(x, 0.2)) / 0.2, below[note]) for (note, _), x in recorded.items()])
    decay = float(np.median(fall)) * math.log(10) / 20
    masses = [100 * math.sqrt(hz / gap) for _, gap, hz in places()]  # the same power in each third octave
    if knock != '-':
        played = notes(ours)
        levelled = gain(played, recorded)
        found = median([(levels(played[i], 0) - levels(recorded[i], 0) - levelled, below[i[0]]) for i in recorded])
        centres = [math.log(math.sqrt(low * high)) for low, high in map(edges, range(BANDS))]
        masses = [mode['mass_kg'] * 10**(np.interp(math.log(mode['frequency_hz']), centres, smooth(found)) / 20)
                  for mode in fit.read(knock)['modes']]
        print(f'ours minus recorded in dB by bands from {FIRST_HZ} Hz on: {np.round(found, 1)}', file=sys.stderr)
    print(HEADER)
    print(',\n'.join(row(i, hz, decay, mass) for (i, _, hz), mass in zip(places(), masses)))
    print('  ]\n}')


if __name__ == '__main__':
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
