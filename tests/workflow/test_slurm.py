# SPDX-License-Identifier: MIT
"""The workflow on a Slurm of this machine alone, as scripts/cluster starts it."""

import os
import shutil
import subprocess

import pytest
from conftest import ROOT, killed_program, samples

STATUS = ROOT / "workflow/slurm/status"
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


# A Slurm of which each job has another state. Of a job that it has forgotten, Snakemake looks for the file.
@pytest.mark.parametrize("answer, status", [
    ("JobId=7 JobState=COMPLETED Reason=None", "success"), ("JobId=7 JobState=RUNNING Reason=None", "running"),
    ("JobId=7 JobState=NODE_FAIL Reason=None", "failed"), ("slurm_load_jobs error: Invalid job id specified", "success"),
    ("slurm_load_jobs error: Unable to contact slurm controller", "running")])
def test_status_of_a_job(tmp_path, answer, status):
    scontrol = tmp_path / "scontrol"
    is_error = "error" in answer
    scontrol.write_text(f"#!/bin/sh\necho '{answer}' >&{2 if is_error else 1}\nexit {int(is_error)}\n")
    scontrol.chmod(0o755)
    run = subprocess.run([STATUS, "7"], capture_output=True, text=True, env={"PATH": f"{tmp_path}:{os.environ['PATH']}"})
    assert run.stdout == status + "\n"
