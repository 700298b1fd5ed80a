# SPDX-License-Identifier: MIT
"""A struck string as a function of its parameters, with exact derivatives."""

from __future__ import annotations

import os
from typing import Any, Iterable, Mapping

import numpy as np
import numpy.typing as npt

from . import _core
from .figures import axes_or_new
from .source import source_of

Samples = npt.NDArray[np.float64]


class StruckString:
    """A hammer that strikes a string at rest: displacement at the pickup and contact force, and their derivatives.

    felt, string: a material and a resonator of the kind string, each a name, a path or a dict. Keywords of the methods
    are values of parameters; the others have those of the files. Raises Error with one line for what it cannot use.
    """

    def __init__(self, felt: str | os.PathLike[str] | Mapping[str, Any] = "felt_c4",
                 string: str | os.PathLike[str] | Mapping[str, Any] = "string_c4", *,
                 sample_rate_hz: float = 44100) -> None:
        self._make((*source_of(felt), *source_of(string), float(sample_rate_hz)))

    def _make(self, made_of):
        self._made_of = made_of
        self._core = _core.StruckString(*made_of)
        self._rate = made_of[-1]
        self._rows = self._core.parameters()
        self._names = [row["name"] for row in self._rows]

    def __getstate__(self) -> tuple[Any, ...]:
        return self._made_of

    def __setstate__(self, made_of: tuple[Any, ...]) -> None:
        self._make(made_of)

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Unit, first value and range of each parameter, by its name. exponent_change is added to the exponent, at a
        constant force at the end of the felt's design range. Places are at most string_length_m."""
        return {row["name"]: {key: value for key, value in row.items() if key != "name"} for row in self._rows}

    def play(self, seconds: float, **values: float) -> tuple[Samples, Samples]:
        """Displacement at the pickup [m] and contact force [N] in each sample."""
        return self._core.play(self._values(values), self._samples(seconds))

    def tangents(self, seconds: float, names: str | Iterable[str], **values: float) -> tuple[Samples, Samples]:
        """The derivatives of play() with respect to the parameters of these names, or of one: a row of samples for each."""
        numbers = [self._number(name) for name in ([names] if isinstance(names, str) else names)]
        return self._core.tangents(self._values(values), numbers, self._samples(seconds))

    def gradient(self, displacement: npt.ArrayLike, force: npt.ArrayLike | None = None,
                 **values: float) -> dict[str, float]:
        """The derivatives with respect to all parameters of a number that depends on the samples of play().

        displacement, force: its derivatives with respect to each sample of both; force None: it does not depend on it.
        """
        weights = np.asarray(displacement, float)
        of_force = np.zeros(0) if force is None else np.asarray(force, float)
        if weights.ndim != 1 or of_force.ndim != 1 or (force is not None and of_force.shape != weights.shape):
            raise _core.Error("gradient: displacement and force are one row of samples each, of one length")
        return dict(zip(self._names, self._core.gradient(self._values(values), weights, of_force)))

    def plot_motion(self, seconds: float = 0.005, *, places: int = 80, axes: Any = None, **values: float) -> Any:
        """Draws the displacement of the whole string over place and time: the pickup at `places` places. Returns the axes
        of matplotlib."""
        if not 2 <= places <= 10000:
            raise _core.Error(f"plot_motion: places: {places} is refused; allowed: 2 to 10000 places")
        if "pickup_m" in values:
            raise _core.Error("plot_motion: pickup_m: is refused, the picture has all places; allowed: places=80")
        length = values.get("string_length_m", self.parameters["string_length_m"]["initial"])
        at = np.linspace(0, length, places)
        motion = np.array([self.play(seconds, **values, pickup_m=place)[0] for place in at])
        axes = axes_or_new(axes)
        end, half = np.max(np.abs(motion)) * 1000, length / (places - 1) / 2  # a row is drawn around its place
        image = axes.imshow(1000 * motion, origin="lower", aspect="auto", cmap="RdBu", vmin=-end, vmax=end,
                            extent=(0, 1000 * seconds, -half, length + half))
        axes.figure.colorbar(image, ax=axes, label="displacement [mm]")
        axes.set(xlabel="time [ms]", ylabel="place [m]", title="motion of the string", ylim=(0, length))
        return axes

    def _number(self, name: str) -> int:
        if name not in self._names:
            raise _core.Error(f"parameter: '{name}' is unknown; allowed: {', '.join(self._names)}")
        return self._names.index(name)

    def _values(self, values: Mapping[str, float]) -> Samples:
        all_values = np.array([row["initial"] for row in self._rows], float)
        for name, value in values.items():
            all_values[self._number(name)] = value
        return all_values

    def _samples(self, seconds: float) -> int:
        samples = round(seconds * self._rate) if 0 < seconds <= 3600 else 0
        if samples < 1:
            raise _core.Error(f"seconds: {seconds} is refused; allowed: a sample to 3600 s, such as 0.5")
        return samples
