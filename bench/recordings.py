#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Prints how far instruments that ship are from recorded ones, and these from each other: the table of docs/measurements/instruments.md.

    recordings.py PROGRAM RECORDINGS [INSTRUMENT ...]

PROGRAM is contactspline. RECORDINGS holds INSTRUMENT/SOURCE/KEY_LAYER.wav at 44.1 kHz: single notes under their keys of MIDI; LAYER is s
(soft), l (loud), or m where a source has one. We play velocities 0.55 and 0.85, one of which stands beside a single layer, the louder. Of
sources whose numbers an instrument was fitted to, others that are kept, and recordings beside each other, medians over pairs of sources of

    log-mel     the mean difference of spectrograms: 48 bands from 60 Hz, each note of the same A-weighted loudness, down to 60 dB below the
                recording's largest value [dB]
    partials    of strings: differences of the levels of partials 1 to 20, less their median: median and 90 % [dB]
    early       of strings: ratios of the decays of these partials, 40 to 500 ms: median factor
    T60         of drums: ratios of the reverberation times of octaves: median factor
"""
import sys
from itertools import combinations
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent / "drums"))
from make import Stroke
from notes import RATE, from_onset, recorded, rendered
from strings import Note

VELOCITIES = {"s": 0.55, "l": 0.85}
# Of each: sources that it was fitted to, keys, seconds and the highest frequency that are compared [Hz].
OPEN = (40, 45, 50, 55, 59, 64)
INSTRUMENTS = {
    "classical_guitar": (("fluid", "tonejs"), OPEN, 2, 12000),
    "steel_guitar": (("fluid", "tonejs"), OPEN, 2, 12000),
    "fret_guitar": (("fluid",), OPEN, 1.5, 10000),
    "lap_steel": (("fluid", "tonejs"), OPEN[1:], 1.5, 10000),
    "slap_bass": (("fluid_slap",), (43,), 2, 10000),
    "marimba": (("fluid",), (60,), 0.8, 12000),
    "kalimba": (("fluid",), (69,), 0.3, 12000),
    "dulcimer": (("fluid",), (67, 72, 79), 1.2, 12000),
    "trichord_c4": ((), (60,), 3, 14000),
    "snare": (("sonicpi",), (38,), 0.6, 16000),
    "tom": (("sonicpi",), (45,), 1, 16000),
}
DRUMS, BARS = ("snare", "tom"), ("marimba", "kalimba")


def heard(sound, instrument, key):
    _, _, seconds, top = INSTRUMENTS[instrument]
    if instrument in DRUMS:
        return Stroke(sound, seconds)
    return Note(sound, key, {"seconds": seconds, "top": top, "tops": {}, "inharmonicity": {key: inharmonicity(sound, key)}})


def inharmonicity(sound, key):
    """B, up to 5e-4, at which partials 3 to 20 have most of the levels [dB]."""
    part = from_onset(sound)[int(0.03 * RATE):int(0.73 * RATE)]
    n = 1 << 16
    level, f0, k = 20 * np.log10(np.abs(np.fft.rfft(part * np.blackman(len(part)), n)) + 1e-6), 440 * 2 ** ((key - 69) / 12), np.arange(3, 21)
    level = np.array([level[max(0, i - 3):i + 4].max() for i in range(len(level))])  # within 2 Hz
    at = lambda b: np.minimum(np.round(k * f0 * np.sqrt(1 + b * k * k) * n / RATE).astype(int), n // 2 - 1)
    return max(np.concatenate([[0], np.geomspace(1e-6, 5e-4, 80)]), key=lambda b: level[at(b)].sum())


def ours(program, instrument):
    """By key and layer."""
    _, keys, seconds, _ = INSTRUMENTS[instrument]
    file = Path(__file__).parents[1] / f"data/instruments/{instrument}.json"
    return {(key, layer): heard(rendered(program, {"seconds": max(seconds, 1), "velocity": velocity, "events": []}, file, key), instrument, key)
            for key in keys for layer, velocity in VELOCITIES.items()}


def theirs(folder, instrument):
    """By source, then by key and layer."""
    sources = {}
    for (source, name), sound in recorded(folder).items():
        key, layer = name.split("_")
        if int(key) in INSTRUMENTS[instrument][1]:
            sources.setdefault(source, {})[int(key), layer] = heard(sound, instrument, int(key))
    return sources


def pairs(a, b):
    for (key, layer), note in a.items():
        other = next((b[key, at] for at in (layer, "m", "l") if (key, at) in b and (layer != "s" or at != "l")), None)
        if other is not None and ((key, "m") not in b or layer != "s"):
            yield note, other


def apart(instrument, a, b):
    """What is said above, of one source and another; None if they have no note in common."""
    notes = list(pairs(a, b))
    if not notes:
        return None
    if instrument in DRUMS:
        return [np.mean([note.distance(other) for note, other in notes]), 2 ** np.median(np.concatenate([note.t60_apart(other) for note, other in notes]))]
    log_mel = np.mean([np.abs(note.differences(other)).mean() for note, other in notes])
    if instrument in BARS:
        return [log_mel]
    levels = np.abs(np.concatenate([note.levels_apart(other) for note, other in notes]))
    decays = np.concatenate([np.log2(np.maximum(note.decays, 0.5) / np.maximum(other.decays, 0.5)) for note, other in notes])
    return [log_mel, np.median(levels), np.percentile(levels, 90), 2 ** np.nanmedian(np.abs(decays))]


def row(instrument, of):
    of = [found for found in of if found is not None]
    if not of:
        return "-"
    found = np.median(of, 0)
    if instrument in BARS:
        return f"{found[0]:.1f}"
    if instrument in DRUMS:
        return f"{found[0]:.1f}; T60 {found[1]:.2f}"
    return f"{found[0]:.1f}; {found[1]:.1f}, {found[2]:.0f}; {found[3]:.2f}"


def main(program, folder, *only):
    print("| instrument | fitted | kept | recordings |\n|---|---|---|---|")
    for instrument in only or INSTRUMENTS:
        sources, played = theirs(Path(folder) / instrument, instrument), ours(program, instrument)
        fitted = INSTRUMENTS[instrument][0]
        columns = [[apart(instrument, played, notes) for source, notes in sources.items() if (source in fitted) == is_fitted] for is_fitted in (True, False)]
        columns.append([apart(instrument, a, b) for a, b in combinations(sources.values(), 2)])
        print(f"| `{instrument}` |", " | ".join(row(instrument, of) for of in columns), "|", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 3 or any(name not in INSTRUMENTS for name in sys.argv[3:]):
        sys.exit(__doc__)
    main(*sys.argv[1:])
