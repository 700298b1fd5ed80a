#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the data of docs/how-to/fit.md: simulated measurements of materials whose parameters are known.

    python3 make_data.py FOLDER

felt_*.csv: the C4 hammer of Chaigne and Askenfelt (J. Acoust. Soc. Am. 95, 1994), mass 2.97 g, F = 4.5e9 y^2.5, thrown
at a rigid force sensor at five speeds; sampled at 44.1 kHz with noise of 1 % of the largest force. The publication
states no Hunt-Crossley loss; 0.12 s/m is our choice.
rubber_ball.csv: a rubber ball of 25 mm and 9 g on wood, which data/materials/rubber_on_wood.json describes by Hertz's
law, F = 4.903e5 y^1.5, from nominal elastic constants; contact times with noise of 1 % and restitution with noise of
0.5 %. The loss of 0.1 s/m is our choice.
"""
import math
import pathlib
import random
import sys

FELT = {"mass": 2.97e-3, "stiffness": 4.5e9, "exponent": 2.5, "loss": 0.12}
BALL = {"mass": 9e-3, "stiffness": 4.903e5, "exponent": 1.5, "loss": 0.1}


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


if __name__ == "__main__":
    random.seed(1994)
    felt(pathlib.Path(sys.argv[1]))
    rubber_ball(pathlib.Path(sys.argv[1]))
