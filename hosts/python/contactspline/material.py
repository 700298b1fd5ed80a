# SPDX-License-Identifier: MIT
"""Materials: a contact law, its spline and its impacts."""

import json

import numpy as np

from . import _core
from .source import source_of, threads_of, watch_of


class Material:
    """A material with its designed spline.

    source: the name of one that ships, the path of a material file, or a dict with the keys of such a file; keywords
    are keys of such a file, too. Raises Error with the line that the program prints.
    """

    def __init__(self, source=None, /, **keys):
        if source is not None and keys and not isinstance(source, dict):
            raise TypeError("Material: keys stand alone or beside a dict; a name or a path takes none")
        self._design = _core.design(*source_of(source if source is not None and not keys else {**(source or {}), **keys}))

    @classmethod
    def _of(cls, design):
        made = cls.__new__(cls)
        made._design = design
        return made

    name = property(lambda self: self._design.name, doc="The identifier.")
    description = property(lambda self: self._design.description, doc="One line; may be empty.")
    law = property(lambda self: self._design.law, doc="The contact law as a line of text.")
    loss_s_per_m = property(lambda self: self._design.loss_s_per_m, doc="The Hunt-Crossley loss [s/m].")
    end_m = property(lambda self: self._design.end_m, doc="The end of the spline's design range [m].")
    mass_kg = property(lambda self: self._design.mass_kg(), doc="The mass of its impacts [kg].")
    speeds_m_per_s = property(lambda self: self._design.speeds, doc="The range of its impacts' speeds, or None [m/s].")
    knots_m = property(lambda self: self._design.knots(), doc="Left end of each segment [m].")
    energies_j = property(lambda self: self._design.energies(), doc="Potential at each knot [J].")
    forces_n = property(lambda self: self._design.forces(), doc="Force at each knot [N].")
    half_curvatures_n_per_m = property(lambda self: self._design.half_curvatures(),
                                       doc="Coefficient of the square in each segment [N/m].")

    @property
    def errors(self):
        """The errors of the spline against the law, as `contactspline inspect --json` prints them."""
        return json.loads(self._design.json)["errors"]

    def force(self, compression_m):
        """The spline's force [N] at compressions [m], in their shape; 0 out of contact."""
        return self._design.spline_force(np.asarray(compression_m, float))

    def potential(self, compression_m):
        """The spline's potential [J] at compressions [m], in their shape; 0 out of contact."""
        return self._design.spline_potential(np.asarray(compression_m, float))

    def exact_force(self, compression_m):
        """The law's force [N] at compressions [m], in their shape; 0 out of contact."""
        return self._design.exact_force(np.asarray(compression_m, float))

    def impact(self, speed_m_per_s, mass_kg=None, *, of="exact", sample_rate_hz=44100):
        """A mass (by default the material's) that hits a rigid barrier.

        of: "exact", the law; "spline", its spline in continuous time; "simulated", the contact step at a sample rate.
        """
        if of not in ("exact", "spline", "simulated"):
            raise ValueError(f"of: '{of}' is unknown; allowed: exact, spline, simulated")
        return self._design.impact(speed_m_per_s, mass_kg, of, sample_rate_hz)

    def plot(self, axes=None):
        """Draws the force of law and spline over the compression. Returns the axes of matplotlib."""
        axes = axes_or_new(axes)
        y = np.linspace(0, self.end_m, 500)
        axes.plot(1000 * y, self.exact_force(y), label="law")
        axes.plot(1000 * y, self.force(y), "--", label=f"spline, {len(self.knots_m)} segments")
        axes.plot(1000 * self.knots_m, self.forces_n, ".", color="black", label="knots")
        axes.set(xlabel="compression [mm]", ylabel="force [N]", title=self.description or self.name)
        axes.legend()
        return axes

    def plot_impacts(self, speeds_m_per_s=None, axes=None):
        """Draws contact duration and largest force over speeds (by default the material's range)."""
        import matplotlib.pyplot as plt

        if speeds_m_per_s is None:
            slowest, fastest = self.speeds_m_per_s or (0.1, 10)
            speeds_m_per_s = np.geomspace(slowest, fastest, 40)
        impacts = [self.impact(speed) for speed in speeds_m_per_s]
        if axes is None:
            _, axes = plt.subplots(2, 1, sharex=True)
        axes[0].loglog(speeds_m_per_s, [1000 * impact.contact_duration_s for impact in impacts])
        axes[0].set(ylabel="contact duration [ms]", title=self.description or self.name)
        axes[1].loglog(speeds_m_per_s, [impact.max_force_n for impact in impacts])
        axes[1].set(xlabel="speed [m/s]", ylabel="largest force [N]")
        return axes

    def __repr__(self):
        return f"<Material {self.name}: {self.law}, {len(self.knots_m)} segments>"

    def _repr_html_(self):
        return table_html(self.description or self.name, [
            ("law", self.law), ("segments", len(self.knots_m)), ("design range", f"{1000 * self.end_m:.4g} mm"),
            ("loss", f"{self.loss_s_per_m:g} s/m"), ("worst error of the force", f"{100 * self.errors['force']['worst']:.3g} %")])


def design_many(sources, *, threads=None, progress=None):
    """Designs materials (names, paths or dicts) on all cores. Returns them in their order; the first error is raised.

    progress(done, total) is called about ten times a second.
    """
    sources = [source_of(source) for source in sources]
    designs = _core.design_many(sources, threads_of(threads), watch_of(progress, len(sources)))
    return [Material._of(design) for design in designs]


def axes_or_new(axes):
    import matplotlib.pyplot as plt

    return plt.subplots()[1] if axes is None else axes


def table_html(title, rows):
    from html import escape

    cells = "".join(f"<tr><td>{escape(str(key))}</td><td>{escape(str(value))}</td></tr>" for key, value in rows)
    return f"<b>{escape(title)}</b><table>{cells}</table>"
