#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fits a keyboard file to recorded notes.

    fit.py PROGRAM KEYBOARD RECORDINGS FITTED [STEP ...]

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
5. felts below C4 (exponent and stiffness by lines over the octaves) and strike places above C3 up to C6 (one factor) by
   rendered notes. Least is the mean distance of the levels of partials 1 to 24, plus WEIGHT times that of the centroid. No
   exponent exceeds HIGHEST_EXPONENT;
6. the two laws of the own losses, the detuning of double and triple strings (one factor), all bridge_ratio (one factor) and
   the horizontal motion by the recorded decays of partials 1 to 8, as unison() computes them: the amplitudes of the strings
   of a key and of their horizontal motion on a bridge of one mobility. From C6 on horizontal_ratio falls by one factor for
   each octave;
7. the high-pass of the sound by the levels of partials of rendered notes, then output_ratio by their loudness, the mean of both
   layers and of the key with its neighbours. A key whose loudness is more than UNEVEN_DB off the line between its neighbours among the
   notes becomes a note, too, with the output_ratio that puts it there.

The steps are strings (1 to 3), hammers (4), refine (5), decays (6) and output (7); without STEP it takes all. A step that is left out leaves
what KEYBOARD has, so that a fitted file can be fitted on; without output the notes between the keys A and C are left out. Prints each estimate with its error. It needs Debian's python3-numpy and python3-scipy.
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
PULL = 0.02  # dB
WEIGHT = 0.2
FARTHEST_DB = 20  # a partial counts no more than this
DB = 20 / math.log(10)  # dB/s per 1/s
HIGHEST_EXPONENT = 3.5  # of felts taken from pianos (D. Hall and A. Askenfelt, JASA 83, 1988)
UNEVEN_DB = 0.5  # so neighbours differ by at most 1 dB more than on the line, which is hardly heard
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


def strings_of(keyboard, key):
    return 1 + (key >= keyboard['keyboard']['first_double_key']) + (key >= keyboard['keyboard']['first_triple_key'])


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
        strings = strings_of(keyboard, note['key'])
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


def write(keyboard, notes, path):
    written = copy.deepcopy(keyboard)
    written['keyboard']['notes'] = [rounded(note) for note in notes]
    with open(path, 'w') as file:
        file.write(HEADER + text_of(written) + '\n')


def rendered(program, keyboard, notes, layers, features, seconds, names):
    """Features of the notes as the program plays them."""
    with tempfile.TemporaryDirectory() as folder:
        write(keyboard, notes, f'{folder}/keyboard.json')
        compare.score(folder, program, f'{folder}/keyboard.json', layers, seconds, names)
        return {(name, layer): features(f'{folder}/{name}v{layer}.wav', name) for name in names for layer in layers}


def shape(note, parameters):
    """A note with another hammer and strike place. Over octaves from C4: the stiffness by a parabola, the mass by a line, and
    from C5 on the strike place by a line."""
    octaves = (note['key'] - 60) / 12
    stiffness, mass, place = (np.polyval(parameters[2::-1], octaves), np.polyval(parameters[4:2:-1], octaves),
                              parameters[5] * max(0, octaves - 1))
    return note | {'stiffness_n_per_m_alpha': note['stiffness_n_per_m_alpha'] * math.exp(stiffness),
                   'hammer_mass_kg': note['hammer_mass_kg'] * math.exp(mass),
                   'strike_position_m': note['strike_position_m'] * math.exp(place)}


def levels(path, name, most=12):
    """Levels of partials, loudness of the first 0.8 s in dB(A), and centroid as 20 log10."""
    x = compare.load(path)
    return ({k: level for k, _, level in compare.partials(x, pitch(compare.key_of(name)))[0] if k <= most},
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
        ours = rendered(program, keyboard, [shape(note, parameters) for note in notes], list(compare.SPEEDS),
                        levels, 0.85, compare.NOTES)
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


def refined(note, parameters):
    """A note with another felt below C4 (exponent, and stiffness at a compression of 1 mm, by lines over the octaves) and,
    above C3 up to C6, another strike place (one factor)."""
    exponent, stiffness = max(0, (60 - note['key']) / 12) * np.array(parameters[:2])
    place = parameters[2] if 48 < note['key'] <= HIGHEST_MEASURED else 0
    return note | {'exponent': note['exponent'] + exponent,
                   'stiffness_n_per_m_alpha': note['stiffness_n_per_m_alpha'] * math.exp(stiffness) * 1000**exponent,
                   'strike_position_m': note['strike_position_m'] * math.exp(place)}


def refine(program, keyboard, notes, recordings):
    """Notes with felts below C4 and strike places by the recorded levels of partials 1 to 24 and the centroid."""
    names = [compare.name_of(note['key']) for note in notes if note['key'] <= HIGHEST_MEASURED]
    heard = lambda path, name: levels(path, name, 24)
    real = {(name, layer): heard(f'{recordings}/{name}v{layer}.wav', name) for name in names for layer in compare.SPEEDS}

    def cost(parameters):
        ours = rendered(program, keyboard, [refined(note, parameters) for note in notes], list(compare.SPEEDS), heard, 0.85, names)
        return (np.mean(sum((level_distance(ours[of][0], real[of][0]) for of in ours), [])) +
                WEIGHT * np.mean([abs(ours[of][2] - real[of][2]) for of in ours]))

    start = np.zeros(3)
    steepest = 12 * min((HIGHEST_EXPONENT - note['exponent']) / (60 - note['key']) for note in notes if note['key'] < 60)
    found = minimize(cost, start, method='Nelder-Mead', bounds=[(0, steepest), (None, None), (None, None)],
                     options={'initial_simplex': np.vstack([start, np.diag([0.3, 0.3, -0.05])]), 'maxfev': 40, 'xatol': 0.01,
                              'fatol': 0.01})
    print(f'refined: {cost(start):.2f} dB before, {found.fun:.2f} dB with parameters {np.round(found.x, 3).tolist()}, '
          f'{found.nfev} trials', flush=True)
    return [refined(note, found.x) for note in notes]


def unison(note, strings, detuning_hz, horizontal, factor, mobility, k, decay_per_s, t):
    """Level in dB of partial k: the amplitudes a of the strings and of their horizontal motion, a' = (2 pi i d - s) a - g r (r . a)
    with the own decay s and g = 2 f Z Y bridge_ratio^2, heard as r . a. r is 1 for a string; N strings that move horizontally
    as one count as one string with r = bridge_ratio sqrt(N), struck by strike_ratio/sqrt(N)."""
    f, mu = pitch(note['key']), note['mass_kg'] / note['length_m']
    g = factor * 2 * f * math.sqrt(tension(note) * mu) * mobility * note['bridge_ratio']**2
    strike_ratio, bridge_ratio, cents = horizontal
    d = np.append(detuning_hz, np.mean(detuning_hz) + f * (2**(cents / 1200) - 1))
    struck = np.append(np.full(strings, 1 / strings), strike_ratio / math.sqrt(strings))
    r = np.append(np.ones(strings), bridge_ratio * math.sqrt(strings))
    rates, modes = np.linalg.eig(np.diag(2j * np.pi * k * d - decay_per_s) - g * np.outer(r, r))
    a = (r @ modes) * np.linalg.solve(modes, struck.astype(complex))
    return 20 * np.log10(np.abs(np.exp(np.outer(t, rates)) @ a) + 1e-6)


def horizontal_ratio(note, fall):
    return math.exp(-fall * max(0, note['key'] - 84) / 12)


def fit_decays(keyboard, notes, recorded):
    """Own losses, bridge_ratio, detuning and the horizontal motion, by the decays of both layers."""
    body = keyboard['keyboard']['body']
    detuning = {1: [0], 2: body['double_hz'], 3: body['triple_hz']}
    curves = []
    for name, note in zip(compare.NOTES, notes):
        strings = strings_of(keyboard, note['key'])
        for features in (recorded[name, layer] for layer in compare.SPEEDS):
            for (k, f, t, y), (_, early, late) in zip(features['curves'], features['decays_db_per_s']):
                if k <= 8:
                    part = slice(5, 301, 4)  # 0.1 to 6 s
                    heard = np.where(y > max(y.max() - 60, y[-20:].max() + 6), y, np.nan)  # above the recording's noise
                    curves.append((note, strings, k, f / 1000, t[part], heard[part], early, late))

    def distances(parameters):
        constant, rise, scale, factor, strike_ratio, bridge_ratio, cents = np.exp(parameters[:-1])
        early, late, level = [], [], []
        for note, strings, k, khz, t, y, theirs_early, theirs_late in curves:
            ratio = horizontal_ratio(note, parameters[-1])
            x = unison(note, strings, scale * np.array(detuning[strings]), (ratio * strike_ratio, ratio * bridge_ratio, cents),
                       factor, body['mobility_m_per_n_s'], k, constant + rise * khz**2, t)
            missing = x - y
            begin, end = (t < 0.4) & np.isfinite(y), (t > 1) & (t < 3) & np.isfinite(y)
            if begin.any() and end.sum() > 5:
                level.append(np.mean(np.abs(missing[end] - missing[begin].mean())))
            for found, theirs, limits in ((early, theirs_early, (0.1, 1.0)), (late, theirs_late, (2, 6))):
                ours = compare.slope(t, x, *limits, x.max() - 55)
                if (theirs or 0) > 0.5 and ours:
                    found.append(abs(math.log2(max(ours, 0.5) / theirs)))
        return np.mean(early), np.mean(late), np.mean(level)

    def cost(parameters):
        early, late, level = distances(parameters)
        return early + late + level / 6

    first = notes[0]
    rise = first['quadratic_loss_m2_per_s'] * 1e6 * (2 * math.pi)**2 * first['mass_kg'] / first['length_m'] / tension(first)
    last = notes[-1]
    start = np.append(np.log([first['constant_loss_per_s'], rise, 1, 1, body['horizontal_strike_ratio'],
                              body['horizontal_bridge_ratio'], body['horizontal_cents']]),
                      12 * math.log(1 / last.get('horizontal_ratio', 1)) / (last['key'] - 84))
    best = minimize(cost, start, method='Nelder-Mead', options={
        'initial_simplex': np.vstack([start, start + 0.4 * np.eye(len(start))]), 'maxfev': 250, 'xatol': 0.02, 'fatol': 0.002})
    constant, rise, scale, factor, *horizontal = np.exp(best.x[:-1])
    for parameters in (start, best.x):
        print('decays: own {:.3f} + {:.4f} (f/kHz)^2 [1/s], detuning times {:.2f}, bridge_ratio^2 times {:.2f}, horizontal strike {:.2f}, '
              'bridge {:.2f}, {:.1f} cents, from C6 on times exp(-{:.2f}) an octave: '.format(*np.exp(parameters[:-1]), parameters[-1]) +
              '{:.2f} octaves from the early decays, {:.2f} from the late ones, {:.1f} dB from the levels between 1 and 3 s'
              .format(*distances(parameters)), flush=True)
    for note in notes:
        note |= {'constant_loss_per_s': constant, 'bridge_ratio': note['bridge_ratio'] * math.sqrt(factor), 'quadratic_loss_m2_per_s':
                 rise * 1e-6 * tension(note) * note['length_m'] / note['mass_kg'] / (2 * math.pi)**2,
                 'horizontal_ratio': horizontal_ratio(note, best.x[-1])}
    for name in ('double_hz', 'triple_hz'):
        body[name] = [round(scale * hz, 4) for hz in body[name]]
    for name, value in zip(('horizontal_strike_ratio', 'horizontal_bridge_ratio', 'horizontal_cents'), horizontal):
        body[name] = float(f'{value:.3g}')


def high_pass_db(f, above_hz, quality):
    x = f / above_hz
    return 20 * np.log10(x * x / np.hypot(1 - x * x, x / quality))


def heard(path, name):
    """Partials 1 to 12, and loudness of the first second in dB(A)."""
    x = compare.load(path)
    return ({k: (f, level) for k, f, level in compare.partials(x, pitch(compare.key_of(name)))[0] if k <= 12},
            compare.loudness_dba(x[:compare.RATE]))


def fit_high_pass(keyboard, ours, recorded):
    """output_above_hz and output_quality by the levels of partials."""
    body, pairs = keyboard['keyboard']['body'], []
    for (name, layer), (partials, _) in ours.items():
        theirs = {k: level for k, _, level in recorded[name, layer]['partials']}
        both = [k for k in partials if k in theirs and theirs[k] > max(theirs.values()) - 50]
        if len(both) >= 2:
            pairs.append((np.array([partials[k][0] for k in both]), np.array([partials[k][1] - theirs[k] for k in both])))
    now = body['output_above_hz'], body.get('output_quality', math.sqrt(0.5))

    def distance(logs):
        d = [levels + high_pass_db(f, *np.exp(logs)) - high_pass_db(f, *now) for f, levels in pairs]
        return np.mean(np.minimum(np.concatenate([np.abs(e - np.median(e)) for e in d]), FARTHEST_DB))

    best = minimize(distance, np.log((100, 1)), method='Nelder-Mead')
    above, quality = np.exp(best.x)
    print(f'high-pass: {above:.0f} Hz, quality {quality:.2f}, {best.fun:.2f} dB from the recorded levels, {distance(np.log(now)):.2f} before')
    body |= {'output_above_hz': round(above), 'output_quality': float(f'{quality:.2g}')}


def fit_output(program, keyboard, notes, recorded):
    """Notes with output_ratio. A key whose loudness is far from the line between those of its neighbours becomes a note."""
    layers, given = list(compare.SPEEDS), [note['key'] for note in notes]
    keys = np.arange(given[0], given[-1] + 1)
    for note in notes:
        note['output_ratio'] = 1.0
    fit_high_pass(keyboard, rendered(program, keyboard, notes, layers, heard, 1.05, compare.NOTES), recorded)

    def loudness(notes):
        names = [compare.name_of(key) for key in keys]
        ours = rendered(program, keyboard, notes, layers, heard, 1.05, names)
        return np.array([np.mean([ours[name, layer][1] for layer in layers]) for name in names])

    def at(given, values):
        return values[np.array(given) - keys[0]]

    found = loudness(notes)
    theirs = np.array([np.mean([recorded[name, layer]['loudness_dba'] for layer in layers]) for name in compare.NOTES])
    missing = theirs - at(given, found)
    missing -= np.median(missing)
    padded = np.pad(missing, 1, mode='edge')
    smooth = (padded[:-2] + 2 * padded[1:-1] + padded[2:]) / 4
    print(f'loudness: {np.round(missing, 1)} dB missing, {np.round(smooth, 1)} given')
    wanted = np.interp(keys, given, at(given, found) + smooth)
    for _ in keys:
        gains = np.interp(keys, given, at(given, wanted - found))
        off = np.abs(found + gains - wanted)
        if off.max() <= UNEVEN_DB:
            break
        given = sorted([*given, int(keys[off.argmax()])])
    notes = [note_of(notes, key) | {'output_ratio': 10**(gain / 20)} for key, gain in zip(given, at(given, gains))]
    missing = wanted - loudness(notes)  # the knock and the body's velocity do not follow output_ratio, so once more
    for note, gain in zip(notes, at(given, missing)):
        note['output_ratio'] *= 10**(gain / 20)
    off = np.abs(np.interp(keys, given, at(given, missing)) - missing)
    print(f'notes: {", ".join(map(compare.name_of, given))}; other keys are up to {off.max():.2f} dB off the line')
    return notes


STEPS = ('strings', 'hammers', 'refine', 'decays', 'output')


def main(program, keyboard_file, recordings, fitted_file, *steps):
    keyboard, recorded = read(keyboard_file), compare.table(recordings)
    program = os.path.abspath(program)
    notes = [note_of(keyboard['keyboard']['notes'], compare.key_of(name)) for name in compare.NOTES]
    if 'strings' in steps:
        notes = estimate(keyboard, recorded)
    if 'hammers' in steps:
        notes = fit_hammers(program, keyboard, notes, recordings)
    if 'refine' in steps:
        notes = refine(program, keyboard, notes, recordings)
    if 'decays' in steps:
        fit_decays(keyboard, notes, recorded)
    if 'output' in steps:
        notes = fit_output(program, keyboard, notes, recorded)
    write(keyboard, notes, fitted_file)


if __name__ == '__main__':
    if len(sys.argv) < 5 or not set(sys.argv[5:]) <= set(STEPS):
        sys.exit(__doc__)
    main(*sys.argv[1:5], *(sys.argv[5:] or STEPS))
