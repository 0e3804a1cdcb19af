"""A closed curve by arc length, and polygons as the simplest of them."""

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from regrasp.mechanics.checks import Array


class Boundary(Protocol):
    """A closed curve run counter-clockwise, by arc length s in [0, length)."""

    @property
    def length(self) -> float:
        """[m]."""

    @property
    def corners(self) -> Array:
        """(k,) arc lengths where the tangent jumps."""

    @property
    def moments(self) -> tuple[float, Array]:
        """Area [m^2] and first moments (2,) [m^3] of the region inside."""

    def points(self, s: ArrayLike) -> Array:
        """(..., 2) points at arc lengths."""

    def tangents(self, s: ArrayLike) -> Array:
        """(..., 2) unit tangents; at a corner that of the stretch after it."""

    def nearest(self, point: Array) -> float:
        """The arc length of the point nearest to ``point`` (2,)."""

    def polygon(self, tolerance: float) -> Array:
        """(k, 2) corners of a polygon on the curve that is nowhere farther than ``tolerance`` from it."""


class PolygonBoundary:
    """Straight sides between vertices (k, 2), counter-clockwise."""

    def __init__(self, vertices: Array) -> None:
        self._vertices = vertices
        self._sides = np.roll(vertices, -1, axis=0) - vertices
        lengths = np.hypot(*self._sides.T)
        self._directions = self._sides / lengths[:, None]
        self._starts = np.concatenate([[0.0], np.cumsum(lengths)])

    @property
    def length(self) -> float:
        """[m]."""
        return float(self._starts[-1])

    @property
    def corners(self) -> Array:
        """(k,) arc lengths of the vertices between sides of different direction."""
        before = np.roll(self._directions, 1, axis=0)
        turn = before[:, 0] * self._directions[:, 1] - before[:, 1] * self._directions[:, 0]
        return self._starts[:-1][abs(turn) > 1e-12]

    @property
    def moments(self) -> tuple[float, Array]:
        """Area [m^2] and first moments (2,) [m^3], by Green's theorem side by side."""
        a, b = self._vertices, np.roll(self._vertices, -1, axis=0)
        cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        return float(cross.sum() / 2), ((a + b) * cross[:, None]).sum(axis=0) / 6

    def points(self, s: ArrayLike) -> Array:
        """(..., 2) points at arc lengths."""
        side, along = self._place(s)
        result: Array = self._vertices[side] + along[..., None] * self._directions[side]
        return result

    def tangents(self, s: ArrayLike) -> Array:
        """(..., 2) unit tangents; at a vertex that of the side after it."""
        result: Array = self._directions[self._place(s)[0]]
        return result

    def nearest(self, point: Array) -> float:
        """The arc length of the point nearest to ``point`` (2,)."""
        lengths = np.diff(self._starts)
        along = np.clip(((point - self._vertices) * self._directions).sum(axis=1), 0.0, lengths)
        feet = self._vertices + along[:, None] * self._directions
        side = int(np.argmin(((feet - point) ** 2).sum(axis=1)))
        return float(self._starts[side] + along[side]) % self.length

    def polygon(self, tolerance: float) -> Array:
        """(k, 2) the vertices themselves."""
        return self._vertices

    def _place(self, s: ArrayLike) -> tuple[np.ndarray, Array]:
        """The side each arc length lies on and how far along it [m]."""
        wrapped = np.asarray(s, dtype=float) % self.length
        side = np.clip(np.searchsorted(self._starts, wrapped, side="right") - 1, 0, len(self._vertices) - 1)
        return side, wrapped - self._starts[side]
