"""Parts of a boundary of cubics or of straight sides: points whose hull contains one, and its tangents.

A place is the number of its piece plus the fraction of it passed, modulo how many there are.
"""

from typing import Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.cubic import polar_at

ROUNDING = 2.0**-46
"""Doubles are off by a few 2^-53 of the reach of points, and tangents of the longest they are mixed from."""
_CORNER = 5.0  # degrees, by which polygons turn at a corner at least


class Pieces(Protocol):
    """Of a boundary."""

    @property
    def count(self) -> int:
        """How many."""

    @property
    def reach(self) -> float:
        """No point is farther from the centre of mass, along an axis [m]."""

    def hull(self, lo: float, hi: float) -> tuple[Array, Array, Array]:
        """(m, 2) points, (t, 2) tangents of any length, (t,) how far from them true ones may be."""

    def point(self, u: float) -> Array:
        """(2,) at a place [m]."""

    def to_corners(self, s: float) -> tuple[float, float]:
        """How far it is to a corner from an arc length, back and ahead [m]."""


class Cubics:
    """A smooth boundary of (k, 4, 2) control points, which has no corners."""

    def __init__(self, control: Array) -> None:
        self.control, self.count, self.reach = control, len(control), float(np.abs(control).max())

    def hull(self, lo: float, hi: float) -> tuple[Array, Array, Array]:
        """Control points of the parts stand for their curve, those of its derivative for its tangents."""
        edges, a, b = _parts(lo, hi)
        pieces = np.moveaxis(self.control[edges % self.count], 1, 0)
        points = np.concatenate([polar_at(pieces, at) for at in ((a, a, a), (a, a, b), (a, b, b), (b, b, b))])
        ways = np.diff(pieces, axis=0)
        tangents = np.concatenate([polar_at(ways, at) for at in ((a, a), (a, b), (b, b))])
        return points, tangents, np.full(len(tangents), ROUNDING * np.hypot(*ways.T).max())

    def point(self, u: float) -> Array:
        """Of its cubic."""
        edge = int(np.floor(u))
        at = np.array([u - edge])
        result: Array = polar_at(self.control[edge % self.count][:, None], (at, at, at))[0]
        return result

    def to_corners(self, _: float) -> tuple[float, float]:
        """There are none."""
        return np.inf, np.inf


class StraightSides:
    """A polygon of (k, 2) vertices."""

    def __init__(self, vertices: Array) -> None:
        self.vertices, self.count, self.reach = vertices, len(vertices), float(np.abs(vertices).max())
        self.along = np.roll(vertices, -1, axis=0) - vertices

    def hull(self, lo: float, hi: float) -> tuple[Array, Array, Array]:
        """The ends of the parts of sides, and each side."""
        edges, a, b = _parts(lo, hi)
        starts, tangents = self.vertices[edges % self.count], self.along[edges % self.count]
        points = np.concatenate([starts + at[:, None] * tangents for at in (a, b)])
        return points, tangents, ROUNDING * np.hypot(*tangents.T)

    def point(self, u: float) -> Array:
        """On its side."""
        edge = int(np.floor(u))
        result: Array = self.vertices[edge % self.count] + (u - edge) * self.along[edge % self.count]
        return result

    def to_corners(self, s: float) -> tuple[float, float]:
        """From vertex to vertex."""
        lengths, before = np.hypot(*self.along.T), np.roll(self.along, 1, axis=0)
        across = before[:, 0] * self.along[:, 1] - before[:, 1] * self.along[:, 0]
        turned = np.abs(np.arctan2(across, (before * self.along).sum(axis=1)))
        at = np.concatenate([[0.0], np.cumsum(lengths)])
        corners = at[:-1][turned > np.radians(_CORNER)]
        back, ahead = (s - corners) % at[-1], (corners - s) % at[-1]
        return float(back.min(initial=np.inf)), float(ahead.min(initial=np.inf))


def _parts(lo: float, hi: float) -> tuple[np.ndarray, Array, Array]:
    """(m,) pieces between two places, and fractions of each from which on and up to which it is."""
    edges = np.arange(np.floor(lo), max(np.ceil(hi), np.floor(lo) + 1))
    return edges.astype(int), np.maximum(lo - edges, 0.0), np.minimum(hi - edges, 1.0)
