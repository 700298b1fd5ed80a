# SPDX-License-Identifier: MIT
"""scripts_test.py HOST LIBRARIES FOLDER: HOST is csound, puredata, supercollider, ladspa, lv2 or jackconsole. Compiles the hammer-string by Faust's script as
docs/how-to/faust-scripts.md says, renders it in the host, and compares its pitch with the closed form."""
import ctypes
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from scsynth import message, play_score, run_sclang
from sound import RATE, block, channels, need, need_file, require_pitch, run

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


def render_supercollider():
    need("faust2supercollider", "scsynth", "sclang", "ruby", "g++")
    need_file("/usr/include/SuperCollider/plugin_interface/SC_PlugIn.h")
    run("faust2supercollider", "hammer_string_stereo.dsp")
    function = re.search(r"(\{.*\})\.play", block(PAGE, "supercollider"))[1]
    run_sclang(os.getcwd(), f'SynthDef("first", {{ Out.ar(0, {function}.value) }}).writeDefFile("{os.getcwd()}");')
    score = [(0, message("/d_recv", Path("first.scsyndef").read_bytes())), (0, message("/s_new", "first", 1000, 0, 0))]
    return play_score(os.getcwd(), score, 2, 2 * RATE)[1]


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

    def play(self, handle, unsigned, ports, strike, sounds):
        """Plays into sounds from a strike on. unsigned: the type of ports and lengths."""
        for port, target in enumerate(ports):
            self.call("connect_port", None, handle, unsigned(port), address(target))
        self.call("activate", None, handle)
        self.call("run", None, handle, unsigned(64))
        strike.value = 1
        self.call("run", None, handle, unsigned(len(sounds[0])))
        return [list(sound) for sound in sounds]


def address(data):
    return ctypes.c_void_p(ctypes.addressof(data))


def render_ladspa():
    need("faust2ladspa", "g++")
    need_file("/usr/include/ladspa.h")
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
    return plugin.play(handle, ctypes.c_ulong, [*sounds, *controls], controls[0], sounds)


class Lv2(ctypes.Structure):
    """The descriptor of a plug-in, after LV2's core."""
    _fields_ = [("uri", ctypes.c_char_p),
                *((name, ctypes.c_void_p) for name in ["instantiate", "connect_port", "activate", "run"])]
    call, play = Ladspa.call, Ladspa.play


class Lv2Feature(ctypes.Structure):
    _fields_ = [("uri", ctypes.c_char_p), ("data", ctypes.c_void_p)]


def render_lv2():
    need("faust2lv2", "g++")
    need_file("/usr/include/lv2.h")
    run("faust2lv2", "hammer_string_stereo.dsp")
    bundle = Path("hammer_string_stereo.lv2")
    library = ctypes.CDLL(f"./{bundle}/hammer_string_stereo.so")
    library.lv2_descriptor.restype = ctypes.POINTER(Lv2)
    plugin = library.lv2_descriptor(0)[0]
    # It wants the numbers of names: urid:map.
    map_ = ctypes.CFUNCTYPE(ctypes.c_uint32, ctypes.c_void_p, ctypes.c_char_p)(lambda _, name: sum(name) + 1)
    data = (ctypes.c_void_p * 2)(None, ctypes.cast(map_, ctypes.c_void_p))
    feature = Lv2Feature(b"http://lv2plug.in/ns/ext/urid#map", ctypes.addressof(data))
    features = (ctypes.c_void_p * 2)(ctypes.addressof(feature), None)
    handle = ctypes.c_void_p(plugin.call("instantiate", ctypes.c_void_p, address(plugin), ctypes.c_double(RATE),
                                         ctypes.c_char_p(str(bundle).encode()), address(features)))
    assert handle
    samples = 2 * RATE
    ports, sounds = [], []
    for text in re.split(r"\] , \[|lv2:port \[", (bundle / "hammer_string_stereo.ttl").read_text())[1:]:
        if "lv2:AudioPort" in text:
            sounds.append((ctypes.c_float * samples)())
            ports.append(sounds[-1])
        else:
            ports.append(ctypes.c_float(float(re.search(r"lv2:default ([-+.\de]+)", text)[1])))
        assert f"lv2:index {len(ports) - 1} ;" in text, text
    return plugin.play(handle, ctypes.c_uint32, ports, ports[0], sounds)


class JackClient:
    """Records two ports of a program, at a server of its own without a sound card."""

    def __init__(self, samples):
        os.environ |= {"JACK_DEFAULT_SERVER": f"contactspline_{os.getpid()}", "JACK_NO_START_SERVER": "1", "JACK_NO_AUDIO_RESERVATION": "1"}
        self.server = subprocess.Popen(["jackd", "--no-realtime", "--sync", "--timeout", "10000", "--name",
                                        os.environ["JACK_DEFAULT_SERVER"], "-d", "dummy", "-r", str(RATE), "-p", "512"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.jack = ctypes.CDLL("libjack.so.0")
        for name in ("client_open", "port_register", "port_by_name", "port_get_buffer", "port_name"):
            getattr(self.jack, f"jack_{name}").restype = ctypes.c_void_p
        self.samples, self.sounds, self.done = samples, [(ctypes.c_float * samples)() for _ in range(2)], 0
        self.is_connected = False
        if not self.wait(self.open):
            self.server.kill()
            print("skipped: jackd does not start here")
            sys.exit(77)
        self.ports = [ctypes.c_void_p(self.jack.jack_port_register(self.client, f"in_{side}".encode(), b"32 bit float mono audio",
                                                                   ctypes.c_ulong(1), ctypes.c_ulong(0))) for side in range(2)]
        self.callback = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_uint32, ctypes.c_void_p)(self.process)
        self.jack.jack_set_process_callback(self.client, self.callback, None)
        self.jack.jack_activate(self.client)

    def wait(self, is_so):
        end = time.monotonic() + 20
        while not (found := is_so()) and time.monotonic() < end:
            time.sleep(0.01)
        return found

    def open(self):
        self.client = ctypes.c_void_p(self.jack.jack_client_open(b"test", 1 | 2, None))
        return self.client.value

    def process(self, frames, _):
        if not self.is_connected:
            return 0
        count = min(frames, self.samples - self.done)
        for port, sound in zip(self.ports, self.sounds):
            ctypes.memmove(ctypes.addressof(sound) + 4 * self.done, self.jack.jack_port_get_buffer(port, frames), 4 * count)
        self.done += count
        return 0

    def record(self, program):
        names = [f"{program}:out_{side}".encode() for side in range(2)]
        assert self.wait(lambda: all(self.jack.jack_port_by_name(self.client, name) for name in names)), program
        own = [b"test:in_0", b"test:in_1"]
        assert self.wait(lambda: all(self.jack.jack_connect(self.client, *pair) in (0, 17) for pair in zip(names, own))), program  # EEXIST
        self.is_connected = True
        assert self.wait(lambda: self.done == self.samples), self.done
        return [list(sound) for sound in self.sounds]

    def close(self):
        self.jack.jack_client_close(self.client)
        self.server.terminate()
        self.server.wait()


def render_jackconsole():
    need("faust2jackconsole", "jackd", "g++")
    need_file("/usr/include/jack/jack.h")
    run("faust2jackconsole", "hammer_string_stereo.dsp")
    client = JackClient(3 * RATE // 2)
    program = subprocess.Popen(["./hammer_string_stereo", "-strike", "1"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    try:
        return client.record("hammer_string_stereo")
    finally:
        client.close()  # first: the server would wait minutes for a program that was killed
        program.kill()
        program.wait()


def main():
    host, libraries, folder = sys.argv[1:]
    os.environ["FAUST_LIB_PATH"] = libraries
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    os.chdir(folder)
    shutil.copy(Path(libraries) / "audio/hammer_string_stereo.dsp", ".")
    require_pitch(globals()[f"render_{host}"]())


main()
