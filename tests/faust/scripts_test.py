# SPDX-License-Identifier: MIT
"""scripts_test.py csound|puredata|ladspa LIBRARIES FOLDER: compiles the hammer-string by Faust's script as
docs/how-to/faust-scripts.md says, renders it in the host, and compares its pitch with the closed form."""
import ctypes
import os
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from sound import RATE, block, channels, need, require_pitch, run

PAGE = "faust-scripts.md"


def render_csound():
    need("faust2csound", "csound", "g++")
    run("faust2csound", "hammer_string_stereo.dsp")
    Path("first.csd").write_text(block(PAGE, "csound"))
    run("csound", "first.csd")
    return channels("first.wav")


def render_puredata():
    need("faust2puredata", "pd", "g++")
    run("faust2puredata", "hammer_string_stereo.dsp")
    Path("first.pd").write_text(block(PAGE, "pd"))
    run("pd", "-batch", "-nogui", "-noprefs", "-r", str(RATE), "first.pd")
    return channels("first.wav")


class Ladspa(ctypes.Structure):
    """The descriptor of a plug-in, after LADSPA's interface in version 1.1."""
    POINTERS = ["range_hints", "data", "instantiate", "connect_port", "activate", "run"]
    _fields_ = [("id", ctypes.c_ulong), ("label", ctypes.c_char_p), ("properties", ctypes.c_int), ("name", ctypes.c_char_p),
                ("maker", ctypes.c_char_p), ("copyright", ctypes.c_char_p), ("ports", ctypes.c_ulong),
                ("kinds", ctypes.POINTER(ctypes.c_int)), ("port_names", ctypes.POINTER(ctypes.c_char_p)),
                *((name, ctypes.c_void_p) for name in POINTERS)]

    def call(self, name, result, *arguments):
        kinds = [type(argument) for argument in arguments]
        return ctypes.CFUNCTYPE(result, *kinds)(getattr(self, name))(*arguments)


def address(data):
    return ctypes.c_void_p(ctypes.addressof(data))


def render_ladspa():
    need("faust2ladspa", "g++")
    if not Path("/usr/include/ladspa.h").exists():
        print("skipped: ladspa.h is not installed")
        sys.exit(77)
    run("faust2ladspa", "hammer_string_stereo.dsp")
    library = ctypes.CDLL("./hammer_string_stereo.so")
    library.ladspa_descriptor.restype = ctypes.POINTER(Ladspa)
    plugin = library.ladspa_descriptor(ctypes.c_ulong(0))[0]
    assert (plugin.name, plugin.maker) == (b"hammer_string_stereo", b"Contact Spline"), (plugin.name, plugin.maker)
    handle = ctypes.c_void_p(plugin.call("instantiate", ctypes.c_void_p, address(plugin), ctypes.c_ulong(RATE)))
    samples = 2 * RATE
    sounds = [(ctypes.c_float * samples)() for _ in range(2)]
    # As in Csound: strike, speed, hammer mass, stiffness ratio, felt loss, damping, strike position.
    controls = [ctypes.c_float(value) for value in (0, 2.5, 0.00297, 1, 0, 0, 0.12)]
    assert plugin.ports == 9 and [plugin.kinds[p] for p in range(9)] == 2 * [2 | 8] + 7 * [1 | 4]
    for port, target in enumerate([*sounds, *controls]):
        plugin.call("connect_port", None, handle, ctypes.c_ulong(port), address(target))
    plugin.call("activate", None, handle)
    plugin.call("run", None, handle, ctypes.c_ulong(64))
    controls[0].value = 1
    plugin.call("run", None, handle, ctypes.c_ulong(samples))
    return [list(sound) for sound in sounds]


def main():
    host, libraries, folder = sys.argv[1:]
    os.environ["FAUST_LIB_PATH"] = libraries
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    os.chdir(folder)
    shutil.copy(Path(libraries) / "audio/hammer_string_stereo.dsp", ".")
    require_pitch({"csound": render_csound, "puredata": render_puredata, "ladspa": render_ladspa}[host]())


main()
