"""Where a finger meets a surface that it comes to along a line, or from outside."""

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array
from regrasp.mechanics.value import numbers
from regrasp.mesh.closest import at, weights_of_nearest

_INSIDE = 1e-9  # of a barycentric weight: a line through an edge meets both faces
_MOST_TRIED = 2000


def crossings(point: Array, direction: Array, corners: Array) -> tuple[np.ndarray, Array]:
    """The faces (k,) of triangles (m, 3, 3) that a line meets, and where along it (k,) [of ``direction``].

    Cramer's rule for point + t d = a + v (b - a) + w (c - a) (Moeller and Trumbore, 1997).
    """
    a, b, c = corners.transpose(1, 0, 2)
    e, g, away = b - a, c - a, point - a
    p = np.cross(direction, g)
    det = (e * p).sum(axis=1)
    scale = np.linalg.norm(e, axis=1) * np.linalg.norm(g, axis=1) * np.linalg.norm(direction)
    crosses = abs(det) > 1e-12 * scale
    det = np.where(crosses, det, 1.0)
    v = (away * p).sum(axis=1) / det
    q = np.cross(away, e)
    w = (q @ direction) / det
    hit = np.flatnonzero(crosses & (v >= -_INSIDE) & (w >= -_INSIDE) & (v + w <= 1 + _INSIDE))
    return hit, ((q * g).sum(axis=1) / det)[hit]


def entry(point: Array, direction: Array, corners: Array, inward: Array) -> Array:
    """(3,) where the line through ``point`` along ``direction`` enters the object, nearest to the point.

    inward: (m, 3) normals of the faces. Raises ``InvalidInput`` where it never does.
    """
    if not direction.any():
        raise InvalidInput("along must be a direction, got (0, 0, 0)")
    direction = direction / np.linalg.norm(direction)
    faces, t = crossings(point, direction, corners)
    enters = inward[faces] @ direction > 0
    if not enters.any():
        raise InvalidInput(
            f"the line through {numbers(point)} along {numbers(direction)} does not enter the object"
        )
    t = t[enters]
    result: Array = point + t[np.argmin(abs(t))] * direction
    return result


def outermost(point: Array, corners: Array, inward: Array) -> Array:
    """(3,) the nearest point of the surface with nothing of the object in front of it, along its normal."""
    weights = weights_of_nearest(np.broadcast_to(point, (len(corners), 3)), corners)
    feet = at(corners, weights)
    order = np.argsort(np.linalg.norm(feet - point, axis=1), kind="stable")
    size = float(np.ptp(corners, axis=(0, 1)).max())
    for face in order[:_MOST_TRIED]:
        _, t = crossings(feet[face], -inward[face], corners)
        if not (t > 1e-9 * size).any():
            result: Array = feet[face]
            return result
    raise InvalidInput(f"no place near {numbers(point)} is open to the outside along its normal; give along=")
