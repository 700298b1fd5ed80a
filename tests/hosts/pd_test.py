# SPDX-License-Identifier: MIT
"""The object in Pd itself, pd -batch: see host_test.py."""
import random
import sys
from pathlib import Path

from host_test import (BLOCK, DURATION, EXAMPLES, HOSTILE, HostTest, Instrument, RATE, as_single, channels, hz, need,
                       random_lives, require_music, require_pitch, run, write_wav)
from sound import block
import numpy as np


class Patch:
    """Text of a patch: objects and the lines between them."""

    def __init__(self, text="#N canvas 0 0 450 300 10;"):
        lines = text.strip().split("\n")
        self.connections = [line for line in lines if line.startswith("#X connect")]
        self.lines = [line for line in lines if not line.startswith("#X connect")]
        self.objects = [line for line in self.lines if line.startswith("#X")]
        self.count = len(self.objects)

    def add(self, kind, text):
        self.lines.append(f"#X {kind} 10 10 {text};")
        self.count += 1
        return self.count - 1

    def connect(self, source, outlet, sink, inlet):
        self.connections.append(f"#X connect {source} {outlet} {sink} {inlet};")

    def write(self, name):
        Path(name).write_text("\n".join(self.lines + self.connections) + "\n")


class PdTest(HostTest):
    precision = "single"
    smallest = 2.0**-63  # PD_BIGORSMALL of m_pd.h, which tabwrite~ asks
    by_signal = False

    def samples(self):
        super().samples()
        self.by_signal = True
        super().samples()

    def first_values(self, instrument):
        return instrument.rounded() if self.by_signal else []

    def pd(self, patch):
        """Runs a patch in real Pd without a sound card; what it prints."""
        return run("pd", "-batch", "-nogui", "-noprefs", "-noaudio", "-stderr", "-r", str(RATE), "-path", str(Path(self.module).parent), patch)

    def record(self, patch, object_, count, samples, messages):
        """Sends messages at samples, (sample, receiver, text) each, records the outlets of an object, and ends. What Pd
        prints, and an array for each outlet."""
        arrays = [f"sound{channel}" for channel in range(count)]
        for channel, name in enumerate(arrays):
            patch.add("obj", f"table {name} {samples}")
            recorder = patch.add("obj", f"tabwrite~ {name}")
            patch.connect(patch.add("obj", "r record"), 0, recorder, 0)
            patch.connect(object_, channel, recorder, 0)
        patch.connect(patch.add("obj", "r files"), 0, patch.add("obj", "soundfiler"), 0)
        # A qlist counts milliseconds from one message to the next, in single precision: each falls into the middle of a block.
        lines, now = [], -BLOCK // 2
        for at, target, text in sorted([(0, "record", "bang"), *messages,
                                        (samples + BLOCK, "files", f"write -wave -bytes 4 test.wav {' '.join(arrays)}"),
                                        (samples + BLOCK, "pd", "quit")], key=lambda row: row[0]):
            lines.append(f"{(at - now) * 1000 / RATE!r} {target} {text};")
            now = at
        Path("messages.txt").write_text("0 pd dsp 1;\n" + "\n".join(lines) + "\n")
        start, split, read, play = (patch.add("obj", "loadbang"), patch.add("obj", "t b b"),
                                    patch.add("msg", "read messages.txt"), patch.add("msg", "bang"))
        qlist = patch.add("obj", "qlist")
        for source, outlet, sink in [(start, 0, split), (split, 1, read), (split, 0, play), (read, 0, qlist), (play, 0, qlist)]:
            patch.connect(source, outlet, sink, 0)
        patch.write("test.pd")
        Path("test.wav").unlink(missing_ok=True)
        printed = self.pd("test.pd")
        assert "contactspline~:" not in printed, printed
        return np.array(channels("test.wav"))

    def render(self, instrument, taps, performance, samples):
        patch = Patch()
        wires = list(instrument.parameters) if self.by_signal else []
        played = patch.add("obj", f"contactspline~ {instrument.name} {' '.join(wires + taps)}")
        patch.connect(patch.add("obj", "r played"), 0, played, 0)
        for inlet, name in enumerate(wires, 1):
            signal = patch.add("obj", f"sig~ {as_single(instrument.parameters[name][2])!r}")
            patch.connect(patch.add("obj", f"r {name}"), 0, signal, 0)
            patch.connect(signal, 0, played, inlet)
        messages = []
        for at, kind, *words in performance:
            if kind == "set" and self.by_signal:
                messages.append((at, words[0], repr(words[1])))
                continue
            text = " ".join(repr(w) if isinstance(w, float) else str(w) for w in words if w is not None)
            messages.append((at, "played", f"note {text}" if kind == "note" else text))
        return self.record(patch, played, len(taps), samples, messages)

    def page(self):
        patch = Patch(block("pd.md", "pd"))
        require_pitch([list(sound) for sound in self.record(patch, 2, 2, 2 * RATE, [])])

    def pieces(self):
        """The pieces of examples/pd, where what goes to the sound card is recorded."""
        Path("sides~.pd").write_text("\n".join(["#N canvas 0 0 450 300 10;", *["#X obj 10 10 inlet~;"] * 2, *["#X obj 10 10 outlet~;"] * 2,
                                                "#X connect 0 0 2 0;", "#X connect 1 0 3 0;"]))
        for name, notes in [("piano", [(0.1, hz(38)), (3.6, hz(35)), (7, hz(31)), (10.3, hz(33))]),
                            ("slide", [(3, hz(69)), (9.5, hz(74))]), ("polyrhythm", [(0.1, hz(60)), (4.9, hz(60))])]:
            patch = Patch((EXAMPLES / f"pd/{name}.pd").read_text().replace(" dac~;", " sides~;"))
            sides = [line.endswith("sides~;") for line in patch.objects].index(True)
            require_music(name, self.record(patch, sides, 2, 16 * RATE, []), notes)

    def hostile(self):
        """A million values at random, as messages and as signals that move at every sample."""
        count = 0
        for name in ("hammer_string", "lap_steel", "snare", "piano", "slap_bass"):
            instrument, draw = Instrument(self.reference, name), random.Random(name)
            wires, rounds = list(instrument.parameters), 30000
            values = np.array([[draw.choice(HOSTILE) if draw.random() < 0.5 else draw.uniform(-2, 2) for _ in range(rounds)]
                               for _ in wires], np.float32)
            write_wav("values.wav", values)
            patch = Patch()
            played = patch.add("obj", f"contactspline~ {name} {' '.join(wires)} left right energy_j")
            names = [f"values{w}" for w in range(len(wires))]
            for w, values_name in enumerate(names):
                patch.add("obj", f"table {values_name} {rounds}")
                player = patch.add("obj", f"tabplay~ {values_name}")
                patch.connect(patch.add("obj", "r record"), 0, player, 0)
                patch.connect(player, 0, played, w + 1)
            patch.connect(patch.add("obj", "r played"), 0, played, 0)
            # A parameter and an event by message, of values from the table.
            read = patch.add("obj", "tabread values0")
            patch.connect(patch.add("obj", "r index"), 0, read, 0)
            texts = [f"{word} \\$1" for word in [*wires, *instrument.events]] + ["note \\$1 0.5", "note 60 \\$1"]
            for text in texts:
                message = patch.add("msg", text)
                patch.connect(read, 0, message, 0)
                patch.connect(message, 0, played, 0)
            messages = [(0, "files", f"read values.wav {' '.join(names)}")]
            messages += [(block * BLOCK, "index", str(draw.randrange(rounds))) for block in range(1, rounds // BLOCK)]
            # Pd's arrays write 0 for what is not finite: 0 x + 1 is 1 where x is. More, where there is energy.
            sum_ = patch.add("obj", "+~")
            for outlet in range(3):
                zero = patch.add("obj", "*~ 0")
                patch.connect(played, outlet, zero, 0)
                patch.connect(zero, 0, sum_, 0)
            one = patch.add("obj", "sig~ 1")
            patch.connect(one, 0, sum_, 0)
            large, clipped = patch.add("obj", "*~ 1e+30"), patch.add("obj", "clip~ 0 1")
            for source, outlet, sink in [(played, 2, large), (large, 0, clipped), (clipped, 0, sum_)]:
                patch.connect(source, outlet, sink, 0)
            sound = self.record(patch, sum_, 1, rounds, messages)
            assert (sound >= 1).all() and (sound > 1).any(), name
            count += values.size + len(texts) * (rounds // BLOCK)
        print(count, "values")
        assert count >= 1000000, count

    def lifetimes(self):
        """100 objects are made, play a note and are deleted at random, more than one at a time."""
        patch, messages = Patch(), []
        for index, (begin, end, name) in enumerate(random_lives(3)):
            patch.lines.append(f"#N canvas 0 0 450 300 life{index} 0;")
            patch.add("restore", f"pd life{index}")
            texts = [f"obj 10 10 contactspline~ {name}", "obj 10 40 r played", "obj 10 70 throw~ sum", "connect 1 0 0 0", "connect 0 0 2 0"]
            messages += [(begin * BLOCK, f"pd-life{index}", text) for text in texts]
            messages += [(begin * BLOCK, "played", "60 0.7"), (end * BLOCK, f"pd-life{index}", "clear")]
        sound = self.record(patch, patch.add("obj", "catch~ sum"), 1, DURATION * BLOCK, messages)
        assert np.isfinite(sound).all() and np.abs(sound).max() > 0.01
        assert np.abs(sound[0, -2 * BLOCK:]).max() == 0

    def refusals(self):
        hammer = "contactspline~ hammer_string"
        for text, sent, said in [
            ("contactspline~ harpsichord", "", "harpsichord: INSTRUMENT: no such instrument ships; allowed: a .json file"),
            ("contactspline~ absent.json", "", "absent.json: file: does not exist"),
            ("contactspline~", "", "instrument: is missing; allowed: a name, such as piano"),
            (f"{hammer} sound", "", "no parameter or output of hammer_string has the name sound; allowed are:"),
            (hammer, "note 60", "note: too few or too many values; allowed: two numbers, KEY VELOCITY"),
            (hammer, "60 0.7 1", "list: too few or too many values; allowed: two numbers, KEY VELOCITY"),
            (hammer, "note 60 loud", "note: a value is no number; allowed: two numbers, KEY VELOCITY"),
            (hammer, "stiffness_ratio foo", "stiffness_ratio: a value is no number; allowed: one number"),
            (hammer, "stiffness_ratio", "stiffness_ratio: too few or too many values; allowed: one number"),
            (hammer, "strike foo", "strike: a value is no number; allowed: one number, in m/s or N, or none"),
            (hammer, "strike 1 2", "strike: too few or too many values; allowed: one number, in m/s or N, or none"),
            (hammer, "reset 1", "reset: too few or too many values; allowed: no value"),
            (hammer, "bend 1", "bend: no message of hammer_string; allowed: note KEY VELOCITY"),
        ]:
            patch = Patch()
            object_ = patch.add("obj", text)
            start, split = patch.add("obj", "loadbang"), patch.add("obj", "t b b")
            patch.connect(start, 0, split, 0)
            if sent:
                message = patch.add("msg", sent)
                patch.connect(split, 1, message, 0)
                patch.connect(message, 0, object_, 0)
            patch.connect(split, 0, patch.add("msg", "\\; pd quit"), 0)
            patch.write("test.pd")
            printed = self.pd("test.pd")
            if said not in printed:
                sys.exit(f"{text}, {sent}: not said: {said}\n{printed}")


need("pd")
PdTest().main()
