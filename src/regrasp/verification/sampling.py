"""Set-points: each row in equilibrium, inside cones and limits, and the plan's at its time.

Rows are compared with ``plan.forces(t)``, contact by contact, to 2^-40 of the largest force of that contact
on the way: the rounding of a path is that of its forces. So are they with the path that ``verify`` decides,
retraced, and a finger that carries no force at an end carries none to the last bit. An angle of theta rounds
to 2^-53 theta, so a turn by theta is compared to 2^-40 (1 + theta).
"""

from collections.abc import Iterator
from math import inf

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, numbers_in
from regrasp.mechanics.value import one_line
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.exact import RESOLUTION, load_size
from regrasp.verification.float_filter import folded, judge_rows
from regrasp.verification.kinds import check_transition, is_transition
from regrasp.verification.protocols import Plan
from regrasp.verification.records import check_record_form, deciding_forces
from regrasp.verification.retraced import retraced, turned_by
from regrasp.verification.shapes import check_shapes
from regrasp.verification.verdict import Verification

_DOUBT = float(RESOLUTION)
_SAME_ANGLE = 1e-9
"""By how much an angle may differ from the plan's, per 1 + the turn [rad]."""
_BLOCK = 8192  # rows at a time, which stay in the cache


def verify_setpoints(
    plan: Plan, forces: Array, times: Array | None = None, angles: Array | None = None
) -> Verification:
    """Check sampled forces (m, n, d) of a plan, the numbers that a controller will be given.

    Each must hold the object, and be the plan's at its time to 2^-40 of the largest force; the fingers that
    carry none at an end carry none there; least normal forces and rates of the record are kept.

    Args:
        plan: the plan they are of.
        forces: (m, n, d) object frame [N]; (m, n, 4) with soft fingers.
        times: (m,) rising, from the start of the plan [s]; spread evenly over it if left out.
        angles: (m,) of the object from the start [rad], needed where it turns, and the plan's to 1e-9; the
            load turns the other way.

    Raises:
        InvalidInput: For what is no plan, and for forces, times and angles that are no numbers.
    """
    if not is_transition(plan) or not callable(getattr(plan, "forces", None)):
        raise InvalidInput(f"verify_setpoints needs a plan that is one transition, got {shown(plan)}")
    check_transition(plan)
    forces = numbers_in(forces, "forces of set-points must be numbers")
    times = None if times is None else numbers_in(times, "times of set-points must be numbers")
    angles = None if angles is None else numbers_in(angles, "angles of set-points must be numbers")
    unfit = check_shapes(plan) or check_record_form(plan)
    if unfit:
        return _refused(unfit[0])
    start, duration = plan.start, plan.scaling.duration
    n, d = start.forces.shape
    if forces.ndim != 3 or forces.shape[1:] != (n, d):
        return _refused(f"set-points must have shape (m, {n}, {d}), got {forces.shape}")
    if times is None:
        times = np.linspace(0.0, duration, len(forces))
    if times.shape != (len(forces),) or not (np.diff(times) > 0).all() or not _within(times, duration):
        return _refused(f"times of set-points must rise within [0, {shown(duration)}] s, one for each")
    if not np.isfinite(forces).all():
        return _refused("forces of set-points must be finite numbers")
    if plan.turn is not None:
        if angles is None:
            return _refused("set-points of an object that turns need its angles")
        if angles.shape != times.shape or not np.isfinite(angles).all():
            return _refused("angles of set-points must be finite numbers, one for each")
        loads = _turned_loads(start.load, angles, plan.turn.axis)
    elif plan.course is None:
        loads = np.broadcast_to(start.load.vector, (len(forces), start.load.vector.size))
    else:
        at = plan.course.times
        loads = np.stack([np.interp(times, at, column) for column in plan.course.loads.T], axis=-1)
    asked = load_size(start.grasp, start.load.vector[None] if plan.course is None else plan.course.loads)
    broken: dict[int, list[str]] = {}
    residuals, angle_margins, slacks = [0.0], [inf], [inf]
    for first in range(0, len(forces), _BLOCK):
        rows = slice(first, first + _BLOCK)
        found, *rest = judge_rows(start.grasp, forces[rows], loads[rows], asked, "set-point {}", first)
        broken |= found
        for known, value in zip((residuals, angle_margins, slacks), rest, strict=True):
            known.append(value)
        for row, violation in _compared(plan, forces, times, slice(max(first - 1, 0), first + _BLOCK)):
            broken.setdefault(row, [f"set-point {row}: {violation}"])
    if plan.turn is not None and angles is not None:
        off = abs(angles - turned_by(plan.turn, plan.scaling, times))
        for row in np.flatnonzero(~(off <= _SAME_ANGLE * (1 + abs(plan.turn.angles[-1])))).tolist():
            by = f"t = {times[row]:.9g} s, off by {off[row]:.3g} rad"
            broken.setdefault(row, [f"set-point {row}: its angle is not the plan's at {by}"])
    violations = tuple(v for row in sorted(broken) for v in broken[row])
    return Verification(violations, max(residuals), min(angle_margins), min(slacks))


@np.errstate(all="ignore")
def _compared(plan: Plan, forces: Array, times: Array, rows: slice) -> Iterator[tuple[int, str]]:
    """(row, what is wrong) of those ``rows`` that are not the plan's, least normals and rates included."""
    forces, times, first = forces[rows], times[rows], rows.start
    grasp, d, record = plan.start.grasp, plan.start.grasp.dimension, plan.record
    names, deciding = list(map(one_line, grasp.names)), deciding_forces(plan)
    planned = (_said(plan, times, forces.shape), retraced(plan, times))
    parts = ((slice(0, d), "N"), (slice(d, None), "N m"))
    for part, unit in parts if forces.shape[2] > d else parts[:1]:
        size = abs(deciding[..., part]).max(axis=(0, 2), initial=0.0)
        off = np.maximum(*(folded(np.maximum, abs(forces[..., part] - f[..., part])) for f in planned))
        for row, i in np.argwhere(~(off <= _DOUBT * _growth(plan) * size)).tolist():
            when, by = f"t = {times[row]:.9g} s", f"off by {off[row, i]:.3g} {unit}"
            yield first + row, f"force of {names[i]} is not the plan's at {when}, {by}"
    ends = ((0, 0.0), (times.size - 1, plan.scaling.duration))
    for (k, at), idle in zip(ends, (plan.arriving, plan.leaving), strict=True):
        for i in (grasp.names.index(name) for name in idle if name in grasp.names):
            if times[k] == at and forces[k, i].any():
                yield first + k, f"{names[i]} must carry no force there"
    size = abs(deciding[..., :d]).max(axis=(0, 2))
    for i, least in enumerate(record.least_normals):
        normal = forces[:, i, :d] @ grasp.normals[i]
        for row in np.flatnonzero(normal < least * (1 - _DOUBT) - 2 * _DOUBT * size[i]).tolist():
            yield first + row, f"{names[i]} pushes along its normal with less than {least:.9g}"
    for i, limit in enumerate(record.rate_limits):
        most = limit * np.diff(times) * (1 + _DOUBT) + 4 * _DOUBT * size[i]
        change = np.hypot.reduce(np.diff(forces[:, i, :d], axis=0), axis=1)
        for row in np.flatnonzero(change > most).tolist():
            yield first + row + 1, f"{names[i]} changes faster than {limit:.9g}"


def _said(plan: Plan, times: Array, shape: tuple[int, ...]) -> Array:
    """(m, n, d) the forces that the plan answers."""
    try:
        found = numbers_in(plan.forces(times), "forces of a plan at times must be numbers")
    except Exception as error:
        raise InvalidInput(f"forces of a plan at times failed: {shown(error)}") from error
    if found.shape != shape:
        raise InvalidInput(
            f"forces of a plan at {times.size} times must have shape {shape}, got {found.shape}"
        )
    return found


def _growth(plan: Plan) -> float:
    """How much rounding of a path may grow: by the turn, and by the weights between angles far apart."""
    if plan.turn is None:
        return 1.0
    angles = plan.turn.angles
    return float((1 + abs(angles[-1])) / np.cos(abs(np.diff(angles)).max() / 2))


def _refused(problem: str) -> Verification:
    return Verification((problem,), inf, 0, 0)


def _within(times: Array, duration: float) -> bool:
    return times.size == 0 or bool(times[0] >= 0 and times[-1] <= duration)


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
