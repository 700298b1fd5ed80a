# SPDX-License-Identifier: MIT
"""What the fits to recorded notes share: sounds, and instrument files as text. It needs Debian's python3-numpy and python3-scipy."""
import glob
import json
import os
import re

from scipy.io import wavfile

RATE = 44100


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
