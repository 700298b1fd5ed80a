# SPDX-License-Identifier: MIT
"""The programs of README and of the page run, each alone, in an empty folder."""

import pathlib
import re

import pytest

ROOT = pathlib.Path(__file__).parents[3]
PAGES = [ROOT / "README.md", ROOT / "docs/how-to/python.md", ROOT / "docs/how-it-works/gradients.md"]
PROGRAMS = [program for page in PAGES
            for program in re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)]


def test_the_pages_have_programs():
    assert len(PROGRAMS) >= 12


@pytest.mark.parametrize("program", PROGRAMS, ids=range(len(PROGRAMS)))
def test_a_program_runs(program, tmp_path, monkeypatch, capsys):
    if "import torch" in program:
        pytest.importorskip("torch", reason="python3-torch is not installed")
    monkeypatch.chdir(tmp_path)
    exec(compile(program, "page", "exec"), {})
    if "write(" in program:
        assert (tmp_path / "c4.wav").stat().st_size > 100000
    if "print(" in program:
        assert capsys.readouterr().out.strip()
