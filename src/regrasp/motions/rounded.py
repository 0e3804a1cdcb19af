"""A polygonal way with rounded corners, passed from rest to rest.

A corner at p between unit directions u and v is the quadratic Bezier curve of p - h u, p, p + h v, which lies
in that triangle: what the straight parts and the triangles keep clear of, the way keeps clear of. With s the
length along the polygon, q'(s) is continuous, |q'| <= 1 and |q''| = |v - u| / (2 h) in a corner, else 0. In
time s = L (10 x^3 - 15 x^4 + 6 x^5), x = t / T; its largest s' is 15/8 L / T, its s'' 10 / sqrt 3 L / T^2.
"""

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import ArrayValue

FASTEST, _HARDEST = 15 / 8, 10 / sqrt(3)


@dataclass(frozen=True, eq=False)
class RoundedWay(ArrayValue):
    """points: (k, d) corners, no two in a row alike [m]. cuts: (k - 2,) how far before it each is rounded."""

    points: Array
    cuts: Array

    @cached_property
    def lengths(self) -> Array:
        """(k - 1,) of the straight parts, corners not rounded [m]."""
        result: Array = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return result

    @property
    def length(self) -> float:
        """Of the polygon; the way is no longer [m]."""
        return float(self.lengths.sum())

    @cached_property
    def directions(self) -> Array:
        """(k - 1, d) unit directions of the parts."""
        result: Array = np.diff(self.points, axis=0) / self.lengths[:, None]
        return result

    @cached_property
    def bend(self) -> float:
        """The largest |q''(s)| [1/m]."""
        if not self.cuts.size:
            return 0.0
        turns = np.linalg.norm(np.diff(self.directions, axis=0), axis=1)
        return float((turns / (2 * self.cuts)).max())

    def at(self, s: Array) -> tuple[Array, Array]:
        """Places (m, d) [m] and their change by s (m, d), at lengths (m,) along the polygon."""
        ends = np.cumsum(self.lengths)
        part = np.minimum(np.searchsorted(ends, s, side="right"), self.lengths.size - 1)
        along = s - (ends - self.lengths)[part]
        place = self.points[part] + along[:, None] * self.directions[part]
        change = self.directions[part].copy()
        for i, h in enumerate(self.cuts):
            x = (s - ends[i] + h) / (2 * h)
            near = (x > 0) & (x < 1)
            p, u, v, y = self.points[i + 1], self.directions[i], self.directions[i + 1], x[near][:, None]
            place[near] = p - (1 - y) ** 2 * h * u + y**2 * h * v
            change[near] = (1 - y) * u + y * v
        return place, change

    def shortest_time(self, speed: float, acceleration: float) -> float:
        """A time that keeps both limits all the way [s]; bends count as passed at the largest speed."""
        fast = FASTEST * self.length
        return max(fast / speed, sqrt((_HARDEST * self.length + fast**2 * self.bend) / acceleration))

    def part_before(self, s: float) -> float:
        """The part of its duration that goes by up to a length of the polygon [m], in steps of 1 / 1024."""
        x = np.arange(1025) / 1024
        return float(x[np.searchsorted(x**3 * (10 - 15 * x + 6 * x**2), s / self.length, side="right") - 1])

    def over_time(self, x: Array, duration: float) -> tuple[Array, Array]:
        """Places (m, d) [m] and velocities (m, d) [m/s] at parts x (m,) of the duration [s]."""
        s = self.length * x**3 * (10 - 15 * x + 6 * x**2)
        rate = self.length * 30 * x**2 * (1 - x) ** 2 / duration
        place, change = self.at(np.minimum(s, self.length))
        return place, rate[:, None] * change
