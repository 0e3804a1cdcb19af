"""Distances from outlines and surfaces, for what checks ways through the air."""

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array


def to_boundary(points: Array, ring: Array) -> Array:
    """(m,) distances of points (m, 2) from the sides of a polygon (k, 2); negative inside [m]."""
    best, inside = np.full(len(points), np.inf), np.zeros(len(points), dtype=bool)
    x, y = points.T
    for p, q in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        u = np.clip(((points - p) @ (q - p)) / ((q - p) @ (q - p)), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - p - u[:, None] * (q - p), axis=1))
        if p[1] != q[1]:
            inside ^= ((p[1] > y) != (q[1] > y)) & (x < (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]) + p[0])
    return np.where(inside, -best, best)


def to_faces(points: Array, corners: Array) -> Array:
    """(m,) distances of points (m, 3) from triangles (k, 3, 3): to planes above them, else to sides [m]."""
    best = np.full(len(points), np.inf)
    for face in corners:
        centre = face.mean(axis=0)
        size = np.linalg.norm(face - centre, axis=1).max()
        near = np.linalg.norm(points - centre, axis=1) - size < best
        best[near] = np.minimum(best[near], _to_face(points[near], face))
    return best


def within(points: Array, corners: Array) -> NDArray[np.bool_]:
    """(m,) whether points (m, 3) are inside of closed triangles (k, 3, 3), by the angles these fill.

    Of a face at a, b, c from a point, sides x, y, z long, it is twice atan2(a . b x c, x y z + a . b z +
    b . c x + c . a y) (Van Oosterom and Strackee 1983); together 4 pi inside, 0 outside.
    """
    a, b, c = np.moveaxis(corners - points[:, None, None], 2, 0)
    x, y, z = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    beside = x * y * z + (a * b).sum(axis=2) * z + (b * c).sum(axis=2) * x + (c * a).sum(axis=2) * y
    filled = np.arctan2((a * np.cross(b, c)).sum(axis=2), beside).sum(axis=1)
    return np.asarray(abs(filled) > np.pi)


def _to_face(points: Array, face: Array) -> Array:
    a, b, c = face
    n = np.cross(b - a, c - a)
    n = n / np.linalg.norm(n)
    above, best = np.ones(len(points), dtype=bool), np.full(len(points), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        side = q - p
        above &= (points - p) @ np.cross(n, side) >= 0
        s = np.clip((points - p) @ side / (side @ side), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - p - s[:, None] * side, axis=1))
    return np.where(above, np.minimum(best, abs((points - a) @ n)), best)


def points_of_axis(tips: Array, capsule: Array, apart: float) -> Array:
    """(m, s, d) points of a finger's axis from its tips (m, d), at most ``apart`` [m] from one another."""
    count = int(np.ceil(np.linalg.norm(capsule) / apart)) + 1 if capsule.any() else 1
    return np.asarray(tips[:, None] + np.linspace(0, 1, count)[:, None] * capsule)


def to_axis(points: Array, tips: Array, capsule: Array) -> Array:
    """(m, s) distances of points (m, s, d) from the axes of another finger, from its tips (m, d) [m]."""
    away = points - tips[:, None]
    square = float(capsule @ capsule)
    along = np.clip(away @ capsule / square, 0.0, 1.0) if square else np.zeros(away.shape[:2])
    return np.asarray(np.linalg.norm(away - along[..., None] * capsule, axis=-1))
