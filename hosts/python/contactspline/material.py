# SPDX-License-Identifier: MIT
"""Materials: a contact law, its spline and its impacts."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, fields
from typing import Any, Callable, Generic, Iterable, Mapping, Sequence, TypeVar, overload

import numpy as np
import numpy.typing as npt

from . import _core
from .figures import axes_or_new, figure_html, table_html
from .source import source_of, threads_of, watch_of


T = TypeVar("T", float, npt.NDArray[np.float64])


@dataclass(frozen=True, eq=False)
class Impact(Generic[T]):
    """What impacts on a rigid barrier do: numbers, or arrays of one shape. print() shows a table."""

    speed_m_per_s: T
    mass_kg: T
    max_compression_m: T
    contact_duration_s: T
    exit_speed_m_per_s: T
    max_force_n: T

    def __str__(self) -> str:
        names = [field.name for field in fields(self)]
        columns = np.stack([np.ravel(getattr(self, name)) for name in names])
        lines = [names] + [[f"{value:.6g}" for value in row] for row in columns.T.tolist()]
        return "\n".join("  ".join(cell.rjust(len(name)) for cell, name in zip(line, names)) for line in lines)


class Material:
    """A material with its designed spline.

    source: the name of one that ships, the path of a material file, or a dict with the keys of such a file; keywords
    are keys of such a file, too. Raises Error with the line that the program prints.
    """

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any] | None = None, /, **keys: Any) -> None:
        if source is not None and keys and not isinstance(source, Mapping):
            raise TypeError("Material: keys stand alone or beside a dict; a name or a path takes none")
        own = source if isinstance(source, Mapping) else {}
        self._make(source_of({**own, **keys} if keys or source is None else source))

    def _make(self, source, design=None):
        self._made_of = source
        self._design = _core.design(*source) if design is None else design

    @classmethod
    def _of(cls, source, design=None):
        made = cls.__new__(cls)
        made._make(source, design)
        return made

    def __getstate__(self) -> tuple[str, bool]:
        return self._made_of

    def __setstate__(self, made_of: tuple[str, bool]) -> None:
        self._make(made_of)

    @property
    def name(self) -> str:
        """The identifier."""
        return self._design.name

    @property
    def description(self) -> str:
        """One line; may be empty."""
        return self._design.description

    @property
    def law(self) -> str:
        """The contact law as a line of text."""
        return self._design.law

    @property
    def loss_s_per_m(self) -> float:
        """The Hunt-Crossley loss [s/m]."""
        return self._design.loss_s_per_m

    @property
    def end_m(self) -> float:
        """The end of the spline's design range [m]."""
        return self._design.end_m

    @property
    def mass_kg(self) -> float:
        """The mass of its impacts [kg]."""
        return self._design.mass_kg()

    @property
    def speeds_m_per_s(self) -> tuple[float, float] | None:
        """The range of its impacts' speeds, or None [m/s]."""
        return self._design.speeds

    @property
    def knots_m(self) -> npt.NDArray[np.float64]:
        """Left end of each segment [m]."""
        return self._design.knots()

    @property
    def energies_j(self) -> npt.NDArray[np.float64]:
        """Potential at each knot [J]."""
        return self._design.energies()

    @property
    def forces_n(self) -> npt.NDArray[np.float64]:
        """Force at each knot [N]."""
        return self._design.forces()

    @property
    def half_curvatures_n_per_m(self) -> npt.NDArray[np.float64]:
        """Coefficient of the square in each segment [N/m]."""
        return self._design.half_curvatures()

    @property
    def errors(self) -> dict[str, Any]:
        """The errors of the spline against the law, as `contactspline inspect --json` prints them."""
        return json.loads(self._design.json)["errors"]

    def force(self, compression_m: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """The spline's force [N] at compressions [m], in their shape; 0 out of contact."""
        return self._design.spline_force(np.asarray(compression_m, float))

    def potential(self, compression_m: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """The spline's potential [J] at compressions [m], in their shape; 0 out of contact."""
        return self._design.spline_potential(np.asarray(compression_m, float))

    def exact_force(self, compression_m: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """The law's force [N] at compressions [m], in their shape; 0 out of contact."""
        return self._design.exact_force(np.asarray(compression_m, float))

    @overload
    def impact(self, speed_m_per_s: float, mass_kg: float | None = None, *, of: str = "exact",
               sample_rate_hz: float = 44100) -> Impact[float]: ...
    @overload
    def impact(self, speed_m_per_s: Sequence[float] | npt.NDArray[Any], mass_kg: npt.ArrayLike | None = None, *,
               of: str = "exact", sample_rate_hz: float = 44100) -> Impact[npt.NDArray[np.float64]]: ...

    def impact(self, speed_m_per_s: Any, mass_kg: npt.ArrayLike | None = None, *, of: str = "exact",
               sample_rate_hz: float = 44100) -> Impact[Any]:
        """A mass (by default the material's) that hits a rigid barrier; arrays of speeds and masses give arrays.

        of: "exact", the law; "spline", its spline in continuous time; "simulated", the contact step at a sample rate.
        """
        if of not in ("exact", "spline", "simulated"):
            raise _core.Error(f"of: '{of}' is unknown; allowed: exact, spline, simulated")
        speeds, masses = np.broadcast_arrays(np.asarray(speed_m_per_s, float),
                                             np.asarray(self.mass_kg if mass_kg is None else mass_kg, float))
        values: Any = [speeds, masses, *self._design.impacts(speeds, masses, of, float(sample_rate_hz))]
        return Impact(*map(float, values)) if speeds.ndim == 0 else Impact(*values)

    def plot(self, axes: Any = None) -> Any:
        """Draws the force of law and spline over the compression. Returns the axes of matplotlib."""
        axes = axes_or_new(axes)
        y = np.linspace(0, self.end_m, 500)
        axes.plot(1000 * y, self.exact_force(y), label="law")
        axes.plot(1000 * y, self.force(y), "--", label=f"spline, {len(self.knots_m)} segments")
        axes.plot(1000 * self.knots_m, self.forces_n, ".", color="black", label="knots")
        axes.set(xlabel="compression [mm]", ylabel="force [N]", title=self.description or self.name)
        axes.legend()
        return axes

    def plot_impacts(self, speeds_m_per_s: npt.ArrayLike | None = None, axes: Any = None) -> Any:
        """Draws contact duration and largest force over speeds (by default the material's range).

        axes: two, for the duration and the force; by default those of a new figure. Returns them.
        """
        import matplotlib.pyplot as plt

        if speeds_m_per_s is None:
            slowest, fastest = self.speeds_m_per_s or (0.1, 10)
            speeds_m_per_s = np.geomspace(slowest, fastest, 40)
        speeds = np.atleast_1d(np.asarray(speeds_m_per_s, float))
        impacts = self.impact(speeds)
        if axes is None:
            _, axes = plt.subplots(2, 1, sharex=True, layout="constrained")
        if np.size(axes) != 2:
            raise _core.Error("plot_impacts: axes: are not two; allowed: two axes of matplotlib, or None")
        axes[0].loglog(speeds, 1000 * impacts.contact_duration_s)
        axes[0].set(ylabel="contact duration [ms]", title=self.description or self.name)
        axes[1].loglog(speeds, impacts.max_force_n)
        axes[1].set(xlabel="speed [m/s]", ylabel="largest force [N]")
        return axes

    def __repr__(self) -> str:
        return f"<Material {self.name}: {self.law}, {len(self.knots_m)} segments>"

    def _repr_html_(self) -> str:
        return table_html(self.description or self.name, [
            ("law", self.law), ("segments", len(self.knots_m)), ("design range", f"{1000 * self.end_m:.4g} mm"),
            ("loss", f"{self.loss_s_per_m:g} s/m"), ("worst error of the force", f"{100 * self.errors['force']['worst']:.3g} %")
        ]) + figure_html(self.plot)


def design_many(sources: Iterable[str | os.PathLike[str] | Mapping[str, Any]], *, threads: int | None = None,
                progress: Callable[[int, int], object] | None = None) -> list[Material]:
    """Designs materials (names, paths or dicts) on all cores. Returns them in their order; the first error is raised.

    progress(done, total) is called about ten times a second, and at the end.
    """
    if isinstance(sources, (str, bytes, os.PathLike, Mapping)):
        raise _core.Error("sources: is one material; allowed: a list of names, paths or dicts")
    texts = [source_of(source) for source in sources]
    designs = _core.design_many(texts, threads_of(threads), watch_of(progress, len(texts)))
    return [Material._of(text, design) for text, design in zip(texts, designs)]
