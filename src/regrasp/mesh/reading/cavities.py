"""Surfaces inside another: cavities of a body, which a mesh of one surface cannot hold."""

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mesh.arrays import Indices
from regrasp.mesh.solid import moments

_MOST_TRIED = 200  # surfaces, the largest first
_MOST_POINTS = 16  # vertices of each


def filled(solids: list[tuple[Array, Indices]], outer: int) -> list[str]:
    """Words on surfaces inside the one numbered ``outer`` that are wound the other way, so bound cavities."""
    vertices, faces = solids[outer]
    low, high, sense = vertices.min(axis=0), vertices.max(axis=0), moments(vertices, faces)[0]
    others = [solid for k, solid in enumerate(solids) if k != outer]
    volumes = []
    for points, part in sorted(others, key=lambda solid: -float(np.ptp(solid[0], axis=0).max()))[
        :_MOST_TRIED
    ]:
        volume = moments(points, part)[0]
        if volume * sense < 0 and (points >= low).all() and (points <= high).all():
            tried = points[:: -(-len(points) // _MOST_POINTS)]
            if (abs(windings(tried, vertices[faces])) > 0.5).all():
                volumes.append(abs(volume))
    if not volumes:
        return []
    what = f"{len(volumes)} cavit{'ies' if len(volumes) > 1 else 'y'}"
    return [f"filled: {what} of volume {sum(volumes):.6g}, since a mesh has one surface; its weight is off"]


def windings(points: Array, corners: Array) -> Array:
    """(k,) how often a closed surface of triangles (m, 3, 3) winds about each of ``points`` (k, 3).

    The sum of the triangles' solid angles over 4 pi (van Oosterom and Strackee, IEEE Transactions on
    Biomedical Engineering 30, 1983).
    """
    total = np.empty(len(points))
    for k, point in enumerate(points):
        a, b, c = (corners - point).transpose(1, 0, 2)
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=1)
        rest = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
        total[k] = np.arctan2(volume, rest).sum() / (2 * np.pi)
    return total
