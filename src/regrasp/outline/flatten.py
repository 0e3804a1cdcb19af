"""Curves of drawings as chords."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from regrasp.mechanics.checks import Array

# Half of what two neighbouring chords may turn by: the turn from a chord's first half to its second.
_HALF_TURN = np.radians(1.0)
_FIRST, _HALVINGS = 4, 14


@dataclass(frozen=True)
class Curve:
    """A piece of a drawing: points ``at`` (m, 2) for parameters (m,) from start to end."""

    at: Callable[[Array], Array]
    start: float = 0.0
    end: float = 1.0
    straight: bool = False


def line(a: Array, b: Array) -> Curve:
    """The straight piece from a (2,) to b (2,)."""
    return Curve(lambda t: a + t[:, None] * (b - a), straight=True)


def flattened(curve: Curve, tolerance: float) -> Array:
    """(k, 2) points from end to end: chords within ``tolerance`` of the curve, turning 2 degrees at most."""
    if curve.straight:
        return curve.at(np.array([curve.start, curve.end]))
    t = np.linspace(curve.start, curve.end, _FIRST + 1)
    for _ in range(_HALVINGS):
        middle = (t[:-1] + t[1:]) / 2
        points, between = curve.at(t), curve.at(middle)
        first, second = between - points[:-1], points[1:] - between
        cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        turn = abs(np.arctan2(cross, (first * second).sum(axis=1)))
        sagitta = abs(cross) / np.maximum(np.hypot(*(first + second).T), 1e-300)
        rough = (turn > _HALF_TURN) | (sagitta > tolerance)
        if not rough.any():
            break
        t = np.sort(np.concatenate([t, middle[rough]]))
    return curve.at(t)
