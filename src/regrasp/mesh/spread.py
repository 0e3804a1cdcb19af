"""Points spread evenly over a surface."""

from dataclasses import dataclass

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mesh.arrays import Indices
from regrasp.mesh.closest import at, to_segments

# Faces turned by more than this do not crowd one another: both sides and the rim of a plate get points.
_APART = np.cos(np.radians(75.0))
_POOL, _ENOUGH = 30, 8  # points of the pool for each one asked for: to begin with, and at least
_LEAST_POOL, _LARGE_POOL, _MOST_POOL = 3000, 30_000, 1_000_000
_ROUNDS = 4
_PAIRS = 4_000_000


@dataclass(frozen=True)
class Surface:
    """corners: (m, 3, 3). areas: (m,). normals: (m, 3). sharp: starts and ends (k, 3), (k, 3) of edges."""

    corners: Array
    areas: Array
    normals: Array
    sharp: tuple[Array, Array]


def spread(
    surface: Surface, count: int, seed: int, clearance: float | None, least: float
) -> tuple[Indices, Array]:
    """Faces (n,) and weights (n, 3) of ``count`` points, ``clearance`` [m] or more from sharp edges.

    A pool of points, random by area, is thinned: each next point is the one farthest from those before; then
    each moves to the middle of the part of the pool nearest to it, a few times (Lloyd). clearance: if not
    given, a quarter of the spacing sqrt(area / count), halved until half of the surface or more is left.
    """
    spacing = np.sqrt(surface.areas.sum() / count)
    extent = float(np.ptp(surface.corners, axis=(0, 1)).max())
    limit = max(spacing / 4 if clearance is None else clearance, extent / 1000)
    size = max(_LEAST_POOL, min(_POOL * count, _LARGE_POOL), _ENOUGH * count)
    while True:
        faces, weights = _pool(surface, size, np.random.default_rng(seed))
        points = at(surface.corners[faces], weights)
        room = to_segments(points, *surface.sharp, limit)
        keep = spacing / 4
        while clearance is None and keep > least and np.mean(room >= keep) < 0.5:
            keep /= 2
        keep = max(keep if clearance is None else clearance, least)
        free = np.flatnonzero(room >= keep)
        if free.size >= _ENOUGH * count or size >= _MOST_POOL or not free.size:
            break
        size = min(8 * size, _MOST_POOL)
    if free.size < count:
        farthest = to_segments(points[:: size // _LEAST_POOL], *surface.sharp, extent).max()
        raise InvalidInput(
            f"the surface has no room for {count} points {keep:.3g} or more from its sharp edges: "
            f"{free.size} of {size} random points are that far, the farthest about {farthest:.3g}; "
            "give a smaller clearance"
        )
    points, normals = points[free], surface.normals[faces[free]]
    chosen = free[_centred(points, normals, _farthest(points, normals, count))]
    return faces[chosen], weights[chosen]


def _pool(surface: Surface, size: int, rng: np.random.Generator) -> tuple[Indices, Array]:
    """Random points: one in each of ``size`` equal shares of the area."""
    heap = np.cumsum(surface.areas)
    where = (np.arange(size) + rng.random(size)) / size * heap[-1]
    faces = np.minimum(np.searchsorted(heap, where, side="right"), len(heap) - 1)
    root, other = np.sqrt(rng.random(size)), rng.random(size)
    weights = np.stack([1 - root, root * (1 - other), root * other], axis=1)
    return faces, weights


def _farthest(points: Array, normals: Array, count: int) -> Indices:
    x = points - points.mean(axis=0)
    square = (x * x).sum(axis=1)
    chosen = np.zeros(count, dtype=np.int64)
    away = np.full(len(x), np.inf)
    for i in range(1, count):
        last = chosen[i - 1]
        step = square - 2 * (x @ x[last]) + square[last]
        step[normals @ normals[last] < _APART] = np.inf
        np.minimum(away, step, out=away)
        chosen[i] = np.argmax(away)
    return chosen


def _centred(points: Array, normals: Array, chosen: Indices) -> Indices:
    """Each of the chosen points moved to the middle of those nearest to it."""
    count = len(chosen)
    for _ in range(_ROUNDS):
        cell = _nearest(points, normals, chosen)
        sizes = np.bincount(cell, minlength=count)
        sums = np.stack([np.bincount(cell, column, count) for column in points.T], axis=1)
        middles = sums / np.maximum(sizes, 1)[:, None]
        order = np.lexsort((((points - middles[cell]) ** 2).sum(axis=1), cell))
        full, first = np.unique(cell[order], return_index=True)
        chosen = chosen.copy()
        chosen[full] = order[first]
    return chosen


def _nearest(points: Array, normals: Array, chosen: Indices) -> Indices:
    """(n,) which of the chosen points is nearest to each point, among those that do not face apart."""
    result = np.zeros(len(points), dtype=np.int64)
    step = max(1, _PAIRS // len(chosen))
    centre = points.mean(axis=0)
    to = points[chosen] - centre
    for begin in range(0, len(points), step):
        part = slice(begin, begin + step)
        away = (to * to).sum(axis=1) - 2 * (points[part] - centre) @ to.T
        away[normals[part] @ normals[chosen].T < _APART] = np.inf
        result[part] = np.argmin(away, axis=1)
    return result
