# SPDX-License-Identifier: MIT
# What the compiled part has for the typed one.
from typing import Any

__version__: str
shipped: dict[str, list[str]]
actions: dict[str, int]
oversamplings: tuple[int, ...]
sample_rates_hz: tuple[float, float]

class Error(ValueError): ...

def __getattr__(name: str) -> Any: ...
