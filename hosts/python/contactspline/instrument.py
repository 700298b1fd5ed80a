# SPDX-License-Identifier: MIT
"""Instruments: what they have, what they play, and their sound."""

from __future__ import annotations

import base64
import io
import math
import operator
import os
import wave
from typing import Any, Callable, Iterable, Mapping, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core
from .figures import axes_or_new, figure_html, table_html
from .source import check_rate, json_of, source_of, threads_of, watch_of, write_whole

_STRIKE, _RELEASE, _PLUCK, _NOTE_ON, _NOTE_OFF, _SET, _BOW = (
    _core.actions[name] for name in ("strike", "release", "pluck", "note_on", "note_off", "set", "bow"))
_PLAYED = {_STRIKE: "strike", _RELEASE: "strike", _PLUCK: "pluck", _BOW: "bow"}  # kinds of an instrument's events


_FORCE = "force_n"  # the sum of the contact forces, beside the outputs that an instrument lists


class Event(NamedTuple):
    """What happens at a time: strike, release, pluck, bow, note and change make it."""

    time_s: float
    action: int
    number: int | str
    value: float | None
    rise_s: float
    hold_s: float


def strike(time_s: float, speed_m_per_s: float | None = None, event: int | str = 0, hold_s: float = math.inf) -> Event:
    """A blow at a time, by a name or a number of the instrument's events; its damper falls after hold_s.

    speed_m_per_s None: the value that the parameter of the event has then.
    """
    return Event(time_s, _STRIKE, event, speed_m_per_s, 0, hold_s)


def release(time_s: float, event: int | str = 0) -> Event:
    """Lets the damper of a blow fall."""
    return Event(time_s, _RELEASE, event, 0, 0, math.inf)


def pluck(time_s: float, force_n: float | None = None, event: int | str = 0, rise_s: float = 0.004) -> Event:
    """A pluck at a time, whose force rises within rise_s, 1e-5 to 1, and lets go.

    force_n None: the value that the parameter of the event has then.
    """
    return Event(time_s, _PLUCK, event, force_n, rise_s, math.inf)


def bow(time_s: float, acceleration_m_per_s2: float | None = None, event: int | str = 0, hold_s: float = math.inf) -> Event:
    """A stroke of a bow at a time, which is lifted after hold_s.

    acceleration_m_per_s2 None: the value that the parameter of the event has then.
    """
    return Event(time_s, _BOW, event, acceleration_m_per_s2, 0, hold_s)


def note(time_s: float, key: int, velocity: float = 1.0, hold_s: float = math.inf) -> Event:
    """A key of MIDI (60: middle C) with a velocity from 0 to 1, let go after hold_s."""
    return Event(time_s, _NOTE_ON, key, velocity, 0, hold_s)


def change(time_s: float, parameter: str, value: float) -> Event:
    """A parameter takes another value."""
    return Event(time_s, _SET, parameter, value, 0, math.inf)


class Sound:
    """What an instrument played: `outputs` by name, arrays of samples in SI units, with the contact force and energy.

    force_n: the sum of the contact forces, or None. energy_j, energy_step: the stored energy after every energy_step
    samples, or None.
    """

    level_db: float = -1.0  # of the peak, in files

    def __init__(self, title: str, outputs: dict[str, npt.NDArray[Any]], units: dict[str, str], sample_rate_hz: float,
                 force_n: npt.NDArray[Any] | None = None, energy_j: npt.NDArray[np.float64] | None = None,
                 energy_step: int = 0) -> None:
        self.title, self.outputs, self.units, self.sample_rate_hz = title, outputs, units, sample_rate_hz
        self.force_n, self.energy_j, self.energy_step = force_n, energy_j, energy_step

    def __getitem__(self, output: str) -> npt.NDArray[Any]:
        if output not in self.outputs and output == _FORCE and self.force_n is not None:
            return self.force_n
        if output not in self.outputs:
            raise _core.Error(f"{self.title}: output '{output}' is unknown; allowed: {', '.join(self.outputs)}")
        return self.outputs[output]

    @property
    def samples(self) -> npt.NDArray[Any]:
        """The first output."""
        return next(iter(self.outputs.values()))

    def time_s(self) -> npt.NDArray[np.float64]:
        """The time of each sample [s]."""
        return np.arange(len(self.samples)) / self.sample_rate_hz

    def wav(self, output: str | None = None, level_db: float | None = None) -> bytes:
        """An output (by default the first) as the bytes of a WAV file of 16 bits, with its peak at a level, at most 0 dB.

        level_db None: the level that a score asks for, else -1.
        """
        level_db = self.level_db if level_db is None else level_db
        if not -200 <= level_db <= 0:
            raise _core.Error(f"level_db: {level_db} is refused; allowed: -200 to 0, such as -1")
        samples = self.samples if output is None else self[output]
        peak = np.max(np.abs(samples), initial=0.0)
        scale = 32767 * 10 ** (level_db / 20) / peak if peak > 0 else 0
        whole = np.round(np.asarray(samples, float) * scale).astype("<i2")
        file = io.BytesIO()
        with wave.open(file, "wb") as to:
            to.setnchannels(1 if whole.ndim == 1 else whole.shape[1])
            to.setsampwidth(2)
            to.setframerate(round(self.sample_rate_hz))
            to.writeframes(whole.tobytes())
        return file.getvalue()

    def write(self, path: str | os.PathLike[str], output: str | None = None, level_db: float | None = None) -> None:
        """Writes wav() to a file, whose name ends in .wav."""
        name = os.fsdecode(path)
        if not name.lower().endswith(".wav"):
            raise _core.Error(f"{name}: sound: its ending names no format that can be written; allowed: .wav")
        write_whole(path, self.wav(output, level_db))

    def plot(self, output: str | None = None, axes: Any = None) -> Any:
        """Draws an output (by default the first) over time. Returns the axes of matplotlib."""
        axes = axes_or_new(axes)
        name = next(iter(self.outputs)) if output is None else output
        lines = axes.plot(self.time_s(), self[name], linewidth=0.5)
        if len(lines) == 2:
            axes.legend(lines, ["left", "right"])
        axes.set(xlabel="time [s]", ylabel=f"{name} [{self.units.get(name, 'N')}]", title=self.title)
        return axes

    def __repr__(self) -> str:
        return f"<Sound {self.title}: {len(self.samples)} samples at {self.sample_rate_hz:g} Hz of {', '.join(self.outputs)}>"

    def _repr_html_(self) -> str:
        data = base64.b64encode(self.wav()).decode()
        length = f"{len(self.samples) / self.sample_rate_hz:.3g} s"
        return (table_html(self.title, [("length", length), ("outputs", ", ".join(self.outputs))])
                + figure_html(lambda axes: self.plot(axes=axes))
                + f'<audio controls src="data:audio/wav;base64,{data}"></audio>')


class Instrument:
    """What makes sound: `parameters`, `events`, `outputs` and `presets` tell what it has, `play` plays it.

    source: hammer_string, mass_barrier, piano, an instrument that ships, the path of an instrument file, or a dict with the
    keys of such a file. parts: what the first three are made of instead: material, for hammer_string also resonator,
    tuning_cents, hammer_mass_kg and damper_per_s; for piano keyboard. Material, resonator and keyboard are names, paths or
    dicts. Raises Error with the line that the program prints.
    """

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any], /, **parts: Any) -> None:
        self._make(source_of(source), json_of(parts))

    def _make(self, source: tuple[str, bool], parts: str) -> None:
        self._made_of = source, parts
        self._source = _core.Source(*source, parts)
        self.name: str = self._source.name
        self.description: str = self._source.description
        self.license: str = self._source.license
        self.parameters: dict[str, dict[str, Any]] = {row["name"]: row for row in self._source.parameters()}
        self.events: dict[str, dict[str, Any]] = {row["name"]: row for row in self._source.events()}
        self.outputs: dict[str, dict[str, Any]] = {row["name"]: row for row in self._source.outputs()}
        self.presets: dict[str, dict[str, float]] = {name: dict(zip(self.parameters, values)) for name, values in self._source.presets().items()}

    def __getstate__(self) -> tuple[tuple[str, bool], str]:
        return self._made_of

    def __setstate__(self, made_of: tuple[tuple[str, bool], str]) -> None:
        self._make(*made_of)

    def play(self, events: Event | Iterable[Event] = (), seconds: float = 1.0, *, sample_rate_hz: float = 44100,
             parameters: Mapping[str, npt.ArrayLike] | None = None, outputs: str | Iterable[str] | None = None,
             force: bool = True, energy_step: int = 0, precision: str = "double",
             tuning: npt.ArrayLike | None = None, oversample: int = 1) -> Sound:
        """Plays events (strike, pluck, note, ...; one or a list). Returns a Sound.

        parameters: values by name, each a number or an array of values over the whole time, within their ranges. outputs: the names of those
        that are computed (default: all); "force_n" is the sum of the contact forces. energy_step: samples between two energies; 0: none. precision: "double" or
        "single". tuning: cents of the 128 keys of MIDI, as read_tuning() gives; NaN: the key does not sound.
        oversample: 1, 2, 4 or 8: runs at so many times the rate, for contacts that are too short for it.
        """
        play = {"double": self._source.play_double, "single": self._source.play_single}.get(precision)
        if play is None:
            raise _core.Error(f"precision: '{precision}' is unknown; allowed: double, single")
        if oversample not in _core.oversamplings:
            raise _core.Error(f"oversample: {oversample} is refused; allowed: {', '.join(map(str, _core.oversamplings))}")
        check_rate(oversample * sample_rate_hz)
        samples = _samples(seconds, sample_rate_hz)
        wanted = list(self.outputs) if outputs is None else [outputs] if isinstance(outputs, str) else list(outputs)
        numbers = [self._output(name) for name in wanted]
        if not wanted:
            raise _core.Error(f"{self.name}: outputs: is empty; allowed: one or more of {', '.join(self._all_outputs())}")
        is_force_wanted = len(self.outputs) in numbers
        energy_step = operator.index(energy_step)
        if energy_step < 0:
            raise _core.Error(f"energy_step: {energy_step} is refused; allowed: 0 or more samples")
        curves = {self._number(name): self._curve(name, values, samples) for name, values in (parameters or {}).items()}
        initial = [(number, values[0][1]) for number, values in curves.items()]
        rows = [(sample, _SET, number, value, 0.0) for number, values in curves.items() for sample, value in values[1:]]
        rows = self._rows(events, rows, samples, sample_rate_hz, parameters or {})
        played, forces, energies = play(initial, rows, samples, sample_rate_hz,
                                        [number in numbers for number in range(len(self.outputs))],
                                        force or is_force_wanted, energy_step, [] if tuning is None else np.asarray(tuning, float).tolist(), int(oversample))
        late = self._source.latency(int(oversample))
        arrays = [array[late:] for array in (*played, forces)]
        sounds = {name: arrays[number] for number, name in enumerate(self._all_outputs()) if number in numbers}
        units = {name: self.outputs[name]["unit"] if name in self.outputs else "N" for name in sounds}
        return Sound(self.description or self.name, sounds, units, sample_rate_hz,
                     arrays[-1] if force or is_force_wanted else None,
                     energies[:samples // energy_step] if energy_step else None, energy_step)

    def _all_outputs(self):
        """The names of all that play and render_many record, in the order of the compiled part."""
        return [*self.outputs, *([] if _FORCE in self.outputs else [_FORCE])]

    def _output(self, name):
        """The number of an output."""
        if name not in self._all_outputs():
            raise _core.Error(f"{self.name}: outputs: '{name}' is unknown; allowed: {', '.join(self._all_outputs())}")
        return self._all_outputs().index(name)

    def _find(self, what, name):
        if name not in getattr(self, what):
            raise _core.Error(f"{self.name}: {what}: '{name}' is unknown; allowed: {', '.join(getattr(self, what))}")
        return getattr(self, what)[name]

    def _number(self, parameter):
        self._find("parameters", parameter)
        return list(self.parameters).index(parameter)

    def _check(self, parameter, low, high):
        """Refuses values of a parameter, from low to high, that are out of its range."""
        row = self._find("parameters", parameter)
        for value in (low, high):
            if not row["min"] <= value <= row["max"]:
                raise _core.Error(f"{self.name}: {parameter}: {value} is refused; allowed: {row['min']:g} to {row['max']:g} "
                                 f"{row['unit']}, such as {row['initial']:g}")

    def _rows(self, events, rows, samples, rate, parameters):
        """These rows and all that happens, by time: (sample, action, number, value, rise)."""
        rows = list(rows)
        events = [events] if isinstance(events, (Event, str)) else list(events)
        for event in events:
            if not isinstance(event, Event):
                raise _core.Error(f"{self.name}: events: {event!r} is no event; allowed: strike(0, 2), pluck(0), note(0, 60), "
                                  "release(1), change(1, NAME, VALUE)")
            rows += self._event_rows(event, rate)
            if round(event.time_s * rate) > samples:
                raise _core.Error(f"{self.name}: the time {event.time_s:g} s of an event is behind the end; allowed: 0 to "
                                  f"{samples / rate:g} s, or more seconds")
        self._refuse_unheard(events, parameters)
        return sorted((row for row in rows if row[0] < samples), key=lambda row: row[0])

    def _refuse_unheard(self, events, parameters):
        """Refuses a parameter whose value nobody hears, as each blow or pluck has a value of its own."""
        blows = [(self._event_of(event)["parameter"], event.value) for event in events if event.action in (_STRIKE, _PLUCK, _BOW)]
        for name in parameters:
            values = [value for parameter, value in blows if parameter == name]
            if values and None not in values and all(event.action in _PLAYED for event in events):
                raise _core.Error(f"{self.name}: {name}: changes nothing, as each event has a value of its own; allowed: "
                                 "events without one, such as strike(0) or pluck(0)")

    def _curve(self, name, values, samples):
        """Where the values change: (sample, value)."""
        values = np.atleast_1d(np.asarray(values, float))
        if values.ndim > 1 or not 1 <= len(values) <= samples or not np.all(np.isfinite(values)):
            raise _core.Error(f"{self.name}: {name}: is no number and no array over time; allowed: 1 to {samples} finite values")
        self._check(name, values.min(), values.max())
        begins = np.arange(len(values)) * samples // len(values)
        changes = np.flatnonzero(np.diff(values, prepend=math.nan))
        return [(float(begins[i]), float(values[i])) for i in changes]

    def _event_rows(self, event, rate):
        if not (0 <= event.time_s <= 3600 and event.hold_s >= 0):
            raise _core.Error(f"{self.name}: an event's time {event.time_s} or hold {event.hold_s} is refused; "
                             "allowed: 0 to 3600 seconds, and 0 or more")
        number = self._event_number(event)
        value = math.nan if event.value is None else float(event.value)  # NaN: the parameter's
        rows = [(float(round(event.time_s * rate)), event.action, number, value, float(event.rise_s))]
        ends = {_STRIKE: _RELEASE, _NOTE_ON: _NOTE_OFF, _BOW: _BOW}.get(event.action)
        if ends is not None and math.isfinite(event.hold_s):
            rows.append((float(round(min(event.time_s + event.hold_s, 7200) * rate)), ends, number, 0.0, 0.0))
        return rows

    def _event_number(self, event):
        """The number of its event, key or parameter; its value must be allowed for that."""
        if event.action == _SET:
            self._check(event.number, event.value, event.value)
            return self._number(event.number)
        if event.action in (_NOTE_ON, _NOTE_OFF):
            if not (0 <= operator.index(event.number) <= 127 and 0 <= event.value <= 1):
                raise _core.Error(f"{self.name}: key {event.number} with velocity {event.value} is refused; allowed: "
                                 "keys 0 to 127 and velocities 0 to 1, such as 60 and 0.8")
            return operator.index(event.number)
        row = self._event_of(event)
        if event.action == _PLUCK and not 1e-5 <= event.rise_s <= 1:
            raise _core.Error(f"{self.name}: rise_s: {event.rise_s} is refused; allowed: 1e-05 to 1, such as 0.004")
        if event.action != _RELEASE and event.value is not None:
            self._check(row["parameter"], event.value, event.value)
        return row["number"]

    def _event_of(self, event):
        """The row of a blow, a pluck or a bow."""
        kind = _PLAYED[event.action]
        names = [name for name, row in self.events.items() if row["kind"] == kind]
        name = names[event.number] if isinstance(event.number, int) and 0 <= event.number < len(names) else event.number
        if name not in names:
            others = [name for name, row in self.events.items() if row["kind"] != kind]
            raise _core.Error(f"{self.name}: {kind}: {event.number!r} is unknown; allowed: {', '.join(names)}" if names else
                              f"{self.name}: {kind}: it has none; allowed: "
                              + (f"{self.events[others[0]]['kind']}, for {', '.join(others)}" if others else "note"))
        return self.events[name]

    def __repr__(self) -> str:
        return f"<Instrument {self.name}: {self.description}>"

    def _repr_html_(self) -> str:
        rows = [(row["name"], f"{row['initial']:g} {row['unit']}, {row['min']:g} to {row['max']:g}")
                for row in self.parameters.values()]
        return table_html(self.description or self.name, rows)


def render_many(instrument: Instrument, parameters: Mapping[str, npt.ArrayLike], events: Event | Iterable[Event] = (),
                seconds: float = 1.0, *, sample_rate_hz: float = 44100, output: str | None = None,
                precision: str = "single", threads: int | None = None, out: npt.NDArray[np.float32] | None = None,
                progress: Callable[[int, int], object] | None = None) -> npt.NDArray[np.float32]:
    """Renders an instrument once for each row of parameters, on all cores. Returns float32 samples, (rows, samples).

    parameters: a dict from names to arrays of the same length. events: what every row plays; strike(0) takes the speed
    that the row has. output: a name (default: the first), "force_n" among them. out: where the samples go, for instance
    a numpy.memmap; default: a new array. The samples of a row do not depend on the other rows, their order or the number of threads. progress(done, total) is called about ten times
    a second, and at the end.
    """
    if not isinstance(instrument, Instrument):
        raise _core.Error(f"instrument: {instrument!r} is none; allowed: an Instrument, such as Instrument(\"tom\")")
    if precision not in ("single", "double"):
        raise _core.Error(f"precision: '{precision}' is unknown; allowed: single, double")
    samples = _samples(seconds, sample_rate_hz)
    if not isinstance(parameters, Mapping):
        raise _core.Error("parameters: is no dict; allowed: arrays of one and the same length by name")
    columns = [np.asarray(values, float) for values in parameters.values()]
    if not columns or any(column.ndim != 1 or len(column) != len(columns[0]) for column in columns):
        shapes = ", ".join(f"{name} has the shape {column.shape}" for name, column in zip(parameters, columns)) or "there is none"
        raise _core.Error(f"parameters: are no columns: {shapes}; allowed: arrays of one and the same length by name, "
                          "such as {\"speed_m_per_s\": [1, 2]}")
    values = np.ascontiguousarray(np.stack(columns, axis=1))
    for name, column in zip(parameters, columns):
        if len(column):
            instrument._check(name, column.min(), column.max())
    shape = (len(values), samples)
    if out is None:
        out = np.empty(shape, np.float32)
    elif (not isinstance(out, np.ndarray) or out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous
          or not out.flags.writeable):
        raise _core.Error(f"out: is no array for this; allowed: float32, C order, writable, {shape}")
    number = 0 if output is None else instrument._output(output)
    play = instrument._source.play_many_single if precision == "single" else instrument._source.play_many_double
    play([instrument._number(name) for name in parameters], values, instrument._rows(events, [], samples, sample_rate_hz, parameters),
         sample_rate_hz, number, out, threads_of(threads), watch_of(progress, len(values)))
    return out


def _samples(seconds, sample_rate_hz):
    check_rate(sample_rate_hz)
    if not 0 < seconds <= 3600:
        raise _core.Error(f"seconds: {seconds} is refused; allowed: above 0, up to 3600")
    return max(1, round(seconds * sample_rate_hz))
