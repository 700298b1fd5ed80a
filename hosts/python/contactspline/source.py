# SPDX-License-Identifier: MIT
"""What names, paths and objects mean for the compiled part."""

from __future__ import annotations

import json
import os
from typing import Any, Callable, Mapping

import numpy as np

from . import _core


def json_of(value: Mapping[str, Any]) -> str:
    """The text of a file with these keys. Paths are texts there, numbers and arrays of NumPy are numbers and lists."""

    def plain(one):
        if isinstance(one, (np.generic, np.ndarray)):
            return one.tolist()
        if isinstance(one, os.PathLike):
            return os.fsdecode(one)
        raise _core.Error(f"{type(one).__name__}: is no value of a file; allowed: a name, a path, a number, a list or a dict")

    return json.dumps(value, allow_nan=False, default=plain)


def source_of(source: str | os.PathLike[str] | Mapping[str, Any]) -> tuple[str, bool]:
    """The text that the compiled part reads, and whether it is the text of a file: a name, a path or a dict."""
    if isinstance(source, Mapping):
        return json_of(dict(source)), True
    return os.fspath(source), False


def threads_of(threads: int | None) -> int:
    """The number of threads; None: one for each core."""
    threads = (os.cpu_count() or 1) if threads is None else threads
    if threads < 1:
        raise ValueError(f"threads: {threads} is refused; allowed: 1 or more, such as 2")
    return threads


def watch_of(progress: Callable[[int, int], object] | None, total: int) -> Callable[[int], None]:
    """Tells progress(done, total), if there is one. An interrupt from the keyboard is raised here and stops the work."""

    def watch(done: int) -> None:
        if progress is not None:
            progress(done, total)

    return watch
