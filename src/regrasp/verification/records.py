"""Whether a plan keeps what its record says: least normal forces, rates along a path, idle fingers."""

from fractions import Fraction
from math import inf, isfinite

import numpy as np

from regrasp.errors import shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import one_line
from regrasp.verification.exact import RESOLUTION, dot, exact, root, rounded
from regrasp.verification.falling import steepest
from regrasp.verification.protocols import Plan


def check_record(plan: Plan) -> list[str]:
    """What of the record is not so, or cannot be."""
    broken = check_record_form(plan)
    if broken:
        return broken
    record, grasp = plan.record, plan.start.grasp
    names = list(map(one_line, grasp.names))
    forces = deciding_forces(plan)
    for i, least in enumerate(record.least_normals):
        normal = exact(grasp.contacts[i].normal.tolist())
        lowest = min(dot(exact(f[i, : len(normal)].tolist()), normal) for f in forces)
        if lowest < Fraction(least) * (1 - RESOLUTION):
            broken.append(f"{names[i]} pushes with {rounded(lowest):.9g} along its normal, below {least:.9g}")
    for i, limit in enumerate(record.rate_limits):
        if limit < inf:
            broken += _check_rate(plan, i, names[i], limit)
    return broken + _check_choices(plan)


def deciding_forces(plan: Plan) -> Array:
    """(K, n, d) forces between which all others are combinations whose weights sum to 1 or more."""
    if plan.turn is not None:
        turn = plan.turn
        return turn.forces if turn.middles is None else np.concatenate([turn.forces, turn.middles])
    return np.stack([plan.start.forces, plan.end.forces]) if plan.course is None else plan.course.forces


def check_record_form(plan: Plan) -> list[str]:
    """Numbers that no record has."""
    record, n = plan.record, len(plan.start.grasp)
    broken = []
    for what, values, least in (
        ("rate limit", record.rate_limits, "greater than 0"),
        ("least normal force", record.least_normals, "at least 0"),
    ):
        if len(values) not in (0, n):
            broken.append(f"record: {n} contacts need as many {what}s or none, got {len(values)}")
        if not all(v > 0 or (v == 0 and least == "at least 0") for v in values):
            broken.append(f"record: every {what} must be {least}, got {', '.join(map(str, values))}")
    if not all(map(isfinite, record.least_normals)):
        broken.append("record: every least normal force must be a number")
    if not 0 <= record.reserve < 1:
        broken.append(f"record: reserve is {record.reserve:g}, not a fraction of the friction from 0 to 1")
    if not 0 <= record.balancing < inf:
        broken.append(f"record: forces were balanced by {record.balancing:g}, which is no change of a force")
    for choice in record.choices:
        limits = choice.force_limits
        if choice.end not in ("start", "end"):
            broken.append(
                f"record: a state was chosen for {shown(choice.end)}, which is neither start nor end"
            )
        if not all(limit > 0 for limit in limits):
            broken.append(f"record: force limits must be greater than 0, got {', '.join(map(str, limits))}")
    return broken


def _check_choices(plan: Plan) -> list[str]:
    """Whether the states chosen keep the force limits they were chosen under, one for each finger in use."""
    grasp, broken = plan.start.grasp, []
    for choice in plan.record.choices:
        at_end = choice.end == "end"
        state, idle = (plan.end, plan.leaving) if at_end else (plan.start, plan.arriving)
        used = [i for i, name in enumerate(grasp.names) if name not in idle]
        if len(choice.force_limits) != len(used):
            broken.append(
                f"{choice.end} was chosen for {len(used)} fingers in use, but {len(choice.force_limits)} "
                f"force limits are on record"
            )
            continue
        forces = grasp.cones.measured(state.forces).tolist()
        for i, limit in zip(used, choice.force_limits, strict=True):
            f = exact(forces[i])
            if limit < inf and dot(f, f) > (Fraction(limit) * (1 + RESOLUTION)) ** 2:
                broken.append(
                    f"{choice.end} was chosen with forces of {one_line(grasp.names[i])} up to {limit:.9g}, "
                    f"it has {root(dot(f, f)):.9g}"
                )
    return broken


def _check_rate(plan: Plan, i: int, name: str, limit: float) -> list[str]:
    """Whether the force of contact i changes no faster than ``limit`` [N/s]."""
    course, d = plan.course, plan.start.grasp.dimension
    if plan.turn is not None:
        return [f"a turning path promises no rates, this one promises {limit:.9g} for {name}"]
    if course is None:
        ends = (exact(state.forces[i, :d].tolist()) for state in (plan.start, plan.end))
        change = [x - y for x, y in zip(*ends, strict=True)]
        most = Fraction(limit) * Fraction(plan.scaling.duration) * (1 + RESOLUTION)
        fast = dot(change, change) * steepest(plan.scaling) ** 2 > most**2
        return [f"{name} changes faster than {limit:.9g} on the straight path"] if fast else []
    times = exact(course.times.tolist())
    for k in range(len(times) - 1):
        step = Fraction(limit) * (times[k + 1] - times[k])
        a, b = exact(course.forces[k, i, :d].tolist()), exact(course.forces[k + 1, i, :d].tolist())
        change = [x - y for x, y in zip(b, a, strict=True)]
        if dot(change, change) > (step * (1 + RESOLUTION)) ** 2:
            return [f"{name} changes faster than {limit:.9g} after t = {course.times[k]:.9g} s"]
    return []


def check_idle(plan: Plan) -> list[str]:
    """What is wrong with the fingers that a transition names."""
    broken = [f"contact {shown(name)} leaves and arrives" for name in plan.leaving if name in plan.arriving]
    ends = (("start", plan.start, plan.arriving), ("end", plan.end, plan.leaving))
    for label, state, idle in ends:
        for name in idle:
            if name not in state.grasp.names:
                known = ", ".join(map(one_line, state.grasp.names))
                broken.append(f"contact {shown(name)} is not one of {known}")
                continue
            force = state.forces[state.grasp.names.index(name)].tolist()
            if any(force):
                broken.append(f"{label}: {one_line(name)} must carry no force, it carries {force}")
    return broken
