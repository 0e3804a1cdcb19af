"""Flat faces that stand for round sets, from inside: what they accept is truly safe.

In the plane a friction cone has two edges and needs nothing else. In space an inner pyramid has its vertices
on the cone, the first along t_1, and so its faces nearer to the axis: with u_k between two vertices,

    mu cos(pi / m) f.n - f.u_k >= 0,    k = 1..m.

A limit |f| <= r becomes f.u <= c r for directions u, with c the least cosine to the nearest u of any
direction that f may have: around the whole circle in the plane, over the friction cone in space, in rings.
"""

from functools import lru_cache
from math import atan, ceil, cos, pi, sin

import numpy as np

from regrasp.mechanics.checks import Array, read_only
from regrasp.mechanics.grasp import Grasp


def cone_faces(grasp: Grasp, frictions: Array, facets: int | None) -> Array:
    """(n, k, d) rows a with a.f >= 0 inside the cone: its edges in the plane, the pyramid's in space."""
    n, t = grasp.normals, grasp.tangents
    if grasp.dimension == 2:
        across = frictions[:, None] * n
        return np.stack([across - t, across + t], axis=1)
    if facets is None:
        raise ValueError("a cone in space has no faces unless facets are given")
    round_ = _circle(facets, 0.5) @ t  # (n, facets, 3)
    faces: Array = (frictions * cos(pi / facets))[:, None, None] * n[:, None] - round_
    return faces


def ball_faces(grasp: Grasp, frictions: Array, facets: int) -> tuple[Array, Array]:
    """Directions u (n, k, d) and cosines c (n, k): f.u <= c r for all k makes |f| <= r in the cone."""
    if grasp.dimension == 2:
        around, shape = _circle(facets, 0.0), (len(grasp), facets)
        return np.broadcast_to(around, (*shape, 2)), np.full(shape, cos(pi / facets))
    n, (t1, t2) = grasp.normals[:, None], np.moveaxis(grasp.tangents, 1, 0)[:, :, None]
    caps = [_cap(atan(mu), facets, ceil(facets / 4)) for mu in frictions.tolist()]
    x, y, z = (np.array([cap[0][:, axis] for cap in caps])[..., None] for axis in range(3))
    return x * t1 + y * t2 + z * n, np.array([cap[1] for cap in caps])


def round_faces(facets: int, dimension: int) -> tuple[Array, Array]:
    """Directions (k, d) and cosines (k,) all around: v.u <= c r for all k makes |v| <= r for any v."""
    if dimension == 2:
        return _circle(facets, 0.0), np.full(facets, cos(pi / facets))
    return _cap(pi, facets, ceil(facets / 2))


def gauge(forces: Array, directions: Array, cosines: Array) -> float:
    """The least radius whose faces hold all forces (n, d)."""
    return float((np.einsum("nkd,nd->nk", directions, forces) / cosines).max())


@lru_cache(maxsize=64)
def _circle(facets: int, shift: float) -> Array:
    angles = 2 * pi * (np.arange(facets) + shift) / facets
    return read_only(np.column_stack([np.cos(angles), np.sin(angles)]))


@lru_cache(maxsize=256)
def _cap(cap: float, facets: int, rings: int) -> tuple[Array, Array]:
    """Directions (k, 3) along (t_1, t_2, n) in rings over a cone of half-angle ``cap``, cosines (k,)."""
    half = pi / facets
    directions, cosines = [], []
    for j in range(rings):
        near, far = cap * j / rings, cap * (j + 1) / rings
        middle = (near + far) / 2
        # cos of the angle to the nearest u is concave along a meridian: least at an end of the band.
        least = min(cos(a) * cos(middle) + sin(a) * sin(middle) * cos(half) for a in (near, far))
        around = _circle(facets, 0.0)
        directions.append(
            np.column_stack([sin(middle) * around, np.full(facets, cos(middle))]),
        )
        cosines.append(np.full(facets, least))
    return read_only(np.vstack(directions)), read_only(np.concatenate(cosines))
