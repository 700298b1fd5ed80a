# SPDX-License-Identifier: MIT
"""Instruments: what they have, what they play, and their sound."""

import base64
import io
import json
import math
import wave
from collections import namedtuple

import numpy as np

from . import _core
from .material import axes_or_new, table_html
from .source import source_of, threads_of, watch_of

_STRIKE, _RELEASE, _PLUCK, _NOTE_ON, _NOTE_OFF, _SET = range(6)
_Event = namedtuple("_Event", "time_s action number value rise_s hold_s")


def strike(time_s, speed_m_per_s, event=0, hold_s=math.inf):
    """A blow at a time, by a name or a number of the instrument's events; its damper falls after hold_s."""
    return _Event(time_s, _STRIKE, event, speed_m_per_s, 0, hold_s)


def release(time_s, event=0):
    """Lets the damper of a blow fall."""
    return _Event(time_s, _RELEASE, event, 0, 0, math.inf)


def pluck(time_s, force_n, event=0, rise_s=0.004):
    """A pluck at a time, whose force rises within rise_s and lets go."""
    return _Event(time_s, _PLUCK, event, force_n, rise_s, math.inf)


def note(time_s, key, velocity=1.0, hold_s=math.inf):
    """A key of MIDI (60: middle C) with a velocity from 0 to 1, let go after hold_s."""
    return _Event(time_s, _NOTE_ON, key, velocity, 0, hold_s)


def change(time_s, parameter, value):
    """A parameter takes another value."""
    return _Event(time_s, _SET, parameter, value, 0, math.inf)


class Sound:
    """What an instrument played: `outputs` by name, arrays of samples in SI units, with the contact force and energy.

    force_n: the sum of the contact forces, or None. energy_j, energy_step: the stored energy after every energy_step
    samples, or None.
    """

    def __init__(self, title, outputs, units, sample_rate_hz, force_n=None, energy_j=None, energy_step=0):
        self.title, self.outputs, self.units, self.sample_rate_hz = title, outputs, units, sample_rate_hz
        self.force_n, self.energy_j, self.energy_step = force_n, energy_j, energy_step

    def __getitem__(self, output):
        if output not in self.outputs:
            raise ValueError(f"{self.title}: output '{output}' is unknown; allowed: {', '.join(self.outputs)}")
        return self.outputs[output]

    @property
    def samples(self):
        """The first output."""
        return next(iter(self.outputs.values()))

    def time_s(self):
        """The time of each sample [s]."""
        return np.arange(len(self.samples)) / self.sample_rate_hz

    def wav(self, output=None, peak_db=-1.0):
        """An output (by default the first) as the bytes of a WAV file of 16 bits, with its peak at a level."""
        samples = self.samples if output is None else self[output]
        peak = np.max(np.abs(samples), initial=0.0)
        scale = 32767 * 10 ** (peak_db / 20) / peak if peak > 0 else 0
        whole = np.round(np.asarray(samples, float) * scale).astype("<i2")
        file = io.BytesIO()
        with wave.open(file, "wb") as to:
            to.setnchannels(1 if whole.ndim == 1 else whole.shape[1])
            to.setsampwidth(2)
            to.setframerate(round(self.sample_rate_hz))
            to.writeframes(whole.tobytes())
        return file.getvalue()

    def write(self, path, output=None, peak_db=-1.0):
        """Writes wav() to a file."""
        with open(path, "wb") as file:
            file.write(self.wav(output, peak_db))

    def plot(self, output=None, axes=None):
        """Draws an output (by default the first) over time. Returns the axes of matplotlib."""
        axes = axes_or_new(axes)
        name = next(iter(self.outputs)) if output is None else output
        axes.plot(self.time_s(), self[name], linewidth=0.5)
        axes.set(xlabel="time [s]", ylabel=f"{name} [{self.units[name]}]", title=self.title)
        return axes

    def __repr__(self):
        return f"<Sound {self.title}: {len(self.samples)} samples at {self.sample_rate_hz:g} Hz of {', '.join(self.outputs)}>"

    def _repr_html_(self):
        data = base64.b64encode(self.wav()).decode()
        return table_html(self.title, [("length", f"{len(self.samples) / self.sample_rate_hz:.3g} s"),
                                       ("outputs", ", ".join(self.outputs))]) + \
            f'<audio controls src="data:audio/wav;base64,{data}"></audio>'


class Instrument:
    """What makes sound: `parameters`, `events`, `outputs` and `presets` tell what it has, `play` plays it.

    source: hammer_string, slide_string, fret_string, mass_barrier, piano, an instrument that ships, the path of an
    instrument file, or a dict with the keys of such a file. parts: for the first four, what they are made of instead, with
    the keys of a voice of a score: resonator and material (names, paths or dicts), pluck_m, ...; and first values of
    parameters. Raises Error with the line that the program prints.
    """

    def __init__(self, source, /, **parts):
        self._source = _core.Source(*source_of(source), json.dumps(parts, allow_nan=False))
        self.name, self.description, self.license = self._source.name, self._source.description, self._source.license
        self.parameters = {row["name"]: row for row in self._source.parameters()}
        self.events = {row["name"]: row for row in self._source.events()}
        self.outputs = {row["name"]: row for row in self._source.outputs()}
        self.presets = {name: dict(zip(self.parameters, values)) for name, values in self._source.presets().items()}

    def play(self, events=(), seconds=1.0, *, sample_rate_hz=44100, parameters=None, outputs=None, force=True,
             energy_step=0, precision="double"):
        """Plays events (strike, pluck, note, ...; one or a list). Returns a Sound.

        parameters: values by name, each a number or an array of values over the whole time. outputs: the names of those
        that are computed (default: all). energy_step: samples between two energies; 0: none. precision: "double" or
        "single".
        """
        play = {"double": self._source.play_double, "single": self._source.play_single}.get(precision)
        if play is None:
            raise ValueError(f"precision: '{precision}' is unknown; allowed: double, single")
        samples = _samples(seconds, sample_rate_hz)
        wanted = list(self.outputs) if outputs is None else [outputs] if isinstance(outputs, str) else list(outputs)
        for name in wanted:
            self._find("outputs", name)
        curves = {self._number(name): self._curve(name, values, samples) for name, values in (parameters or {}).items()}
        initial = [(number, values[0][1]) for number, values in curves.items()]
        rows = [(sample, _SET, number, value, 0.0) for number, values in curves.items() for sample, value in values[1:]]
        rows = self._rows(events, rows, samples, sample_rate_hz)
        played, forces, energies = play(initial, rows, samples, sample_rate_hz, [name in wanted for name in self.outputs],
                                        force, energy_step)
        return Sound(self.description or self.name,
                     {name: array for name, array in zip(self.outputs, played) if name in wanted},
                     {name: self.outputs[name]["unit"] for name in wanted}, sample_rate_hz,
                     forces if force else None, energies if energy_step else None, energy_step)

    def _find(self, what, name):
        if name not in getattr(self, what):
            raise ValueError(f"{self.name}: {what}: '{name}' is unknown; allowed: {', '.join(getattr(self, what))}")
        return getattr(self, what)[name]

    def _number(self, parameter):
        self._find("parameters", parameter)
        return list(self.parameters).index(parameter)

    def _rows(self, events, rows, samples, rate):
        """These rows and all that happens, by time: (sample, action, number, value, rise)."""
        rows = list(rows)
        for event in [events] if isinstance(events, _Event) else events:
            rows += self._event_rows(event, rate)
        return sorted((row for row in rows if row[0] < samples), key=lambda row: row[0])

    def _curve(self, name, values, samples):
        """Where the values change: (sample, value)."""
        values = np.atleast_1d(np.asarray(values, float))
        if values.ndim > 1 or not 1 <= len(values) <= samples or not np.all(np.isfinite(values)):
            raise ValueError(f"{self.name}: {name}: is no number and no array over time; allowed: 1 to {samples} finite values")
        begins = np.arange(len(values)) * samples // len(values)
        changes = np.flatnonzero(np.diff(values, prepend=math.nan))
        return [(float(begins[i]), float(values[i])) for i in changes]

    def _event_rows(self, event, rate):
        if not (math.isfinite(event.time_s) and event.time_s >= 0 and event.hold_s >= 0):
            raise ValueError(f"{self.name}: an event's time {event.time_s} or hold {event.hold_s} is refused; "
                             "allowed: seconds, 0 or more")
        if not math.isfinite(event.value):
            raise ValueError(f"{self.name}: an event's value {event.value} is refused; allowed: a finite number")
        number = self._number(event.number) if event.action == _SET else self._event_number(event)
        rows = [(float(round(event.time_s * rate)), event.action, number, float(event.value), float(event.rise_s))]
        if math.isfinite(event.hold_s):
            ends = {_STRIKE: _RELEASE, _NOTE_ON: _NOTE_OFF}[event.action]
            rows.append((float(round((event.time_s + event.hold_s) * rate)), ends, number, 0.0, 0.0))
        return rows

    def _event_number(self, event):
        if event.action in (_NOTE_ON, _NOTE_OFF):
            if not 0 <= event.number <= 127:
                raise ValueError(f"{self.name}: key {event.number} is refused; allowed: 0 to 127, such as 60")
            return event.number
        kind = "pluck" if event.action == _PLUCK else "strike"
        names = [name for name, row in self.events.items() if row["kind"] == kind]
        name = names[event.number] if isinstance(event.number, int) and 0 <= event.number < len(names) else event.number
        if name not in names:
            raise ValueError(f"{self.name}: {kind}: {event.number!r} is unknown; allowed: {', '.join(names) or 'none'}")
        return self.events[name]["number"]

    def __repr__(self):
        return f"<Instrument {self.name}: {self.description}>"

    def _repr_html_(self):
        rows = [(row["name"], f"{row['initial']:g} {row['unit']}, {row['min']:g} to {row['max']:g}")
                for row in self.parameters.values()]
        return table_html(self.description or self.name, rows)


def render_many(instrument, parameters, events=(), seconds=1.0, *, sample_rate_hz=44100, output=None, precision="single",
                threads=None, out=None, progress=None):
    """Renders an instrument once for each row of parameters, on all cores. Returns float32 samples, (rows, samples).

    parameters: a dict from names to arrays of the same length. events: what every row plays. output: a name (default:
    the first). out: where the samples go, for instance a numpy.memmap; default: a new array. The samples of a row do
    not depend on the other rows, their order or the number of threads. progress(done, total) is called about ten times
    a second.
    """
    if precision not in ("single", "double"):
        raise ValueError(f"precision: '{precision}' is unknown; allowed: single, double")
    samples = _samples(seconds, sample_rate_hz)
    columns = [np.asarray(values, float) for values in parameters.values()]
    if not columns or any(column.ndim != 1 or len(column) != len(columns[0]) for column in columns):
        raise ValueError("parameters: are no columns; allowed: arrays of one and the same length by name")
    values = np.ascontiguousarray(np.stack(columns, axis=1))
    if not np.all(np.isfinite(values)):
        raise ValueError("parameters: some are not finite; allowed: finite numbers")
    shape = (len(values), samples)
    if out is None:
        out = np.empty(shape, np.float32)
    elif out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous:
        raise ValueError(f"out: is no array for this; allowed: float32, C order, {shape}")
    name = next(iter(instrument.outputs)) if output is None else output
    instrument._find("outputs", name)
    play = instrument._source.play_many_single if precision == "single" else instrument._source.play_many_double
    play([instrument._number(name) for name in parameters], values, instrument._rows(events, [], samples, sample_rate_hz),
         sample_rate_hz, list(instrument.outputs).index(name), out, threads_of(threads), watch_of(progress, len(values)))
    return out


def _samples(seconds, sample_rate_hz):
    if not 1000 <= sample_rate_hz <= 768000:
        raise ValueError(f"sample_rate_hz: {sample_rate_hz} is refused; allowed: 1000 to 768000")
    if not 0 < seconds <= 3600:
        raise ValueError(f"seconds: {seconds} is refused; allowed: above 0, up to 3600")
    return max(1, round(seconds * sample_rate_hz))
