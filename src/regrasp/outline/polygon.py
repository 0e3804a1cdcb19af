"""A boundary of straight sides."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from regrasp.mechanics.checks import Array, ArrayLike, read_only
from regrasp.mechanics.value import ArrayValue

# Curves read from files turn by 2 degrees at most from chord to chord: their vertices are no corners.
CORNER_ANGLE = np.radians(5.0)
"""A vertex is a corner where the boundary turns by more than this [rad]."""


@dataclass(frozen=True, eq=False)
class PolygonBoundary(ArrayValue):
    """Straight sides between ``vertices`` (k, 2) [m], counter-clockwise, neighbours apart."""

    vertices: Array

    @cached_property
    def _lengths(self) -> Array:
        result: Array = np.hypot(*self._sides.T)
        return result

    @cached_property
    def _sides(self) -> Array:
        result: Array = np.roll(self.vertices, -1, axis=0) - self.vertices
        return result

    @cached_property
    def _directions(self) -> Array:
        result: Array = self._sides / self._lengths[:, None]
        return result

    @cached_property
    def _starts(self) -> Array:
        """(k + 1,) arc lengths of the vertices, and the whole length."""
        return np.concatenate([[0.0], np.cumsum(self._lengths)])

    @property
    def length(self) -> float:
        """[m]."""
        return float(self._starts[-1])

    @cached_property
    def corners(self) -> Array:
        """(k,) arc lengths of the vertices where the boundary turns by more than ``CORNER_ANGLE``."""
        before, after = np.roll(self._directions, 1, axis=0), self._directions
        sine = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        turn = np.arctan2(sine, (before * after).sum(axis=1))
        return read_only(self._starts[:-1][abs(turn) > CORNER_ANGLE])

    @cached_property
    def moments(self) -> tuple[float, Array]:
        """Area [m^2] and centroid (2,) [m], by Green's theorem about a vertex, where little cancels."""
        base = self.vertices[0]
        a, b = self.vertices - base, np.roll(self.vertices, -1, axis=0) - base
        cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        return float(cross.sum() / 2), base + ((a + b) * cross[:, None]).sum(axis=0) / (3 * cross.sum())

    @property
    def second_moment(self) -> float:
        """Polar, about the centroid [m^4]: triangles from it, cross / 12 (a.a + a.b + b.b) each."""
        a = self.vertices - self.moments[1]
        b = np.roll(a, -1, axis=0)
        cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        return float((cross * (a * a + a * b + b * b).sum(axis=1)).sum() / 12)

    def points(self, s: ArrayLike) -> Array:
        """(..., 2) points at arc lengths."""
        side, along = self._place(s)
        result: Array = self.vertices[side] + along[..., None] * self._directions[side]
        return result

    def tangents(self, s: ArrayLike) -> Array:
        """(..., 2) unit tangents; at a vertex that of the side after it."""
        result: Array = self._directions[self._place(s)[0]]
        return result

    def nearest(self, point: Array) -> float:
        """The arc length of the point nearest to ``point`` (2,); the first of several."""
        along = np.clip(((point - self.vertices) * self._directions).sum(axis=1), 0.0, self._lengths)
        feet = self.vertices + along[:, None] * self._directions
        side = int(np.argmin(np.hypot(*(feet - point).T)))
        return float(self._starts[side] + along[side]) % self.length

    def polygon(self, tolerance: float) -> Array:
        """(k, 2) the vertices themselves."""
        return self.vertices

    def _place(self, s: ArrayLike) -> tuple[np.ndarray, Array]:
        """The side each arc length lies on and how far along it [m]."""
        wrapped = np.asarray(s, dtype=float) % self.length
        side = np.clip(np.searchsorted(self._starts, wrapped, side="right") - 1, 0, len(self.vertices) - 1)
        return side, wrapped - self._starts[side]
