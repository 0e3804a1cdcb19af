"""How far a load can go that two planar contacts hold, in closed form.

The forces are x u + f_1(k) and -x u + f_2(k), u along the line of the contacts and both linear in k, so that
each cone edge g . f >= 0 is a x + b k + c >= 0. A pair of edges with a_i > 0 > a_j leaves room for the
squeeze x where

    (b_i k + c_i) / a_i + (b_j k + c_j) / -a_j >= 0,

and an edge with a = 0 bounds k itself: the least of these bounds is the answer. The same sum of edges,
h = sum g / |a|, is what a twist makes of the forces, G' y = h, and so proves it.
"""

from collections.abc import Iterator
from math import hypot, inf
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp

_FLAT = 1e-12
_NO_ROOM = 1e-9

Row = tuple[float, float, float, int, tuple[float, float]]
"""a, b, c, the contact, and g."""


class ReachOfTwo(NamedTuple):
    """k, forces (2, 2) and the twist (3,) that proves that no k is larger; or a ray, without a twist."""

    k: float
    forces: Array
    twist: Array
    is_unbounded: bool


def reach_of_two(grasp: Grasp, base: Array, direction: Array, sign: float, most: float) -> ReachOfTwo | None:
    """The largest k, or with a ``sign`` below 0 the least, with which base + k direction is balanced.

    None where none is, where rounding decides, and for contacts at one place or without friction.
    """
    (x1, y1), (x2, y2) = grasp.positions.tolist()
    length = hypot(x2 - x1, y2 - y1)
    if length <= _FLAT * (grasp.size or 1.0) or min(grasp.frictions.tolist()) <= 0:
        return None
    u = (x2 - x1) / length, (y2 - y1) / length
    starts = [_shares(w, (x1, y1), (x2, y2), u, length) for w in (base.tolist(), direction.tolist())]
    rows: list[Row] = []
    for i, (n, mu) in enumerate(zip(grasp.normals.tolist(), grasp.frictions.tolist(), strict=True)):
        for side in (1.0, -1.0):
            g = mu * n[0] + side * n[1], mu * n[1] - side * n[0]
            a = (g[0] * u[0] + g[1] * u[1]) * (1 - 2 * i)
            c, b = (g[0] * f[i][0] + g[1] * f[i][1] for f in starts)
            rows.append((0.0 if abs(a) <= _FLAT * hypot(*g) else a, sign * b, c, i, g))
    low, high, binding = -inf, inf, None
    for slope, constant, h in _bounds(rows):
        if slope > 0:
            low = max(low, -constant / slope)
        elif slope < 0 and -constant / slope < high:
            high, binding = -constant / slope, h
        elif slope == 0 and constant < 0:
            return None
    room = max(abs(low) if low > -inf else 0.0, abs(high) if high < inf else 0.0)
    if not high - low > _NO_ROOM * room or high < -most or low > most:
        return None
    q = np.array([[-y1, x1], [-y2, x2]])
    if high == inf and most == inf:
        x = _squeeze([(a, b, 0.0, i, g) for a, b, _, i, g in rows], 1.0)
        return ReachOfTwo(sign, _forces(starts, u, x, sign, ray=True), np.zeros(3), is_unbounded=True)
    k = min(high, most)
    twist = np.zeros(3)
    if high <= most and binding is not None:
        twist[2] = (binding[0] - binding[1]) @ (q[0] - q[1]) / length**2
        twist[:2] = binding[0] - twist[2] * q[0]
    return ReachOfTwo(sign * k, _forces(starts, u, _squeeze(rows, k), sign * k), twist, is_unbounded=False)


def _shares(
    wrench: list[float],
    first: tuple[float, float],
    second: tuple[float, float],
    u: tuple[float, float],
    length: float,
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Forces of both contacts that balance a wrench, the first without a part along u."""
    fx, fy, torque = wrench
    across = -(torque + second[1] * fx - second[0] * fy) / length  # f_1 along the normal of u
    one = across * u[1], -across * u[0]
    return one, (-fx - one[0], -fy - one[1])


def _bounds(rows: list[Row]) -> Iterator[tuple[float, float, Array]]:
    """Slope and constant of each bound slope k + constant >= 0 on k, and its h (2, 2)."""
    for a, b, c, i, g in rows:
        h = np.zeros((2, 2))
        if a == 0:
            h[i] = g
            yield b, c, h
        if a <= 0:
            continue
        for a2, b2, c2, j, g2 in rows:
            if a2 < 0:
                h = np.zeros((2, 2))
                h[i] += np.array(g) / a
                h[j] += np.array(g2) / -a2
                yield b / a + b2 / -a2, c / a + c2 / -a2, h


def _squeeze(rows: list[Row], k: float) -> float:
    """A squeeze between its bounds, the middle where there are two."""
    low = max((-(b * k + c) / a for a, b, c, *_ in rows if a > 0), default=-inf)
    high = min((-(b * k + c) / a for a, b, c, *_ in rows if a < 0), default=inf)
    if low > -inf and high < inf:
        return (low + high) / 2
    return low if low > -inf else high if high < inf else 0.0


def _forces(
    starts: list[tuple[tuple[float, float], tuple[float, float]]],
    u: tuple[float, float],
    x: float,
    k: float,
    ray: bool = False,
) -> Array:
    base, more = (np.array(f) for f in starts)
    forces: Array = (0.0 if ray else 1.0) * base + k * more + x * np.array([u, (-u[0], -u[1])])
    return forces
