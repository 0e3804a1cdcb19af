"""The verdict on whole plans.

On the straight path f(t) lies on the segment between the ends. With one grasp and one load all conditions
hold at every t when they hold at both ends and 0 <= T(t) <= 1; a B-spline stays within its control values.

On a course forces and loads are linear between instants, so equilibrium, cones, limits and least normal
forces hold at every t when they hold at the instants, and a rate is one number on each stretch.
"""

from collections.abc import Callable
from fractions import Fraction
from math import inf
from typing import cast

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import number
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.exact import RESOLUTION, check_state, dot, exact
from regrasp.verification.load_gap import check_load
from regrasp.verification.protocols import Course, Plan, Scaling
from regrasp.verification.regrasps import Regrasp, check_joints
from regrasp.verification.setpoints import Checked, check_rows
from regrasp.verification.turning_steps import check_turn
from regrasp.verification.verdict import Verification


def verify(
    plan: Plan | Regrasp, load: Callable[[float], Wrench] | None = None, *, curvature: float | None = None
) -> Verification:
    """Check a transition in exact arithmetic: the ends, the path between them and the idle finger.

    Of a regrasp every step is checked, and every joint between two steps.

    load: a function of time [s] that the plan was made for. The plan's load is linear between its instants
    and is what the forces balance exactly; the function may differ from it between them. That gap must be
    less than the margins can take: forces that balance the function must exist inside cones and limits.
    curvature: a bound on the second derivative of the load, |F''| and |tau''| / grasp.size [N/s^2], which
    proves the gap (a measured one that is larger refutes it). Without it the gap is measured between the
    instants, and the verdict says so.
    Raises ``InvalidInput`` for what is no plan, no load function or no curvature.
    """
    if hasattr(plan, "steps") and hasattr(plan, "orientations"):
        if load is not None:
            raise InvalidInput("a regrasp holds the load it was planned for; leave load out")
        return _verify_regrasp(cast(Regrasp, plan))
    if not all(hasattr(plan, name) for name in ("start", "end", "scaling", "record", "leaving", "arriving")):
        raise InvalidInput(f"verify needs a plan, got {plan!r}")
    if load is not None and not callable(load):
        raise InvalidInput(f"load must be the function of time the plan was made for, got {load!r}")
    if load is not None and plan.turn is not None:
        raise InvalidInput("a turning path holds the load that turns with it; leave load out")
    if curvature is not None:
        if load is None:
            raise InvalidInput("curvature bounds a load function: give load as well")
        curvature = number(curvature, "curvature", least=0)
    violations = _check_idle(plan) + _check_scaling(plan.scaling)
    if plan.start.grasp != plan.end.grasp:
        violations.append("start and end have different contacts")
    if plan.turn is not None:
        found = check_turn(plan, plan.turn)
    else:
        found = _check_ends(plan) if plan.course is None else _check_course(plan, plan.course)
    violations += found.violations + _check_record(plan)
    gap, proven = None, False
    if load is not None:
        gap, proven, broken = check_load(plan, load, curvature)
        violations += broken
    return Verification(tuple(violations), *found[1:], gap, proven)


def _verify_regrasp(plan: Regrasp) -> Verification:
    if not plan.steps:
        return Verification(tuple(check_joints(plan)), inf, 0.0, -inf)
    verdicts = [verify(step) for step in plan.steps]
    broken = [f"step {k}: {v}" for k, verdict in enumerate(verdicts, 1) for v in verdict.violations]
    return Verification(
        tuple(broken + check_joints(plan)),
        max(verdict.worst_residual for verdict in verdicts),
        min(verdict.least_angle for verdict in verdicts),
        min(verdict.least_cone_slack for verdict in verdicts),
    )


def _check_ends(plan: Plan) -> Checked:
    broken = []
    if plan.start.load != plan.end.load:
        broken.append("start and end have different loads, so the straight path keeps no equilibrium")
    residuals, slacks, angles = [0.0], [inf], [inf]
    for label, state in (("start", plan.start), ("end", plan.end)):
        residual, slack, violations = check_state(state, label)
        residuals.append(residual)
        slacks.append(slack)
        angles.append(state.margins.least_angle)
        broken += violations
    return Checked(broken, max(residuals), min(angles), min(slacks))


def _check_course(plan: Plan, course: Course) -> Checked:
    times, forces, loads = course.times, course.forces, course.loads
    broken = []
    if times[0] != 0 or times[-1] != plan.scaling.duration or not (times[1:] > times[:-1]).all():
        broken.append(f"the instants must rise from 0 to the duration {plan.scaling.duration!r} s")
    for label, state, k in (("start", plan.start, 0), ("end", plan.end, -1)):
        if (state.forces != forces[k]).any() or (state.load.vector != loads[k]).any():
            broken.append(f"{label}: its forces or its load are not those of the path at that instant")
    found = check_rows(plan.start.grasp, forces, loads, "instant {}")
    return found._replace(violations=broken + found.violations)


def _check_record(plan: Plan) -> list[str]:
    """Whether the path keeps the rates and the least normal forces that it says it keeps."""
    record, names = plan.record, plan.start.grasp.names
    course, turn = plan.course, plan.turn
    forces = np.stack([plan.start.forces, plan.end.forces]) if course is None else course.forces
    if turn is not None:  # between these, combinations whose weights sum to 1 or more
        forces = turn.forces if turn.middles is None else np.concatenate([turn.forces, turn.middles])
    broken = []
    for i, least in enumerate(record.least_normals):
        normal = exact(plan.start.grasp.contacts[i].normal.tolist())
        lowest = min(dot(exact(f[i, : len(normal)].tolist()), normal) for f in forces)
        if lowest < Fraction(least) * (1 - RESOLUTION):
            broken.append(f"{names[i]} pushes with {float(lowest):.9g} along its normal, below {least:.9g}")
    for i, limit in enumerate(record.rate_limits):
        if limit < inf:
            broken += _check_rate(plan, i, limit)
    return broken


def _check_rate(plan: Plan, i: int, limit: float) -> list[str]:
    """Whether the force of contact i changes no faster than ``limit`` [N/s]."""
    name, course = plan.start.grasp.names[i], plan.course
    if course is None:
        return [f"a straight path promises no rates, this one promises {limit:.9g} for {name}"]
    times = exact(course.times.tolist())
    for k in range(len(times) - 1):
        step = Fraction(limit) * (times[k + 1] - times[k])
        d = plan.start.grasp.dimension
        a, b = exact(course.forces[k, i, :d].tolist()), exact(course.forces[k + 1, i, :d].tolist())
        change = [x - y for x, y in zip(b, a, strict=True)]
        if dot(change, change) > (step * (1 + RESOLUTION)) ** 2:
            return [f"{name} changes faster than {limit:.9g} after t = {course.times[k]:.9g} s"]
    return []


def _check_scaling(scaling: Scaling) -> list[str]:
    control = [Fraction(c) for c in scaling.control]
    broken = []
    if control[0] != 1 or control[-1] != 0:
        broken.append(
            f"time scaling runs from {scaling.control[0]:g} to {scaling.control[-1]:g}, not from 1 to 0"
        )
    if min(control) < 0 or max(control) > 1:
        broken.append("time scaling may leave [0, 1], so the path may leave the segment between its ends")
    if not scaling.duration > 0:
        broken.append(f"duration is {scaling.duration:g} s, not greater than 0")
    return broken


def _check_idle(plan: Plan) -> list[str]:
    broken = [f"contact {name!r} leaves and arrives" for name in plan.leaving if name in plan.arriving]
    ends = (("start", plan.start, plan.arriving), ("end", plan.end, plan.leaving))
    for label, state, idle in ends:
        for name in idle:
            if name not in state.grasp.names:
                broken.append(f"contact {name!r} is not one of {', '.join(state.grasp.names)}")
                continue
            force = state.forces[state.grasp.names.index(name)].tolist()
            if any(force):
                broken.append(f"{label}: {name} must carry no force, it carries {force}")
    return broken
