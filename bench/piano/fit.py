#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fits a keyboard file to recorded notes.

    fit.py PROGRAM KEYBOARD RECORDINGS FITTED

PROGRAM is contactspline. KEYBOARD is a keyboard file with published notes and a body whose mobility Y it gives. RECORDINGS holds NOTEvLAYER.wav,
as `compare.py fetch` makes it, for the keys A and C. FITTED is written: a note for each of these keys, with lengths and masses
of KEYBOARD, and

1. the bending stiffness by the partials: B = pi^2 EI/(T L^2), the mean of both layers, up to C6;
2. the strings' own losses by the decays from 2 to 6 s: one law constant + rise f^2 for all keys up to C6, the least sum of
   |log2| over partials 1 to 12;
3. bridge_ratio r by the decays from 0.1 to 1 s: N strings that move together decay by 2 N f Z Y r^2 faster than alone,
   with the pitch f and the impedance Z = sqrt(T mu) (G. Weinreich, JASA 62, 1977). log r is a parabola over the keys;
4. hammers and strike places by rendered notes: KEYBOARD's times exp of six parameters (shape() says which). Least is the mean
   distance of the levels of partials 1 to 12, plus WEIGHT times that of the loudness over the keys and between the layers
   and of the centroid (as 20 log10), plus PULL times the square of the parameters, which holds them near 0;
5. the detuning of double and triple strings: of SCALES times that of KEYBOARD, the one whose rendered decays are
   nearest; then one factor for all bridge_ratio by the median of the rendered early decays, and one for the own losses by
   that of the late ones;
6. output_ratio by the loudness of rendered notes, the mean of both layers and of the key with its neighbours.

Prints each estimate with its error. It needs Debian's python3-numpy and python3-scipy.
"""
import copy
import json
import math
import os
import re
import sys
import tempfile

import numpy as np
from scipy.optimize import minimize

import compare

HEADER = """\
// A piano of 88 keys, written by bench/piano/fit.py from bench/piano/published.json (strings and hammers, with their sources)
// and recorded notes: the keys A and C of layers 7 and 15 of the Salamander Grand Piano V3, a Yamaha C5, by Alexander Holm
// (CC BY 3.0). Bending stiffness, losses, detuning, hammers, strike places, bridge_ratio and output_ratio are fitted to them.
"""
SCALES = (0.03, 0.06, 0.12, 0.24)
PULL = 0.02  # dB
WEIGHT = 0.2
FARTHEST_DB = 20  # a partial counts no more than this
DB = 20 / math.log(10)  # dB/s per 1/s
HIGHEST_MEASURED = 84  # above, partials are too few for B, and too short for a late decay


def read(path):
    """A JSON file whose lines may end with // comments."""
    with open(path) as file:
        return json.loads(re.sub(r'(^|\s)//.*', '', file.read()))


def pitch(key):
    return 440 * 2**((key - 69) / 12)


def note_of(notes, key):
    """The note of a key as the generator interpolates it."""
    i = max(j for j in range(len(notes) - 1) if j == 0 or notes[j]['key'] <= key)
    low, high = notes[i], notes[i + 1]
    part = (key - low['key']) / (high['key'] - low['key'])
    linear = lambda a, b: a + part * (b - a)
    geometric = lambda a, b: math.exp(linear(math.log(a), math.log(b)))
    note = {'key': key}
    for name in low:
        if name != 'key':
            note[name] = (linear if name in ('hammer_mass_kg', 'exponent') else geometric)(low[name], high[name])
    note['mass_kg'] = note['length_m'] * geometric(*(n['mass_kg'] / n['length_m'] for n in (low, high)))
    return note


def bending_stiffness(note, b):
    """EI for the inharmonicity B: the tension follows from the pitch, (2 pi f)^2 mu = T beta^2 (1 + B)."""
    beta = math.pi / note['length_m']
    return b / (1 + b) * (2 * math.pi * pitch(note['key']))**2 * note['mass_kg'] / note['length_m'] / beta**4


def tension(note):
    mu, beta = note['mass_kg'] / note['length_m'], math.pi / note['length_m']
    return ((2 * math.pi * pitch(note['key']))**2 * mu - note['bending_stiffness_n_m2'] * beta**4) / beta**2


def own_losses(recorded):
    """constant [1/s] and rise [1/s per kHz^2] of the decays from 2 to 6 s."""
    f, s = np.array([(k * pitch(compare.key_of(name)) / 1000, late / DB) for (name, _), features in recorded.items()
                     if compare.key_of(name) <= HIGHEST_MEASURED
                     for k, _, late in features['decays_db_per_s'] if k <= 12 and (late or 0) > 0.5]).T
    cost = lambda p: np.abs(np.log2((np.exp(p[0]) + np.exp(p[1]) * f**2) / s)).sum()
    starts = [(math.log(np.median(s) * a), math.log(np.median(s) * b)) for a in (0.3, 1) for b in (0.03, 0.5)]
    best = min((minimize(cost, start, method='Nelder-Mead') for start in starts), key=lambda found: found.fun)
    constant, rise = np.exp(best.x)
    print(f'own decay: {constant:.3f} + {rise:.4f} (f/kHz)^2 [1/s], error {best.fun / len(s):.2f} octaves, of {len(s)} decays')
    return constant, rise


def estimate(keyboard, recorded):
    """Notes with B, losses and bridge_ratio."""
    published, mobility = keyboard['keyboard'], keyboard['keyboard']['body']['mobility_m_per_n_s']
    constant, rise = own_losses(recorded)
    notes, ratios = [], []
    for name in compare.NOTES:
        note = note_of(published['notes'], compare.key_of(name))
        f, of_key = pitch(note['key']), [recorded[name, layer] for layer in compare.SPEEDS]
        b = [features['B'] for features in of_key if len(features['partials']) >= 6]
        if b and note['key'] <= HIGHEST_MEASURED:
            note['bending_stiffness_n_m2'] = bending_stiffness(note, float(np.mean(b)))
        mu = note['mass_kg'] / note['length_m']
        note |= {'constant_loss_per_s': constant,
                 'quadratic_loss_m2_per_s': rise * 1e-6 * tension(note) / mu / (2 * math.pi)**2}
        excess = {}  # of the early decay of each partial over its own
        for features in of_key:
            for k, early, _ in features['decays_db_per_s']:
                if k <= 8 and (early or 0) > 0.5:
                    excess.setdefault(k, []).append(early / DB - constant - rise * (k * f / 1000)**2)
        excess = np.median([max(np.mean(values), 0.02) for values in excess.values()])
        strings = 1 + (note['key'] >= published['first_double_key']) + (note['key'] >= published['first_triple_key'])
        ratios.append(math.sqrt(excess / (2 * strings * f * math.sqrt(tension(note) * mu) * mobility)))
        spread = f'{np.ptp(b) / np.mean(b):.1%}' if len(b) > 1 else 'not measured'
        print(f'{name}: B {np.mean(b) if b else math.nan:.2e}, between layers {spread}; bridge_ratio alone {ratios[-1]:.2f}')
        notes.append(note)
    keys = np.array([note['key'] - 60 for note in notes])
    parabola = np.polyfit(keys, np.log(ratios), 2)
    error = np.sqrt(np.mean((np.polyval(parabola, keys) - np.log(ratios))**2))
    print(f'log bridge_ratio: {parabola} (key - 60), error {error:.2f}')
    for note, key in zip(notes, keys):
        note |= {'bridge_ratio': float(np.exp(np.polyval(parabola, key))), 'output_ratio': 1.0}
    return notes


def rounded(note):
    return {name: value if name == 'key' else float(f'{value:.4g}') for name, value in note.items()}


def text_of(value, depth=0):
    """JSON with short objects and lists in one line."""
    line = json.dumps(value)
    if len(line) + 2 * depth <= 118 or not isinstance(value, (dict, list)):
        return line
    inner, outer = '\n' + '  ' * (depth + 1), '\n' + '  ' * depth
    if isinstance(value, list):
        return '[' + ','.join(inner + text_of(entry, depth + 1) for entry in value) + outer + ']'
    return '{' + ','.join(f'{inner}"{name}": {text_of(entry, depth + 1)}' for name, entry in value.items()) + outer + '}'


def write(keyboard, notes, scale, path):
    written = copy.deepcopy(keyboard)
    written['keyboard']['notes'] = [rounded(note) for note in notes]
    for name in ('double_hz', 'triple_hz'):
        written['keyboard']['body'][name] = [round(scale * hz, 4) for hz in keyboard['keyboard']['body'][name]]
    with open(path, 'w') as file:
        file.write(HEADER + text_of(written) + '\n')


def rendered(program, keyboard, notes, scale, layers, features=compare.features, seconds=compare.SECONDS):
    """Features of the notes as the program plays them."""
    with tempfile.TemporaryDirectory() as folder:
        write(keyboard, notes, scale, f'{folder}/keyboard.json')
        compare.score(folder, program, f'{folder}/keyboard.json', layers, seconds)
        return {(name, layer): features(f'{folder}/{name}v{layer}.wav', name)
                for name in compare.NOTES for layer in layers}


def shape(note, parameters):
    """A note with another hammer and strike place. Over octaves from C4: the stiffness by a parabola, the mass by a line, and
    from C5 on the strike place by a line."""
    octaves = (note['key'] - 60) / 12
    stiffness, mass, place = (np.polyval(parameters[2::-1], octaves), np.polyval(parameters[4:2:-1], octaves),
                              parameters[5] * max(0, octaves - 1))
    return note | {'stiffness_n_per_m_alpha': note['stiffness_n_per_m_alpha'] * math.exp(stiffness),
                   'hammer_mass_kg': note['hammer_mass_kg'] * math.exp(mass),
                   'strike_position_m': note['strike_position_m'] * math.exp(place)}


def levels(path, name):
    """Levels of partials, loudness of the first 0.8 s in dB(A), and centroid as 20 log10."""
    x = compare.load(path)
    return ({k: level for k, _, level in compare.partials(x, pitch(compare.key_of(name)))[0] if k <= 12},
            compare.loudness_dba(x[:int(0.8 * compare.RATE)]), 20 * math.log10(compare.centroid_hz(x)))


def level_distance(ours, real):
    """Mean distance of the levels of partials that both have, beside their median [dB]; nothing from one partial alone."""
    both = [k for k in ours if k in real and real[k] > max(real.values()) - 50]
    d = np.array([ours[k] - real[k] for k in both])
    return [np.mean(np.minimum(np.abs(d - np.median(d)), FARTHEST_DB))] if len(both) >= 2 else []


def fit_hammers(program, keyboard, notes, recordings):
    """Notes with hammers and strike places by the recorded levels and loudness."""
    real = {(name, layer): levels(f'{recordings}/{name}v{layer}.wav', name)
            for name in compare.NOTES for layer in compare.SPEEDS}

    def cost(parameters):
        ours = rendered(program, keyboard, [shape(note, parameters) for note in notes], SCALES[0],
                        list(compare.SPEEDS), levels, 0.85)
        partials = np.mean(sum((level_distance(ours[of][0], real[of][0]) for of in ours), []))
        missing = np.array([[ours[name, layer][1] - real[name, layer][1] for layer in compare.SPEEDS]
                            for name in compare.NOTES])
        keys, steps = missing.mean(1), missing[:, 1] - missing[:, 0]
        loudness = np.mean(np.abs(keys - np.median(keys))) + np.mean(np.abs(steps))
        centroid = np.mean([abs(ours[of][2] - real[of][2]) for of in ours])
        return partials + WEIGHT * (loudness + centroid) + PULL * np.sum(np.square(parameters))

    start, steps = np.zeros(6), np.diag([-0.7, 0.4, 0.15, -0.3, -0.15, -0.2])
    found = minimize(cost, start, method='Nelder-Mead',
                     options={'initial_simplex': np.vstack([start, steps]), 'maxfev': 150, 'xatol': 0.01, 'fatol': 0.005})
    print(f'hammers: {cost(start):.2f} dB from the recorded levels as published, {found.fun:.2f} dB with parameters '
          f'{np.round(found.x, 3).tolist()}, {found.nfev} trials', flush=True)
    return [shape(note, found.x) for note in notes]


def octaves_from(ours, recorded):
    """Distances of early and of late decays in octaves, ours above the recorded ones; partials 1 to 8."""
    pairs = ([], [])
    theirs = {k: decays for k, *decays in recorded['decays_db_per_s']}
    for k, *mine in ours['decays_db_per_s']:
        for part in (0, 1):
            if k <= 8 and k in theirs and (theirs[k][part] or 0) > 0.5:
                pairs[part].append(np.clip(math.log2(max(mine[part] or 0, 0.5) / theirs[k][part]), -3, 3))
    return pairs


def decay_distances(program, keyboard, notes, scale, recorded):
    """Early and late decays of all notes, as octaves_from() has them."""
    ours = rendered(program, keyboard, notes, scale, [7])
    pairs = [octaves_from(ours[of], recorded[of]) for of in ours]
    return [np.concatenate([pair[part] for pair in pairs]) for part in (0, 1)]


def fit_decays(program, keyboard, notes, recorded):
    """Scale of the detuning; bridge_ratio and own losses of the notes are changed."""
    sums = []
    for scale in SCALES:
        early, late = (np.abs(d).mean() for d in decay_distances(program, keyboard, notes, scale, recorded))
        sums.append(early + late)
        print(f'detuning times {scale}: {early:.2f} octaves from the early decays, {late:.2f} from the late ones', flush=True)
    scale = SCALES[int(np.argmin(sums))]
    early = np.median(decay_distances(program, keyboard, notes, scale, recorded)[0])
    for note in notes:
        note['bridge_ratio'] *= 2**(-early / 2)
    late = np.median(decay_distances(program, keyboard, notes, scale, recorded)[1])
    for note in notes:
        note['constant_loss_per_s'] *= 2**-late
        note['quadratic_loss_m2_per_s'] *= 2**-late
    print(f'bridge_ratio times {2**(-early / 2):.3f}, then own losses times {2**-late:.3f}', flush=True)
    return scale


def fit_loudness(program, keyboard, notes, scale, recorded):
    ours = rendered(program, keyboard, notes, scale, list(compare.SPEEDS))
    missing = np.array([np.mean([recorded[name, layer]['loudness_dba'] - ours[name, layer]['loudness_dba']
                                 for layer in compare.SPEEDS]) for name in compare.NOTES])
    missing -= np.median(missing)
    padded = np.pad(missing, 1, mode='edge')
    smooth = (padded[:-2] + 2 * padded[1:-1] + padded[2:]) / 4
    for note, decibels in zip(notes, smooth):
        note['output_ratio'] = 10**(decibels / 20)
    print(f'loudness: {np.round(missing, 1)} dB missing, {np.round(smooth, 1)} given')


def main(program, keyboard_file, recordings, fitted_file):
    keyboard, recorded = read(keyboard_file), compare.table(recordings)
    program = os.path.abspath(program)
    notes = estimate(keyboard, recorded)
    notes = fit_hammers(program, keyboard, notes, recordings)
    scale = fit_decays(program, keyboard, notes, recorded)
    fit_loudness(program, keyboard, notes, scale, recorded)
    write(keyboard, notes, scale, fitted_file)


if __name__ == '__main__':
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
