"""Forces of a least cost, polished: a tolerance on the objective leaves its square root on the forces.

Newton's method on the conditions of optimality does it (``closed_form.least``), for the convex
objectives over exact cones: at once, in arrays, where the constraints nearly touched are the right ones, else
in loops that search for those. Forces are taken only if they are no worse.
"""

from itertools import count
from typing import Any, NamedTuple

import numpy as np

from regrasp.closed_form.least import at_once, by_duals, face_newton
from regrasp.closed_form.least.face_newton import INSIDE
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import NEGLIGIBLE
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.value import kept
from regrasp.planning.states.objectives import Bound, ConvexObjective
from regrasp.planning.states.solving import Chooser, Polish
from regrasp.programs import Solution

_KINDS = {Bound.NONE: 0, Bound.FORCE: 1, Bound.NORMAL: 2, Bound.MARGIN: 3}
"""The words of ``faces``."""
_UNEVEN = 1e6  # squares that differ by more are left to others
PATIENCE = 100_000
"""Calls of arrays or interpreted loops, a fifth of a millisecond more each: then compiling, 17 s, pays."""
_calls = count()


def _refined() -> Any:
    from regrasp.closed_form.compiled.least_forces import refined

    return refined


def at_first_sight(
    chooser: Chooser,
    objective: ConvexObjective,
    answer: Solution,
    frictions: list[float],
    limits: list[float],
) -> Array | None:
    """The forces (n, w) at the minimum, in equilibrium inside cones and limits, of the face in sight.

    None where that is not the right one, and where compiled loops are faster: in space, and for peaks.
    """
    if objective.bound is Bound.NONE and chooser.least is None:
        exact = _by_duals(chooser, objective, answer.duals, frictions, limits)
        if exact is not None:
            return exact
    forces = chooser.wanted(answer)
    is_plain = chooser.grasp.dimension == 2 and objective.bound in (Bound.NONE, Bound.NORMAL)
    if not is_plain and next(_calls) >= PATIENCE:
        return None
    given = _given(chooser, objective, forces, frictions, limits)
    if given is None:
        return None
    with np.errstate(all="ignore"):  # guesses that lead nowhere end in numbers that are none
        found = at_once.refined(*given)
    return found[0] if found is not None and found[1] else None


def _by_duals(
    chooser: Chooser, objective: ConvexObjective, duals: Array, frictions: list[float], limits: list[float]
) -> Array | None:
    """The least squares within cones, where no limit is beyond its finger's force."""
    grasp, unit = chooser.grasp, chooser.unit
    task = kept(grasp, (objective, tuple(frictions), unit if objective.follows_unit else 1.0), _least_squares)
    if task is None:
        return None
    r = chooser.vector.size
    load = chooser.vector / unit
    if task.fingers is None:
        found = by_duals.least(-duals[:r], task.matrix, load, task.frictions, task.soft, task.linear)
        if found is None:
            return None
        best = unit * np.einsum("ij,ijk->ik", found, task.frames)
    else:
        pairs = by_duals.least_in_plane((-duals[:r]).tolist(), task.fingers, load.tolist())
        if pairs is None:
            return None
        best = unit * np.array(pairs)
    if max(limits) < np.inf or min(limits) < np.inf:
        sizes = np.sqrt((best * best).sum(axis=1))
        if not (sizes <= limits).all():
            return None
    result: Array = best
    return result


class _Task(NamedTuple):
    """What ``by_duals`` takes besides a load; ``fingers`` in the plane.

    frames: (n, w, w) normal and tangents of each finger, in which matrix and linear are.
    """

    frictions: Array
    soft: Array
    linear: Array
    matrix: Array
    frames: Array
    fingers: list[tuple[float, ...]] | None


def _least_squares(grasp: Grasp, key: tuple[ConvexObjective, tuple[float, ...], float]) -> _Task | None:
    """None for a cost that is not of squares alone."""
    objective, frictions, unit = key
    squares, linear = objective.squares(grasp), objective.linear(grasp, unit)
    if squares is None or not 0 < squares.min() <= squares.max() < _UNEVEN * squares.min():
        return None
    mu = np.array([INSIDE * friction if friction > NEGLIGIBLE else 0.0 for friction in frictions])
    linear = np.zeros((len(grasp), grasp.width)) if linear is None else linear
    soft, fingers, cones = 1 / (2 * squares), None, grasp.cones
    if grasp.dimension == 2:
        torques = grasp.scaled_matrix[2].reshape(-1, 2)
        fingers = np.column_stack([torques, cones.normals, mu, soft, linear]).tolist()
    frames = np.concatenate([cones.normals[:, None], cones.tangents], axis=1)
    matrix = np.einsum("rij,ikj->rik", grasp.scaled_matrix.reshape(-1, *linear.shape), frames)
    linear = np.einsum("ij,ikj->ik", linear, frames)
    return _Task(mu, soft, linear, matrix.reshape(len(matrix), -1), frames, fingers)


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
    return forces if settled is None or _is_worse(chooser, objective, settled, forces) else settled


def _is_worse(chooser: Chooser, objective: ConvexObjective, forces: Array, others: Array) -> bool:
    """Whether forces (n, w) are worse than others: what was moved into limits may be."""
    found, before = (
        objective.value(GraspState(chooser.grasp, chooser.load, chooser.grasp.cones.forces(each)))
        for each in (forces, others)
    )
    return found < before if objective.maximise else found > before


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
