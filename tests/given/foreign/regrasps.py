"""Regrasps of plain values, right ones and such with one thing changed."""

from dataclasses import replace
from math import atan, cos, sin
from types import SimpleNamespace

import numpy as np

import regrasp as rg
from foreign import Plan, turn

AXIS = np.array([0.0, 0.0, 1.0])
FRICTION = 0.75


def contact(name, x, y, d, **more) -> rg.Contact:
    place, normal = [x, y, 0.0][:d], [-x, -y, 0.0][:d]
    return rg.Contact(place, normal, FRICTION, name=name, **more)


def seen(angle, d) -> np.ndarray:
    """A weight, 0.3 rad from -y, as seen from an object turned by ``angle``."""
    return np.array([-sin(angle + 0.3), -cos(angle + 0.3), 0.0][:d])


def held(grasp, angle, d, third=0.0) -> rg.GraspState:
    """A and C squeeze with 2 and carry half of the weight each; the third finger pushes against both."""
    load = seen(angle, d)
    forces = np.array([c.normal * (2 if c.name in "AC" else third) for c in grasp])
    rest = -(load + third * (grasp[2].normal if len(grasp) > 2 else 0)) / 2
    forces[:2] += rest
    return rg.GraspState(grasp, rg.Wrench(load), forces)


def regrasp(d=2, angle=0.5) -> SimpleNamespace:
    a, c = contact("A", -1, 0, d), contact("C", 1, 0, d)
    first, pair, last = (
        rg.Grasp([a, c, *more]) for more in ([contact("E", 0, -1, d)], [], [contact("G", 0, 1, d)])
    )
    removal = Plan("removal", "E", held(first, 0, d, 0.5), held(first, 0, d))
    start, end = held(pair, 0, d), held(pair, angle, d)
    path = turn([0, angle], [start.forces, end.forces], None if d == 2 else AXIS)
    rotation = Plan("rotation", None, start, end, turn=path)
    addition = Plan("addition", "G", held(last, angle, d), held(last, angle, d, 0.5))
    return whole([removal, rotation, addition], d, [0.0, 0.0, angle, angle])


def whole(steps, d, orientations) -> SimpleNamespace:
    margin = min(float(atan(FRICTION) - atan(0.5 / 2)), margin_of(steps))
    plan = SimpleNamespace(steps=tuple(steps), orientations=tuple(orientations), margin=margin)
    if d == 3:
        plan.rotations = np.array([matrix(angle) for angle in orientations])
    return plan


def margin_of(steps) -> float:
    return min(step.end.margins.least_angle for step in steps[:-1])


def matrix(angle) -> np.ndarray:
    return np.array([[cos(angle), -sin(angle), 0], [sin(angle), cos(angle), 0], [0, 0, 1.0]])


def changed(plan, k=None, **changes) -> SimpleNamespace:
    """The regrasp with another value, or with one of its steps changed."""
    values = vars(plan) | ({} if k is not None else changes)
    if k is not None:
        steps = list(plan.steps)
        steps[k] = replace(steps[k], **changes)
        values["steps"] = tuple(steps)
    return SimpleNamespace(**values)
