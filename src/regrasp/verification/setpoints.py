"""Many rows of forces at once: set-points, and the instants of a course.

Rows that are inside by more than rounding are settled in floating point, whose error is bounded; the others
are decided exactly.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.mechanics.wrench import Wrench, torque
from regrasp.verification.exact import RESOLUTION, check_state
from regrasp.verification.protocols import Plan
from regrasp.verification.verdict import Verification


class Checked(NamedTuple):
    """What was found of some rows; fields as in ``Verification``."""

    violations: list[str]
    worst_residual: float
    least_angle: float
    least_cone_slack: float


def check_rows(grasp: Grasp, forces: Array, loads: Array, labels: str) -> Checked:
    """Check forces (m, n, d) against loads (m, 3 or 6); ``labels`` names row k by ``labels.format(k)``."""
    d, doubt = grasp.dimension, float(RESOLUTION)
    pushed = forces[..., :d]
    normal = (pushed * grasp.normals).sum(axis=-1)
    tangential = np.linalg.norm(pushed - normal[..., None] * grasp.normals, axis=-1)
    magnitude = np.linalg.norm(pushed, axis=-1)
    torques = torque(grasp.positions, pushed)
    if grasp.torsions is not None:
        about = forces[..., 3]
        used = np.divide(grasp.frictions * about, grasp.torsions, out=0 * about, where=grasp.torsions > 0)
        used[..., grasp.torsions == 0] = np.where(about[..., grasp.torsions == 0] == 0, 0.0, inf)
        tangential, magnitude = np.hypot(tangential, used), np.hypot(magnitude, used)
        torques = torques + about[..., None] * grasp.normals
    inside = grasp.frictions * normal - tangential > doubt * magnitude
    inside |= (forces == 0).all(axis=-1)  # the apex
    inside &= magnitude <= grasp.max_forces * (1 - doubt)
    total = np.concatenate([pushed, torques], axis=-1).sum(axis=1) + loads
    arm = grasp.size or 1.0
    scale = np.maximum(magnitude.max(axis=1), np.linalg.norm(loads[:, :d], axis=1))
    off = np.maximum(np.linalg.norm(total[:, :d], axis=1), np.linalg.norm(total[:, d:], axis=1) / arm)
    settled = inside.all(axis=1) & (off <= doubt / 2 * scale)
    with np.errstate(divide="ignore", invalid="ignore"):
        slack_of = grasp.frictions**2 - (tangential / normal) ** 2
        relative = np.where(scale > 0, off / scale, 0.0)[settled]
    violations = []
    slacks = [float(slack_of[settled][magnitude[settled] > 0].min(initial=inf))]
    residuals = [float(relative.max(initial=0.0))]
    for row in np.flatnonzero(~settled):
        state = GraspState(grasp, Wrench.from_vector(loads[row]), forces[row])
        residual, slack, broken = check_state(state, labels.format(row))
        violations += broken
        slacks.append(slack)
        residuals.append(residual)
    used = magnitude > doubt * scale[:, None]
    angles = np.where(used, np.arctan(grasp.frictions) - np.arctan2(tangential, normal), inf)
    return Checked(violations, max(residuals), float(angles.min(initial=inf)), min(slacks))


def verify_setpoints(
    plan: Plan, forces: Array, times: Array | None = None, angles: Array | None = None
) -> Verification:
    """Check sampled forces (m, n, d) of a plan, the numbers that a controller will be given.

    times: (m,) [s], needed where the plan's load varies; it is taken as linear between the plan's instants.
    angles: (m,) of the object from the start [rad], needed where it turns; the load turns the other way.
    """
    start = plan.start
    n, d = start.forces.shape
    if forces.ndim != 3 or forces.shape[1:] != (n, d):
        return Verification((f"set-points must have shape (m, {n}, {d}), got {forces.shape}",), inf, 0, 0)
    if plan.turn is not None:
        if angles is None:
            return Verification(("set-points of an object that turns need its angles",), inf, 0, 0)
        loads = _turned_loads(start.load, angles, plan.turn.axis)
    elif plan.course is None:
        loads = np.broadcast_to(start.load.vector, (len(forces), start.load.vector.size))
    elif times is None:
        return Verification(("set-points under a load that varies need their times",), inf, 0, 0)
    else:
        at = plan.course.times
        loads = np.stack([np.interp(times, at, column) for column in plan.course.loads.T], axis=-1)
    found = check_rows(start.grasp, forces, loads, "set-point {}")
    return Verification(
        tuple(found.violations), found.worst_residual, found.least_angle, found.least_cone_slack
    )


def _turned_loads(load: Wrench, angles: Array, axis: Array | None) -> Array:
    """(m, 3) or (m, 6) a load seen from an object at these angles, about ``axis`` in space."""
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    if axis is None:
        fx, fy = load.force
        turned = c * load.force + s * np.array([fy, -fx])
        return np.hstack([turned, np.broadcast_to(load.torque, c.shape)])
    still = [(axis @ vector) * axis for vector in (load.force, load.torque)]
    return np.hstack(
        [
            along + c * (vector - along) - s * np.cross(axis, vector)
            for along, vector in zip(still, (load.force, load.torque), strict=True)
        ]
    )
