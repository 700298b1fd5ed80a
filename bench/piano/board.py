#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes the table of modes of a piano's soundboard from published means, as a resonator file.

    board.py > ../../data/resonators/soundboard.json

The published means are those of K. Ege, X. Boutillon and M. Rebillat (J. Sound Vib. 332, 2013): 2 % of loss factor and, up to
1.1 kHz, one mode for each 20 Hz. The rim takes RIM_PER_S more. A mode for each GAP with the mass m has the mean mobility 1/(4 m GAP) (E. Skudrzyk, JASA 67,
1980), which is MOBILITY here. Above 1 kHz the modes of a board overlap, and its mobility is smooth. So one mode for each 2 % of
the frequency will do, with a loss by which it overlaps with the next one. Frequencies are scattered within half a gap, and
so are the signs of the shapes at the two ears, by multiples of irrational numbers.

SIDE of each mode comes to the left ear and is taken from the right one, with signs that change from mode to mode: then nothing cancels between
neighbours, and the levels of partials keep. With 3.5 the difference of the sides is 7 dB below their mean (median over the keys A and C); recorded
notes have 3 (Salamander Grand Piano V3) and at C4 4 and 8 dB (that and the MuseScore General soundfont).
"""
import math

MOBILITY = 7e-4  # m/s per newton at the bridge
LOSS_FACTOR = 0.02
RIM_PER_S = 8
GAP_HZ = 20
FIRST_HZ, LAST_HZ = 60, 11000
SIDE = 3.5

HEADER = """\
// Soundboard of a piano at its bridge, written by bench/piano/board.py: modes as dense as K. Ege, X. Boutillon and M. Rebillat
// measured them (J. Sound Vib. 332, 2013), one for each 20 Hz up to 1 kHz and, where they overlap, one for each 2 % of the
// frequency. Their loss factor is 2 %, the rim takes 8 1/s more, and their masses give a mean mobility of 0.7 mm/s per newton.
// What differs at the two ears makes the piano as wide as a recorded one.
{
  "name": "soundboard",
  "description": "soundboard of a piano",
  "modes": ["""


def scattered(i, irrational):
    """From -1 to 1."""
    return 2 * math.modf(i * irrational)[0] - 1


def rows():
    hz, i = FIRST_HZ, 0
    while hz < LAST_HZ:
        i += 1
        gap = max(GAP_HZ, LOSS_FACTOR * hz)
        place = hz + gap / 4 * scattered(i, math.sqrt(2))
        left, right = (1 if scattered(i, math.sqrt(p)) < 0 else -1 for p in (3, 7))
        middle, side = (left + right) // 2, SIDE * (-1) ** (i - 1)
        yield (f'    {{ "frequency_hz": {place:.1f}, "decay_per_s": {RIM_PER_S + math.pi * LOSS_FACTOR * place:.4g}, '
               f'"mass_kg": {1 / (4 * MOBILITY * gap):.4g}, "strike_shape": 1, "pickup_shape": {middle + side:g}, "right_shape": {middle - side:g} }}')
        hz += gap


if __name__ == '__main__':
    print(HEADER)
    print(',\n'.join(rows()))
    print('  ]\n}')
