# SPDX-License-Identifier: MIT
"""The workflow on a Slurm of this machine alone, as scripts/cluster starts it."""

import os
import shutil
import subprocess

import pytest
from conftest import ROOT, killed_program, samples

PATH = os.environ["PATH"] + ":/usr/sbin"
MISSING = [name for name in ("snakemake", "munged", "slurmctld", "slurmd") if shutil.which(name, path=PATH) is None]


@pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}; scripts/install-packages cluster installs it")
@pytest.mark.skipif(os.geteuid() != 0, reason="slurmd runs as root")
def test_samples_are_those_of_the_program_also_after_a_kill(tmp_path, plan, expected):
    killed = killed_program(tmp_path, "2", 1)
    run = subprocess.run([ROOT / "scripts/cluster", plan, "out", "3"], cwd=tmp_path, capture_output=True, text=True,
                         env={**os.environ, "HOME": str(tmp_path), "CONTACTSPLINE_PROGRAM": str(killed)})
    assert run.returncode == 0, run.stdout + run.stderr
    assert "Submitted job" in run.stderr and samples(tmp_path / "out") == expected
    assert len((tmp_path / "attempts-2").read_text()) == 2
