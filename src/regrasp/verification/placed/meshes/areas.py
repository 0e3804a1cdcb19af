"""Which part of a surface triangles cover, no place of it counted twice."""

from itertools import pairwise
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array

_ON = 1e-9  # of the reach: a triangle is on a face
_CLOSE = 1e-9  # of the whole area
_MISSED = 1e-6  # of an area: what triangles may be beside faces, or over one another
_ASLANT = np.array([0.36, 0.48, 0.8])  # a direction that few faces are at right angles to


def share_of(corners: Array, normals: Array, vertices: Array, faces: Any) -> float:
    """The part of a mesh's area that triangles (m, 3, 3) with inward normals cover, or less by rounding [-].

    -1 where one of them is not on faces, or where two of them lie over one another. Where a face is left out
    it is not all, however small the face.
    """
    t = np.asarray(vertices)[np.asarray(faces)]
    cross = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    whole, sizes = _areas(t), _areas(np.asarray(corners))
    surface, reach = _Flat(t, -cross / (2 * whole)[:, None]), float(np.abs(vertices).max())
    given = _Flat(np.asarray(corners), np.asarray(normals))
    alike = _alike(given, surface)
    used, twice, covered = set(alike.values()), 0.0, np.zeros(len(whole))
    covered[list(used)] = whole[list(used)]
    if len(used) < len(alike):
        return -1.0
    for k, triangle in enumerate(given.corners):
        if k in alike:
            continue
        flat = (triangle - triangle.mean(axis=0)) @ given.normals[k]
        on = surface.beside(triangle, given.normals[k], reach)
        if np.abs(flat).max() > _ON * reach or not len(on):
            return -1.0
        same = on[np.abs(t[on] - triangle).max(axis=(1, 2)) <= _ON * reach]
        size = sizes[k]
        if len(same):
            if int(same[0]) in used:
                return -1.0
            used.add(int(same[0]))
            covered[same[0]] = whole[same[0]]
            continue
        common = np.array([_common(triangle, t[j], given.normals[k]) for j in on])
        others = given.beside(triangle, given.normals[k], reach)
        over = [_common(triangle, given.corners[j], given.normals[k]) for j in others if j != k]
        if common.sum() < size * (1 - _MISSED) or max(over, default=0.0) > _MISSED * size:
            return -1.0
        covered[on] += common
        twice += sum(over)
    share = float((covered.sum() - twice) / whole.sum())
    return share if (covered >= whole * (1 - _MISSED)).all() else min(share, 1 - 2 * _CLOSE)


def share_on(shape: Any, proof: Any) -> float:
    """The part of a mesh that a proof is about, -1 where it is about no part of it, or about no mesh."""
    return share_of(proof.corners, proof.normals, *shape.surface()) if hasattr(shape, "surface") else -1.0


def part_of_surface(share: float) -> str:
    """Which part of a mesh the places are on that a proof is about; empty for all of it."""
    return "" if share > 1 - _CLOSE else f" on the {share:.1%} of the surface that was asked about"


class _Flat:
    """Triangles (m, 3, 3) and their unit normals (m, 3)."""

    def __init__(self, corners: Array, normals: Array) -> None:
        self.corners, self.normals = corners, normals
        self._centres = corners.mean(axis=1)
        self._least, self._most = corners.min(axis=1), corners.max(axis=1)
        # what lies together does along any direction: so of many few are looked at
        along = normals @ _ASLANT
        self._by_normal = np.argsort(along, kind="stable")
        self._facing = along[self._by_normal]
        heights = corners @ _ASLANT
        self._by_height = np.argsort(heights.min(axis=1), kind="stable")
        self._lowest = heights.min(axis=1)[self._by_height]
        self._reached = np.maximum.accumulate(heights.max(axis=1)[self._by_height])

    def beside(self, triangle: Array, normal: Array, reach: float) -> np.ndarray:
        """Which are in the plane of a triangle, with the same normal, and near it."""
        some = self._some(triangle, normal, reach)
        found = np.linalg.norm(self.normals[some] - normal, axis=1) <= _ON
        found &= np.abs((self._centres[some] - triangle.mean(axis=0)) @ normal) <= _ON * reach
        near = (self._least[some] <= triangle.max(axis=0) + _ON * reach) & (
            self._most[some] >= triangle.min(axis=0) - _ON * reach
        )
        result: np.ndarray = some[found & near.all(axis=1)]
        return result

    def _some(self, triangle: Array, normal: Array, reach: float) -> np.ndarray:
        """In order, all that may be beside a triangle, and few of the others."""
        facing, heights, room = normal @ _ASLANT, triangle @ _ASLANT, 2 * _ON * reach
        a, b = np.searchsorted(self._facing, [facing - 2 * _ON, facing + 2 * _ON])
        c = np.searchsorted(self._reached, heights.min() - room)
        d = np.searchsorted(self._lowest, heights.max() + room)
        return np.sort(self._by_normal[a:b] if b - a < d - c else self._by_height[c:d])


def _alike(given: _Flat, surface: _Flat) -> dict[int, int]:
    """Which triangles are faces to the last digit, in the order of their corners, too."""
    places = {corners.tobytes(): j for j, corners in enumerate(surface.corners + 0.0)}
    found = {k: places.get(corners.tobytes(), -1) for k, corners in enumerate(given.corners + 0.0)}
    off = np.abs(given.normals - surface.normals[list(found.values())]).max(axis=1) if found else np.zeros(0)
    return {k: j for k, j in found.items() if j >= 0 and off[k] <= _ON}


def _areas(t: Array) -> Array:
    result: Array = np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1) / 2
    return result


def _common(one: Array, other: Array, normal: Array) -> float:
    """The area that two triangles of one plane share: the one cut along the sides of the other."""
    u = np.linalg.svd(normal[None])[2][1:]
    left, cutter = [p @ u.T for p in one], other @ u.T
    way = np.sign(_turn(*cutter))
    for p, q in pairwise((*cutter, cutter[0])):
        heights = [way * _turn(p, q, r) for r in left]
        kept = []
        for (a, b), (r, s) in zip(_around(heights), _around(left), strict=True):
            if a >= 0:
                kept.append(r)
            if a * b < 0:
                kept.append(r + a / (a - b) * (s - r))
        left = kept
    return abs(sum(float(r[0] * s[1] - r[1] * s[0]) for r, s in _around(left))) / 2


def _turn(p: Array, q: Array, r: Array) -> float:
    """Twice the area of a triangle, positive counter-clockwise."""
    return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))


def _around(items: list[Any]) -> list[tuple[Any, Any]]:
    """Each with the next, the last with the first."""
    return list(zip(items, items[1:] + items[:1], strict=True))
