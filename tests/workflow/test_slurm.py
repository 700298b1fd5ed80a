# SPDX-License-Identifier: MIT
"""The workflow on a Slurm whose nodes are this machine, as scripts/cluster starts it."""

import os
import shutil
import signal
import subprocess
import time

import pytest
from conftest import ROOT, killed_program, rendered, samples

PROGRAM = os.environ["CONTACTSPLINE_PROGRAM"]
STATUS = ROOT / "workflow/slurm/status"
PATH = os.environ["PATH"] + ":/usr/sbin"
MISSING = [name for name in ("snakemake", "munged", "slurmctld", "slurmd") if shutil.which(name, path=PATH) is None]
REASON = f"not installed: {', '.join(MISSING)}; scripts/install-packages cluster installs it" if MISSING else "slurmd runs as root"
needs_slurm = pytest.mark.skipif(bool(MISSING) or os.geteuid() != 0, reason=REASON)


@needs_slurm
def test_samples_are_those_of_the_program_also_after_a_kill(tmp_path, plan, expected):
    killed = killed_program(tmp_path, "2", 1)
    run = subprocess.run([ROOT / "scripts/cluster", plan, "out", "3"], cwd=tmp_path, capture_output=True, text=True,
                         env={**os.environ, "HOME": str(tmp_path), "CONTACTSPLINE_PROGRAM": str(killed)})
    assert run.returncode == 0, run.stdout + run.stderr
    assert "Submitted job" in run.stderr and samples(tmp_path / "out") == expected
    assert len((tmp_path / "attempts-2").read_text()) == 2


# A shard of this plan takes most of a second of a processor: its node is lost in the middle of it.
LONG_PLAN = """{
  "name": "strikes", "instrument": "tanpura", "parameters": {"finger_release_n": {"uniform": [1, 2]}},
  "events": [{"time_s": 0, "event": "pluck_finger"}],
  "outputs": ["bridge_force_n", "force_n"], "seed": 1, "count": 64, "seconds": 0.5 }"""


def processes(folder):
    """The processes of a Slurm whose files are in a folder, with the name of their node. They are its daemons and its
    jobs. Between these stand processes that overwrite their environment: slurmstepd."""
    import psutil

    for process in psutil.process_iter(["cmdline", "environ"]):
        words, environment = process.info["cmdline"], process.info["environ"] or {}
        if environment.get("SLURM_CONF", "").startswith(f"{folder}/"):
            yield process, words, environment.get("SLURMD_NODENAME", words[-1] if "-N" in words else None)


def pending(shard):
    """The name of a shard while it is written."""
    return shard.with_name(f".contactspline-{shard.name}.part")


def first_writer(folder, run):
    """Waits for a shard that is half written. Returns its node and its path."""
    while run.poll() is None:
        for _, words, node in processes(folder):
            if words and words[0] == PROGRAM and "--shard" in words:
                index, shards = words[words.index("--shard") + 1].split("/")
                shard = folder / f"out/strikes-{int(index):05}-of-{int(shards):05}.h5"
                if pending(shard).exists():
                    return node, shard
    raise AssertionError(f"no shard was being written: exit {run.returncode}")


def lose(node, folder):
    """Kills all that runs on a node, as the loss of its machine does: daemon and slurmstepd first, which would tell."""
    import psutil

    until = time.monotonic() + 1  # also a job that the daemon has just begun
    while time.monotonic() < until:
        lost = [process for process, _, where in processes(folder) if where == node]
        for process in lost:
            try:
                parent = process.parent()
                if parent and parent.name() == "slurmstepd":
                    parent.kill()
                process.kill()
            except psutil.NoSuchProcess:
                pass


@needs_slurm
def test_a_lost_node_costs_time_only(tmp_path, plan):
    plan.write_text(LONG_PLAN)
    expected = rendered(plan)
    counted = tmp_path / "counted"
    counted.write_text(f"""#!/bin/bash
case "$*" in *"--shard "*) echo "$SLURMD_NODENAME $*" >>"{tmp_path}/attempts" ;; esac
exec {PROGRAM} "$@"
""")
    counted.chmod(0o755)
    messages = tmp_path / "messages"
    environment = {**os.environ, "HOME": str(tmp_path), "TMPDIR": str(tmp_path), "CONTACTSPLINE_PROGRAM": str(counted)}
    with open(messages, "w") as file:
        run = subprocess.Popen([ROOT / "scripts/cluster", plan, "out", "4"], cwd=tmp_path, stdout=file, stderr=file,
                               env=environment, start_new_session=True)
    try:
        node, shard = first_writer(tmp_path, run)
        lose(node, tmp_path)
        assert pending(shard).exists() and not shard.exists()
        joined = subprocess.run([PROGRAM, "dataset", plan, "-o", "out", "--shards", "4", "--join"], cwd=tmp_path,
                                capture_output=True, text=True)
        assert joined.returncode == 2 and "does not exist" in joined.stderr
        assert run.wait(timeout=500) == 0, messages.read_text()
    finally:
        if run.poll() is None:
            os.killpg(run.pid, signal.SIGTERM)
            run.wait()
    number = int(shard.name.split("-")[1])
    attempts = [line.split()[0] for line in (tmp_path / "attempts").read_text().splitlines() if f"--shard {number}/4" in line]
    assert attempts == [node, {"one": "two", "two": "one"}[node]]
    assert samples(tmp_path / "out") == expected and not list((tmp_path / "out").glob("*.part"))


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
