"""The path between two equilibria while the load turns (docs/facts.md, 6).

A force of fixed size that turns by Delta < pi is, at the angle theta from the first,

    w(theta) = a w^A + b w^B,   a = sin(Delta - theta) / sin(Delta),   b = sin(theta) / sin(Delta),

and the same combination of the forces balances it. a and b are never negative, so the cones are kept; their
sum is cos(theta - Delta / 2) / cos(Delta / 2), from 1 at the ends to 1 / cos(Delta / 2) in the middle.

A load with a part that does not turn (a torque in the plane; in space what lies along the axis) leaves that
line. It runs along an arc, whose tangents at both ends meet in w^M, and with the squares of half angles

    w = a w^A + c w^M + b w^B,   a = sin^2((Delta - theta) / 2) / sin^2(Delta / 2),
                                 b = sin^2(theta / 2) / sin^2(Delta / 2),   c = 1 - a - b >= 0:

a rational quadratic Bezier curve. Three states, the middle one under w^M, hold everything between them.
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
    half, x = (
        delta / 2,
        (theta - delta / 2)[..., None, None],
    )  # as in ``turning_peaks``, so that nothing cancels
    u, v = (start + end) / (2 * cos(half)), (end - start) / (2 * sin(half))
    slope: Array = v * np.cos(x) - u * np.sin(x)
    return slope


def turning_peaks(start: Array, end: Array, delta: float) -> tuple[float, float]:
    """The largest |f(theta)| and |f'(theta)| of one force (d,) in a turn.

    With x = theta - delta / 2 it is f = u cos x + v sin x: |f|^2 is a constant plus a sine wave in 2 x, and
    |f'|^2 the same constant less that wave.
    """
    if delta == 0:
        return sqrt(max(float(start @ start), float(end @ end))), 0.0
    half = delta / 2
    u, v = (start + end) / (2 * cos(half)), (end - start) / (2 * sin(half))
    uu, vv, uv = float(u @ u), float(v @ v), float(u @ v)
    c, p = (uu + vv) / 2, (uu - vv) / 2
    highest, steepest = (
        max(_highest(c, sign * p, sign * uv, side) for side in (half, -half)) for sign in (1, -1)
    )
    return sqrt(highest), sqrt(steepest)


def row_crests(start: Array, end: Array, delta: Array) -> Array:
    """The largest value on turns by ``delta`` of what is linear in forces, from its values at the ends."""
    half = delta / 2
    u, v = (start + end) / (2 * np.cos(half)), (end - start) / (2 * np.sin(half))
    is_between = np.abs(np.arctan2(v, u)) <= np.abs(half)
    crests: Array = np.where(is_between, np.hypot(u, v), np.maximum(start, end))
    return crests


def arc_weights(delta: float, theta: Array) -> tuple[Array, Array, Array]:
    """(a, c, b) of an arc by ``delta`` in (-pi, pi) at angles ``theta`` (...) between 0 and delta."""
    whole, before, after = sin(delta / 2), np.sin(theta / 2), np.sin((delta - theta) / 2)
    a, b = (after / whole) ** 2, (before / whole) ** 2
    return a, 2 * cos(delta / 2) * (before / whole) * (after / whole), b


def arc_path(start: Array, middle: Array, end: Array, delta: float, theta: Array) -> Array:
    """Forces (..., n, d) at angles ``theta`` (...), by way of ``middle`` (n, d), the forces under w^M."""
    a, c, b = (weight[..., None, None] for weight in arc_weights(delta, theta))
    path: Array = a * start + c * middle + b * end
    return path


def arc_slope(start: Array, middle: Array, end: Array, delta: float, theta: Array) -> Array:
    """The derivative of ``arc_path`` with respect to theta, (..., n, d)."""
    square = 2 * sin(delta / 2) ** 2
    a, b = -np.sin(delta - theta)[..., None, None] / square, np.sin(theta)[..., None, None] / square
    slope: Array = a * (start - middle) + b * (end - middle)
    return slope


def arc_peaks(start: Array, middle: Array, end: Array, delta: float) -> tuple[float, float]:
    """The largest |f(theta)| and |f'(theta)| of one force (d,) along an arc.

    With x = theta - delta / 2 it is f = u + v cos x + w sin x: the slope of |f|^2 is a trigonometric
    polynomial of degree two, whose zeros are those of a quartic in exp(i x).
    """
    half = delta / 2
    v = (middle - (start + end) / 2) * (cos(half) / sin(half) ** 2)
    u, w = middle - v / cos(half), (end - start) / (2 * sin(half))
    size = float(max(abs(u).max(), abs(v).max(), abs(w).max()))
    if size == 0:
        return 0.0, 0.0
    u, v, w = u / size, v / size, w / size  # squares of small forces would vanish
    vv, ww, vw = float(v @ v), float(w @ w), float(v @ w)
    first, second = complex(u @ w, u @ v), complex(vw, (vv - ww) / 2)  # of exp(i x) and exp(2 i x)
    zeros = np.angle(np.roots([second, first, 0.0, first.conjugate(), second.conjugate()]))
    at = np.r_[-half, half, zeros[abs(zeros) <= abs(half)]][:, None]
    highest = ((u + v * np.cos(at) + w * np.sin(at)) ** 2).sum(axis=1).max()
    steepest = max(_highest((vv + ww) / 2, (ww - vv) / 2, -vw, side) for side in (half, -half))
    return size * sqrt(float(highest)), size * sqrt(steepest)


def _highest(c: float, p: float, q: float, delta: float) -> float:
    """The largest c + p cos(2 x) + q sin(2 x) for x from 0 to delta."""
    crest = atan2(q, p) / 2
    inside = any(min(0.0, delta) <= at <= max(0.0, delta) for at in (crest, crest + pi, crest - pi))
    ends = (c + p * cos(2 * x) + q * sin(2 * x) for x in (0.0, delta))
    return max(c + hypot(p, q) if inside else 0.0, *ends, 0.0)
