"""What people do today when a finger leaves, as plans: forces over time under the same load."""

from collections.abc import Callable

import cvxpy as cp
import numpy as np

import regrasp as rg
from regrasp.plans.record import Record

INSTANTS = 51
Rival = Callable[[rg.GraspState, str, float], rg.Transition]


def ramp(start: rg.GraspState, leaves: str, duration: float) -> rg.Transition:
    """The leaving finger's force falls linearly, the others keep theirs."""
    gone = start.grasp.index(leaves)
    rows = np.repeat(start.forces[None], INSTANTS, axis=0)
    rows[:, gone] *= np.linspace(1, 0, INSTANTS)[:, None]
    return as_plan(start, leaves, duration, rows)


def least_squares(start: rg.GraspState, leaves: str, duration: float) -> rg.Transition:
    """The least forces in equilibrium without cones; the leaving finger's weight and the squeeze fade."""
    grasp, w = start.grasp, start.load.vector
    gone, d = grasp.index(leaves), grasp.dimension
    lengths = grasp.lengths[:, None]
    G = grasp.matrix / lengths  # torques over a length, so that the unit does not matter

    def least(weight: float) -> np.ndarray:
        weights = np.ones(len(grasp))
        weights[gone] = weight
        W = np.repeat(weights, d)
        return (W * (np.linalg.pinv(G * W) @ (-w / lengths[:, 0]))).reshape(-1, d)

    squeeze = start.forces - least(1.0)
    return as_plan(
        start, leaves, duration, np.array([least(s) + s * squeeze for s in np.linspace(1, 0, INSTANTS)])
    )


def nearest(part: float) -> Rival:
    """At each instant the forces nearest to the start inside cones of ``part`` of the friction.

    The leaving finger's normal force is limited by a ramp, as in a task-space controller; a QP, or in space
    a program with second-order cones.
    """

    def rival(start: rg.GraspState, leaves: str, duration: float) -> rg.Transition:
        grasp, w = start.grasp, start.load.vector
        gone = grasp.index(leaves)
        f, limit = cp.Variable(start.forces.shape), cp.Parameter(nonneg=True)
        held = [grasp.matrix @ cp.vec(f, order="C") == -w]
        for i, c in enumerate(grasp):
            along = c.normal @ f[i]
            held.append(cp.norm(f[i] - along * c.normal) <= part * c.friction * along)
        held.append(grasp[leaves].normal @ f[gone] <= limit)
        problem = cp.Problem(cp.Minimize(cp.sum_squares(f - start.forces)), held)
        most, rows = float(grasp[leaves].normal @ start.forces[gone]), []
        for s in np.linspace(1, 0, INSTANTS):
            limit.value = most * s
            problem.solve(solver=cp.CLARABEL)
            if problem.status != cp.OPTIMAL:
                raise rg.Infeasible(f"no forces inside {part:g} of the friction at {1 - s:.2f} of the way")
            rows.append(f.value.copy())
        return as_plan(start, leaves, duration, np.array(rows))

    return rival


def as_plan(start: rg.GraspState, leaves: str, duration: float, rows: np.ndarray) -> rg.Transition:
    """Forces at equal instants (m, n, d) as a plan, unchecked. What a solver leaves is no force."""
    sizes = np.linalg.norm(rows, axis=2, keepdims=True)
    rows = np.where(sizes > 1e-6 * sizes.max(), rows, 0.0)
    times = np.linspace(0, duration, len(rows))
    path = rg.SampledPath(times, rows, np.repeat(start.load.vector[None], len(rows), axis=0))
    ends = (rg.GraspState(start.grasp, start.load, rows[k]) for k in (0, -1))
    return rg.Transition(
        *ends, rg.TimeScaling.linear(duration), Record(reserve=0.0), leaving=(leaves,), path=path
    )


def ours(start: rg.GraspState, leaves: str, duration: float) -> rg.Transition:
    """The plan of regrasp, from the same start."""
    return rg.plan_removal(start, leaves, objective="angle", duration=duration)


def chosen(start: rg.GraspState, leaves: str, duration: float) -> rg.Transition:
    """The plan of regrasp, from a start that it chooses, too."""
    return rg.plan_removal(
        start.grasp, leaves, load=start.load, objective="angle", whole_objective="angle", duration=duration
    )


RIVALS: dict[str, Rival] = {
    "plan, start chosen too": chosen,
    "plan": ours,
    "QP nearest to start, 0.7 friction": nearest(0.7),
    "QP nearest to start, full friction": nearest(1.0),
    "least squares, no cones": least_squares,
    "ramp, others keep": ramp,
}
