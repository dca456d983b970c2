"""Runs of a scene or of matrices."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Callable, Optional, Tuple

import numpy as np

from . import _core
from ._input import as_input, positive
from ._region import AnyMethod, as_method


@dataclass(frozen=True)
class Simulation:
    """What a run came to.

    ``status``
        "done", "stopped" (by the callback), "diverged" (at ``diverged_at`` [s]), or why a solve failed.
    ``step``, ``steps``, ``time``
        The step at the start [s], how many were kept, the time they reached [s].
    ``energy``
        Kinetic plus potential energy at the start and at the end [J].
    ``x``, ``v``
        (n,) position [m] and velocity [m/s] of the unknowns at the end.
    ``times``, ``frames``
        (f,) times [s]; (f, vertices, 3) positions [m] of a scene's vertices, or (f, n) of matrices.
    ``faces``
        Vertices of each face, to draw a scene's frames with.
    """

    method: str
    status: str
    step: float
    steps: int
    time: float
    diverged_at: Optional[float]
    energy: Tuple[float, float]
    x: np.ndarray = field(repr=False)
    v: np.ndarray = field(repr=False)
    times: np.ndarray = field(repr=False)
    frames: np.ndarray = field(repr=False)
    faces: list = field(repr=False)

    @property
    def diverged(self) -> bool:
        return self.status == "diverged"


def simulate(K=None, M=None, D=None, *, method: AnyMethod, duration: float,
             step: Optional[float] = None, max_step: Optional[float] = None, safety: float = 1.5,
             relinearize: float = 0.01, damping: str = "own", newton: int = 1, implicit_damping=None,
             frames: int = 0, callback: Optional[Callable[[float, np.ndarray, np.ndarray], object]] = None,
             x=None, v=None, seed: int = 1, grid: Optional[str] = None, spacing: Optional[float] = None,
             material: Optional[str] = None, pin: Optional[str] = None, scale: Optional[float] = None,
             diagonals: Optional[str] = None) -> Simulation:
    """Runs ``M x'' = −K x − D v``, or a scene, for ``duration`` seconds.

    Without ``step`` the recommended one is taken, and what diverges all the same goes on with a shorter one; a
    step that is given is kept, come what may. ``frames`` positions are kept beside the first, evenly
    spaced: each the first state that is no earlier, and none twice.
    ``callback(t, x, v)`` sees every good state and stops the run by returning False. ``x`` and ``v`` are where
    matrices start (default: at rest, a random displacement of unit M-norm). ``relinearize`` is the time between
    linearizations of the linearized methods [s], ``damping="designed"`` fits a scene's alpha to the step, and
    ``newton`` is how many Newton steps an implicit step of a scene may take. The other arguments are those of
    :func:`limits`.

    Raises ValueError for what cannot be used, and where no step is stable.

    >>> run = simulate([[100.0]], method="symplectic-euler", duration=1.0, step=0.01, x=[1.0], frames=10)
    >>> run.status, run.frames.shape
    ('done', (11, 1))
    """
    for name, value in (("duration", duration), ("step", step), ("max_step", max_step),
                        ("relinearize", relinearize)):
        positive(name, value)
    if damping not in ("own", "designed"):
        raise ValueError(f"damping: is {damping!r}, expected 'own' or 'designed'")
    if not 1 <= newton <= 100:
        raise ValueError(f"newton: is {newton}, expected 1 to 100")
    of = as_input(K, M, D, grid, spacing, material, pin, scale, diagonals, implicit_damping)
    found = _core.simulate(of, as_method(method)._method, duration, step, max_step, safety, relinearize,
                           damping == "designed", newton, seed, frames, callback, x, v)
    return Simulation(faces=of.faces, **found)
