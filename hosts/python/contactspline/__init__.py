# SPDX-License-Identifier: MIT
"""Collisions of musical instruments, solved in closed form: materials, impacts, instruments and their sound.

    import contactspline as cs
    cs.Material("felt_c4").impact(2.5)
    cs.Instrument("tanpura").play(cs.pluck(0, 0.5), seconds=2).plot()
"""

from ._core import Error, __version__
from .dataset import dataset
from .fitting import Fit, fit
from .gradients import StruckString
from .instrument import Instrument, Sound, bow, change, note, pluck, release, render_many, strike
from .material import Impact, Material, design_many
from .resonator import Keyboard, Resonator
from .score import play_score, read_tuning, shipped

__all__ = ["Error", "Fit", "Impact", "Instrument", "Keyboard", "Material", "Resonator", "Sound", "StruckString", "bow", "change",
           "dataset", "design_many", "fit", "note", "play_score", "pluck", "read_tuning", "release", "render_many", "shipped", "strike"]

Error.__module__ = __name__
