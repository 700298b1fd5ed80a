#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the data of docs/how-to/fit.md and own-instrument.md: simulated measurements whose parameters are known.

    python3 make_data.py FOLDER [PROGRAM]

felt_*.csv: the C4 hammer of Chaigne and Askenfelt (J. Acoust. Soc. Am. 95, 1994), mass 2.97 g, F = 4.5e9 y^2.5, thrown
at a rigid force sensor at five speeds; sampled at 44.1 kHz with noise of 1 % of the largest force. The publication
states no Hunt-Crossley loss; 0.12 s/m is our choice.
rubber_ball.csv: a rubber ball of 25 mm and 9 g on wood, which data/materials/rubber_on_wood.json describes by Hertz's
law, F = 4.903e5 y^1.5, from nominal elastic constants; contact times with noise of 1 % and restitution with noise of
0.5 %. The loss of 0.1 s/m is our choice.
mallet_*.wav: a mallet of 32 g with a rubber head, F = 8e8 y^1.8, strikes the bar that data/resonators/marimba_c4.json
describes, in its middle, at five speeds; what an accelerometer at its end records at 44.1 kHz, with noise 70 dB below
the loudest sample. Mallet and noise are our choice.
tine_*.wav and kalimba_*.wav, if PROGRAM is given, the path of contactspline: it renders tine.json with TINE, and kalimba.json
with TINES and BOX in place of the open numbers, at other velocities and levels; then come a room of 0.2 s and noise, both 50 dB
softer. All are our choice.
"""
import cmath
import json
import math
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile
import wave

FELT = {"mass": 2.97e-3, "stiffness": 4.5e9, "exponent": 2.5, "loss": 0.12}
BALL = {"mass": 9e-3, "stiffness": 4.903e5, "exponent": 1.5, "loss": 0.1}
MALLET = {"mass": 32e-3, "stiffness": 8e8, "exponent": 1.8}

RATE = 22050  # Hz, of notes of instruments
TINE = 0.0341, 5, 0.5  # bending stiffness, loss, weight of the contact
# Cents from the key, decay of the tine, ratio and decay of its overtone, its shape at the foot.
TINES = {
    60: (-14, 3.1, 5.72, 24, 0.034),
    64: (9, 3.9, 5.95, 31, 0.022),
    67: (-5, 5.2, 6.18, 38, 0.041),
    72: (17, 6.6, 5.83, 52, 0.019),
    76: (-22, 8.3, 6.05, 60, 0.027),
}
BOX = [30, 50]  # how loud its modes are
# Key, velocity and peak of each recording.
PLUCKS = {
    "c4": (60, 0.6, 0.5),
    "e4": (64, 0.8, 0.7),
    "g4": (67, 0.5, 0.4),
    "c5": (72, 0.9, 0.8),
    "e5": (76, 0.7, 0.3),
    "g4_again": (67, 0.8, 0.45),
}


def motion(material, speed, step):
    """Force [N] at steps from the first touch on, duration [s] and restitution, by the midpoint rule."""

    def force(y, v):
        return material["stiffness"] * y ** material["exponent"] * (1 + material["loss"] * v) if y > 0 else 0.0

    y, v, forces = 0.0, speed, []
    while y >= 0:
        forces.append(force(y, v))
        half_y, half_v = y + step / 2 * v, v - step / 2 * forces[-1] / material["mass"]
        y, v = y + step * half_v, v - step * force(half_y, half_v) / material["mass"]
    return forces, step * (len(forces) - 1) + step * (1 - y / (v * step)), -v / speed


def felt(folder):
    rate, refined = 44100, 64
    for number, speed in enumerate([0.4, 0.8, 1.5, 3.0, 5.0], 1):
        forces, _, _ = motion(FELT, speed, 1 / rate / refined)
        phase = random.randrange(refined)
        samples = [0.0] * 60 + forces[phase::refined]
        samples += [0.0] * (240 - len(samples))
        noise = 0.01 * max(samples)
        with open(folder / f"felt_{number}.csv", "w") as file:
            file.write("Time (ms);Force (N)\n")
            for i, sample in enumerate(samples):
                file.write(f"{1e3 * (i - 50) / rate:.5f};{sample + random.gauss(0, noise):.4f}\n".replace(".", ","))


def rubber_ball(folder):
    with open(folder / "rubber_ball.csv", "w") as file:
        file.write("# a ball dropped on a board from seven heights, four times each\nspeed_m_per_s,contact_time_ms,restitution\n")
        for speed in [0.3, 0.5, 0.8, 1.2, 1.8, 2.6, 3.6]:
            _, duration, restitution = motion(BALL, speed, 1e-6)
            for _ in range(4):
                file.write(f"{speed},{1e3 * duration * random.gauss(1, 0.01):.4f},{restitution * random.gauss(1, 0.005):.4f}\n")


class Mode:
    """A mode of a bar under a force at the place of the strike, exact between steps at which the force acts."""

    def __init__(self, frequency, decay, mass, strike, pickup, step):
        self.strike, self.pickup, self.phasor = strike, pickup, 0j
        self.turn = complex(-decay, frequency)
        self.turn_of_step = cmath.exp(self.turn * step)
        self.per_impulse = strike / (1j * mass * frequency)

    def advance(self):
        self.phasor *= self.turn_of_step

    def displacement(self):
        return self.strike * self.phasor.real

    def acceleration(self):
        return self.pickup * (self.turn**2 * self.phasor).real


def modes_of_bar(step):
    generated = pathlib.Path(__file__).parents[2] / "generated/marimba_c4.json"
    bar = json.loads(generated.read_text())
    columns = "angular_frequency_rad_per_s", "decay_per_s", "mass_kg", "strike_shape", "pickup_shape"
    return [Mode(*row, step) for row in zip(*(bar[column] for column in columns)) if row[3] != 0]


def struck_bar(speed, rate, refined, seconds):
    """Acceleration [m/s^2] of the end of the bar from the first touch on."""
    step = 1 / rate / refined
    modes = modes_of_bar(step)
    place, samples = 0.0, []
    for i in range(400 * refined):  # 9 ms: they touch no more
        if i % refined == 0:
            samples.append(sum(mode.acceleration() for mode in modes))
        place += step * speed
        for mode in modes:
            mode.advance()
        compression = place - sum(mode.displacement() for mode in modes)
        if compression > 0:
            impulse = step * MALLET["stiffness"] * compression ** MALLET["exponent"]
            speed -= impulse / MALLET["mass"]
            for mode in modes:
                mode.phasor += mode.per_impulse * impulse
    for mode in modes:
        mode.turn_of_step **= refined
    while len(samples) < seconds * rate:
        samples.append(sum(mode.acceleration() for mode in modes))
        for mode in modes:
            mode.advance()
    return samples


def mallet(folder):
    rate, gain = 44100, 1 / 11000
    for number, speed in enumerate([0.25, 0.5, 1.0, 1.5, 2.0], 1):
        samples = [0.0] * 100 + struck_bar(speed, rate, 20, 0.13)
        noise = 10 ** (-70 / 20) * max(map(abs, samples))
        words = [round(32767 * gain * (sample + random.gauss(0, noise))) for sample in samples]
        with wave.open(str(folder / f"mallet_{number}.wav"), "wb") as file:
            file.setnchannels(1)
            file.setsampwidth(2)
            file.setframerate(rate)
            file.writeframes(struct.pack(f"<{len(words)}h", *words))


def kalimba_numbers():
    """The true ones in the order in which kalimba.json leaves them open."""
    for key, (cents, decay, ratio, overtone_decay, _) in TINES.items():
        frequency = 440 * 2 ** ((key - 69) / 12 + cents / 1200)
        yield from (frequency, decay, ratio * frequency, overtone_decay)
    yield from (shape for _, _, _, _, shape in TINES.values())
    yield from BOX


def in_a_room(samples, rate):
    """With noise, both 50 dB softer than the note."""
    softer, length, every = 10 ** (-50 / 20), rate // 5, 16
    echoes = [(i, random.gauss(0, 1) * 10 ** (-3 * i / length)) for i in range(0, length, every)]
    norm, peak = math.sqrt(sum(level**2 for _, level in echoes)), max(map(abs, samples))
    heard = [sample + random.gauss(0, softer * peak) for sample in samples]
    for delay, level in echoes:
        for i in range(delay, len(heard)):
            heard[i] += softer * level / norm * samples[i - delay]
    return heard


def filled(file, numbers):
    """The text of an instrument file with these numbers in place of its open ones."""
    text = (pathlib.Path(__file__).parent / file).read_text()
    return re.sub(r'\{ "fit": \[.*?\].*?\}', lambda _: str(next(numbers)), text)


def rendered(program, instrument, key, velocity, *more):
    """A note as samples of 16 bits at RATE."""
    with tempfile.TemporaryDirectory() as scratch:
        note = {"time_s": 0.15, "key": key, "velocity": velocity}
        score = {"instrument": "true.json", "duration_s": 0.7, "events": [note]}
        (pathlib.Path(scratch) / "true.json").write_text(instrument)
        (pathlib.Path(scratch) / "note.json").write_text(json.dumps(score))
        arguments = ["note.json", "--rate", str(RATE), "--bits", "16", *more, "--no-figure", "-o", "note.wav"]
        subprocess.run([program, "render", *arguments], cwd=scratch, check=True, stdout=subprocess.DEVNULL)
        with wave.open(f"{scratch}/note.wav") as file:
            count = file.getnframes()
            return struct.unpack(f"<{count}h", file.readframes(count))


def write_sound(path, samples):
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes(struct.pack(f"<{len(samples)}h", *samples))


def write_recording(path, note, loudest):
    heard = in_a_room(note, RATE)
    gain = 32767 * loudest / max(map(abs, heard))
    write_sound(path, [round(gain * sample) for sample in heard])


def tine(folder, program):
    """The contact is as at 88.2 kHz."""
    instrument = filled("tine.json", iter(TINE))
    for number, velocity in enumerate((0.3, 0.9, 0.6), 1):
        note = rendered(program, instrument, 69, velocity, "--oversample", "4")
        write_recording(folder / f"tine_{number}.wav", note, 0.8)


def kalimba(folder, program):
    instrument = filled("kalimba.json", kalimba_numbers())
    for name, (key, velocity, loudest) in PLUCKS.items():
        write_recording(folder / f"kalimba_{name}.wav", rendered(program, instrument, key, velocity), loudest)


if __name__ == "__main__":
    random.seed(1994)
    felt(pathlib.Path(sys.argv[1]))
    rubber_ball(pathlib.Path(sys.argv[1]))
    mallet(pathlib.Path(sys.argv[1]))
    if len(sys.argv) > 2:
        kalimba(pathlib.Path(sys.argv[1]), sys.argv[2])
        tine(pathlib.Path(sys.argv[1]), sys.argv[2])
