"""The largest stable step of each method."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import Dict, Iterator, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core
from ._input import as_input, positive
from ._region import AnyMethod, Method, as_method


@dataclass(frozen=True)
class StiffestMode:
    """The largest eigenvalue k0 of M⁻¹K [1/s²] and what is proved of it.

    ``value`` is None where it did not converge. ``residual`` is ‖K'v − k0 v‖ of the unit vector found, relative
    to k0. ``upper_bound`` is proved, by ``bound``: a factorization ("inertia") or "gershgorin".
    """

    value: Optional[float]
    converged: bool
    value_kind: Optional[str]
    residual: Optional[float]
    upper_bound: float
    bound: str
    smallest: Optional[float]
    products: int


@dataclass(frozen=True)
class Damping:
    """D = d0 M + alpha K where ``kind`` is "rayleigh", nothing ("none"), or any other ("general").

    ``d0`` in 1/s, ``alpha`` in s; None where two numbers do not say it.
    """

    kind: str
    d0: Optional[float]
    alpha: Optional[float]


@dataclass(frozen=True)
class Design:
    """The stiffness-proportional damping ``alpha`` [s] that makes the step ``h_max`` [s] largest, beside d0 [1/s]."""

    h_max: float
    alpha: float
    d0: float


@dataclass(frozen=True)
class MethodLimits:
    """What one method can do. Steps in seconds, ``inf`` where nothing limits them, None where none is known.

    ``status``
        "limited", "unlimited", "none" (no step is stable) or "unknown".
    ``h_max``
        Every smaller step keeps every mode bounded, with the structure's own damping; ``h_max_source`` says
        whether it is "exact" (for k0) or an "estimate" (from computed eigenvalues).
    ``h_certified``
        Proved stable; ``h_certified_source`` says by what, ``reason`` why nothing is.
    ``recommended_step``
        With the safety factor on the stiffness.
    ``designed``
        The best damping that could be fitted.
    ``h_every_pose``
        Proved for every pose of a scene of springs.
    ``transient_growth``
        How far √energy may grow at the recommended step before it decays, at least.
    """

    name: str
    status: str
    h_max: Optional[float]
    h_max_source: Optional[str]
    h_certified: Optional[float]
    h_certified_source: Optional[str]
    reason: Optional[str]
    recommended_step: Optional[float]
    designed: Optional[Design]
    h_every_pose: Optional[float]
    transient_growth: Optional[float]


@dataclass(frozen=True)
class MassScaling:
    """Mass that makes a step hold: ``particles`` maps numbers in the input to what each gets [kg].

    ``added_mass`` is their sum, ``least_added_mass`` what no such scaling can go below.
    """

    particles: Dict[int, float]
    added_mass: float
    least_added_mass: float
    proved: bool


@dataclass(frozen=True)
class StepAnswer:
    """Whether one method holds at ``step`` [s], and what alone would make it hold where it does not.

    ``holds`` is None where it is not known. ``margin`` is h_max/step. The changes: the largest factor below 1 on K,
    the range of ``alpha`` [s], the least factor above 1 on M, mass for some particles, the fewest ``substeps``.
    ``reasons`` says by their names why some of these are None.
    """

    step: float
    holds: Optional[bool]
    margin: Optional[float]
    proved: bool
    stiffness_factor: Optional[float]
    alpha: Optional[Tuple[float, float]]
    uniform_mass_factor: Optional[float]
    mass_scaling: Optional[MassScaling]
    substeps: Optional[int]
    reasons: Dict[str, str]


@dataclass(frozen=True)
class Carrier:
    """An element (or where there are none an unknown) that carries the stiffest mode.

    ``share`` of the mode's energy, ``stiffness`` its largest eigenvalue [N/m], ``mass`` of its free particles [kg].
    """

    kind: str
    index: int
    share: float
    vertices: Sequence[int]
    stiffness: float
    mass: float


@dataclass(frozen=True)
class StiffestMotion:
    """What decides the step: the ten ``carriers`` of most of the stiffest mode's energy, and that ``mode``, (n,).

    ``nodal_bound`` and ``element_bound`` are the bounds on k0 [1/s²] that explicit finite-element codes run with.
    """

    carriers: Sequence[Carrier]
    mode: np.ndarray
    nodal_bound: Optional[float]
    element_bound: Optional[float]


@dataclass(frozen=True)
class Cheapest:
    """The method and the step [s] that cost least CPU time for an error, and why; ``error`` is predicted over
    ``error_over`` [s]."""

    method: Optional[str]
    step: Optional[float]
    cpu_seconds_per_second: Optional[float]
    error: Optional[float]
    error_over: Optional[float]
    reason: str


@dataclass(frozen=True)
class Limits(Mapping[str, MethodLimits]):
    """The answer for a structure: a mapping from the names of methods to :class:`MethodLimits`."""

    degrees_of_freedom: int
    condensed: int
    symmetric: bool
    stiffness_indefinite: bool
    growth_rate: Optional[float]
    k0: StiffestMode
    damping: Damping
    safety: float
    methods: Dict[str, MethodLimits]
    for_step: Optional[Dict[str, StepAnswer]] = None
    stiffest: Optional[StiffestMotion] = None
    cheapest: Optional[Cheapest] = None

    def __getitem__(self, name: Union[str, Method]) -> MethodLimits:
        return self.methods[str(name)]

    def __iter__(self) -> Iterator[str]:
        return iter(self.methods)

    def __len__(self) -> int:
        return len(self.methods)

    def _rows(self):
        def cell(h):
            return "-" if h is None else f"{h:.6g}"

        for m in self.methods.values():
            yield m.name, m.status, cell(m.h_max), cell(m.h_certified), cell(m.recommended_step)

    _head = ("method", "status", "h_max [s]", "certified [s]", "to use [s]")

    def _title(self):
        k0 = "k0 not converged" if self.k0.value is None else f"k0 = {self.k0.value:.10g} 1/s²"
        return f"{self.degrees_of_freedom} unknowns, {k0}, damping: {self.damping.kind}"

    def __repr__(self) -> str:
        rows = [self._head, *self._rows()]
        widths = [max(len(row[i]) for row in rows) for i in range(len(self._head))]
        lines = ("  ".join(c.ljust(w) if i < 2 else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths)))
                 for row in rows)
        return "\n".join([self._title(), *(line.rstrip() for line in lines)])

    def _repr_html_(self) -> str:
        def row(cells, tag):
            return "<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in cells) + "</tr>"

        body = "".join(row(cells, "td") for cells in self._rows())
        return (f"<table><caption>{html.escape(self._title())}</caption>"
                f"<thead>{row(self._head, 'th')}</thead><tbody>{body}</tbody></table>")


def limits(K=None, M=None, D=None, *, methods: Sequence[AnyMethod] = (), safety: float = 1.5,
           max_step: float = 0.01, certify: bool = True, digits: Optional[int] = None,
           certify_loss: float = 1e-3, for_step: Optional[float] = None, error: Optional[float] = None,
           stiffest: bool = False, implicit_damping=None, seed: int = 1, grid: Optional[str] = None,
           spacing: Optional[float] = None, material: Optional[str] = None, pin: Optional[str] = None,
           scale: Optional[float] = None, diagonals: Optional[str] = None) -> Limits:
    """The largest stable step of each method for ``M x'' = −K x − D v``, or for a scene.

    Parameters
    ----------
    K : (n, n) array or sparse matrix, or path
        Stiffness [N/m], or the file of a scene or a mesh. With ``grid="NxM"`` nothing.
    M, D : (n, n) array or sparse matrix, optional
        Mass [kg] (default: 1) and damping [kg/s] (default: none).
    methods : whatever :class:`Method` takes, each; default: those of the command
    safety : factor >= 1 on the stiffness, for the recommended steps
    max_step : recommended where nothing limits the step [s]
    certify : False leaves out every proof, which is quicker
    digits : of h, 1 to 10; default: all, or 4 from 20 000 unknowns on
    certify_loss : part of h that a proof by pieces of a large system may lose
    for_step : a wanted step [s], optional
        Whether each method holds there, and what would make it hold.
    error : between 0 and 1, optional
        The cheapest method and step for this error, relative to what moves.
    stiffest : True for what carries the stiffest mode
    implicit_damping : (n, n) array or sparse matrix, optional
        More of D [kg/s]: what implicit-damping-euler takes implicitly (default: all of D).
    grid, spacing, material, pin, scale, diagonals
        As the command's options of these names.

    Returns
    -------
    Limits
        Exact for Rayleigh damping and for symplectic Euler with any; else from all eigenvalues of the motion
        where they were computed. A step that is certified is stable also in exact arithmetic.

    Raises
    ------
    ValueError
        In the command's words, for what cannot be used.

    Examples
    --------
    >>> import scipy.sparse
    >>> chain = 1e4 * scipy.sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(50, 50))
    >>> answer = limits(chain)
    >>> f"{answer['symplectic-euler'].h_max:.6f}"
    '0.010005'
    >>> answer["implicit-euler"].status
    'unlimited'
    >>> wanted = limits(chain, methods=["symplectic-euler"], for_step=1 / 60).for_step["symplectic-euler"]
    >>> wanted.holds, wanted.substeps, f"{wanted.stiffness_factor:.4f}"
    (False, 2, '0.3603')
    """
    positive("max_step", max_step)
    positive("for_step", for_step)
    if error is not None and not 0 < error < 1:
        raise ValueError(f"error: is {error:g}, expected more than 0 and less than 1")
    if digits is not None and not 1 <= digits <= 10:
        raise ValueError(f"digits: is {digits}, expected 1 to 10")
    if not 1e-5 <= certify_loss < 1:
        raise ValueError(f"certify_loss: is {certify_loss:g}, expected at least 1e-5 and less than 1")
    of = as_input(K, M, D, grid, spacing, material, pin, scale, diagonals, implicit_damping)
    found = _core.limits(of, [as_method(m)._method for m in methods], safety, max_step, seed, certify, digits or 0,
                         certify_loss, for_step, error, stiffest)
    found["k0"] = StiffestMode(**found["k0"])
    found["damping"] = Damping(**found["damping"])
    for one in found["methods"].values():
        one["designed"] = one["designed"] and Design(*one["designed"])
    found["methods"] = {name: MethodLimits(**one) for name, one in found["methods"].items()}
    for one in (found["for_step"] or {}).values():
        one["mass_scaling"] = one["mass_scaling"] and MassScaling(**one["mass_scaling"])
    found["for_step"] = found["for_step"] and {name: StepAnswer(**one) for name, one in found["for_step"].items()}
    if found["stiffest"]:
        found["stiffest"]["carriers"] = [Carrier(**one) for one in found["stiffest"]["carriers"]]
        found["stiffest"] = StiffestMotion(**found["stiffest"])
    found["cheapest"] = found["cheapest"] and Cheapest(**found["cheapest"])
    return Limits(**found)
