"""The most of v . f over forces that keep a distance from the edges of their cones and a limit, from above.

With A and B the edges of a sector, A the clockwise one, m_A and m_B across them inward, a force f of at most
F at a distance d or more from both edges has m_A . f >= d |A| and m_B . f >= d |B|, so for any s, t >= 0

    v . f <= (v + s m_A + t m_B) . f - (s |A| + t |B|) d <= F |v + s m_A + t m_B| - (s |A| + t |B|) d

and the least of these over a few s and t, those of the corners of the region, is the most of v . f. Cones
within a sector of less than half a turn: what keeps the distance from their edges keeps it from the sector's.
"""

from fractions import Fraction

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.protocol import Point
from regrasp.verification.placed.roots import root_above, root_below

_THINNEST = 0.1  # sine of a sector's angle: what rounding moves its tip by is ten times that of its edges


def cone_edges(d: Point, mu: Fraction) -> tuple[Point, Point]:
    """The edges of the cone about the normal (-d_y, d_x), the clockwise one first."""
    return (mu * d[0] - d[1], mu * d[1] + d[0]), (-mu * d[0] - d[1], -mu * d[1] + d[0])


def is_sector(a: Point, b: Point) -> bool:
    """Whether it is less than half a turn from one edge to the other, counter-clockwise."""
    return _cross(a, b) > 0


def most_eroded(a: Point, b: Point, limit: Fraction, margin: Fraction, v: Point) -> Fraction:
    """An upper bound of v . f, in rationals, close to the largest."""
    ma, mb = (-a[1], a[0]), (b[1], -b[0])
    da, db = (margin * root_below(e[0] * e[0] + e[1] * e[1]) for e in (a, b))
    # at the corner of both edges v + s m_A + t m_B = 0
    det = _cross(ma, mb)
    s, t = _cross(mb, v) / det, _cross(v, ma) / det
    if s >= 0 and t >= 0:
        return -s * da - t * db
    best = limit * root_above(v[0] * v[0] + v[1] * v[1])
    across = float(margin)
    along = float(root_below(limit * limit - margin * margin))
    for m, edge, least in ((ma, a, da), (mb, b, db)):
        # at the corner of an edge and the circle v + s m is along it
        fx, fy = (along * float(e) + across * float(c) for e, c in zip(edge, m, strict=True))
        turning = float(m[0]) * fy - float(m[1]) * fx
        s = Fraction(max(-(float(v[0]) * fy - float(v[1]) * fx) / turning, 0.0))
        x, y = v[0] + s * m[0], v[1] + s * m[1]
        best = min(best, limit * root_above(x * x + y * y) - s * least)
    return best


def roughly_eroded(a: Array, b: Array, limit: float, margin: float, v: Array) -> Array:
    """The same in doubles, of unit edges (m, 2) and v (m, 2)."""
    speed = np.hypot(*v.T)
    one, two, across = _crosses(a, v), _crosses(v, b), _crosses(a, b)
    along = np.sqrt(limit**2 - margin**2)
    left = along * a + margin * np.stack([-a[:, 1], a[:, 0]], axis=1)
    right = along * b + margin * np.stack([b[:, 1], -b[:, 0]], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        tip = (a + b) * (margin / across)[:, None]
    corners = np.max([(c * v).sum(axis=1) for c in (left, right, tip)], axis=0)
    inside = (limit * one >= margin * speed) & (limit * two >= margin * speed)
    result: Array = np.where(across < _THINNEST, np.inf, np.where(inside, limit * speed, corners))
    return result


def _cross(a: Point, b: Point) -> Fraction:
    return a[0] * b[1] - a[1] * b[0]


def _crosses(a: Array, b: Array) -> Array:
    result: Array = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return result
