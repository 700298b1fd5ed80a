# SPDX-License-Identifier: MIT
"""The notebooks of examples/notebooks run from top to bottom; what they claim is in their assertions."""

import importlib.util
import os
import pathlib

import pytest

NOTEBOOKS = sorted((pathlib.Path(__file__).parents[3] / "examples/notebooks").glob("*.ipynb"))
MISSING = [name for name in ("nbclient", "ipykernel") if importlib.util.find_spec(name) is None]
pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(f'python3-{name}' for name in MISSING)}")


def outputs_of(notebook):
    """The data of all outputs: dicts by kind."""
    return [output.data for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs if "data" in output]


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 5


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path, monkeypatch):
    import nbclient
    import nbformat

    notebook = nbformat.read(path, 4)
    assert not outputs_of(notebook), "a notebook is stored without outputs: they would not follow changes"
    if any("import torch" in cell.source for cell in notebook.cells):
        pytest.importorskip("torch", reason="python3-torch is not installed")
    for name in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "MPLCONFIGDIR"):
        monkeypatch.setenv(name, str(tmp_path / name))
    monkeypatch.delenv("MPLBACKEND", raising=False)  # the kernel's own shows figures in the page
    kept = set(os.listdir(path.parent))
    nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": tmp_path}}).execute()
    shown = outputs_of(notebook)
    assert sum("image/png" in data or "<img src" in data.get("text/html", "") for data in shown) >= 2
    assert set(os.listdir(path.parent)) == kept
