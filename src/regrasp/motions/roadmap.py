"""Points off a surface and which of them may see one another: a roadmap, searched for shortest ways."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.motions.bounds import Distance

_LAYERS = (1.02, 1.5, 2.5)  # of how far tips keep: heights of points over faces
_MOST = 1500  # points of a layer, about
_NEIGHBOURS = 12
_TURN = np.cos(np.radians(30.0))  # of an edge around which points are set
_TRIES = 500  # ways looked at before there is said to be none

Clear = Callable[[Array, Array], bool]
"""Whether the straight way between two points (d,) keeps clear."""


@dataclass(frozen=True)
class Roadmap:
    """Points that keep clear of an object, and pairs of near ones.

    points: (m, 3) [m]. away: (m,) how far they are off the object [m]. pairs: (k, 2) numbers of points.
    reach: how far ways keep [m].
    """

    points: Array
    away: Array
    pairs: NDArray[np.intp]
    reach: float

    @classmethod
    def over(cls, faces: Array, outward: int, distance: Distance, reach: float, room: float) -> "Roadmap":
        """That over faces (m, 3, 3), in layers; both sides of those after the first ``outward``."""
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        doubled = np.linalg.norm(normals, axis=1)
        normals = normals / doubled[:, None]
        spacing = max(reach + room, float(np.sqrt(doubled.sum() / 2 / _MOST)))
        feet, face = _lattice(faces, spacing)
        lone = face >= outward
        rims, away_from = _rims(faces[:outward], normals[:outward], spacing)
        feet = np.concatenate([feet, feet[lone], rims])
        up = np.concatenate([normals[face], -normals[face[lone]], away_from])
        points = np.concatenate([_thinned(feet + h * (reach + room) * up, spacing / 2) for h in _LAYERS])
        away = distance(points)
        free = away >= reach + room / 2
        points, away = points[free], away[free]
        return cls(points, away, _near(points, points), reach)

    def way(
        self, start: Array, end: Array, to: Distance | None, apart: float, more: Array, clear: Clear
    ) -> Array | None:
        """(k, 3) a shortest way over pairs that ``clear`` finds clear; None where there is none.

        to: distances from fingers that stand, None without any, of which ways keep ``apart`` [m]. more:
            points (m, 3) besides.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import dijkstra

        ends = np.concatenate([[start, end], more])
        n = len(ends)
        points = np.concatenate([ends, self.points])
        tips = np.full(len(points), np.inf) if to is None else to(points)
        usable = tips >= apart
        usable[:2] = True
        pairs = np.concatenate([self.pairs + n, _near(ends, points)])
        pairs = pairs[usable[pairs].all(axis=1)]
        lengths = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
        away = np.concatenate([np.zeros(n), self.away])
        slack = [(v[pairs].sum(axis=1) - lengths) / 2 for v in (away, tips)]
        sure = (slack[0] >= self.reach) & (slack[1] >= apart)
        open_ = np.ones(len(pairs), dtype=bool)
        number = {(min(a, b), max(a, b)): k for k, (a, b) in enumerate(pairs.tolist())}
        for _ in range(_TRIES):
            ij = pairs[open_]
            graph = coo_array((lengths[open_], (ij[:, 0], ij[:, 1])), shape=(len(points),) * 2).tocsr()
            total, before = dijkstra(graph, directed=False, indices=0, return_predecessors=True)
            if not np.isfinite(total[1]):
                return None
            route = [1]
            while route[-1] != 0:
                route.append(int(before[route[-1]]))
            used = [number[min(a, b), max(a, b)] for a, b in itertools.pairwise(route)]
            for k in used:
                sure[k] = sure[k] or clear(*points[pairs[k]])
                open_[k] = sure[k]
            if open_[used].all():
                result: Array = points[route[::-1]]
                return result
        return None


def _lattice(faces: Array, spacing: float) -> tuple[Array, NDArray[np.intp]]:
    """(k, 3) points spread over faces (m, 3, 3) about ``spacing`` [m] apart, and the face of each."""
    sides = np.linalg.norm(np.roll(faces, -1, axis=1) - faces, axis=2).max(axis=1)
    number = np.maximum(1, np.ceil(sides / spacing)).astype(int)
    points, face = [], []
    for n in np.unique(number).tolist():
        i, j = (g.ravel() for g in np.mgrid[0:n, 0:n])
        up, down = i + j < n, i + j < n - 1
        u = np.concatenate([(i[up] + 1 / 3) / n, (i[down] + 2 / 3) / n])
        v = np.concatenate([(j[up] + 1 / 3) / n, (j[down] + 2 / 3) / n])
        which = np.flatnonzero(number == n)
        a, b, c = faces[which].transpose(1, 0, 2)[:, :, None]
        points.append((a + u[:, None] * (b - a) + v[:, None] * (c - a)).reshape(-1, 3))
        face.append(np.repeat(which, u.size))
    return np.concatenate(points), np.concatenate(face)


def _rims(faces: Array, normals: Array, spacing: float) -> tuple[Array, Array]:
    """Points (k, 3) along edges at which faces turn, and unit directions between the normals there."""
    ends = np.concatenate([faces[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    owner = np.tile(np.arange(len(faces)), 3)
    _, number = np.unique(np.round(ends.reshape(-1, 3) / spacing, 9), axis=0, return_inverse=True)
    number = np.sort(number.reshape(-1, 2), axis=1)
    order = np.lexsort((number[:, 1], number[:, 0]))
    same = np.flatnonzero((number[order[1:]] == number[order[:-1]]).all(axis=1))
    one, other = order[same], order[same + 1]
    turns = (normals[owner[one]] * normals[owner[other]]).sum(axis=1) < _TURN
    one, other = one[turns], other[turns]
    points, directions = [np.empty((0, 3))], [np.empty((0, 3))]
    for (a, b), m, n in zip(ends[one], normals[owner[one]], normals[owner[other]], strict=True):
        along = np.linspace(0, 1, max(1, int(np.ceil(np.linalg.norm(b - a) / spacing))) + 1)
        for f in (0.25, 0.5, 0.75):
            points.append(a + along[:, None] * (b - a))
            d = (1 - f) * m + f * n
            directions.append(np.tile(d / max(float(np.linalg.norm(d)), 1e-9), (along.size, 1)))
    return np.concatenate(points), np.concatenate(directions)


def _thinned(points: Array, cell: float) -> Array:
    """One point (k, 3) of every cell of a grid, cell by cell."""
    if not len(points):
        return points
    corner = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
    _, first = np.unique(corner, axis=0, return_index=True)
    result: Array = points[first]
    return result


def _near(some: Array, points: Array) -> NDArray[np.intp]:
    """(k, 2) pairs of each of ``some`` and its neighbours among ``points``, each once, none with itself."""
    from scipy.spatial import cKDTree

    if len(points) < 2 or not len(some):
        return np.empty((0, 2), dtype=np.intp)
    count = min(_NEIGHBOURS + 1, len(points))
    _, near = cKDTree(points).query(some, k=count)
    i = np.repeat(np.arange(len(some)), count)
    pairs = np.sort(np.column_stack([i, np.ravel(near)]), axis=1)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    result: NDArray[np.intp] = np.unique(pairs, axis=0)
    return result
