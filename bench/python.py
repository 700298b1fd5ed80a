#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the installed Python package: calls, and batches on one thread and on two. Prints the tables of docs/how-to/python.md.

In every round each batch runs on one thread, then on two. What it writes is removed before the next one, outside of the
times. Times real time are of processor time on one thread, from the median round. "Two threads" is the median ratio of
the times of the clock, one thread over two; "work" that of processor time, two threads over one: 1 where a second core
is used wholly. Programs beside it lower the first, not the second.
"""

import os
import shutil
import statistics
import tempfile
import time

import numpy as np

import contactspline as cs

ROUNDS = 7
STRING = cs.Instrument("hammer_string", resonator="string_c4", material="felt_c4")
FELT = cs.Material("felt_c4")


def seconds(call):
    """Of the clock and of the processor."""
    clock, processor = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - clock, time.process_time() - processor


def microseconds(call, calls=2000):
    return statistics.median(seconds(lambda: [call() for _ in range(calls)])[1] for _ in range(ROUNDS)) / calls * 1e6


def batch(name, run, sound_s=None, rounds=ROUNDS, before=lambda: None):
    def of(threads):
        before()
        return seconds(lambda: run(threads))

    rounds = [(of(1), of(2)) for _ in range(rounds)]
    clock = statistics.median(one[0] / two[0] for one, two in rounds)
    work = statistics.median(two[1] / one[1] for one, two in rounds)
    alone = statistics.median(one[1] for one, _ in rounds)
    speed = f"{sound_s / alone:.0f} times real time" if sound_s else f"{alone:.2f} s"
    print(f"| {name} | {speed} | {clock:.2f} | {work:.2f} |", flush=True)


def data_set(name, plan):
    with tempfile.TemporaryDirectory() as folder:
        def empty():
            shutil.rmtree(f"{folder}/set", ignore_errors=True)
            os.sync()

        batch(name, lambda threads: cs.dataset(plan, f"{folder}/set", threads=threads), plan["count"] * plan["seconds"], before=empty)


def call_costs():
    event, moment = cs.strike(0, 2), 1 / 44100
    inner, barrier = STRING._source.play_double, cs.Instrument("mass_barrier", material="felt_c4")
    rows, wanted = [(0.0, 0, 0, 2.0, 0.0)], [name == "bridge_force_n" for name in STRING.outputs]
    core = microseconds(lambda: inner([], rows, 1, 44100.0, wanted, False, 0))
    whole = microseconds(lambda: STRING.play(event, moment, outputs="bridge_force_n", force=False))
    print(f"| `play` of one sample of C4, of which its C++ | {whole:.1f} us, {core:.1f} us |")
    print(f"| `play` of one sample of `mass_barrier` | {microseconds(lambda: barrier.play(event, moment)):.1f} us |")
    print(f"| `impact` | {microseconds(lambda: FELT.impact(2.5)):.1f} us |\n")


def main():
    print("| call | processor time |\n|---|---:|")
    call_costs()
    print("| batch | one thread | two threads | work |\n|---|---:|---:|---:|")
    columns = {"hammer_mass_kg": np.geomspace(0.002, 0.01, 300)}
    sounds = np.empty((300, 44100), np.float32)
    batch("`render_many`, 300 strikes of C4, one second each",
          lambda threads: cs.render_many(STRING, columns, cs.strike(0, 2.5), output="bridge_force_n", threads=threads, out=sounds), 300)
    plan = {"name": "c4", "instrument": "hammer_string", "parts": {"resonator": "string_c4", "material": "felt_c4"},
            "parameters": {"hammer_mass_kg": {"logarithmic": [0.002, 0.01]}}, "events": [{"time_s": 0, "event": "strike"}],
            "outputs": ["bridge_force_n"], "seed": 1, "seconds": 1}
    data_set("`dataset`, 2,000 of them to HDF5", {**plan, "count": 2000})
    data_set("`dataset`, 12,000 of them", {**plan, "count": 12000})
    data_set("`dataset`, 40 strikes of `trichord_c4`", {
        "name": "trichord", "instrument": "trichord_c4", "events": [{"time_s": 0, "event": "strike_hammer"}],
        "outputs": ["bridge_force_n"], "seed": 1, "count": 40, "seconds": 1})
    laws = [{"name": f"felt_{i}", "contact": {"stiffness_n_per_m_alpha": 1e9, "exponent": 1.5 + i / 1000},
             "impact": {"mass_kg": 0.003, "min_speed_m_per_s": 0.1, "max_speed_m_per_s": 6},
             "spline": {"knots": "graded", "segments": 16}} for i in range(1000)]
    batch("`design_many`, 1,000 felts of 16 segments, with progress",
          lambda threads: cs.design_many(laws, threads=threads, progress=lambda done, total: None), rounds=3)


if __name__ == "__main__":
    main()
