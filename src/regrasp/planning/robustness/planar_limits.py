"""Where the force of a planar finger, as it changes with one number, leaves the disc |f| <= L.

Along a deviation that grows the force moves on a line, so |f| = L is a quadratic. As a load turns by a it
moves on an ellipse c + p cos a + q sin a, and with t = tan(a / 2) L^2 - |f|^2 times (1 + t^2)^2 is a quartic
in t. As a contact is off by x it is v(x) / s(x) with quadratics v and s, and L^2 s^2 - |v|^2 is a quartic.
"""

from collections.abc import Sequence
from math import atan, inf, sqrt

import numpy as np

Pair = tuple[float, float]
Quadratic = tuple[float, float, float]
"""Coefficients of 1, x and x^2."""

_REAL = 1e-7
"""Of a root's size: an imaginary part below it is rounding's, where the polynomial only touches 0."""


def line_out(force: Pair, change: Pair, limit: float) -> float:
    """The least m >= 0 beyond which |force + m change| > limit; infinite if never."""
    square = change[0] ** 2 + change[1] ** 2
    if square == 0:
        return inf
    along = force[0] * change[0] + force[1] * change[1]
    room = max(limit * limit - force[0] ** 2 - force[1] ** 2, 0.0)
    root = sqrt(along * along + square * room)
    return room / (root + along) if along > 0 else (root - along) / square


def turn_out(middle: Pair, start: Pair, quarter: Pair, limit: float, least: float) -> float:
    """The a nearest to 0, in (-pi, pi), beyond which |middle + start cos a + quarter sin a| > limit.

    Infinite if there is none; it may be if it is farther than ``least``.
    """
    reach = sum(abs(p) * least * least / 2 + abs(q) * least for p, q in zip(start, quarter, strict=True))
    force = middle[0] + start[0], middle[1] + start[1]
    if sqrt(force[0] ** 2 + force[1] ** 2) + reach < limit:
        return inf
    components = [(c + p, 2 * q, c - p) for c, p, q in zip(middle, start, quarter, strict=True)]
    t = _first_below(_room((1.0, 0.0, 1.0), components, limit))
    return 2 * atan(t) if t < inf else inf


def shift_out(size: Quadratic, components: Sequence[Quadratic], limit: float, least: float) -> float:
    """The x nearest to 0 beyond which |v(x)| > limit s(x), s > 0; as in ``turn_out``."""
    room = _room(size, components, limit)
    if least < inf and room[0] > sum(abs(c) * least**k for k, c in enumerate(room) if k):
        return inf
    return _first_below(room)


def _room(size: Quadratic, components: Sequence[Quadratic], limit: float) -> list[float]:
    """Coefficients of limit^2 s^2 - |v|^2."""
    squares = [_square(one) for one in components]
    found = [limit * limit * c - sum(v) for c, *v in zip(_square(size), *squares, strict=True)]
    return [max(found[0], 0.0), *found[1:]]


def _square(a: Quadratic) -> tuple[float, ...]:
    return a[0] * a[0], 2 * a[0] * a[1], 2 * a[0] * a[2] + a[1] * a[1], 2 * a[1] * a[2], a[2] * a[2]


def _first_below(coefficients: list[float]) -> float:
    """The x nearest to 0 beyond which a polynomial falls below 0, at least 0 at x = 0; infinite if never."""
    if coefficients[0] == 0 and coefficients[1]:
        return 0.0
    best = inf
    for root in np.roots(coefficients[::-1]).tolist():
        x = root.real
        if abs(root.imag) > _REAL * abs(root) or abs(x) >= abs(best):
            continue
        slope = sum(k * c * x ** (k - 1) for k, c in enumerate(coefficients) if k)
        if slope * x < 0:
            best = x
    return best
