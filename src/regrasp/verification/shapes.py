"""Shapes of the parts of a plan, and its time function: what all other checks take for granted."""

from fractions import Fraction
from math import inf, isfinite

import numpy as np

from regrasp.errors import shown
from regrasp.verification.exact import RESOLUTION, dot, exact, rounded
from regrasp.verification.protocols import Course, Plan, Scaling, Turn


def check_shapes(plan: Plan) -> list[str]:
    """What of a plan cannot be followed over time at all."""
    if plan.start.grasp != plan.end.grasp:
        return ["start and end have different contacts"]
    broken = check_names(plan) + check_scaling(plan)
    if plan.course is not None:
        broken += check_course_form(plan, plan.course)
    return broken + (check_turn_form(plan, plan.turn) if plan.turn is not None else [])


def check_names(plan: Plan) -> list[str]:
    """Whether the fingers that leave and arrive are named."""
    for verb, names in (("leaves", plan.leaving), ("arrives", plan.arriving)):
        are_names = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
        if not are_names or len(set(names)) != len(names):
            return [
                f"the fingers of which each {verb} must be a tuple of different names, got {shown(names)}"
            ]
    return []


def check_course_form(plan: Plan, course: Course) -> list[str]:
    """Whether there are forces and a load for every instant, all of them numbers."""
    times, forces, loads, shape = course.times, course.forces, course.loads, plan.start.forces.shape
    if times.ndim != 1 or times.size < 2 or forces.shape != (times.size, *shape):
        return [f"a course has two instants or more, and forces (K, {shape[0]}, {shape[1]})"]
    if loads.shape != (times.size, plan.start.load.vector.size):
        return ["a course has a load at every instant"]
    if not (np.isfinite(forces).all() and np.isfinite(loads).all() and np.isfinite(times).all()):
        return ["times, forces and loads of a course must be finite numbers"]
    return []


def check_turn_form(plan: Plan, turn: Turn) -> list[str]:
    """Whether a turn has forces for every angle, middles for every step, and its axis."""
    return _check_states(turn, plan.start.forces.shape) or _check_axis(turn, plan.start.grasp.dimension)


def _check_states(turn: Turn, shape: tuple[int, ...]) -> list[str]:
    """Whether there are forces for every angle, and middles for every step, all of them numbers."""
    count, middles = turn.angles.size, turn.middles
    if turn.angles.ndim != 1 or count < 2 or turn.forces.shape != (count, *shape):
        return [f"a turn has two angles or more, and forces (K, {shape[0]}, {shape[1]})"]
    if middles is not None and middles.shape != (count - 1, *shape):
        return [f"{count - 1} steps of a turn need as many middles"]
    numbers = (turn.angles, turn.forces, *(() if middles is None else (middles,)))
    if not all(np.isfinite(values).all() for values in numbers):
        return ["angles and forces of a turn must be finite numbers"]
    return []


def _check_axis(turn: Turn, dimension: int) -> list[str]:
    """A turn in space has a unit axis, one in the plane none."""
    if (turn.axis is None) != (dimension == 2):
        return ["a turn in space needs its axis, and one in the plane has none"]
    if turn.axis is not None:
        if turn.axis.shape != (3,) or not np.isfinite(turn.axis).all():
            return ["the axis of a turn must have three numbers"]
        axis = exact(turn.axis.tolist())
        if abs(dot(axis, axis) - 1) > RESOLUTION:
            return ["the axis of a turn must have length 1"]
    return []


def check_scaling(plan: Plan) -> list[str]:
    """What is wrong with the time function."""
    scaling: Scaling = plan.scaling
    duration, control = scaling.duration, scaling.control
    if len(control) < 2 or not all(map(isfinite, control)):
        return ["time scaling needs two control values or more, all of them numbers"]
    broken, degree = [], getattr(scaling, "degree", 1)
    if not isinstance(degree, int) or not 1 <= degree < len(control):
        broken.append(f"time scaling is of degree {shown(degree)}, not from 1 to {len(control) - 1}")
    if control[0] != 1 or control[-1] != 0:
        broken.append(f"time scaling runs from {control[0]:g} to {control[-1]:g}, not from 1 to 0")
    if min(control) < 0 or max(control) > 1:
        broken.append("time scaling may leave [0, 1], so the path may leave the segment between its ends")
    if not duration > 0:
        broken.append(f"duration is {duration:g} s, not greater than 0")
    elif not isfinite(duration):
        broken.append(f"duration is {duration:g} s, not a number")
    else:
        largest = max(map(abs, exact([*plan.start.forces.flat, *plan.end.forces.flat])))
        # |T'| of a B-spline is below (number of control values)^2 / duration.
        if rounded(max(largest, Fraction(1)) * len(control) ** 2 / Fraction(duration)) == inf:
            broken.append(f"duration is {duration:g} s, in which no force changes at a finite rate")
    return broken
