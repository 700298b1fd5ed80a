# SPDX-License-Identifier: MIT
"""Resonators and keyboards: what the instruments vibrate with."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from . import _core
from .figures import axes_or_new, figure_html, table_html
from .source import source_of


class Resonator:
    """The modes of a string, bar, membrane, plate or round plate that a simulation at a sample rate keeps, by rising frequency.

    source: the name of one that ships, the path of a resonator file, or a dict with the keys of such a file. Raises
    Error with the line that the program prints.
    """

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any], *, sample_rate_hz: float = 44100) -> None:
        told = json.loads(_core.resonator(*source_of(source), sample_rate_hz))
        self.name: str = told["name"]
        self.description: str = told["description"]
        self.modes_left_out: bool = told["modes_left_out"]
        self.frequencies_hz: npt.NDArray[np.float64] = _column(told["modes"], "frequency_hz")
        self.decays_per_s: npt.NDArray[np.float64] = _column(told["modes"], "decay_per_s")
        self.masses_kg: npt.NDArray[np.float64] = _column(told["modes"], "mass_kg")

    def plot(self, axes: Any = None) -> Any:
        """Draws the decay of each mode over its frequency. Returns the axes of matplotlib."""
        axes = axes_or_new(axes)
        axes.semilogx(self.frequencies_hz, self.decays_per_s, ".")
        axes.set(xlabel="frequency [Hz]", ylabel="decay [1/s]", title=self.description or self.name)
        return axes

    def __repr__(self) -> str:
        return f"<Resonator {self.name}: {len(self.frequencies_hz)} modes>"

    def _repr_html_(self) -> str:
        rows: list[tuple[str, object]] = [("modes", len(self.frequencies_hz))]
        if len(self.frequencies_hz):
            rows += [("lowest", f"{self.frequencies_hz[0]:.6g} Hz"), ("highest", f"{self.frequencies_hz[-1]:.6g} Hz")]
        return table_html(self.description or self.name, rows) + figure_html(self.plot)


class Keyboard:
    """The strings and hammers of a keyboard: `keys` has a row for each MIDI key, as `contactspline inspect` prints it.

    source: the name of one that ships, the path of a keyboard file, or a dict with the keys of such a file. Raises
    Error with the line that the program prints.
    """

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any], *, sample_rate_hz: float = 44100) -> None:
        told = json.loads(_core.keyboard(*source_of(source), sample_rate_hz))
        self.name: str = told["name"]
        self.description: str = told["description"]
        self.keys: dict[int, dict[str, float]] = {
            row["key"]: {name: value for name, value in row.items() if name != "key"} for row in told["keys"]}

    def column(self, name: str) -> npt.NDArray[np.float64]:
        """A value of all keys, such as "tension_n"."""
        first = next(iter(self.keys.values()))
        if name not in first:
            raise _core.Error(f"{self.name}: '{name}' is unknown; allowed: {', '.join(first)}")
        return _column(self.keys.values(), name)

    def __repr__(self) -> str:
        return f"<Keyboard {self.name}: {len(self.keys)} keys>"

    def _repr_html_(self) -> str:
        return table_html(self.description or self.name, [
            ("keys", f"{min(self.keys)} to {max(self.keys)}"),
            ("pitches", f"{self.column('pitch_hz')[0]:.6g} to {self.column('pitch_hz')[-1]:.6g} Hz"),
            ("strings", f"{self.column('strings').sum():g}")])


def _column(rows, name):
    return np.array([row[name] for row in rows], float)
