"""The path between two equilibria while the load turns (docs/facts.md, 6).

A force of fixed size that turns by Delta < pi is, at the angle theta from the first,

    w(theta) = a w^A + b w^B,   a = sin(Delta - theta) / sin(Delta),   b = sin(theta) / sin(Delta),

and the same combination of the forces balances it. a and b are never negative, so the cones are kept; their
sum is cos(theta - Delta / 2) / cos(Delta / 2), from 1 at the ends to 1 / cos(Delta / 2) in the middle.
"""

from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def turning_weights(delta: float, theta: Array) -> tuple[Array, Array]:
    """(a, b) of a turn by ``delta`` in (-pi, pi) at angles ``theta`` (...) between 0 and delta."""
    if delta == 0:
        return np.ones_like(theta), np.zeros_like(theta)
    return np.sin(delta - theta) / sin(delta), np.sin(theta) / sin(delta)


def turning_path(start: Array, end: Array, delta: float, theta: Array) -> Array:
    """Forces (..., n, d) at angles ``theta`` (...), from ``start`` (n, d) at 0 to ``end`` at ``delta``."""
    a, b = turning_weights(delta, theta)
    path: Array = a[..., None, None] * start + b[..., None, None] * end
    return path


def turning_slope(start: Array, end: Array, delta: float, theta: Array) -> Array:
    """The derivative of ``turning_path`` with respect to theta, (..., n, d)."""
    if delta == 0:
        return np.zeros((*theta.shape, *start.shape))
    a, b = -np.cos(delta - theta) / sin(delta), np.cos(theta) / sin(delta)
    slope: Array = a[..., None, None] * start + b[..., None, None] * end
    return slope


def turning_peaks(aa: float, ab: float, bb: float, delta: float) -> tuple[float, float]:
    """The largest |f(theta)| and |f'(theta)| of a turn, from aa = f_0.f_0, ab = f_0.f_1 and bb = f_1.f_1.

    |f|^2 sin^2(delta) = c + p cos(2 theta) + q sin(2 theta), and |f'|^2 is the same with -p and -q.
    """
    if delta == 0:
        return sqrt(max(aa, bb)), 0.0
    s, t = sin(delta), cos(delta)
    c = (aa - 2 * ab * t + bb) / 2
    p, q = (aa * cos(2 * delta) - 2 * ab * t + bb) / -2, s * (ab - aa * t)
    return sqrt(_highest(c, p, q, delta)) / abs(s), sqrt(_highest(c, -p, -q, delta)) / abs(s)


def _highest(c: float, p: float, q: float, delta: float) -> float:
    """The largest c + p cos(2 x) + q sin(2 x) for x from 0 to delta."""
    crest = atan2(q, p) / 2
    inside = any(min(0.0, delta) <= at <= max(0.0, delta) for at in (crest, crest + pi, crest - pi))
    ends = (c + p * cos(2 * x) + q * sin(2 * x) for x in (0.0, delta))
    return max(c + hypot(p, q) if inside else 0.0, *ends, 0.0)
