"""Forces of a least cost, polished: a tolerance on the objective leaves its square root on the forces.

Newton's method on the conditions of optimality does it (``closed_form.least``), for the convex
objectives over exact cones: at once, in arrays, where the constraints nearly touched are the right ones, else
in loops that search for those. Forces are taken only if they are no worse.
"""

from itertools import count
from typing import Any

import numpy as np

from regrasp.closed_form.least import at_once, face_newton
from regrasp.mechanics.checks import Array
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.planning.states.objectives import Bound, ConvexObjective
from regrasp.planning.states.solving import Chooser, Polish

_KINDS = {Bound.NONE: 0, Bound.FORCE: 1, Bound.NORMAL: 2, Bound.MARGIN: 3}
"""The words of ``faces``."""
PATIENCE = 5_000
"""Calls of arrays or interpreted loops, at a millisecond each at most: then compiled ones pay."""
_calls = count()


def _refined() -> Any:
    from regrasp.closed_form.compiled.least_forces import refined

    return refined


def at_first_sight(
    chooser: Chooser, objective: ConvexObjective, forces: Array, frictions: list[float], limits: list[float]
) -> Array | None:
    """The forces (n, w) at the minimum, in equilibrium inside cones and limits, of the face in sight.

    None where that is not the right one, and where compiled loops are faster: in space, and for peaks.
    """
    is_plain = chooser.grasp.dimension == 2 and objective.bound in (Bound.NONE, Bound.NORMAL)
    if not is_plain and next(_calls) >= PATIENCE:
        return None
    given = _given(chooser, objective, forces, frictions, limits)
    if given is None:
        return None
    with np.errstate(all="ignore"):  # guesses that lead nowhere end in numbers that are none
        found = at_once.refined(*given)
    return found[0] if found is not None and found[1] else None


def polished(
    chooser: Chooser, objective: ConvexObjective, forces: Array, frictions: list[float], limits: list[float]
) -> Array:
    """The forces (n, w) at the minimum, or as they are where it is not found."""
    given = _given(chooser, objective, forces, frictions, limits)
    if given is None:
        return forces
    refined = face_newton.refined if next(_calls) < PATIENCE else _refined()
    with np.errstate(all="ignore"):
        best, is_no_worse, fits = refined(*given)
    if is_no_worse and fits:
        found: Array = best
        return found
    settled = chooser.settled(best, frictions, limits) if is_no_worse else None
    return forces if settled is None else settled


POLISH = Polish(at_first_sight, polished)
"""For ``Chooser.best``."""


def _given(
    chooser: Chooser, objective: ConvexObjective, forces: Array, frictions: list[float], limits: list[float]
) -> tuple[Any, ...] | None:
    """The arguments of ``face_newton.refined``; None where forces have no size."""
    unit, grasp = float(abs(forces).max()), chooser.grasp
    if not 0 < unit < np.inf:
        return None
    squares, linear = objective.squares(grasp), objective.linear(grasp, unit)
    return (
        forces, unit, chooser.matrix, chooser.vector, grasp.cones.normals, np.array(frictions), NEGLIGIBLE,
        np.array(limits), np.zeros(len(grasp)) if squares is None else squares,
        np.zeros(forces.shape) if linear is None else linear, _KINDS[objective.bound],
    )  # fmt: skip
