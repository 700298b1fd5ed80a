# SPDX-License-Identifier: MIT
"""What names, paths, objects and threads mean for the compiled part, and files that are written as a whole."""

from __future__ import annotations

import contextlib
import json
import operator
import os
import secrets
from typing import Any, Callable, Mapping

import numpy as np

from . import _core


_MAX_THREADS = 1024  # as the program has it


def json_of(value: Mapping[str, Any]) -> str:
    """The text of a file with these keys. Paths are texts there, numbers and arrays of NumPy are numbers and lists."""

    def plain(one):
        if isinstance(one, (np.generic, np.ndarray)):
            return one.tolist()
        if isinstance(one, os.PathLike):
            return os.fsdecode(one)
        raise _core.Error(f"{type(one).__name__}: is no value of a file; allowed: a name, a path, a number, a list or a dict")

    try:
        return json.dumps(value, allow_nan=False, default=plain)
    except ValueError as error:  # of a number that is not finite
        raise error if isinstance(error, _core.Error) else _core.Error(f"{error}; allowed: finite numbers") from None


def source_of(source: str | os.PathLike[str] | Mapping[str, Any]) -> tuple[str, bool]:
    """The text that the compiled part reads, and whether it is the text of a file: a name, a path or a dict."""
    if isinstance(source, Mapping):
        return json_of(dict(source)), True
    path = os.fsdecode(source)
    if "\0" in path:
        raise _core.Error(f"{path!r}: has a character of value 0; allowed: a name or a path")
    return path, False


def check_rate(sample_rate_hz: float) -> None:
    """Refuses a rate that nothing plays at."""
    low, high = _core.sample_rates_hz
    if not low <= sample_rate_hz <= high:
        raise _core.Error(f"sample_rate_hz: {sample_rate_hz} is refused; allowed: {low:.0f} to {high:.0f}")


def threads_of(threads: int | None) -> int:
    """The number of threads; None: one for each core that this process may use."""
    if threads is None:
        threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        return min(threads, _MAX_THREADS)
    if not 1 <= operator.index(threads) <= _MAX_THREADS:
        raise _core.Error(f"threads: {threads} is refused; allowed: 1 to {_MAX_THREADS}, such as 2")
    return operator.index(threads)


def watch_of(progress: Callable[[int, int], object] | None, total: int) -> Callable[[int], None]:
    """Tells progress(done, total), if there is one. Ctrl-C is raised here and stops the work."""

    def watch(done: int) -> None:
        if progress is not None:
            progress(done, total)

    return watch


def write_whole(path: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file, which is there as a whole or stays as it was. Its folder must exist."""
    folder = os.path.dirname(os.fsdecode(path))
    if not os.path.isdir(folder or "."):
        raise FileNotFoundError(f"{os.fsdecode(path)}: its folder {folder} does not exist; allowed: a folder that exists")
    part = os.path.join(folder, f".contactspline-{secrets.token_hex(8)}")
    with open(part, "xb") as file:  # which is no file of somebody else, and follows no link
        try:
            file.write(content)
            file.close()
            os.replace(part, path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.remove(part)
            raise
