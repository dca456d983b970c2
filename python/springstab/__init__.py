"""The largest stable time step of each method, for your matrices or your scene.

>>> import springstab as ss
>>> answer = ss.limits([[100.0, 0.0], [0.0, 400.0]])
>>> round(answer["symplectic-euler"].h_max, 12)
0.1
"""

from ._diagnose import Diagnosis, GrowthFit, Pattern, diagnose
from ._limits import (Carrier, Cheapest, Damping, Design, Limits, MassScaling, MethodLimits, StepAnswer, StiffestMode,
                      StiffestMotion, limits)
from ._own_step import MethodFit, OwnStep, largest_stable_step
from ._region import BoundaryArc, Method, Region, methods, region
from ._simulate import Simulation, simulate
from ._plot import plot_region

__all__ = [
    "BoundaryArc", "Carrier", "Cheapest", "Damping", "Design", "Diagnosis", "GrowthFit", "Limits", "MassScaling",
    "Method", "MethodFit", "MethodLimits", "OwnStep", "Pattern", "Region", "Simulation", "StepAnswer", "StiffestMode",
    "StiffestMotion", "diagnose", "largest_stable_step", "limits", "methods", "plot_region", "region", "simulate",
]
