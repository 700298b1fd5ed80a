# SPDX-License-Identifier: MIT
"""contactspline.fit: what the program finds, and its errors."""

import json
import pathlib
import shutil

import pytest

import contactspline as cs

EXAMPLES = pathlib.Path(__file__).parents[3] / "examples/fit"
BALL = EXAMPLES / "rubber_ball.fit.json"


def test_it_finds_what_the_program_finds(program, tmp_path):
    found = cs.fit(BALL)
    printed = program("fit", BALL, "--json", "-o", tmp_path / "ball.json")
    assert printed.returncode == 0, printed.stderr
    assert found.numbers == json.loads(printed.stdout)
    found.write(tmp_path / "mine.json")
    assert (tmp_path / "mine.json").read_text() == (tmp_path / "ball.json").read_text()
    assert found.material.name == "fitted_ball"
    assert found.material.impact(1.0).contact_duration_s > 0
    assert repr(found) == found.report and "exponent" in found.report


def test_a_dict_names_data_in_a_folder(tmp_path):
    shutil.copy(EXAMPLES / "rubber_ball.csv", tmp_path)
    lines = []
    found = cs.fit({"name": "fitted_ball", "mass_kg": 0.009, "tables": [{"file": "rubber_ball.csv"}]}, folder=tmp_path,
                   progress=lines.append)
    assert found.numbers["estimates"] == cs.fit(BALL).numbers["estimates"]
    assert lines


def test_errors_are_the_programs_line(program, tmp_path):
    (tmp_path / "bad.fit.json").write_text('{"name": "x", "mass_kg": -1, "tables": [{"file": "none.csv"}]}')
    with pytest.raises(cs.Error) as refused:
        cs.fit(tmp_path / "bad.fit.json")
    printed = program("fit", tmp_path / "bad.fit.json", "-o", tmp_path / "out.json")
    assert printed.returncode == 2
    assert str(refused.value) in printed.stderr and "\n" not in str(refused.value)


def test_missing_data_are_named(tmp_path):
    with pytest.raises(cs.Error, match="none.csv"):
        cs.fit({"name": "x", "mass_kg": 0.01, "tables": [{"file": "none.csv"}]}, folder=tmp_path)
