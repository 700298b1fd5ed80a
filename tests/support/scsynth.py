# SPDX-License-Identifier: MIT
"""SuperCollider's language, and its server in non-real time: definitions of synths, messages, scores."""
import os
import struct
from pathlib import Path

from sound import RATE, channels, run

BLOCK = 64
SCALAR, CONTROL, AUDIO, DEMAND = range(4)
PLUGINS = "/usr/lib/SuperCollider/plugins"


class SynthDef:
    """A definition of units, and its file. An input is a number or a pair of unit and output."""

    def __init__(self, name):
        self.name, self.constants, self.controls, self.units = name, [], {}, []

    def unit(self, kind, rate, inputs, outputs=1):
        self.units.append((kind, rate, inputs, outputs))
        return len(self.units) - 1

    def add_controls(self, values, kind="Control"):
        """A unit of controls with names and first values: what stands for each."""
        first = len(self.controls)
        self.controls.update(values)
        unit = self.unit(kind, CONTROL, [], len(values))
        self.units[unit] += (first,)
        return {name: (unit, output) for output, name in enumerate(values)}

    def bytes(self):
        def text(word):
            return bytes([len(word)]) + word.encode()

        def constant(value):
            self.constants.append(value)
            return len(self.constants) - 1

        units = b""
        for kind, rate, inputs, outputs, *special in self.units:
            units += text(kind) + struct.pack(">biih", rate, len(inputs), outputs, *(special or [0]))
            for value in inputs:
                units += struct.pack(">ii", *(value if isinstance(value, tuple) else (-1, constant(value))))
            units += bytes([rate]) * outputs
        values, names = self.controls.values(), self.controls
        return (b"SCgf" + struct.pack(">ih", 2, 1) + text(self.name)
                + struct.pack(f">i{len(self.constants)}f", len(self.constants), *self.constants)
                + struct.pack(f">i{len(values)}f", len(values), *values)
                + struct.pack(">i", len(names)) + b"".join(text(n) + struct.pack(">i", i) for i, n in enumerate(names))
                + struct.pack(">i", len(self.units)) + units + struct.pack(">h", 0))


def message(*words):
    """A message of Open Sound Control."""
    def padded(data):
        return data + b"\0" * (4 - len(data) % 4)

    kinds = {int: (b"i", lambda x: struct.pack(">i", x)), float: (b"f", lambda x: struct.pack(">f", x)),
             str: (b"s", lambda x: padded(x.encode())),
             bytes: (b"b", lambda x: struct.pack(">i", len(x)) + x + b"\0" * (-len(x) % 4))}
    tags = b"," + b"".join(kinds[type(word)][0] for word in words[1:])
    return padded(words[0].encode()) + padded(tags) + b"".join(kinds[type(word)][1](word) for word in words[1:])


def play_score(plugins, score, count, samples, inputs=None):
    """Plays a score of (sample, message), with the units of a folder: what the server prints, and `count` outputs."""
    with open("score.osc", "wb") as file:
        for at, data in [*score, (samples, message("/c_set", 0, 0))]:
            # Into the middle of a block: times are rounded.
            seconds = (at + BLOCK // 2) / RATE if at > 0 else 0
            bundle = b"#bundle\0" + struct.pack(">Q", int(seconds * 2**32)) + struct.pack(">i", len(data)) + data
            file.write(struct.pack(">i", len(bundle)) + bundle)
    printed = run("scsynth", "-N", "score.osc", inputs or "_", "test.wav", str(RATE), "WAV", "float", "-o", str(count),
                  "-i", "32", "-D", "0", "-U", f"{plugins}:{PLUGINS}")
    return printed, channels("test.wav")


def run_sclang(classes, code):
    """Runs code in the language with the classes of a folder: what it prints."""
    Path("conf.yaml").write_text(f"includePaths:\n  - {classes}\nexcludePaths: []\npostInlineWarnings: false\n")
    Path("test.scd").write_text(f"{code}\n0.exit;\n", encoding="utf-8")
    os.environ |= {"QT_QPA_PLATFORM": "offscreen", "HOME": os.getcwd(), "XDG_RUNTIME_DIR": os.getcwd(), "QTWEBENGINE_DISABLE_SANDBOX": "1"}
    return run("sclang", "-D", "-l", "conf.yaml", "test.scd")
