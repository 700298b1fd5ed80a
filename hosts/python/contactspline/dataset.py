# SPDX-License-Identifier: MIT
"""Data sets: thousands of samples of an instrument in HDF5 files."""

from __future__ import annotations

import os
from typing import Any, Callable, Mapping

from . import _core
from .source import source_of, threads_of


def dataset(plan: str | os.PathLike[str] | Mapping[str, Any], folder: str | os.PathLike[str], *, shards: int = 1,
            shard: int | None = None, threads: int | None = None, force: bool = False,
            report: Callable[[str], object] | None = None) -> str:
    """Renders the samples of a plan into HDF5 files in a folder, as `contactspline dataset` does. Returns a path.

    plan: the path of a plan, or a dict with its keys. shards: number of files; a further one joins them, whose path is
    returned. shard: 1 to shards writes this one alone and returns its path. Whole shards that are there are kept; force
    also replaces those of other plans. report takes the lines that the program prints.
    """
    if not 1 <= shards <= 99999 or not (shard is None or 1 <= shard <= shards):
        raise _core.Error(f"shards, shard: {shards}, {shard} are refused; allowed: 1 to 99999, and 1 to shards or None")
    tell = report if report is not None else (lambda line: None)
    text, is_text = source_of(plan)
    return _core.dataset(text, is_text, os.fspath(folder), shards, shard or 0, threads_of(threads), force,
                         lambda line: tell(line.rstrip("\n")))
