# SPDX-License-Identifier: MIT
"""The workflow on one machine: the same samples in any number of shards, and after jobs that are killed."""

import os
import shutil

import pytest
from conftest import PLAN, killed_program, samples, settings, snakemake

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


def test_files_of_another_plan_are_not_replaced(tmp_path, plan):
    words = settings(plan=plan, output="out", shards=2, program=PROGRAM)
    assert snakemake(tmp_path, *words).returncode == 0
    files = {path: path.read_bytes() for path in (tmp_path / "out").glob("*.h5")}
    plan.write_text(PLAN.replace('"seed": 1', '"seed": 2'))
    run = snakemake(tmp_path, *words)
    assert run.returncode != 0 and "is of another plan or version; allowed: another folder" in run.stderr
    assert len(files) == 3 and all(path.read_bytes() == whole for path, whole in files.items())
    plan.write_text(PLAN)
    assert snakemake(tmp_path, *words).returncode == 0


@pytest.mark.parametrize("change, line", [
    ({"shards": None}, "shards: missing; allowed: --config plan="),
    ({"shards": "abc"}, "shards: abc is refused; allowed: 1 to 64"),
    ({"shards": 200}, "shards: 200 is refused; allowed: 1 to 64"),
    ({"threads": 0}, "threads: 0 is refused; allowed: 1 to 1024"),
    ({"plan": "absent.json"}, "plan: absent.json: No such file or directory; allowed: the path of a plan"),
    ({"plan": "nameless.json"}, "plan: nameless.json is no JSON object with name and count; allowed: what")])
def test_bad_settings_are_refused_in_one_line(tmp_path, plan, change, line):
    (tmp_path / "nameless.json").write_text('{"count": 3}')
    values = {"plan": plan, "output": "out", "shards": 2, **change}
    run = snakemake(tmp_path, *settings(**{key: value for key, value in values.items() if value is not None}))
    assert run.returncode != 0 and run.stderr.startswith("WorkflowError in file"), run.stderr
    ours = [text for text in run.stderr.splitlines()[1:] if text.strip() and not text.startswith("  File")]
    assert len(ours) == 1 and ours[0].startswith(line), run.stderr
    assert not (tmp_path / "out").exists()
