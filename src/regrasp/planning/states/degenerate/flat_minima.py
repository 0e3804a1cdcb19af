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
from regrasp.planning.states.solving import Chooser

_KINDS = {Bound.NONE: 0, Bound.FORCE: 1, Bound.NORMAL: 2, Bound.MARGIN: 3}
"""The words of ``faces``."""
PATIENCE = 5_000
"""Calls of interpreted loops, at a millisecond each at most: then loading or compiling them pays."""
_calls = count()


def _refined() -> Any:
    if next(_calls) < PATIENCE:
        return face_newton.refined
    from regrasp.closed_form.compiled.least_forces import refined

    return refined


def polished(
    chooser: Chooser, objective: ConvexObjective, forces: Array, frictions: list[float], limits: list[float]
) -> Array:
    """The forces (n, w) at the minimum, or as they are where it is not found."""
    unit = float(abs(forces).max())
    if not 0 < unit < np.inf:
        return forces
    grasp = chooser.grasp
    squares, linear = objective.squares(grasp), objective.linear(grasp, unit)
    if squares is None:
        squares = np.zeros(len(grasp))
    if linear is None:
        linear = np.zeros(forces.shape)
    with np.errstate(all="ignore"):  # guesses that lead nowhere end in numbers that are none
        cones, mu, most = grasp.cones.normals, np.array(frictions), np.array(limits)
        given = (
            forces, unit, chooser.matrix, chooser.vector, cones, mu, NEGLIGIBLE, most, squares, linear,
            _KINDS[objective.bound],
        )  # fmt: skip
        refined = _refined()
        at_first = at_once.refined(*given) if refined is face_newton.refined else None
        best, is_no_worse, fits = refined(*given) if at_first is None else (at_first[0], True, at_first[1])
    if is_no_worse and fits:
        found: Array = best
        return found
    settled = chooser.settled(best, frictions, limits) if is_no_worse else None
    return forces if settled is None else settled
