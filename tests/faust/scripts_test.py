# SPDX-License-Identifier: MIT
"""scripts_test.py csound|puredata LIBRARIES FOLDER: compiles the hammer-string by Faust's script as
docs/how-to/faust-scripts.md says, renders it in the host, and compares its pitch with the closed form."""
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


def render_puredata():
    need("faust2puredata", "pd", "g++")
    run("faust2puredata", "hammer_string_stereo.dsp")
    Path("first.pd").write_text(block(PAGE, "pd"))
    run("pd", "-batch", "-nogui", "-noprefs", "-r", str(RATE), "first.pd")


def main():
    host, libraries, folder = sys.argv[1:]
    os.environ["FAUST_LIB_PATH"] = libraries
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    os.chdir(folder)
    shutil.copy(Path(libraries) / "audio/hammer_string_stereo.dsp", ".")
    {"csound": render_csound, "puredata": render_puredata}[host]()
    require_pitch(channels("first.wav"))


main()
