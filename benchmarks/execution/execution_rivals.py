"""What people do today when a finger leaves, as plans: forces over time under the same load."""

from collections.abc import Callable

import cvxpy as cp
import numpy as np

import regrasp as rg
from regrasp.plans.record import Record

INSTANTS = 51
Rival = Callable[..., rg.Transition]
"""Of a start, the finger that leaves or None, the duration [s], and the finger that arrives or None.

One that arrives is in the start already, without force.
"""


def ramp(
    start: rg.GraspState, leaves: str | None, duration: float, arrives: str | None = None
) -> rg.Transition:
    """The leaving finger's force falls linearly, the others keep theirs.

    One that arrives comes to push as hard along its normal as the one that leaves, or as the others do.
    """
    rows, fall = np.repeat(start.forces[None], INSTANTS, axis=0), np.linspace(1, 0, INSTANTS)[:, None]
    if arrives is not None:
        rows[:, start.grasp.index(arrives)] = (1 - fall) * push(start, leaves) * start.grasp[arrives].normal
    if leaves is not None:
        rows[:, start.grasp.index(leaves)] *= fall
    return as_plan(start, leaves, duration, rows, arrives)


def push(start: rg.GraspState, leaves: str | None) -> float:
    """How hard a finger that arrives is to push [N]."""
    normal = (start.forces * start.grasp.normals).sum(axis=1)
    return float(normal[start.grasp.index(leaves)] if leaves is not None else normal[normal > 0].mean())


def least_squares(
    start: rg.GraspState, leaves: str | None, duration: float, arrives: str | None = None
) -> rg.Transition:
    """The least forces in equilibrium without cones; the leaving finger's weight and the squeeze fade.

    One that arrives gains weight as the other loses it.
    """
    grasp, w = start.grasp, start.load.vector
    d = grasp.dimension
    lengths = grasp.lengths[:, None]
    G = grasp.matrix / lengths  # torques over a length, so that the unit does not matter

    def least(weight: float) -> np.ndarray:
        weights = np.ones(len(grasp))
        if leaves is not None:
            weights[grasp.index(leaves)] = weight
        if arrives is not None:
            weights[grasp.index(arrives)] = 1 - weight
        W = np.repeat(weights, d)
        return (W * (np.linalg.pinv(G * W) @ (-w / lengths[:, 0]))).reshape(-1, d)

    squeeze = start.forces - least(1.0)
    rows = np.array([least(s) + s * squeeze for s in np.linspace(1, 0, INSTANTS)])
    return as_plan(start, leaves, duration, rows, arrives)


def nearest(part: float) -> Rival:
    """At each instant the forces nearest to the start inside cones of ``part`` of the friction.

    The leaving finger's normal force is limited by a ramp, as in a task-space controller, that of one that
    arrives by one that rises; a QP, or in space a program with second-order cones.
    """

    def rival(
        start: rg.GraspState, leaves: str | None, duration: float, arrives: str | None = None
    ) -> rg.Transition:
        grasp, w = start.grasp, start.load.vector
        f, limit, comes = (
            cp.Variable(start.forces.shape),
            cp.Parameter(nonneg=True),
            cp.Parameter(nonneg=True),
        )
        wanted = cp.Parameter(start.forces.shape)
        held = [grasp.matrix @ cp.vec(f, order="C") == -w]
        for i, c in enumerate(grasp):
            along = c.normal @ f[i]
            held.append(cp.norm(f[i] - along * c.normal) <= part * c.friction * along)
        if leaves is not None:
            held.append(grasp[leaves].normal @ f[grasp.index(leaves)] <= limit)
        if arrives is not None:
            held.append(grasp[arrives].normal @ f[grasp.index(arrives)] <= comes)
        problem = cp.Problem(cp.Minimize(cp.sum_squares(f - wanted)), held)
        most, rows = push(start, leaves), []
        for s in np.linspace(1, 0, INSTANTS):
            limit.value, comes.value, target = most * s, most * (1 - s), start.forces.copy()
            if arrives is not None:
                target[grasp.index(arrives)] = (1 - s) * most * grasp[arrives].normal
            wanted.value = target
            problem.solve(solver=cp.CLARABEL)
            if problem.status != cp.OPTIMAL:
                raise rg.Infeasible(f"no forces inside {part:g} of the friction at {1 - s:.2f} of the way")
            rows.append(f.value.copy())
        return as_plan(start, leaves, duration, np.array(rows), arrives)

    return rival


def as_plan(
    start: rg.GraspState, leaves: str | None, duration: float, rows: np.ndarray, arrives: str | None = None
) -> rg.Transition:
    """Forces at equal instants (m, n, d) as a plan, unchecked. What a solver leaves is no force."""
    sizes = np.linalg.norm(rows, axis=2, keepdims=True)
    rows = np.where(sizes > 1e-6 * sizes.max(), rows, 0.0)
    times = np.linspace(0, duration, len(rows))
    path = rg.SampledPath(times, rows, np.repeat(start.load.vector[None], len(rows), axis=0))
    ends = (rg.GraspState(start.grasp, start.load, rows[k]) for k in (0, -1))
    gone, come = ((name,) if name is not None else () for name in (leaves, arrives))
    clock, record = rg.TimeScaling.linear(duration), Record(reserve=0.0)
    return rg.Transition(*ends, clock, record, leaving=gone, arriving=come, path=path)


def ours(
    start: rg.GraspState, leaves: str | None, duration: float, arrives: str | None = None
) -> rg.Transition:
    """The plan of regrasp, from the same start."""
    if arrives is None:
        return rg.plan_removal(start, str(leaves), objective="angle", duration=duration)
    before = start.grasp.without(arrives)
    held = rg.GraspState(before, start.load, [start.forces[start.grasp.index(n)] for n in before.names])
    if leaves is None:
        return rg.plan_addition(held, start.grasp[arrives], duration=duration)
    return rg.plan_exchange(held, leaves, start.grasp[arrives], objective="angle", duration=duration)


def chosen(
    start: rg.GraspState, leaves: str | None, duration: float, arrives: str | None = None
) -> rg.Transition:
    """The plan of regrasp, from a start that it chooses, too."""
    if arrives is not None:
        before = start.grasp.without(arrives)
        new = start.grasp[arrives]
        return rg.plan_exchange(
            before, str(leaves), new, load=start.load, objective="angle", duration=duration
        )
    return rg.plan_removal(
        start.grasp,
        str(leaves),
        load=start.load,
        objective="angle",
        whole_objective="angle",
        duration=duration,
    )


RIVALS: dict[str, Rival] = {
    "plan, start chosen too": chosen,
    "plan": ours,
    "QP nearest to start, 0.7 friction": nearest(0.7),
    "QP nearest to start, full friction": nearest(1.0),
    "least squares, no cones": least_squares,
    "ramp, others keep": ramp,
}
