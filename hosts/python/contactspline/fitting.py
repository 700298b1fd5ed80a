# SPDX-License-Identifier: MIT
"""Fits of materials to measurements."""

from __future__ import annotations

import json
import os
from typing import Any, Callable, Mapping

from . import _core
from .material import Material
from .source import source_of, write_whole


class Fit:
    """What fit() found: `numbers` as `contactspline fit --json` prints them, `text` of the material file, `report`."""

    def __init__(self, numbers: dict[str, Any], text: str, report: str) -> None:
        self.numbers, self.text, self.report = numbers, text, report

    @property
    def material(self) -> Material:
        """The material, designed."""
        return Material._of((self.text, True))

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the material file."""
        write_whole(path, self.text.encode())

    def __repr__(self) -> str:
        return self.report


def fit(source: str | os.PathLike[str] | Mapping[str, Any], *, folder: str | os.PathLike[str] = ".",
        progress: Callable[[str], object] | None = None) -> Fit:
    """Fits a material to measurements: the path of a fit file, or a dict with its keys, whose data are in `folder`.

    progress(line) is called with what is fitted now. Raises Error with the line that the program prints.
    """
    return Fit(*_loaded(*_core.fit(*source_of(source), os.fspath(folder), progress or (lambda line: None))))


def _loaded(numbers, text, report):
    return json.loads(numbers), text, report
