# SPDX-License-Identifier: MIT
"""The unit generator in SuperCollider's server itself, scsynth -N, and its classes in sclang: see host_test.py."""
import os
import random
import re
import shutil
import sys
from pathlib import Path

from host_test import (BLOCK, DURATION, EXAMPLES, HOSTILE, HostTest, Instrument, MORTALS, RATE, channels, hz, need, random_lives,
                       require_music, require_pitch, run, write_wav)
from scsynth import AUDIO, CONTROL, DEMAND, SynthDef, message, play_score, run_sclang
from sound import block
import numpy as np

KEYS = range(55, 75)


def spelled(word):
    return [len(word), *word.encode()]


class SuperColliderTest(HostTest):
    precision = "single"

    def first_values(self, instrument):
        return instrument.rounded()

    def scsynth(self, score, count, samples, inputs=None):
        """Plays a score of (sample, message) in non-real time: what the server prints, and its outputs."""
        printed, sound = play_score(Path(self.module).parent, score, count, samples, inputs)
        return printed, np.array(sound)

    def render(self, instrument, taps, performance, samples):
        definition = SynthDef("test")
        slots = definition.add_controls({f"gate{key}": 0 for key in KEYS} | {f"velocity{key}": 0 for key in KEYS}
                                        | {f"value_{event}": 0 for event in instrument.events}
                                        | {name: initial for name, (_, _, initial) in instrument.parameters.items()})
        triggers = definition.add_controls({f"{kind}_{event}": 0 for event in instrument.events for kind in ("plain", "play")}
                                           or {"unused": 0}, "TrigControl")
        inputs = spelled(instrument.name) + [len(taps)] + sum(map(spelled, taps), []) + [len(KEYS)]
        for key in KEYS:
            inputs += [slots[f"gate{key}"], key, slots[f"velocity{key}"]]
        inputs += [2 * len(instrument.events)]
        for event in instrument.events:
            inputs += spelled(event) + [triggers[f"plain_{event}"], 0, 0]
            inputs += spelled(event) + [triggers[f"play_{event}"], 1, slots[f"value_{event}"]]
        inputs += [len(instrument.parameters)]
        for parameter in instrument.parameters:
            inputs += spelled(parameter) + [slots[parameter]]
        unit = definition.unit("ContactInstrument", AUDIO, inputs, len(taps))
        definition.unit("Out", AUDIO, [0, *[(unit, tap) for tap in range(len(taps))]], 0)
        score = [(0, message("/d_recv", definition.bytes())), (0, message("/s_new", "test", 1000, 0, 0))]
        for at, kind, *words in performance:
            if kind == "set":
                sets = [words[0], words[1]]
            elif kind == "note":
                sets = [f"velocity{words[0]}", float(words[1]), f"gate{words[0]}", float(words[1] > 0)]
            else:
                sets = [f"plain_{words[0]}", 1.0] if words[1] is None else [f"value_{words[0]}", words[1], f"play_{words[0]}", 1.0]
            score.append((at, message("/n_set", 1000, *sets)))
        printed, sound = self.scsynth(score, len(taps), samples)
        assert "contactspline:" not in printed and "FAILURE" not in printed, printed
        return sound

    def demand(self):
        """Keys and a parameter at demand rate move when the gate rises; streams that have ended move nothing."""
        definition = SynthDef("test")
        gate = definition.add_controls({"gate": 0})["gate"]
        keys = (definition.unit("Dseq", DEMAND, [1, 60, 64, 67]), 0)
        stiffness = (definition.unit("Dseq", DEMAND, [1, 2, 0.5]), 0)
        inputs = (spelled("piano") + [2] + spelled("left") + spelled("right") + [1, gate, keys, 0.75, 0, 1]
                  + spelled("stiffness_ratio") + [stiffness])
        unit = definition.unit("ContactInstrument", AUDIO, inputs, 2)
        definition.unit("Out", AUDIO, [0, (unit, 0), (unit, 1)], 0)
        score, performance = [(0, message("/d_recv", definition.bytes())), (0, message("/s_new", "test", 1000, 0, 0))], []
        for turn, (key, ratio) in enumerate([(60, 2.0), (64, 0.5), (67, None), (None, None)]):
            at, end = (1 + 20 * turn) * BLOCK, (11 + 20 * turn) * BLOCK
            score += [(at, message("/n_set", 1000, "gate", 1.0)), (end, message("/n_set", 1000, "gate", 0.0))]
            performance += [(at, "set", "stiffness_ratio", ratio)] * (ratio is not None)
            performance += [(at, "note", key, 0.75), (end, "note", key, 0)] * (key is not None)
        expected = Instrument(self.reference, "piano").play("single", performance, 100 * BLOCK)
        _, sound = self.scsynth(score, 2, 100 * BLOCK)
        assert np.abs(expected[:2]).max() > 0
        assert np.array_equal(sound[:, :100 * BLOCK].astype(np.float32), expected[:2])

    def sclang(self, code):
        """Runs code with the classes of the build: what it prints."""
        return run_sclang(Path(self.module).parent / "classes", code)

    def page(self):
        """The page's function and the example of each class, compiled by sclang; its pitch in scsynth."""
        need("sclang")
        function = re.search(r"(\{.*\})\.play", block("supercollider.md", "supercollider")).group(1)
        helps = Path(self.module).parent / "HelpSource/Classes"
        examples = [example for page in sorted(helps.glob("*.schelp"))
                    for example in re.findall(r"(\{(?:[^{}]|\n)*\})\.play", page.read_text())]
        assert len(examples) >= 16, len(examples)
        code = "".join(f'SynthDef("d{i}", {{ Out.ar(0, ({example}).value) }}).writeDefFile("{os.getcwd()}");\n'
                       for i, example in enumerate([function, *examples]))
        printed = self.sclang(code)
        assert "ERROR" not in printed, printed
        for i in range(len(examples) + 1):
            data = Path(f"d{i}.scsyndef").read_bytes()
            score = [(0, message("/d_recv", data)), (0, message("/s_new", f"d{i}", 1000, 0, 0))]
            printed, sound = self.scsynth(score, 2, 2 * RATE)
            assert np.isfinite(sound).all() and np.abs(sound).max() > 1e-4 and "contactspline:" not in printed, (i, printed)
            if i == 0:
                require_pitch([list(channel[:2 * RATE]) for channel in sound])

    def pieces(self):
        """The pieces of examples/supercollider, as sclang reads them."""
        need("sclang")
        pieces = {"piano": [(2.2, hz(38, 64)), (7, hz(31, 43)), (10.2, hz(33, 45))], "drone": [(0.2, hz(43)), (1.4, hz(48)), (3.2, hz(36))],
                  "drums": [(5, hz(63))]}  # bar of the marimba; the tom falls by up to 200 cents
        self.sclang("".join(f'"{EXAMPLES}/supercollider/{name}.scd".load; SynthDef("{name}", {{ Out.ar(0, SynthDef.wrap(~piece)) }})'
                            f'.writeDefFile("{os.getcwd()}");\n' for name in pieces))
        for name, notes in pieces.items():
            score = [(0, message("/d_recv", Path(f"{name}.scsyndef").read_bytes())), (0, message("/s_new", name, 1000, 0, 0))]
            printed, sound = self.scsynth(score, 2, 16 * RATE)
            assert "contactspline:" not in printed and "FAILURE" not in printed, printed
            require_music(name, sound, notes)

    def paths(self):
        """A path beyond ASCII goes from sclang to the server."""
        need("sclang")
        shutil.copy(Path(__file__).parents[2] / "examples/instruments/hammer_on_string.json", "klänge_鐘.json")
        self.sclang(f'SynthDef("test", {{ Out.ar(0, ContactInstrument.ar("{os.getcwd()}/klänge_鐘.json", [[1, 60, 0.7]])) }})'
                    f'.writeDefFile("{os.getcwd()}");')
        score = [(0, message("/d_recv", Path("test.scsyndef").read_bytes())), (0, message("/s_new", "test", 1000, 0, 0))]
        printed, sound = self.scsynth(score, 2, RATE // 4)
        assert np.abs(sound).max() > 0 and "contactspline:" not in printed, printed

    def hostile(self):
        """A million values at random, at audio rate, in gates, keys, velocities, triggers, values and parameters."""
        count, rounds = 0, 30016
        for name in ("hammer_string", "lap_steel", "snare", "piano", "slap_bass"):
            instrument, draw = Instrument(self.reference, name), random.Random(name)
            wires = 5 + len(instrument.parameters)
            values = np.array([[draw.choice(HOSTILE) if draw.random() < 0.5 else draw.uniform(-2, 2) for _ in range(rounds)]
                               for _ in range(wires)], np.float32)
            values[1] = np.where(np.arange(rounds) % 2 == 0, 60, values[1])
            write_wav("values.wav", values)
            definition = SynthDef("test")
            source = definition.unit("In", AUDIO, [3], wires)  # the server's inputs follow its outputs
            signal = [(source, wire) for wire in range(wires)]
            inputs = spelled(name) + [3] + spelled("left") + spelled("force_n") + spelled("energy_j") + [1] + signal[:3]
            inputs += [len(instrument.events)]
            for event in instrument.events:
                inputs += spelled(event) + [signal[3], 1, signal[4]]
            inputs += [len(instrument.parameters)]
            for parameter, wire in zip(instrument.parameters, signal[5:]):
                inputs += spelled(parameter) + [wire]
            unit = definition.unit("ContactInstrument", AUDIO, inputs, 3)
            definition.unit("Out", AUDIO, [0, (unit, 0), (unit, 1), (unit, 2)], 0)
            score = [(0, message("/d_recv", definition.bytes())), (0, message("/s_new", "test", 1000, 0, 0))]
            printed, sound = self.scsynth(score, 3, rounds - BLOCK, "values.wav")
            assert "contactspline:" not in printed, printed
            assert np.isfinite(sound).all() and np.abs(sound).max() > 0, name
            count += values.size
        print(count, "values")
        assert count >= 1000000, count

    def lifetimes(self):
        """100 synths begin and end at random, more than one at a time."""
        score, events, lives = [], [], random_lives(5)
        for name in MORTALS:
            definition = SynthDef(name)
            inputs = spelled(name) + [1] + spelled("left") + [1, 1, 60, 0.7, 0, 0]
            definition.unit("Out", AUDIO, [0, (definition.unit("ContactInstrument", AUDIO, inputs), 0)], 0)
            score.append((0, message("/d_recv", definition.bytes())))
        for node, (begin, end, name) in enumerate(lives, 1000):
            events += [(begin * BLOCK, message("/s_new", name, node, 0, 0)), (end * BLOCK, message("/n_free", node))]
        printed, sound = self.scsynth(score + sorted(events, key=lambda row: row[0]), 1, DURATION * BLOCK)
        assert np.isfinite(sound).all() and np.abs(sound).max() > 0.01 and "FAILURE" not in printed, printed
        assert np.abs(sound[0, -2 * BLOCK:]).max() == 0

    def refusals(self):
        end = [0, 0, 0]
        for inputs, said in [
            (spelled("harpsichord") + [1] + spelled("left") + end, "harpsichord: INSTRUMENT: no such instrument ships"),
            (spelled("tom") + [1] + spelled("sound") + end, "output: there is none of the name sound"),
            (spelled("tom") + [1] + spelled("left") + [0, 1] + spelled("strike") + [1, 0, 0, 0], "event: there is none of the name strike"),
            (spelled("tom") + [1] + spelled("left") + [0, 0, 1] + spelled("bend") + [1], "parameter: there is none of the name bend"),
            (spelled("tom") + [1] + spelled("left") + [0, 0], "its inputs are damaged"),
            ([float("nan")] + [1] + spelled("left") + end, "its inputs are damaged"),
            ([1e30, 65], "its inputs are damaged"),
            ([], "its inputs are damaged"),
            ([None, *spelled("tom")[1:], 1] + spelled("left") + end, "its inputs are damaged"),
            (spelled("tom") + [2] + spelled("left") * 2 + end, "its inputs are damaged"),
        ]:
            definition = SynthDef("test")
            length = definition.add_controls({"length": 3})["length"]
            inputs = [length if value is None else value for value in inputs]
            definition.unit("Out", AUDIO, [0, (definition.unit("ContactInstrument", AUDIO, inputs), 0)], 0)
            printed, sound = self.scsynth([(0, message("/d_recv", definition.bytes())), (0, message("/s_new", "test", 1000, 0, 0))], 1, 640)
            if said not in printed:
                sys.exit(f"not said: {said}\n{printed}")
            assert (sound == 0).all()


need("scsynth")
SuperColliderTest().main()
