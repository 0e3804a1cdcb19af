"""Least normal forces and force limits of two fingers anywhere on an outline.

A least normal force is one more half plane for a finger's force. The disc of a force limit lies between two
polygons of the same directions, its tangents and, narrower by cos(alpha / parts), chords of it: of the arc
within a cone of half-angle alpha a few are enough.
"""

from math import atan, cos, hypot, inf, sin
from typing import NamedTuple

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.anywhere.polygons import Point, Row
from regrasp.planning.states.batch import locus_intervals

PARTS = 4, 16
"""Tangents of a force limit within each cone; the more, the slower."""


class Limits(NamedTuple):
    """Of every finger that holds [any unit of force]; an infinite ``max_force`` is none."""

    min_normal: float = 0.0
    max_force: float = inf

    def __bool__(self) -> bool:
        return self.min_normal > 0.0 or self.max_force < inf

    def per(self, unit: float) -> "Limits":
        """In another unit of force."""
        return Limits(self.min_normal / unit, self.max_force / unit)

    def chords(self, friction: float, parts: int) -> "Limits":
        """Those whose tangents are chords of the force limit within each cone."""
        return Limits(self.min_normal, self.max_force * cos(atan(friction) / parts))

    def turning(self, angle: float) -> "Limits":
        """Those that leave room for a turn between two holds.

        Forces are sums of those before and after, at most 1 / cos(angle / 2) times as large (docs/facts.md,
        6).
        """
        return Limits(self.min_normal, self.max_force * cos(0.5 * angle))

    def rows(self, along: Point, friction: float, parts: int) -> list[Row]:
        """Half planes a . f >= c of a finger on a side, the disc by tangents around it."""
        length = hypot(*along)
        tx, ty = along[0] / length, along[1] / length
        found: list[Row] = []
        if self.min_normal > 0.0:
            found.append(((-along[1], along[0]), self.min_normal * length))
        if self.max_force < inf:
            alpha = atan(friction)
            for k in range(parts):
                angle = alpha * ((2 * k + 1) / parts - 1.0)
                c, s = cos(angle), sin(angle)
                found.append(((c * ty - s * tx, -c * tx - s * ty), -self.max_force))
        return found


NONE = Limits()


def limited_intervals(
    points: Array, normals: Array, friction: float, forces: Array, limits: Limits
) -> tuple[Array, Array]:
    """Ends (lo, hi) of the squeezes (m,) of pairs (m, 2, 2) within limits, lo above hi for none.

    With e along P_2 - P_1 and f_1 = x e + y_1 e', the torque about P_2 gives y_1 = -P_2 x F / |P_2 - P_1|,
    and f_2 = -F - f_1: every limit bounds x.
    """
    (p, q), (n, m) = points.transpose(1, 0, 2), normals.transpose(1, 0, 2)
    lo, hi = locus_intervals(p, n, friction, q, m, friction, forces)
    e = (q - p) / np.hypot(*(q - p).T)[:, None]
    across = np.stack([-e[:, 1], e[:, 0]], axis=1)
    y = -(q[:, 0] * forces[:, 1] - q[:, 1] * forces[:, 0]) / np.hypot(*(q - p).T)
    along, aside = (forces * e).sum(axis=1), (forces * across).sum(axis=1)
    # Each finger's force is (x0 + sign x) e + y0 e'.
    for normal, sign, x0, y0 in ((n, 1.0, 0.0 * y, y), (m, -1.0, -along, -aside - y)):
        slope = sign * (normal * e).sum(axis=1)
        rest = limits.min_normal - x0 * (normal * e).sum(axis=1) - y0 * (normal * across).sum(axis=1)
        if limits.min_normal > 0.0:
            with np.errstate(divide="ignore", invalid="ignore"):
                bound = rest / slope
            lo = np.where(slope > 0, np.maximum(lo, bound), lo)
            hi = np.where(slope < 0, np.minimum(hi, bound), hi)
            hi = np.where((slope == 0) & (rest > 0), -inf, hi)
        if limits.max_force < inf:
            most = np.sqrt(np.maximum(limits.max_force**2 - y0**2, 0.0))
            most[abs(y0) > limits.max_force] = -inf
            lo, hi = np.maximum(lo, -most - sign * x0), np.minimum(hi, most - sign * x0)
    return lo, hi
