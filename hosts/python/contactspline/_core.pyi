# SPDX-License-Identifier: MIT
# What the compiled part has for the typed one.
from typing import Any

__version__: str
shipped: dict[str, list[str]]
actions: dict[str, int]
sample_rates_hz: tuple[float, float]

class Error(ValueError): ...

class Impact:
    @property
    def max_compression_m(self) -> float: ...
    @property
    def contact_duration_s(self) -> float: ...
    @property
    def exit_speed_m_per_s(self) -> float: ...
    @property
    def max_force_n(self) -> float: ...

def __getattr__(name: str) -> Any: ...
