"""What limits and simulations are asked of."""

import math
import os

import scipy.sparse

from . import _core


def _matrix(a):
    """A dense or sparse matrix as compressed columns of float64, each row at most once and in order."""
    if a is None:
        return None
    matrix = scipy.sparse.csc_matrix(a, dtype=float)
    if not matrix.has_canonical_format:
        matrix = matrix.copy()  # the caller's own stays as it is
        matrix.sum_duplicates()
    return matrix


def as_input(source, mass, damping, grid, spacing, material, pin, scale, diagonals, implicit_damping=None):
    """An input of the extension from a file's name, a grid, or matrices."""
    of_geometry = dict(grid=grid, spacing=spacing, material=material, pin=pin, scale=scale, diagonals=diagonals)
    is_file = isinstance(source, (str, os.PathLike))
    if source is None or is_file:
        if mass is not None or damping is not None or implicit_damping is not None:
            raise ValueError("M and D are matrices beside K, expected no scene")
        words = {name: "" if value is None else value for name, value in of_geometry.items()}
        words["spacing"], words["scale"] = spacing, scale
        return _core.Input(file=os.fspath(source) if is_file else "", **words)
    given = [name for name, value in of_geometry.items() if value is not None]
    if given:
        raise ValueError(f"{given[0]} is for grids and meshes, expected none beside matrices")
    return _core.Input(_matrix(source), _matrix(mass), _matrix(damping), _matrix(implicit_damping))


def positive(name, value, unit="seconds"):
    """The number, or ValueError."""
    if value is not None and not (value > 0 and math.isfinite(value)):
        raise ValueError(f"{name}: is {value:g}, expected a positive number of {unit}")
    return value
