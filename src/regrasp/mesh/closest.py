"""The points of a surface nearest to given ones."""

from collections.abc import Iterator

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mesh.arrays import Indices

_FEW = 20_000  # pairs that are all looked at
_PAIRS = 100_000  # of points and faces looked at together: they stay in the cache


def weights_of_nearest(points: Array, corners: Array) -> Array:
    """(k, 3) barycentric weights of the point of each triangle (k, 3, 3) nearest to each point (k, 3)."""
    a, b, c = corners.transpose(1, 0, 2)
    e, g, d = b - a, c - a, points - a
    n = np.cross(e, g)
    area = (n * n).sum(axis=1)
    v, w = (np.cross(d, g) * n).sum(axis=1) / area, (np.cross(e, d) * n).sum(axis=1) / area
    result = np.stack([1 - v - w, v, w], axis=1)
    outside = np.flatnonzero((result < 0).any(axis=1))
    if outside.size:
        result[outside] = _on_sides(points[outside], corners[outside])
    return result


def _on_sides(points: Array, corners: Array) -> Array:
    start = corners
    side = np.roll(corners, -1, axis=1) - start  # (k, 3, 3)
    away = points[:, None] - start
    t = np.clip((away * side).sum(axis=2) / (side * side).sum(axis=2), 0.0, 1.0)  # (k, 3)
    best = np.argmin(np.linalg.norm(away - t[..., None] * side, axis=2), axis=1)
    row = np.arange(len(points))
    result = np.zeros((len(points), 3))
    result[row, best] = 1 - t[row, best]
    result[row, (best + 1) % 3] += t[row, best]
    return result


def touching(points: Array, corners: Array, slack: float) -> tuple[Indices, Indices, Array]:
    """The faces nearest to each point (n, 3), all that are so up to ``slack`` [m], above 0.

    Returns points, faces and weights (k,), (k,), (k, 3), sorted by point, then face.
    """
    found = list(_touching(points, corners, slack))
    i, f, w = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return i, f, w


def _touching(points: Array, corners: Array, slack: float) -> Iterator[tuple[Indices, Indices, Array]]:
    low, high, one = corners.min(axis=1), corners.max(axis=1), corners[:, 0]
    step = max(1, _PAIRS // len(corners))
    for begin in range(0, len(points), step):
        p = points[begin : begin + step]
        # A face's box is no farther than the face; one of its vertices is no nearer.
        box, vertex = np.zeros((len(p), len(corners))), np.zeros((len(p), len(corners)))
        for axis in range(3):
            x = p[:, axis, None]
            box += np.maximum(np.maximum(low[:, axis] - x, x - high[:, axis]), 0.0) ** 2
            vertex += (x - one[:, axis]) ** 2
        reach = np.sqrt(vertex.min(axis=1, keepdims=True)) + slack
        i, f = np.nonzero(box <= reach**2)
        w = weights_of_nearest(p[i], corners[f])
        away = np.linalg.norm(p[i] - at(corners[f], w), axis=1)
        least = np.minimum.reduceat(away, np.searchsorted(i, np.arange(len(p))))
        near = away <= least[i] + slack
        yield i[near] + begin, f[near], w[near]


def at(corners: Array, weights: Array) -> Array:
    """(k, 3) the points of triangles (k, 3, 3) at barycentric weights (k, 3); or vectors between three."""
    result: Array = np.einsum("kcx,kc->kx", corners, weights)
    return result


def to_segments(points: Array, starts: Array, ends: Array, limit: float) -> Array:
    """(n,) distances from points (n, 3) to the nearest of segments (k, 3), ``limit`` [m] where it is farther.

    A segment may be a point.
    """
    result = np.full(len(points), limit)
    if not len(starts):
        return result
    # Pieces no longer than the limit: what is within the limit of one is within 1.5 limits of its middle.
    count = np.maximum(1, np.ceil(np.linalg.norm(ends - starts, axis=1) / limit)).astype(int)
    k = np.repeat(np.arange(len(count)), count)
    rank = np.arange(len(k)) - np.repeat(np.cumsum(count) - count, count)
    side = ((ends - starts) / count[:, None])[k]
    begin = starts[k] + rank[:, None] * side
    square = (side * side).sum(axis=1)
    square[square == 0] = 1.0
    step = max(1, 20 * _PAIRS // len(k))
    for first in range(0, len(points), step):
        some = points[first : first + step]
        i, j = _pairs_within(some, begin + side / 2, 1.5 * limit)
        away = some[i] - begin[j]
        along = np.clip((away * side[j]).sum(axis=1) / square[j], 0.0, 1.0)
        np.minimum.at(result, i + first, np.linalg.norm(away - along[:, None] * side[j], axis=1))
    return result


def _pairs_within(some: Array, others: Array, reach: float) -> tuple[Indices, Indices]:
    """(p,), (p,) the pairs of points (n, 3) and others (k, 3) at most so far apart [m]."""
    if len(some) * len(others) <= _FEW:  # sooner done than trees are imported
        away = some[:, None] - others
        i, j = np.nonzero((away * away).sum(axis=2) <= reach * reach)
        return i, j
    from scipy.spatial import cKDTree

    pairs = cKDTree(some).sparse_distance_matrix(cKDTree(others), reach, output_type="ndarray")
    return pairs["i"], pairs["j"]
