"""Methods and their stable regions in the X-Y plane, X = hd and Y = h²k."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _core


class Method:
    """A time-stepping method: by name, with parameters if it has any (``Method("newmark:beta=0.25,gamma=0.5")``),
    from a method file (``Method("mine.json")``), or from what such a file holds, as a dictionary.

    Raises ValueError for a name, a parameter or a key that is not known, and for an inconsistent tableau.

    >>> Method("rk4").order
    4
    >>> ralston = Method({"name": "ralston", "kind": "runge-kutta", "A": [[], ["2/3"]], "b": ["1/4", "3/4"]})
    >>> ralston.order
    2
    """

    def __init__(self, method: Union[str, os.PathLike, Mapping[str, Any]]):
        if isinstance(method, Mapping):
            self._method = _core.Method.of_text("method", json.dumps(dict(method), indent=1))
        elif isinstance(method, os.PathLike) or method.endswith(".json"):
            self._method = _core.Method.of_file(os.fspath(method))
        else:
            self._method = _core.Method(method)

    @property
    def name(self) -> str:
        return self._method.name

    @property
    def order(self) -> int:
        """Of accuracy in h."""
        return self._method.order

    @property
    def implicit(self) -> bool:
        """Whether a step solves a linear system."""
        return self._method.implicit

    def amplification(self, x: float, y: float) -> np.ndarray:
        """The (m, m) matrix of one step on one oscillator (paper Eq. 21), over (x, h v, carried …)."""
        return self._method.amplification(x, y)

    def __str__(self) -> str:
        return self.name

    def __repr__(self) -> str:
        return f"Method({self.name!r})"

    def __eq__(self, other) -> bool:
        return isinstance(other, Method) and self._method == other._method

    def __hash__(self) -> int:
        return hash(self.name)


AnyMethod = Union[str, os.PathLike, Mapping[str, Any], Method]


def as_method(method: AnyMethod) -> Method:
    return method if isinstance(method, Method) else Method(method)


def methods() -> List[Method]:
    """Every built-in method, first those that tables show where none is named."""
    shown, more = _core.methods()
    return [Method(m.name) for m in [*shown, *more]]


@dataclass(frozen=True)
class BoundaryArc:
    """A smooth piece of the boundary: points in order, and which ``condition`` binds there: "complex_pair",
    "lambda=1", "lambda=-1" or "window"."""

    condition: str
    x: np.ndarray = field(repr=False)
    y: np.ndarray = field(repr=False)


@dataclass(frozen=True)
class Region:
    """Where every eigenvalue of a method's step lies in the unit disk.

    ``y_max``
        The largest Y = h²k, at X = ``x_at_y_max``; inf where unbounded.
    ``y_max_attained``
        Whether powers stay bounded at that point itself.
    ``real_interval``, ``imaginary_interval``
        The reach along X at Y = 0, and √ of that along Y at X = 0.
    """

    method: Method
    y_max: float
    x_at_y_max: Optional[float]
    y_max_attained: bool
    real_interval: float
    imaginary_interval: float

    def boundary(self, window: Optional[Tuple[float, float, float, float]] = None) -> List[BoundaryArc]:
        """The exact boundary in ``window`` = (x_min, x_max, y_min, y_max); by default all of it."""
        return [BoundaryArc(*arc) for arc in self.method._method.boundary(window)]

    def spectral_radius(self, x, y) -> np.ndarray:
        """ρ of the step at each (x, y): arrays of one shape, or that broadcast."""
        x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        return self.method._method.spectral_radius(x, y)

    def critical_step(self, k: float, d: float = 0.0) -> float:
        """The largest h [s] below which the mode k [1/s²], d [1/s] is stable; inf where nothing limits it."""
        return self.method._method.critical_step(k, d)


def region(method: AnyMethod) -> Region:
    """The stable region of a method: whatever :class:`Method` takes.

    >>> rk4 = region("rk4")
    >>> round(rk4.imaginary_interval, 9)
    2.828427125
    >>> rk4.critical_step(100.0) == rk4.imaginary_interval / 10
    True
    """
    method = as_method(method)
    return Region(method=method, **method._method.constants())
