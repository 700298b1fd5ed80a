# SPDX-License-Identifier: MIT
"""scripts_test.py csound|puredata LIBRARIES FOLDER: compiles the hammer-string by Faust's script as
docs/how-to/faust-scripts.md says, renders it in the host, and compares its pitch with the closed form."""
import array
import math
import os
import re
import shutil
import struct
import subprocess
import sys
from pathlib import Path

RATE = 48000
PAGE = Path(__file__).parents[2] / "docs/how-to/faust-scripts.md"


def need(*programs):
    for program in programs:
        if shutil.which(program) is None:
            print("skipped:", program, "is not installed")
            sys.exit(77)


def run(*command):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=200)
    if done.returncode != 0:
        sys.exit(f"{command} exits {done.returncode}\n{done.stdout}\n{done.stderr}")


def block(language):
    """The block of code of this language in the page."""
    return re.search(rf"```{language}\n(.*?)```", PAGE.read_text(), re.DOTALL)[1]


def chunks(data):
    at = 12
    while at + 8 <= len(data):
        length = struct.unpack("<I", data[at + 4:at + 8])[0]
        yield data[at:at + 4], data[at + 8:at + 8 + length]
        at += 8 + length + length % 2


def samples(path):
    """The two channels of a WAV file of 16 bits or of single precision."""
    parts = dict(chunks(path.read_bytes()))
    _, channels, rate, _, _, bits = struct.unpack("<HHIIHH", parts[b"fmt "][:16])
    assert (channels, rate) == (2, RATE), (channels, rate)
    values = array.array({16: "h", 32: "f"}[bits], parts[b"data"])
    full_scale = 32768 if bits == 16 else 1
    return [[x / full_scale for x in values[channel::2]] for channel in (0, 1)]


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


def render_csound():
    need("faust2csound", "csound", "g++")
    run("faust2csound", "hammer_string_stereo.dsp")
    Path("first.csd").write_text(block("csound"))
    run("csound", "first.csd")


def render_puredata():
    need("faust2puredata", "pd", "g++")
    run("faust2puredata", "hammer_string_stereo.dsp")
    Path("first.pd").write_text(block("pd"))
    run("pd", "-batch", "-nogui", "-noprefs", "-r", str(RATE), "first.pd")


def main():
    host, libraries, folder = sys.argv[1:]
    os.environ["FAUST_LIB_PATH"] = libraries
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    os.chdir(folder)
    shutil.copy(Path(libraries) / "audio/hammer_string_stereo.dsp", ".")
    {"csound": render_csound, "puredata": render_puredata}[host]()
    left, right = samples(Path("first.wav"))
    peak = max(map(abs, left))
    error = pitch_error(left, first_partial())
    print(f"peak {peak:.3f}, {error} cents from {first_partial():.2f} Hz")
    # Half a step of the search, and half a cent for a window of 1 s.
    if not (len(left) >= 1.2 * RATE and left == right and 0.01 < peak < 1 and abs(error) <= 1):
        sys.exit("first.wav is not two equal channels below full scale at the pitch of the string")


main()
