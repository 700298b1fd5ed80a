# SPDX-License-Identifier: MIT
"""The package's types, as a type checker of its users sees them."""

import importlib.util
import os
import pathlib
import subprocess
import sys

import pytest

import contactspline as cs

PACKAGE = pathlib.Path(cs.__file__).parent
pytestmark = pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="python3-mypy is not installed")

USER = """
import numpy as np
import contactspline as cs

string = cs.Instrument("hammer_string", resonator="string_c4", material="felt_c4")
sound = string.play([cs.strike(0, 2.5), cs.change(0.1, "damping_per_s", 20)], seconds=2, parameters={"loss_s_per_m": 0.1})
reveal_type(sound["bridge_force_n"])
reveal_type(string.parameters)
reveal_type(cs.Material("felt_c4").impact(2.5).max_force_n)
reveal_type(cs.Material("felt_c4").impact(np.ones(3)).max_force_n)
reveal_type(cs.Material("felt_c4").knots_m)
reveal_type(cs.render_many(string, {"hammer_mass_kg": np.ones(3)}, cs.strike(0, 1)))
reveal_type(cs.play_score("buzz_line").contacts)
reveal_type(cs.dataset({"name": "probe"}, "out", shards=2))
reveal_type(cs.shipped("materials"))
reveal_type(cs.StruckString().gradient(np.ones(3)))
reveal_type(cs.fit("felt.fit.json").material)
"""


@pytest.fixture(scope="module")
def mypy(tmp_path_factory):
    """Runs mypy in a folder. All runs share a cache: NumPy and the like are read once."""
    environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
    cache = tmp_path_factory.mktemp("cache")

    def run(*words, cwd):
        return subprocess.run([sys.executable, "-m", "mypy", "--follow-imports=silent", "--ignore-missing-imports",
                               "--cache-dir", str(cache), *map(str, words)], cwd=cwd, env=environment, capture_output=True,
                              text=True)

    return run


def test_a_users_program_has_types(mypy, tmp_path):
    (tmp_path / "user.py").write_text(USER)
    checked = mypy("--strict", "user.py", cwd=tmp_path)
    assert checked.returncode == 0, checked.stdout
    types = [line.partition('type is "')[2].rstrip('"') for line in checked.stdout.splitlines() if "type is" in line]
    assert len(types) == 11
    expected = ["ndarray", "dict[builtins.str, builtins.dict", "float", "ndarray", "ndarray", "floating", "int", "str",
                "list[builtins.str]", "dict[builtins.str, builtins.float", "Material"]
    for found, part in zip(types, expected):
        assert part in found, (found, part)


@pytest.mark.parametrize("line, says", [
    ("cs.strike('now', 2)", 'expected "float"'), ("cs.Material('felt_c4').impact(2.5).force", 'no attribute "force"'),
    ("cs.Instrument('tom').play(seconds='long')", 'expected "float"'), ("cs.dataset('plan.json')", '"folder"')])
def test_a_wrong_call_is_found(mypy, tmp_path, line, says):
    (tmp_path / "user.py").write_text(f"import contactspline as cs\n\n{line}\n")
    checked = mypy("user.py", cwd=tmp_path)
    assert checked.returncode == 1 and says in checked.stdout


def test_the_package_agrees_with_its_types(mypy, tmp_path):
    checked = mypy(PACKAGE, cwd=tmp_path)
    assert checked.returncode == 0, checked.stdout


def test_the_compiled_part_has_what_the_types_say():
    assert isinstance(cs._core.__version__, str) and issubclass(cs.Error, ValueError)
