# SPDX-License-Identifier: MIT
"""What figures and notebooks share."""

from __future__ import annotations

import base64
import importlib.util
import io
from html import escape
from typing import Any, Callable, Iterable


def axes_or_new(axes: Any) -> Any:
    """These axes of matplotlib, or those of a new figure."""
    import matplotlib.pyplot as plt

    axes = plt.subplots(layout="constrained")[1] if axes is None else axes
    axes.title.set_wrap(True)
    return axes


def table_html(title: str, rows: Iterable[tuple[str, object]]) -> str:
    """A table of names and values under a title."""
    cells = "".join(f"<tr><td>{escape(str(key))}</td><td>{escape(str(value))}</td></tr>" for key, value in rows)
    return f"<b>{escape(title)}</b><table>{cells}</table>"


def figure_html(plot: Callable[[Any], object]) -> str:
    """What plot(axes) draws, as an image within the text; nothing where matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        return ""
    from matplotlib.figure import Figure  # which pyplot does not show a second time

    figure = Figure(figsize=(6, 3), layout="constrained")
    plot(figure.subplots())
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=80)
    return f'<img src="data:image/png;base64,{base64.b64encode(image.getvalue()).decode()}">'
