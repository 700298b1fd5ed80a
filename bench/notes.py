# SPDX-License-Identifier: MIT
"""What the fits to recorded notes share: sounds, and instrument files as text. It needs Debian's python3-numpy and python3-scipy."""
import glob
import json
import os
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from scipy.io import wavfile

RATE = 44100
GAIN = "-40"  # of what is rendered [dB]: the same for all, so that they are as loud beside each other as they are


def rounded(x, digits=5):
    return float(f"{x:.{digits}g}")


def read(path):
    """A sound at 44.1 kHz, the mean of its channels."""
    rate, sound = wavfile.read(path)
    assert rate == RATE, path
    sound = sound.astype(float)
    return sound if sound.ndim == 1 else sound.mean(1)


def recorded(folder):
    """Sounds of FOLDER/SOURCE/NOTE.wav by source and note."""
    return {(os.path.basename(os.path.dirname(path)), os.path.basename(path)[:-4]): read(path)
            for path in sorted(glob.glob(f"{folder}/*/*.wav"))}


def onset(sound):
    """The sample 3 ms before it is first above 0.03 of its peak."""
    return max(0, int(np.argmax(np.abs(sound) > 0.03 * np.abs(sound).max())) - int(0.003 * RATE))


def from_onset(sound):
    return sound[onset(sound):]


def a_weighting(f):
    """[dB]"""
    q = np.maximum(f, 1) ** 2
    return 2 + 20 * np.log10(12194 ** 2 * q * q / ((q + 20.6 ** 2) * np.sqrt((q + 107.7 ** 2) * (q + 737.9 ** 2)) * (q + 12194 ** 2)))


def loudness(sound, begin=0, end=0.6):
    """Of a part from the onset on [dB(A)]."""
    power = np.abs(np.fft.rfft(from_onset(sound)[int(begin * RATE):int(end * RATE)], RATE)) ** 2
    return 10 * np.log10((power * 10 ** (a_weighting(np.fft.rfftfreq(RATE, 1 / RATE)) / 10)).sum())


def windows(sound, seconds, n=2048, hop=512):
    """Spectra of n samples each."""
    return [np.fft.rfft(sound[a:a + n] * np.hanning(n)) for a in range(0, min(len(sound), int(seconds * RATE)) - n, hop)]


def mel_bank(top, bands=48, n=2048):
    """Weights, by band from 60 Hz to `top`, of the frequencies of such spectra."""
    edges = 700 * (10 ** (np.linspace(*(2595 * np.log10(1 + np.array([60, top]) / 700)), bands + 2) / 2595) - 1)
    f = np.fft.rfftfreq(n, 1 / RATE)
    bank = np.maximum(0, np.minimum((f - edges[:-2, None]) / np.diff(edges)[:-1, None], (edges[2:, None] - f) / np.diff(edges)[1:, None]))
    return bank / (bank.sum(1, keepdims=True) + 1e-12)


def mel(sound, seconds, top):
    """Powers by window and band."""
    bank = mel_bank(top)
    return np.array([bank @ np.abs(spectrum) ** 2 for spectrum in windows(sound, seconds)])


def text_of(file):
    """An instrument file, with a line for each row."""
    lines = []
    for key, value in file.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            rows = ",\n".join("    " + json.dumps(row) for row in value)
            lines.append(f'  "{key}": [\n{rows}\n  ]')
        else:
            lines.append(f'  "{key}": {json.dumps(value)}')
    text = "{\n" + ",\n".join(lines) + "\n}\n"
    text = re.sub(r' ?(\{"frequency_hz)', r"\n        \1", text)
    return re.sub(r"\{(?=\S)", "{ ", re.sub(r"(?<=\S)\}", " }", text))


def rendered(program, of, file, key, *options):
    """A note. of: its `seconds` and `velocity`, and `events` before it; file: a dict or a path; options: of `render`."""
    with tempfile.TemporaryDirectory() as folder:
        path = file
        if isinstance(file, dict):
            path = f"{folder}/instrument.json"
            Path(path).write_text(text_of(file), encoding="utf-8")
        score = {"instrument": os.path.abspath(path), "duration_s": of["seconds"] + 0.1,
                 "events": [*of["events"], {"time_s": 0.05, "key": key, "velocity": of["velocity"]}]}
        Path(f"{folder}/score.json").write_text(json.dumps(score), encoding="utf-8")
        subprocess.run([program, "render", f"{folder}/score.json", "--no-figure", "--gain", GAIN, *options, "-o", f"{folder}/note.wav"], check=True,
                       capture_output=True)
        return read(f"{folder}/note.wav")


def named(path, kinds):
    """What `kinds` says of an instrument file, by its name."""
    return kinds[json.loads("\n".join(line for line in Path(path).read_text(encoding="utf-8").splitlines() if not line.startswith("//")))["name"]]
