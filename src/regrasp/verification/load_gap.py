"""How far a plan's load may be from the load it was made for, and whether the margins can take that.

Between instants h apart, a function with |w''| <= c is within c h^2 / 8 of the chord. Forces that balance the
function itself are f - G+ (w - chord), with G the grasp matrix of the fingers that stay: each changes by at
most gap / s, s the least singular value of G. If that is no more than the least force margin and what the
limits leave, such forces lie inside cones and limits at every t. A soft finger's torque m counts as the
tangential force mu m / e that it uses up, in G, too.
"""

from collections.abc import Callable

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.exact import HELD, RESOLUTION
from regrasp.verification.protocols import Plan

# Where between two instants the gap is measured: unevenly, so that no period hides.
_PARTS = (np.arange(1, 12) * 0.6180339887498949) % 1.0


@np.errstate(all="ignore")
def check_load(
    plan: Plan, load: Callable[[float], Wrench], curvature: float | None
) -> tuple[float, bool, list[str]]:
    """The gap [N], whether it is proven, and what is wrong with it."""
    if plan.course is None:
        times = np.array([0.0, plan.scaling.duration])
        forces = np.stack([plan.start.forces, plan.end.forces])
        loads = np.stack([plan.start.load.vector, plan.end.load.vector])
    else:
        times, forces, loads = plan.course.times, plan.course.forces, plan.course.loads
    grasp, moving = plan.start.grasp, (*plan.leaving, *plan.arriving)
    forces = grasp.cones.measured(forces)
    length = float(_lengths(grasp.positions).max()) or 1.0
    scale = max(_sizes(loads, length).max(), float(abs(forces).max()))
    given = _at(load, times, loads.shape[1])
    off = _sizes(given - loads, length)
    asked = max(_sizes(loads, length).max(), _sizes(given, length).max())
    small = min(float(RESOLUTION) * scale, float(HELD) * asked)  # as little as may be out of balance
    if (off > small).any():
        k = int(off.argmax())
        broken = f"at t = {times[k]:.6g} s the load given differs from the plan's by {off[k]:.3g}"
        return float(off[k]), False, [broken]
    between = (times[:-1, None] + _PARTS * np.diff(times)[:, None]).ravel()
    chord = np.stack([np.interp(between, times, column) for column in loads.T], axis=-1)
    gap = measured = float(_sizes(_at(load, between, loads.shape[1]) - chord, length).max())
    if curvature is not None:
        gap = curvature * float(np.diff(times).max()) ** 2 / 8
        if measured > gap * (1 + 1e-6) + small:
            broken = (
                f"the load given bends more than the curvature {curvature:g} given: between instants it "
                f"differs from the plan's by {measured:.3g}, more than {gap:.3g}"
            )
            return measured, False, [broken]
    stays = [i for i, known in enumerate(grasp.names) if known not in moving]
    room = _room(plan, forces[:, stays], stays)
    d, columns = grasp.dimension, grasp.cones.matrix.reshape(-1, len(grasp), grasp.width)
    matrix = columns[:, stays].reshape(len(columns), -1).copy()
    matrix[d:] /= length
    wide = matrix.shape[1] >= matrix.shape[0]
    least = float(np.linalg.svd(matrix, compute_uv=False)[-1]) if wide else 0.0
    # Force and torque may both be off by the gap.
    change = np.sqrt(2) * gap / least if least > 1e-12 else np.inf
    if gap > small and not change <= room:
        broken = (
            f"between instants the load given differs from the plan's by up to {gap:.3g}: forces that "
            f"balance it may differ by {change:.3g}, more than the margins take ({room:.3g}); plan with "
            f"more instants, or keep a reserve"
        )
        return gap, curvature is not None, [broken]
    return gap, curvature is not None, []


def _at(load: Callable[[float], Wrench], times: Array, width: int) -> Array:
    found = [load(t) for t in times.tolist()]
    for wrench in found:
        if not isinstance(wrench, Wrench) or wrench.vector.size != width:
            raise InvalidInput(
                f"load must return a Wrench of the plan's dimension, it returned {shown(wrench)}"
            )
    return np.array([wrench.vector for wrench in found])


def _sizes(wrenches: Array, length: float) -> Array:
    """The larger of |F| and |tau| / length, (m,)."""
    d = 2 if wrenches.shape[1] == 3 else 3
    sizes: Array = np.maximum(_lengths(wrenches[:, :d]), _lengths(wrenches[:, d:] / length))
    return sizes


def _lengths(vectors: Array) -> Array:
    """Along the last axis, of numbers whose squares vanish or overflow as well."""
    result: Array = np.hypot.reduce(vectors, axis=-1)
    return result


def _room(plan: Plan, forces: Array, stays: list[int]) -> float:
    """The least change of a force, as the cones measure it, that could leave its cone or a limit."""
    grasp = plan.start.grasp
    mu, normals = grasp.frictions[stays], grasp.cones.normals[stays]
    normal = (forces * normals).sum(axis=-1)
    tangential = _lengths(forces - normal[..., None] * normals)
    edge = (mu * normal - tangential) / np.hypot(1.0, mu)
    spare = grasp.max_forces[stays] - _lengths(forces)
    rows = grasp.subset(stays).limit_rows
    if rows is not None:
        spare = np.minimum(spare, rows.spare(forces))
    least = plan.record.least_normals
    above = normal - np.array(least)[stays] if least else normal
    return float(min(edge.min(), spare.min(), above.min()))
