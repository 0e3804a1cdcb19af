"""The forces of a transition at any time, from what was proven of it: ends, instants or angles.

A clamped uniform B-spline by de Boor's algorithm, linear interpolation, and fact 6 of docs/facts.md: the same
formulas that plans answer ``forces(t)`` by, written apart from them, so that one which answers otherwise is
found out.
"""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.protocols import Plan, Scaling, Turn


def retraced(plan: Plan, times: Array) -> Array:
    """(m, n, d) forces at m times in [0, duration] [N]."""
    shape = (times.size, *plan.start.forces.shape)
    if plan.course is not None:
        columns = plan.course.forces.reshape(plan.course.times.size, -1).T
        rows = np.stack([np.interp(times, plan.course.times, column) for column in columns], axis=-1)
        return rows.reshape(shape)
    fallen = _fallen(plan.scaling, times)
    if plan.turn is not None:
        return _turned(plan.turn, fallen)
    share = fallen[:, None, None]
    path: Array = share * plan.start.forces + (1 - share) * plan.end.forces
    return path


def turned_by(turn: Turn, scaling: Scaling, times: Array) -> Array:
    """(m,) angles of the object at m times in [0, duration], from its start [rad]."""
    angles: Array = turn.angles[-1] * (1 - _fallen(scaling, times))
    return angles


def _fallen(scaling: Scaling, times: Array) -> Array:
    """T (m,), by de Boor's algorithm on the spans of equal length between the ends."""
    control = np.array(scaling.control, dtype=float)
    degree = getattr(scaling, "degree", min(3, control.size - 1))
    spans = control.size - degree
    knots = np.concatenate([np.zeros(degree), np.linspace(0, 1, spans + 1), np.ones(degree)])
    at = times / scaling.duration
    first = np.clip(np.searchsorted(knots[degree:-degree], at, side="right") - 1, 0, spans - 1)
    values = [control[first + j] for j in range(degree + 1)]
    for r in range(1, degree + 1):
        for j in range(degree, r - 1, -1):
            low, high = knots[first + j], knots[first + j + degree - r + 1]
            share = (at - low) / (high - low)
            values[j] = (1 - share) * values[j - 1] + share * values[j]
    return values[degree]


def _turned(turn: Turn, fallen: Array) -> Array:
    """The combination of the states at both ends of each step, and of the one between where there is one."""
    angles = turn.angles
    theta = angles[-1] * (1 - fallen)
    way = np.sign(angles[-1])
    k = np.clip(np.searchsorted(way * angles, way * theta, side="right") - 1, 0, angles.size - 2)
    step, on = np.diff(angles)[k], theta - angles[k]
    if turn.middles is None:
        a, b = np.sin(step - on) / np.sin(step), np.sin(on) / np.sin(step)
        straight: Array = a[:, None, None] * turn.forces[k] + b[:, None, None] * turn.forces[k + 1]
        return straight
    whole, before, after = (np.sin(x / 2) for x in (step, on, step - on))
    a, b, c = (after / whole) ** 2, (before / whole) ** 2, 2 * np.cos(step / 2) * before * after / whole**2
    states = (turn.forces[k], turn.forces[k + 1], turn.middles[k])
    path: Array = sum(w[:, None, None] * f for w, f in zip((a, b, c), states, strict=True))
    return path
