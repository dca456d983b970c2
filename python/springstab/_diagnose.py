"""A run that blew up, of any simulator."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import List, Optional, Sequence

import numpy as np

from . import _core
from ._input import as_input, positive
from ._region import AnyMethod, as_method
from ._region import methods as all_methods


@dataclass(frozen=True)
class GrowthFit:
    """A method on the growing pattern: its ``factor`` of a step, the one nearest to the run's, and how far that is
    away, ``distance`` = |log Λ/λⁿ|/n for frames every n steps.

    ``stiffness`` is the part of the pattern's at which the factors are nearest, ``step_over_limit`` the run's step
    over the structure's h_max; None where the method does not fit or has no limit.
    """

    method: str
    step_over_limit: Optional[float]
    factor: complex
    distance: float
    stiffness: float
    fits: bool


@dataclass(frozen=True)
class Pattern:
    """What the structure makes of the pattern: its Rayleigh quotients ``stiffness`` [1/s²] and ``damping`` [1/s],
    the part ``of_stiffest`` mode's k0, and the cosine with that mode (None where masses are coupled)."""

    stiffness: float
    damping: float
    of_stiffest: float
    overlap_with_stiffest_mode: Optional[float]


@dataclass(frozen=True)
class Diagnosis:
    """What grows in a run.

    ``status``
        "growing", "no growth", or "too fast": it blew up, over too few frames for a factor.
    ``frames``, ``used``
        How many there are, and how many come before the first that is not finite.
    ``grows_from``, ``grows_to``
        Frames, from 0, over which the pattern follows its factor.
    ``factor``
        Of a step; negative: alternating, complex: ringing, positive: buckling or contact. None where frames are
        further apart than a step and no method says how often it turns in between; ``frame_factor`` is that of a
        frame.
    ``e_foldings``, ``residual``
        Over how many it was followed, and what the frames have besides, relative.
    ``vertices``, ``shares``
        The ten with most of the pattern, from 0, and their parts of its square.
    ``shape``
        The pattern itself, complex, over the numbers of a frame; in the frames it is Re(c Λⁿ shape).
    ``pattern``, ``methods``
        Where a structure was given.
    """

    status: str
    frames: int
    used: int
    step: float
    every: int
    grows_from: Optional[int]
    grows_to: Optional[int]
    factor: Optional[complex]
    frame_factor: Optional[complex]
    e_foldings: Optional[float]
    residual: Optional[float]
    vertices: List[int]
    shares: List[float] = field(repr=False)
    shape: Optional[np.ndarray] = field(repr=False)
    pattern: Optional[Pattern]
    methods: List[GrowthFit] = field(repr=False)

    @property
    def fits(self) -> Optional[GrowthFit]:
        """The method that grows by this factor at this step, if one does."""
        return self.methods[0] if self.methods and self.methods[0].fits else None


def diagnose(frames, h: float, K=None, M=None, D=None, *, every: int = 1,
             methods: Optional[Sequence[AnyMethod]] = None, grid: Optional[str] = None,
             spacing: Optional[float] = None, material: Optional[str] = None, pin: Optional[str] = None,
             scale: Optional[float] = None, diagonals: Optional[str] = None) -> Diagnosis:
    """Since when a run grows, by what factor a step, where, and of which method that is.

    Parameters
    ----------
    frames : (frames, vertices, 3) or (frames, numbers) array
        Positions [m], of any simulator. What is not finite at the end is left out.
    h : the step of the run [s]
    every : steps from one frame to the next
    methods : those to compare with; default: all
    K, M, D, grid, spacing, material, pin, scale, diagonals
        The run's structure, as of :func:`limits`; without it only what the frames alone say.

    Raises
    ------
    ValueError
        For arrays of other shapes, and frames of another size than the structure's.

    Examples
    --------
    A mode of 100 1/s² by symplectic Euler, at 1.1 of its limit of 0.2 s, after a start of 1e-9:

    >>> x, v, frames = 1e-9, 0.0, []
    >>> for _ in range(40):
    ...     frames.append([x])
    ...     v -= 0.22 * 100 * x
    ...     x += 0.22 * v
    >>> found = diagnose(frames, 0.22, [[100.0]])
    >>> found.status, f"{found.factor:.3f}", found.fits.method, f"{found.fits.step_over_limit:.3f}"
    ('growing', '-2.428+0.000j', 'symplectic-euler', '1.100')
    """
    positive("h", h)
    if every < 1:
        raise ValueError(f"every: is {every}, expected at least 1")
    words = dict(grid=grid, spacing=spacing, material=material, pin=pin, scale=scale, diagonals=diagonals)
    given = [value for value in (K, M, D, *words.values()) if value is not None]
    of = as_input(K, M, D, **words) if given else None
    known = all_methods() if methods is None else [as_method(m) for m in methods]
    found = _core.diagnose(frames, h, every, of, [m._method for m in known])
    found["pattern"] = found["pattern"] and Pattern(**found["pattern"])
    found["methods"] = [GrowthFit(**one) for one in found["methods"]]
    return Diagnosis(**found)
