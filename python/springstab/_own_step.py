"""Your own simulator's step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, List, Optional, Tuple

import numpy as np

from . import _core
from ._input import positive
from ._region import AnyMethod, as_method, methods


@dataclass(frozen=True)
class MethodFit:
    """How far the step's eigenvalues are from those of ``method`` on the same accelerations, at the same h, and
    how large a step that method takes [s]."""

    method: str
    distance: float
    h_max: Optional[float]


@dataclass(frozen=True)
class OwnStep:
    """What a step can do.

    ``h_max``
        Every smaller step that was tried keeps the linearization's eigenvalues in the unit disk [s]; inf where
        all did, None where they leave it with the smallest steps already.
    ``leaves_at``
        The eigenvalue that leaves it, just above.
    ``fits``
        Methods, the best first.
    ``claimed``
        The fit of the method that it claims to be, if it does.
    ``is_what_it_claims``
        Whether its eigenvalues are those of that method to 1e-4.
    """

    h_max: Optional[float]
    leaves_at: complex
    fits: List[MethodFit]
    claimed: Optional[MethodFit]

    @property
    def is_what_it_claims(self) -> Optional[bool]:
        return None if self.claimed is None else self.claimed.distance < _core.same_eigenvalues

    @property
    def method_that_fits(self) -> Optional[str]:
        """The best one, if its eigenvalues are the step's to 1e-4."""
        return self.fits[0].method if self.fits and self.fits[0].distance < _core.same_eigenvalues else None


def largest_stable_step(step: Callable[[np.ndarray, np.ndarray, float], Tuple[np.ndarray, np.ndarray]], x, v,
                        claims: Optional[AnyMethod] = None, *, difference: float = 1e-6,
                        first_step: float = 1e-3) -> OwnStep:
    """The largest stable step of any integrator ``step(x, v, h) -> (x, v)``, linearized at (x, v).

    Parameters
    ----------
    step : callable
        A function of its arguments alone, which it must not change.
    x, v : (n,) arrays
        Where to linearize, as at equilibrium [m], [m/s]. At most 400 unknowns.
    claims : the method that it is meant to be
    difference : displacement of central differences, relative to the largest entry of x
    first_step : tried first [s]

    Returns
    -------
    OwnStep
        Eigenvalues within 1e-4 of 1 are motions that physics leaves neutral, and do not count.

    Examples
    --------
    >>> def step(x, v, h):
    ...     v = v - h * 100.0 * x
    ...     return x + h * v, v
    >>> mine = largest_stable_step(step, [0.0], [0.0], claims="symplectic-euler")
    >>> f"{mine.h_max:.5f}", mine.is_what_it_claims
    ('0.20000', True)
    """
    positive("difference", difference, "the size of x")
    positive("first_step", first_step)
    x, v = (np.array(a, dtype=float).ravel() for a in (x, v))
    known = methods()
    if claims is not None:
        claims = as_method(claims)
        if claims not in known:
            known.append(claims)
    found = _core.largest_stable_step(lambda *now: step(*now), x, v, [m._method for m in known], difference,
                                      first_step)
    fits = [MethodFit(**fit) for fit in found["fits"]]
    claimed = next((fit for fit in fits if claims is not None and fit.method == claims.name), None)
    if claims is not None and claimed is None:
        raise ValueError(f"claims: {claims} solves systems whose eigenvalues are not those of single modes")
    return OwnStep(h_max=found["h_max"], leaves_at=found["leaves_at"], fits=fits, claimed=claimed)
