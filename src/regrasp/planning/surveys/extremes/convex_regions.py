"""Convex regions by their corners: (2, 1) ends of an interval, (m, 2) of a polygon, counter-clockwise."""

import numpy as np

from regrasp.mechanics.checks import Array

_NEAR = 1e-12


def size(corners: Array) -> float:
    """Length of an interval, area of a polygon."""
    if len(corners) < 2:
        return 0.0
    if corners.shape[1] == 1:
        return float(corners[-1, 0] - corners[0, 0])
    (x, y), (u, v) = corners.T, np.roll(corners, -1, axis=0).T
    return float((x * v - y * u).sum()) / 2


def hull(points: Array) -> Array:
    """The corners of the convex hull (Andrew's monotone chain)."""
    if points.shape[1] == 1:
        return np.array([points.min(axis=0), points.max(axis=0)])
    ordered = points[np.lexsort((points[:, 1], points[:, 0]))]
    sides = []
    for chain in (ordered, ordered[::-1]):
        side: list[Array] = []
        for p in chain:
            while len(side) > 1 and _turn(side[-2], side[-1], p) <= 0:
                side.pop()
            side.append(p)
        sides += side[:-1]
    return np.array(sides if sides else ordered[:1])


def clipped(corners: Array, normal: Array, bound: float) -> Array:
    """The part of a region where normal . k <= bound; none may be left, (0, p)."""
    beyond = corners @ normal - bound
    if corners.shape[1] == 1:
        end = bound / normal[0]
        low, high = corners[:, 0]
        low, high = (low, min(high, end)) if normal[0] > 0 else (max(low, end), high)
        return np.array([[low], [high]])
    kept = []
    for i, p in enumerate(corners):
        j = (i + 1) % len(corners)
        if beyond[i] <= 0:
            kept.append(p)
        if (beyond[i] < 0 < beyond[j]) or (beyond[j] < 0 < beyond[i]):
            kept.append(p + (corners[j] - p) * beyond[i] / (beyond[i] - beyond[j]))
    return np.array(kept).reshape(-1, 2)


def contains(corners: Array, point: Array) -> bool:
    """Whether a point lies in the region, its edge included but for rounding."""
    if not len(corners):
        return False
    far = float(np.abs(corners).max()) or 1.0
    if corners.shape[1] == 1:
        return bool(corners[0, 0] - _NEAR * far <= point[0] <= corners[-1, 0] + _NEAR * far)
    if len(corners) < 3:
        a, b = corners[0], corners[-1]
        length = float((b - a) @ (b - a))
        share = min(max(float((point - a) @ (b - a)) / length, 0.0), 1.0) if length else 0.0
        return float(np.linalg.norm(a + share * (b - a) - point)) <= _NEAR * far
    return all(
        _turn(a, b, point) >= -_NEAR * far * float(np.linalg.norm(b - a))
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)
    )


def widest_gap(inner: Array, outer: Array, asked: list[Array]) -> Array | None:
    """The unit normal of the inner side beyond which most of the outer region lies, not ``asked`` before."""
    best, most = None, 0.0
    sides = [(a, b) for a, b in zip(inner, np.roll(inner, -1, axis=0), strict=True) if (a != b).any()]
    for a, b in sides:
        length = float(np.linalg.norm(b - a))
        normal = np.array([b[1] - a[1], a[0] - b[0]]) / length
        area = length * float(((outer - a) @ normal).max())
        if area > most and not any(normal @ n > 1 - 1e-15 for n in asked):
            best, most = normal, area
    return best


def _turn(a: Array, b: Array, c: Array) -> float:
    """Twice the area of the triangle a b c, positive to the left."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
