# SPDX-License-Identifier: MIT
import json
import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).parents[2]
PLAN = """{
  "name": "strikes",  // a comment: "name": "other"
  "instrument": "hammer_string", "parts": {"resonator": "string_c4", "material": "felt_c4"},
  "parameters": {"speed_m_per_s": {"uniform": [1, 4]}},
  "events": [{"time_s": 0, "event": "strike"}],
  "outputs": ["bridge_force_n", "force_n"], "sequence": "sobol", "seed": 1, "count": 64, "seconds": 0.05 }"""


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "strikes.json"
    path.write_text(PLAN)
    return path


@pytest.fixture
def expected(plan):
    return rendered(plan)


def rendered(plan):
    """The samples as the program writes them into one shard."""
    folder = plan.parent / "expected"
    subprocess.run([os.environ["CONTACTSPLINE_PROGRAM"], "dataset", plan, "-o", folder], check=True, capture_output=True)
    return samples(folder)


def samples(folder):
    """All arrays of the joined file."""
    import h5py

    arrays = {}
    with h5py.File(folder / "strikes.h5") as file:
        for group in ("parameters", "outputs"):
            for name, array in file[group].items():
                arrays[f"{group}/{name}"] = (array[:].tobytes(), array.shape)
    assert len(arrays) == 3 and all(shape[0] == 64 for _, shape in arrays.values())
    return arrays


def snakemake(folder, *words):
    """Runs the workflow in a folder. Returns the completed process."""
    environment = {**os.environ, "HOME": str(folder), "XDG_CACHE_HOME": str(folder / "cache")}
    return subprocess.run(["snakemake", "-s", ROOT / "workflow/Snakefile", "--cores", "2", *map(str, words)], cwd=folder,
                          env=environment, capture_output=True, text=True)


def settings(**values):
    return ["--config", *(f"{key}={value}" for key, value in values.items())]


def killed_program(folder, shards, attempts):
    """A program whose first attempts of these of three shards are killed. It counts the attempts in attempts-SHARD."""
    program, path = os.environ["CONTACTSPLINE_PROGRAM"], folder / "killed"
    path.write_text(f"""#!/bin/bash
case "$*" in *--join*) exec {program} "$@" ;; esac
attempt=0; for word in "$@"; do case "$word" in [{shards}]/3) attempt="{folder}/attempts-${{word%/3}}" ;; esac; done
[ "$attempt" != 0 ] || exec {program} "$@"
echo >>"$attempt"
[ "$(wc -l <"$attempt")" -gt {attempts} ] || {{ {program} "$@" & sleep 0.0$((RANDOM % 8)); kill -9 $!; wait $!; kill -9 $$; }}
exec {program} "$@"
""")
    path.chmod(0o755)
    return path
