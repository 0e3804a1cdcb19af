"""Polytopes around unit balls, for round sets: fine where a program leans on their corners.

An outer polytope touches the unit sphere at points p_j: {u : p_j . u <= 1}. Its corners are the facets of the
hull of the p_j, each divided by its distance. What holds for the corners holds for all unit vectors, since
support functions are convex; what holds for all of them holds for the points p_j. So corners give forces that
are safe, points a bound on what forces can withstand. A corner on which a program leans is cut off by
touching there, too: two programs more and both meet to a percent or so.
"""

from functools import lru_cache
from itertools import product
from math import pi

import numpy as np

from regrasp.mechanics.checks import Array, read_only

SIDES = 24
_ROUNDING = 1e-12
_LEANS = 1e-5  # of the largest dual
_NEAR = 1.0005  # farther than this out a corner is cut off

CONE, LIMIT = "cone", "limit"
Key = tuple[int, int, str]
"""Case, contact, and what of it is round: its cone or its limit."""


class Apexes:
    """The outer polytopes of one program after the other."""

    def __init__(self) -> None:
        self._points: dict[Key, Array] = {}
        self._used: list[tuple[Key, Array, int]] = []

    def points(self, key: Key, size: int) -> Array:
        """(k, size) unit vectors at which the polytope touches."""
        return self._points.get(key, _start(size))

    def corners(self, key: Key, size: int, row: int) -> Array:
        """(k, size) its corners, which a program has from ``row`` on."""
        kept = self._points.get(key)
        found = _first_corners(size) if kept is None else _corners(kept)
        self._used.append((key, found, row))
        return found

    def forget(self) -> None:
        """Another program is laid out."""
        self._used.clear()

    def cut(self, duals: Array) -> bool:
        """Touch where the program with these duals (m,) leans on corners; False where these are near."""
        some = False
        for key, corners, row in self._used:
            lengths = np.sqrt((corners * corners).sum(axis=1))
            leans = (duals[row : row + len(corners)] > _LEANS * duals.max()) & (lengths > _NEAR)
            if leans.any():
                more = corners[leans] / lengths[leans, None]
                self._points[key] = np.vstack([self.points(key, corners.shape[1]), more])
                some = True
        return some


def _corners(points: Array) -> Array:
    from scipy.spatial import ConvexHull

    facets = ConvexHull(points).equations
    found: Array = facets[:, :-1] / -facets[:, -1:] * (1 + _ROUNDING)
    return found


@lru_cache
def _first_corners(size: int) -> Array:
    return read_only(np.unique(_corners(_start(size)).round(14), axis=0) * (1 + _ROUNDING))


@lru_cache
def _start(size: int) -> Array:
    """Evenly spread: on a circle; corners of an icosahedron and the middles of its edges; of the 24-cell."""
    if size == 2:
        angles = 2 * pi * np.arange(SIDES) / SIDES
        return read_only(np.column_stack([np.cos(angles), np.sin(angles)]))
    if size == 4:
        axes, signs = np.eye(4), np.array(list(product((0.5, -0.5), repeat=4)))
        return read_only(np.vstack([axes, -axes, signs]))
    long = (1 + 5**0.5) / 2
    signs = np.array([[0.0, a, b * long] for a in (1, -1) for b in (1, -1)])
    corners = np.vstack([np.roll(signs, k, axis=1) for k in range(3)])
    pairs = [(a, b) for a in range(12) for b in range(a) if abs(corners[a] @ corners[b] - long) < 1e-9]
    points = np.vstack([corners, [corners[a] + corners[b] for a, b in pairs]])
    return read_only(points / np.sqrt((points * points).sum(axis=1))[:, None])
