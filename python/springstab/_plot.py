"""Regions drawn with matplotlib."""

from __future__ import annotations

from typing import Optional, Tuple, Union

from ._region import AnyMethod, Region, region

_styles = {"complex_pair": "-", "lambda=-1": "--", "lambda=1": ":"}


def plot_region(method: Union[AnyMethod, Region], ax=None,
                window: Optional[Tuple[float, float, float, float]] = None, **line):
    """Draws the exact boundary of a method's stable region; returns the axes.

    Solid where a complex pair of eigenvalues leaves the unit disk, dashed where one does at −1, dotted at 1.
    ``line`` goes to ``Axes.plot``.
    """
    import matplotlib.pyplot as plt

    found = method if isinstance(method, Region) else region(method)
    if ax is None:
        ax = plt.figure(layout="constrained").gca()
        ax.set_xlabel("X = h d")
        ax.set_ylabel("Y = h² k")
    line.setdefault("color", ax._get_lines.get_next_color() if "color" not in line else None)
    label = found.method.name
    for arc in found.boundary(window):
        if arc.condition in _styles:
            ax.plot(arc.x, arc.y, _styles[arc.condition], label=label, **line)
            label = None
    ax.legend()
    return ax
