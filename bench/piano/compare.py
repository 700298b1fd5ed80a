#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How near a piano is to a recorded grand, note by note, in figures.

Reference: Salamander Grand Piano V3 (a Yamaha C5, recorded by Alexander Holm, CC BY 3.0), MP3 layers 7 and 15 from the
npm packages @audio-samples/piano-mp3-velocity7 and -velocity15. It needs Debian's python3-numpy, python3-scipy, ffmpeg,
and npm.

    compare.py fetch REF              # downloads and decodes the reference notes into the folder REF
    compare.py score FOLDER CS        # renders the same notes with the program CS into FOLDER (hammer speeds below)
    compare.py distance FOLDER REF    # prints the distances between two folders of notes
    compare.py neighbours CS          # prints how far apart in loudness neighbours of the 88 keys are
    compare.py features FOLDER        # prints B, partial levels, decays and loudness of each note, as JSON

A folder holds NOTEvLAYER.wav, for instance C4v7.wav. Levels are in dB, decays in dB/s, frequencies in Hz.
"""
import json, os, subprocess, sys, tarfile, tempfile
import numpy as np
from scipy.io import wavfile
from scipy.signal import fftconvolve, get_window

RATE = 44100
NOTES = ['A0', 'C1', 'A1', 'C2', 'A2', 'C3', 'A3', 'C4', 'A4', 'C5', 'A5', 'C6', 'A6', 'C7', 'A7', 'C8']
if os.environ.get('CONTACTSPLINE_KEYS') == 'judge':  # keys that fit.py does not see
    NOTES = [f'{name}{octave}' for octave in range(1, 8) for name in ('D#', 'F#')]
SPEEDS = {7: 2.0, 15: 4.5}  # hammer speeds in m/s whose loudness differs as that of the layers does (7 dB)
SECONDS = 8.0


NAMES = 'C C# D D# E F F# G G# A A# B'.split()


def name_of(key):
    return f'{NAMES[key % 12]}{key // 12 - 1}'


def key_of(note):
    return 12 * (int(note[-1]) + 1) + NAMES.index(note[:-1])


def fetch(folder):
    os.makedirs(folder, exist_ok=True)
    with tempfile.TemporaryDirectory() as t:
        for layer in SPEEDS:
            name = subprocess.run(['npm', 'pack', '--silent', f'@audio-samples/piano-mp3-velocity{layer}'], cwd=t,
                                  check=True, capture_output=True, text=True).stdout.split()[-1]
            tarfile.open(os.path.join(t, name)).extractall(t)
            for note in NOTES:
                subprocess.run(['ffmpeg', '-v', 'error', '-y', '-i', f'{t}/package/audio/{note}v{layer}.mp3', '-ar', str(RATE),
                                '-t', str(SECONDS), f'{folder}/{note}v{layer}.wav'], check=True)


def render(program, keyboard, key, speed, seconds, base):
    """Writes base.wav (and the score, base.json)."""
    with open(base + '.json', 'w') as f:
        json.dump({'instrument': keyboard, 'duration_s': seconds,
                   'events': [{'time_s': 0, 'key': key, 'speed_m_per_s': speed, 'hold_s': seconds}]}, f)
    subprocess.run([program, 'render', base + '.json', '-o', base + '.wav', '--no-figure',
                    '--gain', '20'], check=True, capture_output=True)


def score(folder, program, keyboard='piano', layers=tuple(SPEEDS), seconds=SECONDS, notes=None):
    os.makedirs(folder, exist_ok=True)
    for note in notes or NOTES:
        for layer in layers:
            render(program, keyboard, key_of(note), SPEEDS[layer], seconds, f'{folder}/{note}v{layer}')


def neighbours(program, keyboard='piano'):
    with tempfile.TemporaryDirectory() as t:
        for layer, speed in SPEEDS.items():
            loudness = []
            for key in range(21, 109):
                render(program, keyboard, key, speed, 1.0, f'{t}/{key}')
                loudness.append(loudness_dba(load(f'{t}/{key}.wav')))
            steps = np.abs(np.diff(loudness))
            print(f'layer {layer}: median {np.median(steps):.1f} dB, worst {steps.max():.1f} dB, from key {21 + steps.argmax()} on')


def side_db(folder):
    """How far the difference of the sides is below their mean, the median over the notes [dB]."""
    def of(sound):
        return 10 * np.log10(((sound[:, 0] - sound[:, 1])**2).sum() / ((sound[:, 0] + sound[:, 1])**2).sum())
    return np.median([of(load(f'{folder}/{note}v{layer}.wav')[:3 * RATE]) for note in NOTES for layer in SPEEDS])


def load(path):
    """Samples by channels, from 3 ms before the onset."""
    rate, x = wavfile.read(path)
    assert rate == RATE, path
    x = x.astype(float) / {np.dtype('int32'): 2.0**31, np.dtype('int16'): 2.0**15}.get(x.dtype, 1.0)
    x = x[:, None] if x.ndim == 1 else x
    envelope = np.abs(x).max(1)
    return x[max(0, int(np.argmax(envelope > 0.02 * envelope.max())) - int(0.003 * RATE)):]


def power(x, t0, n):
    s = x[int(t0 * RATE):int(t0 * RATE) + n]
    s = np.pad(s, ((0, n - len(s)), (0, 0)))
    w = get_window('blackmanharris', n)[:, None]
    return (np.abs(np.fft.rfft(s * w, axis=0) / w.sum() * 2)**2).mean(1)


def partials(x, f0, most=24):
    """[(number, frequency, level)], f0 and B of a stiff string through them."""
    n = 1 << 15
    p, f = power(x, 0.05, n), np.fft.rfftfreq(n, 1 / RATE)
    b, base, found = 3e-4, f0, []
    for k in range(1, most + 1):
        if len(found) >= 2:
            ks, fs = np.array([r[0] for r in found]), np.array([r[1] for r in found])
            c = np.linalg.lstsq(np.c_[np.ones(len(ks)), ks**2], (fs / ks)**2, rcond=None)[0]
            base, b = np.sqrt(max(c[0], 1)), max(c[1] / c[0], 0)
            b = min(b, 2e-3) if len(found) < 4 else b
        at = k * base * np.sqrt(1 + b * k * k)
        if at > 16000:
            break
        width = min(max(f0 * (0.25 if k > 1 else 0.06), 3), at * 0.03 + 3)
        near = (f > at - width) & (f < at + width)
        if near.sum() < 3:
            break
        i = int(np.argmax(np.where(near, p, 0)))
        if p[i] < 8 * np.median(p[(f > at - 0.45 * f0) & (f < at + 0.45 * f0)]):
            continue
        l, m, r = np.log(p[i - 1:i + 2] + 1e-30)
        found.append((k, float((i + (0.5 * (l - r) / (l - 2 * m + r) if l - 2 * m + r else 0)) * RATE / n), float(10 * np.log10(p[i] + 1e-30))))
    return found, float(base), float(b)


def decay(x, f, width):
    """Times and level of one partial."""
    t, half = np.arange(len(x)) / RATE, int(RATE / width)
    w = np.hanning(2 * half + 1)
    hop = int(0.02 * RATE)
    y = sum(np.abs(fftconvolve(x[:, c] * np.exp(-2j * np.pi * f * t), w / w.sum(), 'same')[::hop])**2 for c in range(x.shape[1]))
    return np.arange(len(y)) * 0.02, 10 * np.log10(y + 1e-30)


def slope(t, y, begin, end, floor):
    m = (t >= begin) & (t <= end) & (y > floor)
    return float(-np.polyfit(t[m], y[m], 1)[0]) if m.sum() >= 8 else None


def a_weight(f):
    q = f * f
    return 2 + 20 * np.log10(12194**2 * q * q / ((q + 20.6**2) * np.sqrt((q + 107.7**2) * (q + 737.9**2)) * (q + 12194**2)) + 1e-30)


def mel(x, seconds=3.0, bands=64, n=4096, hop=1024):
    x = x[:int(seconds * RATE)]
    x = np.pad(x, ((0, int(seconds * RATE) - len(x)), (0, 0)))
    f = np.fft.rfftfreq(n, 1 / RATE)
    edges = 700 * (10**(np.linspace(*(2595 * np.log10(1 + np.array([30, 16000]) / 700)), bands + 2) / 2595) - 1)
    bank = np.maximum(0, np.minimum((f - edges[:-2, None]) / np.diff(edges)[:-1, None], (edges[2:, None] - f) / np.diff(edges)[1:, None]))
    bank /= bank.sum(1, keepdims=True) + 1e-12
    w = np.hanning(n)[:, None]
    return np.array([bank @ (np.abs(np.fft.rfft(x[a:a + n] * w, axis=0))**2).mean(1) for a in range(0, len(x) - n, hop)])


def loudness_dba(x):
    p = (np.abs(np.fft.rfft(x, axis=0))**2).mean(1)
    f = np.maximum(np.fft.rfftfreq(len(x), 1 / RATE), 1)
    return float(10 * np.log10((p * 10**(a_weight(f) / 10)).sum() + 1e-30))


def centroid_hz(x):
    head, f = power(x, 0, 1 << 14), np.fft.rfftfreq(1 << 14, 1 / RATE)
    heard = f > 25
    return float((head * f)[heard].sum() / head[heard].sum())


def features(path, note):
    x = load(path)
    f0 = 440 * 2**((key_of(note) - 69) / 12)
    found, base, b = partials(x, f0)
    decays, curves = [], []
    for k, f, _ in found[:12]:
        t, y = decay(x, f, min(f0 * 0.4, 40))
        floor = max(y.max() - 55, y[-20:].max() + 6)
        decays.append((k, slope(t, y, 0.1, 1.0, floor), slope(t, y, 2, 6, floor)))
        curves.append((k, f, t, y))
    return {'partials': found, 'f0': base, 'B': b, 'decays_db_per_s': decays,
            'loudness_dba': loudness_dba(x[:RATE]),
            'centroid_hz': centroid_hz(x), 'mel': mel(x), 'curves': curves}


def table(folder):
    return {(n, l): features(f'{folder}/{n}v{l}.wav', n) for n in NOTES for l in SPEEDS}


def distance(ours, real):
    a, b = table(ours), table(real)
    gain = np.median([a[i]['loudness_dba'] - b[i]['loudness_dba'] for i in a])
    top = max(10 * np.log10(b[i]['mel'].max()) for i in b)
    level, early, late, inharmonic, mels, centroid = [], [], [], [], [], []
    print('note   loudness  log-mel  B ours/real  early decay, median of ours/real')
    for i in a:
        p, q = ({k: l for k, _, l in s['partials'] if k <= 12} for s in (a[i], b[i]))
        both = [k for k in p if k in q and q[k] > max(q.values()) - 50]
        if len(both) >= 2:
            d = np.array([p[k] - q[k] for k in both])
            level += list(np.abs(d - np.median(d)))
        d, e = ({k: (u, v) for k, u, v in s['decays_db_per_s'] if k <= 8} for s in (a[i], b[i]))
        mine = [np.log2(d[k][0] / e[k][0]) for k in d if k in e and (d[k][0] or 0) > 0.5 and (e[k][0] or 0) > 0.5]
        early += mine
        late += [np.log2(d[k][1] / e[k][1]) for k in d if k in e and (d[k][1] or 0) > 0.5 and (e[k][1] or 0) > 0.5]
        ratio = a[i]['B'] / b[i]['B'] if key_of(i[0]) <= 84 and min(a[i]['B'], b[i]['B']) > 1e-6 else None
        if ratio:
            inharmonic.append(abs(np.log2(ratio)))
        ma, mb = (np.maximum(10 * np.log10(s['mel'] + 1e-30) - o, top - 80) for s, o in ((a[i], gain), (b[i], 0)))
        mels.append(np.abs(ma - mb).mean())
        centroid.append(abs(np.log2(a[i]['centroid_hz'] / b[i]['centroid_hz'])))
        print(f"{i[0]:3s} v{i[1]:<2d} {a[i]['loudness_dba'] - b[i]['loudness_dba'] - gain:8.1f} {mels[-1]:8.1f} "
              f"{ratio if ratio else float('nan'):12.2f} {2**np.median(mine) if mine else float('nan'):12.2f}")
    layers = sorted(SPEEDS)
    balance = np.array([np.mean([a[n, l]['loudness_dba'] - b[n, l]['loudness_dba'] for l in layers]) for n in NOTES]) - gain
    steps = [abs((a[n, layers[1]]['loudness_dba'] - a[n, layers[0]]['loudness_dba']) - (b[n, layers[1]]['loudness_dba'] - b[n, layers[0]]['loudness_dba'])) for n in NOTES]
    print(f'\npartial levels: median {np.median(level):.1f} dB, 90 % {np.percentile(level, 90):.1f} dB'
          f'\nearly decay: median factor {2**np.median(np.abs(early)):.2f}, 90 % {2**np.percentile(np.abs(early), 90):.1f}'
          f'\nlate decay: median factor {2**np.median(np.abs(late)):.2f}'
          f'\ninharmonicity B: median factor {2**np.median(inharmonic):.2f}, worst {2**max(inharmonic):.1f}'
          f'\nlog-mel spectrogram, 3 s, one gain for all notes: mean {np.mean(mels):.1f} dB'
          f'\nloudness over the keyboard: rms {np.sqrt((balance**2).mean()):.1f} dB, worst {np.abs(balance).max():.0f} dB'
          f'\ncentroid: median factor {2**np.median(centroid):.2f}'
          f'\nloudness between the layers: median difference {np.median(steps):.1f} dB'
          f'\nsides beside the middle: {side_db(ours):.1f} dB, {side_db(real):.1f} dB')


if __name__ == '__main__':
    command = dict(fetch=fetch, score=score, distance=distance, neighbours=neighbours).get(sys.argv[1]) if len(sys.argv) > 2 else None
    if command:
        command(*sys.argv[2:])
    elif len(sys.argv) == 3 and sys.argv[1] == 'features':
        print(json.dumps({f'{n}v{l}': {k: v for k, v in f.items() if k not in ('mel', 'curves')} for (n, l), f in table(sys.argv[2]).items()}, indent=1))
    else:
        sys.exit(__doc__)
