# SPDX-License-Identifier: MIT
"""What tests of hosts share: blocks of a page, WAV files, the pitch of a string."""
import array
import math
import os
import re
import shlex
import shutil
import struct
import subprocess
import sys
from pathlib import Path

RATE = 48000


def need(*programs):
    """Ends the test as skipped where a program is missing."""
    for program in programs:
        if shutil.which(program) is None:
            print("skipped:", program, "is not installed")
            sys.exit(77)


def need_file(path):
    """Ends the test as skipped where a header is missing."""
    if not Path(path).exists():
        print("skipped:", path, "is not installed")
        sys.exit(77)


def run(*command, status=0):
    """Runs a command to its end, with this exit status; what it printed. CONTACTSPLINE_UNDER is a command that runs it."""
    under = shlex.split(os.environ.get("CONTACTSPLINE_UNDER", ""))
    done = subprocess.run([*under, *command], stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                          timeout=3000 if under else 200)
    if done.returncode != status:
        sys.exit(f"{command} exits {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout + done.stderr


def block(page, language, number=0):
    """A block of code of this language in a page of docs/how-to, counted from 0."""
    text = (Path(__file__).parents[2] / "docs/how-to" / page).read_text()
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)[number]


def chunks(data):
    at = 12
    while at + 8 <= len(data):
        length = struct.unpack("<I", data[at + 4:at + 8])[0]
        yield data[at:at + 4], data[at + 8:at + 8 + length]
        at += 8 + length + length % 2


def channels(path):
    """The channels of a WAV file of 16 bits, of single or of double precision."""
    parts = dict(chunks(Path(path).read_bytes()))
    _, count, rate, _, _, bits = struct.unpack("<HHIIHH", parts[b"fmt "][:16])
    assert rate == RATE, rate
    values = array.array({16: "h", 32: "f", 64: "d"}[bits], parts[b"data"])
    full_scale = 32768 if bits == 16 else 1
    return [[x / full_scale for x in values[channel::count]] for channel in range(count)]


def pitch_error(sound, frequency):
    """Cents from a frequency to the largest value of the spectrum within 50 cents, in steps of one."""
    window = [x * (0.5 - 0.5 * math.cos(2 * math.pi * n / RATE)) for n, x in enumerate(sound[RATE // 10:RATE // 10 + RATE])]

    def power(cents):
        turn = 2 * math.cos(2 * math.pi * frequency * 2 ** (cents / 1200) / RATE)
        a = b = 0.0
        for x in window:
            a, b = x + turn * a - b, a
        return a * a + b * b - turn * a * b

    return max(range(-50, 51), key=power)


def first_partial():
    """Of the string string_c4: f = 1/(2 L) sqrt(T L/M) sqrt(1 + pi^2 EI/(T L^2))."""
    length, mass, tension, stiffness = 0.62, 0.00393, 670, 0.00983833
    return math.sqrt(tension * length / mass) / (2 * length) * math.sqrt(
        1 + math.pi**2 * stiffness / (tension * length**2))


def require_pitch(sounds):
    """Two equal channels of at least 1.2 s below full scale, at the pitch of string_c4 within a cent: half a step of the
    search, and half a cent for a window of 1 s."""
    left, right = sounds
    peak = max(map(abs, left))
    error = pitch_error(left, first_partial())
    print(f"peak {peak:.3f}, {error} cents from {first_partial():.2f} Hz")
    if not (len(left) >= 1.2 * RATE and left == right and 0.01 < peak < 1 and abs(error) <= 1):
        sys.exit("not two equal channels below full scale at the pitch of the string")
