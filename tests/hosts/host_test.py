# SPDX-License-Identifier: MIT
"""What the tests of Csound, Pd and SuperCollider share. A performance is a list of (sample, command...), at multiples of a
block, in order: ("set", parameter, value), ("note", key, velocity), ("play", event, value). HOST_test.py CASE MODULE
REFERENCE FOLDER runs a case: page, pieces, samples, parameters, bowing, hostile, lifetimes, refusals."""
import os
import random
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from sound import RATE, channels, need, require_pitch, run

BLOCK = 64
HOSTILE = [float("nan"), float("inf"), -float("inf"), 0.0, -0.0, 1e30, -1e30, 1e-40, 1.0, -1.0, 60.0, 0.5]


class Instrument:
    """The lists of an instrument, from its class."""

    def __init__(self, reference, name):
        self.reference, self.name = reference, name
        self.parameters, self.events, self.outputs = {}, {}, {}
        for line in self._run("double", "lists\n").decode().splitlines():
            kind, item, *rest = line.split()
            if kind == "parameter":
                self.parameters[item] = tuple(map(float, rest))  # min, max, initial
            elif kind == "event":
                self.events[item] = rest[0]
            else:
                self.outputs[item] = float(rest[0])
        first = next(iter(self.outputs))
        self.left = next((o for o in self.outputs if o.startswith("left_")), first)
        self.right = next((o for o in self.outputs if o.startswith("right_")), self.left)

    def _run(self, precision, commands):
        return subprocess.run([self.reference, precision, self.name, str(RATE)], input=commands.encode(), check=True,
                              stdout=subprocess.PIPE).stdout

    def taps(self):
        return ["left", "right", *self.outputs, "force_n"]

    def play(self, precision, performance, samples):
        """What each of taps() must be: an array for each."""
        commands, done = [], 0
        for at, *words in performance:
            commands += [f"process {at - done}"] * (at > done) + [" ".join(map(str, words))]
            done = at
        commands.append(f"process {samples - done}")
        kind = np.float32 if precision == "single" else np.float64
        sound = np.frombuffer(self._run(precision, "\n".join(commands) + "\n"), kind).reshape(samples, -1).T
        rows = dict(zip(self.outputs, sound))
        scaled = [rows[o] / kind(self.outputs[o]) for o in (self.left, self.right)]
        return np.array([*scaled, *sound])

    def something_to_hear(self):
        """Commands that make it sound."""
        # An event without a key would hold up the damper of its one voice.
        events = [] if self.name == "prepared_piano" else self.events
        return [("play", event, None) for event in events] + [("note", 60, 0.7)]


    def rounded(self):
        """Commands that set each parameter to its first value in single precision, as signals do."""
        return [(0, "set", name, as_single(initial)) for name, (_, _, initial) in self.parameters.items()]


def instruments(reference):
    names = subprocess.run([reference, "names"], check=True, stdout=subprocess.PIPE, text=True).stdout.split()
    assert len(names) >= 13, names
    shutil.copy(Path(__file__).parents[2] / "examples/instruments/hammer_on_string.json", "mine.json")
    names.append("mine.json")
    return [Instrument(reference, name) for name in names]


def as_single(value):
    return float(np.float32(value))


def random_performance(instrument, draw, blocks):
    """Notes, strikes, plucks and values at different blocks; each key goes up again."""
    performance, down = [], {}
    for index in range(3, blocks):
        at = index * BLOCK
        for key in [key for key, end in down.items() if end == index]:
            performance.append((at, "note", key, 0))
            del down[key]
        # A trigger falls for a block before it rises again.
        if performance and performance[-1][0] >= at - BLOCK * (performance[-1][1] == "play") or draw.random() < 0.5:
            continue
        kind = draw.choice(["note", "set", "play"])
        if kind == "set" or kind == "play" and not instrument.events:
            name = draw.choice(list(instrument.parameters))
            low, high, _ = instrument.parameters[name]
            performance.append((at, "set", name, as_single(draw.uniform(low, high))))
        elif kind == "note":
            key, end = draw.randrange(55, 75), index + draw.randrange(1, 20)
            if key in down or end in down.values() or end >= blocks:
                continue
            down[key] = end
            performance.append((at, "note", key, as_single(draw.random())))
        else:
            event = draw.choice(list(instrument.events))
            low, high, _ = instrument.parameters[instrument.events[event]]
            performance.append((at, "play", event, draw.choice([None, as_single(draw.uniform(low, high))])))
    return sorted(performance, key=lambda row: row[0])


def require_equal(expected, sound, precision, what, smallest=0):
    """Every sample within a rounding, where the host may divide by full scale in another way, and writes 0 for what is below the
    smallest number; not silent."""
    sound = np.asarray(sound)
    epsilon = float(np.finfo(np.float32 if precision == "single" else np.float64).eps)
    if sound.shape[0] != expected.shape[0] or sound.shape[1] < expected.shape[1]:
        sys.exit(f"{what}: {sound.shape} instead of {expected.shape}")
    sound = sound[:, :expected.shape[1]].astype(np.float64)
    kept = np.where(np.abs(expected) < smallest, 0, expected)
    far = ~(np.abs(sound - kept) <= epsilon * np.abs(kept))
    if far.any():
        tap, sample = np.argwhere(far)[0]
        sys.exit(f"{what}: tap {tap}, sample {sample}: {sound[tap, sample]!r} instead of {expected[tap, sample]!r}")
    if not np.abs(expected).max() > 0:
        sys.exit(f"{what}: silent")


def write_wav(path, channels_):
    """A WAV file of single precision with any values, not numbers, too."""
    data = np.ascontiguousarray(channels_.T, "<f4").tobytes()
    count = channels_.shape[0]
    form = struct.pack("<HHIIHH", 3, count, RATE, RATE * 4 * count, 4 * count, 32)
    parts = b"WAVEfmt " + struct.pack("<I", len(form)) + form + b"data" + struct.pack("<I", len(data)) + data
    Path(path).write_bytes(b"RIFF" + struct.pack("<I", len(parts)) + parts)


# lifetimes begins and ends so many instruments, 100 within a minute of the host's time, each within a second.
LIVES = int(os.environ.get("CONTACTSPLINE_LIVES", "100"))
DURATION = (3 + LIVES * 57 // 100) * RATE // BLOCK  # blocks
MORTALS = ["piano", "classical_guitar", "hammer_string", "tanpura", "mine.json"]
EXAMPLES = Path(__file__).parents[2] / "examples"


def hz(*keys):
    return [440 * 2 ** ((key - 69) / 12) for key in keys]


def require_music(name, sound, notes):
    """A piece of two channels: finite, audible, below full scale, and for each (second, frequencies) the largest value of the
    spectrum of the next second within a semitone is less than a quarter of one away from the frequency."""
    sound = np.asarray(sound)
    assert sound.shape[0] == 2 and np.isfinite(sound).all(), (name, sound.shape)
    peaks = np.abs(sound).max(axis=1)
    assert (peaks > 0.1).all() and (peaks < 1).all(), (name, peaks)
    for second, frequencies in notes:
        begin, steps = int(second * RATE), 8  # in a hertz
        part = np.zeros(RATE) + sound.mean(axis=0)[begin:begin + RATE]
        spectrum = np.abs(np.fft.rfft(part * np.hanning(RATE), steps * RATE))
        for frequency in frequencies:
            low, high = (round(steps * frequency * 2 ** (cents / 1200)) for cents in (-100, 100))
            found = (low + np.argmax(spectrum[low:high + 1])) / steps
            error = 1200 * np.log2(found / frequency)
            if not abs(error) < 25:
                sys.exit(f"{name}: {found:.2f} Hz instead of {frequency:.2f} Hz after {second} s")
    print(name, "peaks", peaks)


def random_lives(seed):
    """(first block, end, name) of each instrument of lifetimes."""
    draw = random.Random(seed)
    shutil.copy(EXAMPLES / "instruments/hammer_on_string.json", "mine.json")
    return [(begin := draw.randrange(1, DURATION - RATE // BLOCK), begin + draw.randrange(1, RATE // BLOCK), draw.choice(MORTALS))
            for _ in range(LIVES)]


class HostTest:
    """A host: render(instrument, taps, performance, samples) gives an array for each tap."""
    precision = "double"
    smallest = 0  # number that the host writes

    def render(self, instrument, taps, performance, samples):
        raise NotImplementedError

    def first_values(self, instrument):
        """What the host does before the first sample."""
        return []

    def samples(self):
        """Random performances of every instrument are those of its class."""
        for seed, instrument in enumerate(instruments(self.reference)):
            performance = random_performance(instrument, random.Random(seed), 150)
            if instrument.events:
                performance.insert(0, (BLOCK, "play", next(iter(instrument.events)), None))
            performance = self.first_values(instrument) + performance
            expected = instrument.play(self.precision, [(at, *[w for w in words if w is not None]) for at, *words in performance],
                                       150 * BLOCK)
            sound = self.render(instrument, instrument.taps(), performance, 150 * BLOCK)
            require_equal(expected, sound, self.precision, instrument.name, self.smallest)
            assert np.abs(expected[2:-1]).max() > 0, instrument.name  # beside the force
            print(instrument.name, len(performance), "commands")

    def bowing(self):
        """For ten seconds all parameters of the violin's bow jump in each block over their ranges, while keys go down and up; then the
        bow is lifted for four seconds. The sound is that of the class; no friction exceeds 5.3 N, and the strings ring out."""
        instrument, draw = Instrument(self.reference, "violin"), random.Random(9)
        bow = [name for name in instrument.parameters if name.startswith("bow_") or name == "assistance"]
        assert len(bow) == 5, bow
        played, blocks = 10 * RATE // BLOCK, 14 * RATE // BLOCK
        performance, key = [], None
        for at in range(3 * BLOCK, played * BLOCK, BLOCK):
            if draw.random() < 0.05:  # hosts differ in the order of notes and values
                performance.append((at, "note", draw.randrange(55, 75) if key is None else key, 1.0 if key is None else 0))
                key = performance[-1][2] if key is None else None
                continue
            for name in bow:
                low, high, _ = instrument.parameters[name]
                performance.append((at, "set", name, as_single(high if draw.random() < 0.25 else draw.uniform(low, high))))
        performance += [(played * BLOCK, "note", key, 0)] * (key is not None)
        performance = self.first_values(instrument) + performance
        expected = instrument.play(self.precision, performance, blocks * BLOCK)
        sound = self.render(instrument, instrument.taps(), performance, blocks * BLOCK)
        require_equal(expected, sound, self.precision, "bowing", self.smallest)
        force_n = np.abs(np.asarray(sound)[instrument.taps().index("bridge_force_n")])
        print("bridge", force_n.max(), "N, at the end", force_n[-RATE // 10:].max(), "N")
        assert np.isfinite(sound).all() and 1 < force_n.max() < 100, force_n.max()
        assert force_n[(blocks - RATE // 10 // BLOCK) * BLOCK:].max() < 1e-3 * force_n.max()

    def parameters(self):
        """Each parameter that can move changes the sound by itself: before the first note, while it is held and let go, or beside
        the others, which may switch it on."""
        count = 0
        for instrument in instruments(self.reference):
            movable = {name: row for name, row in instrument.parameters.items() if row[0] < row[1]}
            middle = [(0, "set", name, as_single((low + high) / 2)) for name, (low, high, _) in movable.items()]
            sounding, again = ([((first + n) * BLOCK, *command) for n, command in enumerate(instrument.something_to_hear())]
                               for first in (2, 40))
            let_go = [(30 * BLOCK, "note", 60, 0),
                      *((30 * BLOCK, "play", event, 0) for event in instrument.events if event.startswith("bow_"))]
            scenes = [(lambda move: [(0, *move), *sounding], sounding),
                      (lambda move: [*sounding, (20 * BLOCK, *move), *let_go, *again], [*sounding, *let_go, *again]),
                      (lambda move: [*(row for row in middle if row[2] != move[1]), (0, *move), *sounding], [*middle, *sounding])]
            plain = [None] * len(scenes)

            def is_heard(move):
                for scene, (moved, unmoved) in enumerate(scenes):
                    if plain[scene] is None:
                        plain[scene] = self.render(instrument, instrument.taps(), unmoved, 4800)
                    if not np.array_equal(plain[scene], self.render(instrument, instrument.taps(), moved(move), 4800)):
                        return True
                return False

            for name, (low, high, initial) in movable.items():
                move = ("set", name, as_single(high if initial < (low + high) / 2 else low))
                if not is_heard(move):
                    sys.exit(f"{instrument.name}: {name} = {move[2]} does not change the sound")
            count += len(movable)
        print(count, "parameters")
        assert count >= 60, count

    def main(self):
        case, self.module, self.reference, folder = sys.argv[1:]
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        os.chdir(folder)
        getattr(self, case)()
