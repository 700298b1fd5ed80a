# SPDX-License-Identifier: MIT
"""The workflow on one machine: the same samples in any number of shards, and after jobs that are killed."""

import os
import shutil

import pytest
from conftest import killed_program, samples, settings, snakemake

pytestmark = pytest.mark.skipif(shutil.which("snakemake") is None,
                                reason="snakemake is not installed; scripts/install-packages cluster installs it")
PROGRAM = os.environ["CONTACTSPLINE_PROGRAM"]


@pytest.mark.parametrize("shards", [1, 7])
def test_samples_do_not_depend_on_the_shards(tmp_path, plan, expected, shards):
    run = snakemake(tmp_path, *settings(plan=plan, output="out", shards=shards, program=PROGRAM))
    assert run.returncode == 0, run.stderr
    assert samples(tmp_path / "out") == expected
    report = [line.split("\t") for line in (tmp_path / "out/report.tsv").read_text().splitlines()]
    assert report[0] == ["shard", "seconds", "processor_seconds", "bytes"] and len(report) == shards + 1
    assert all(int(row[3]) > 64 // shards * 2205 * 8 for row in report[1:])
    again = snakemake(tmp_path, *settings(plan=plan, output="out", shards=shards, program=PROGRAM))
    assert again.returncode == 0 and "Nothing to be done" in again.stderr


# The first two attempts of each shard are killed; the workflow tries three times more.
def test_killed_jobs_are_tried_again(tmp_path, plan, expected):
    killed = killed_program(tmp_path, "123", 2)
    run = snakemake(tmp_path, *settings(plan=plan, output="out", shards=3, program=killed))
    assert run.returncode == 0, run.stderr
    assert samples(tmp_path / "out") == expected
    assert [len((tmp_path / f"attempts-{i}").read_text()) for i in (1, 2, 3)] == [3, 3, 3]


def test_a_shard_that_fails_costs_itself_and_is_reported(tmp_path, plan, expected):
    fails = tmp_path / "fails"
    fails.write_text(f'#!/bin/bash\ncase "$*" in *2/3*) echo no >&2; exit 2 ;; esac\nexec {PROGRAM} "$@"\n')
    fails.chmod(0o755)
    run = snakemake(tmp_path, "--keep-going", *settings(plan=plan, output="out", shards=3, program=fails))
    assert run.returncode != 0
    assert "1 of 3 shards are missing: 00002" in run.stdout + run.stderr
    assert (tmp_path / "out/log/00002.txt").read_text() == "no\n"
    run = snakemake(tmp_path, *settings(plan=plan, output="out", shards=3, program=PROGRAM))
    assert run.returncode == 0, run.stderr
    assert samples(tmp_path / "out") == expected


def test_missing_settings_are_named(tmp_path, plan):
    run = snakemake(tmp_path, *settings(plan=plan, output="out"))
    assert run.returncode != 0 and "shards: missing; allowed: --config plan=" in run.stdout + run.stderr
