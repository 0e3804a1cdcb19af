"""Forces at a flat minimum, polished: a tolerance on the objective leaves its square root on the forces.

Newton's method on the conditions of optimality (Karush, Kuhn, Tucker) with the constraints that are active,

    grad q + G' y + sum_j z_j grad c_j = 0,   G f + w = 0,   c_j = 0,

q the objective and c_j a force's cone, limit or share of the peak. The step of least length serves where the
minimum is not unique. Forces are taken only if they are no worse.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.states.objectives import Bound, ConvexObjective
from regrasp.planning.states.solving import Chooser

_STEPS = 6
# Constraints nearer than this fraction of the largest force are active; the root of a solver's tolerance.
_ACTIVE = 1e-6
# A force below this fraction of the largest is nothing, or the mark of a flat minimum.
TRACE = 1e-4
# A force below this fraction of the largest is nothing.
_NOTHING = 1e-8
_DONE = 1e-13


class _Active(NamedTuple):
    """A constraint that holds with equality: its value, gradient (N,) and Hessian (N, N)."""

    value: float
    gradient: Array
    hessian: Array


def polished(
    chooser: Chooser, objective: ConvexObjective, forces: Array, frictions: list[float], limits: list[float]
) -> Array:
    """The forces (n, w) nearer to the minimum, or as they are.

    Nothing is done for force margins, and where no finger carries a trace of force only.
    """
    sizes = np.sqrt((forces**2).sum(axis=1))
    largest = float(sizes.max())
    if not ((sizes > 0) & (sizes < TRACE * largest)).any():
        return forces
    grasp = chooser.grasp
    used = np.flatnonzero(sizes > _NOTHING * largest).tolist()
    if 0 < len(used) < np.count_nonzero(sizes):
        rest = chooser.of(used).settled(forces[used], [frictions[i] for i in used], [limits[i] for i in used])
        idle = np.zeros_like(forces)
        if rest is not None:
            idle[used] = rest
            if _is_no_worse(grasp, objective, idle, forces, largest, _NOTHING):
                forces, sizes = idle, np.sqrt((idle**2).sum(axis=1))
    if objective.bound is Bound.MARGIN or not ((sizes > 0) & (sizes < TRACE * largest)).any():
        return forces
    x = forces.ravel() / largest
    x = np.append(x, _value(grasp, objective, forces, largest))
    mu, bounds = np.array(frictions), np.array(limits) / largest
    balance = np.column_stack([chooser.matrix, np.zeros(len(chooser.matrix))])
    multipliers = None
    for _ in range(_STEPS):
        active = list(_active(grasp, objective, x, mu, bounds))
        gradient = np.zeros(x.size)
        hessian = np.zeros((x.size, x.size))
        if objective.bound is Bound.NONE:
            squares, linear = _costs(objective, grasp, largest)
            np.fill_diagonal(hessian[:-1, :-1], 2 * squares)
            gradient[:-1] = 2 * squares * x[:-1] + linear
        else:
            gradient[-1] = 1.0
        jacobian = np.array([a.gradient for a in active]).reshape(-1, x.size)
        rows = np.vstack([balance, jacobian])
        if multipliers is None or len(multipliers) != len(rows):
            multipliers = np.linalg.lstsq(rows.T, -gradient, rcond=1e-9)[0]
        for a, z in zip(active, multipliers[len(balance) :].tolist(), strict=True):
            hessian = hessian + z * a.hessian
        off = np.concatenate([balance @ x + chooser.vector / largest, [a.value for a in active]])
        system = np.block([[hessian, rows.T], [rows, np.zeros((len(rows), len(rows)))]])
        step = np.linalg.lstsq(system, np.concatenate([-gradient, -off]), rcond=1e-11)[0]
        x = x + step[: x.size]
        multipliers = step[x.size :]
        if abs(step[: x.size]).max() < _DONE:
            break
    wanted = largest * x[:-1].reshape(forces.shape)
    if not np.isfinite(wanted).all() or abs(wanted - forces).max() > TRACE * largest:
        return forces
    wanted[np.sqrt((wanted**2).sum(axis=1)) < 1e-12 * largest] = 0.0
    found = chooser.settled(wanted, frictions, limits)
    return (
        found
        if found is not None and _is_no_worse(grasp, objective, found, forces, largest, _DONE)
        else forces
    )


def _is_no_worse(
    grasp: Grasp, objective: ConvexObjective, found: Array, forces: Array, unit: float, tolerance: float
) -> bool:
    after, before = (_value(grasp, objective, f, unit) for f in (found, forces))
    return after <= before + tolerance * abs(before)


def _costs(objective: ConvexObjective, grasp: Grasp, unit: float) -> tuple[Array, Array]:
    """(n w,) factors of squares and of forces in the cost, forces in units of ``unit``."""
    squares, linear = objective.squares(grasp), objective.linear(grasp, unit)
    size = grasp.width * len(grasp)
    return (
        np.zeros(size) if squares is None else np.repeat(squares, grasp.width),
        np.zeros(size) if linear is None else linear.ravel(),
    )


def _value(grasp: Grasp, objective: ConvexObjective, forces: Array, unit: float) -> float:
    """What is minimised, forces in units of ``unit``; of force margins nothing."""
    x = forces / unit
    if objective.bound is Bound.NONE:
        squares, linear = _costs(objective, grasp, unit)
        return float(squares @ x.ravel() ** 2 + linear @ x.ravel())
    if objective.bound is Bound.MARGIN:
        return 0.0
    sizes = np.sqrt((x**2).sum(axis=1)) if objective.bound is Bound.FORCE else grasp.cones.normal(x)
    return float(sizes.max())


def _active(
    grasp: Grasp, objective: ConvexObjective, x: Array, mu: Array, bounds: Array
) -> Iterator[_Active]:
    """The active constraints at forces x[:-1] and a peak x[-1], in units of the largest force."""
    w, cones, size = grasp.width, grasp.cones, x.size
    for i in range(len(grasp)):
        here = slice(w * i, w * i + w)
        f, n = x[here], cones.normals[i]
        length = float(np.sqrt(f @ f))
        along = float(f @ n)
        across = f - along * n
        sideways = float(np.sqrt(across @ across))
        none, zero = np.zeros((size, size)), np.zeros(size)
        if mu[i] == 0:
            for t in cones.tangents[i]:
                gradient = zero.copy()
                gradient[here] = t
                yield _Active(float(f @ t), gradient, none)
        elif sideways > 0 and abs(sideways - mu[i] * along) < _ACTIVE * length and length > TRACE:
            direction = across / sideways
            gradient, hessian = zero.copy(), none.copy()
            gradient[here] = direction - mu[i] * n
            hessian[here, here] = (np.eye(w) - np.outer(n, n) - np.outer(direction, direction)) / sideways
            yield _Active(sideways - mu[i] * along, gradient, hessian)
        of_peak = {Bound.FORCE: length, Bound.NORMAL: along}.get(objective.bound)
        for is_peak, value, bound in ((True, of_peak, x[-1]), (False, length, bounds[i])):
            if value is None:
                continue
            if not abs(value - bound) < _ACTIVE or length < TRACE:
                continue
            gradient, hessian = zero.copy(), none.copy()
            if is_peak and objective.bound is Bound.NORMAL:
                gradient[here] = n
            else:
                gradient[here] = f / length
                hessian[here, here] = (np.eye(w) - np.outer(f, f) / length**2) / length
            gradient[-1] -= 1.0 if is_peak else 0.0
            yield _Active(value - bound, gradient, hessian)
