# SPDX-License-Identifier: MIT
"""Scores and MIDI files."""

from __future__ import annotations

import operator
import os
import re
from typing import Any, Iterable, Mapping

import numpy as np
import numpy.typing as npt

from . import _core
from .instrument import Sound
from .source import check_rate, source_of


class ScoreSound(Sound):
    """What a score plays: `contacts` is the number of its contacts."""

    contacts: int


def play_score(source: str | os.PathLike[str] | Mapping[str, Any], *, sample_rate_hz: float = 44100,
               precision: str = "double", instrument: str | os.PathLike[str] | Mapping[Any, str | os.PathLike[str]] | None = None,
               channel: int | Iterable[int] | None = None, tuning: str | os.PathLike[str] | None = None,
               keymap: str | os.PathLike[str] | None = None, a4_hz: float | None = None) -> ScoreSound:
    """Plays a score: a name that ships, the path of a .json or .mid file, or a dict. Returns a Sound, as `render` plays it: a MIDI
    file rings until it is 60 dB down.

    The sound has the shape (samples,) or, in stereo, (samples, 2). Its force_n holds the largest contact force in each
    of at most 1200 equal stretches of time. tuning, keymap: files of Scala (.scl, .kbm) that tune its keys, as a4_hz, the
    pitch of A4, does; in place of what the score says. instrument: what plays a MIDI file, a name or file, or several by
    channel, such as {1: "piano", 10: "kit", "*": "cello"}; their sum divides each by its full scale and mixes it by the
    volume, expression and pan of its channels. channel: those that one instrument plays, 1 to 16; by default all but the
    tenth.
    """
    if precision not in ("single", "double"):
        raise _core.Error(f"precision: '{precision}' is unknown; allowed: single, double")
    check_rate(sample_rate_hz)
    try:
        samples, forces, contacts, output, unit, level_db = _core.play_score(
            *source_of(source), sample_rate_hz, precision == "single", *_instruments_of(instrument),
            _channels_of(channel), *_tuning_of(tuning, keymap, a4_hz))
    except _core.Error as error:  # options of the command line are arguments here; in a path they stand as they are
        raise _core.Error(re.sub(r"(?<!\S)--(channel|instrument)(?![^\s:;,])", r"\1", str(error))) from None
    title = source if isinstance(source, str) else "score"
    sound = ScoreSound(title, {output: samples[:, 0] if samples.shape[1] == 1 else samples}, {output: unit}, sample_rate_hz, forces)
    sound.contacts = contacts
    if level_db is not None:
        sound.level_db = level_db
    return sound


def _instruments_of(instrument):
    if isinstance(instrument, Mapping):
        return "", [(str(channel), os.fspath(name)) for channel, name in instrument.items()]
    return "" if instrument is None else os.fspath(instrument), []


def _channels_of(channel):
    channels = []
    for number in [] if channel is None else channel if isinstance(channel, Iterable) else [channel]:
        try:
            channels.append(operator.index(number))
        except TypeError:
            channels.append(0)
        if not 1 <= channels[-1] <= 16:
            raise _core.Error(f"channel: {number!r} is refused; allowed: an integer from 1 to 16")
    return channels


def _tuning_of(tuning, keymap, a4_hz):
    return *("" if file is None else os.fspath(file) for file in (tuning, keymap)), a4_hz


def read_tuning(tuning: str | os.PathLike[str] | None = None, keymap: str | os.PathLike[str] | None = None, *,
                a4_hz: float | None = None) -> npt.NDArray[np.float64]:
    """Cents of the 128 keys of MIDI above equal temperament, by files of Scala (.scl, .kbm) and the pitch of A4: for
    Instrument.play(tuning=...). NaN: the key does not sound."""
    return np.array(_core.read_tuning(*_tuning_of(tuning, keymap, a4_hz)))


def shipped(kind: str) -> list[str]:
    """The names that ship: kind is "materials", "frictions", "resonators", "keyboards", "instruments" or "scores"."""
    if kind not in _core.shipped:
        raise _core.Error(f"kind: '{kind}' is unknown; allowed: {', '.join(_core.shipped)}")
    return list(_core.shipped[kind])
