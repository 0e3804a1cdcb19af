"""Placements on a knife's edge, which boxes come near and do not meet: forces through where loads meet.

Where the lines of all loads meet in a point, fingers without friction hold them together only where their
normals pass through it, too; and with friction the best placement often is one where an edge of a cone does.
These places are roots along the boundary, a few of each side, and are tried as they are.
"""

from itertools import combinations, product
from math import comb, inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.planning.placement.curves.curved_sides import CurvedSides
from regrasp.planning.placement.search import Search
from regrasp.planning.placement.sides import Sides
from regrasp.planning.placement.sliding import Placed

_SAME = 1e-12  # of the loads, that lines which meet in a point are off it
_HALVINGS = 60
_WORK = 100_000  # norms for one load each, some tenths of a second
_MOST, _BESIDE = 48, 8  # places; and placements of which one finger goes to each of them


def on_edges(search: Search) -> list[Placed]:
    """Placements of fingers whose normals or edges of cones pass through where loads meet, the best first.

    All of them, or of many those with one finger such beside the best placements found.
    """
    meeting = where_loads_meet(search.loads)
    if meeting is None:
        return []
    on, u = places_towards(search.sides, meeting, kept_friction(search.friction, 2 * RESERVE))
    k, most = search.fingers, _WORK // len(search.loads)
    each = combinations(range(len(u)), k) if comb(len(u), k) <= most else ()
    tried = [(on[list(few)], u[list(few)]) for few in each]
    for (_, places, at), finger, one in product(search.placements()[:_BESIDE], range(k), range(len(u))):
        there, where = places.copy(), at.copy()
        there[finger], where[finger] = on[one], u[one]
        order = np.argsort(where, kind="stable")
        tried.append((there[order], where[order]))
    found = [(search.norm_at(*at), *at) for at in tried[:most] if search.are_apart(*at)]
    return sorted((placed for placed in found if placed[0] < inf), key=lambda placed: placed[0])


def where_loads_meet(loads: Array) -> Array | None:
    """(2,) the point that the lines of all loads (L, 3) pass through [m]; None for no point, or a line.

    A point o with o x f = tau of every load.
    """
    crossed = np.column_stack([loads[:, 1], -loads[:, 0]])
    if np.linalg.matrix_rank(crossed) < 2:
        return None
    point = np.asarray(np.linalg.lstsq(crossed, loads[:, 2], rcond=None)[0], float)
    reach = np.abs(crossed) @ np.abs(point) + np.abs(loads[:, 2])
    return point if (np.abs(crossed @ point - loads[:, 2]) <= _SAME * reach).all() else None


def places_towards(sides: Sides, point: Array, friction: float) -> tuple[np.ndarray, Array]:
    """Sides and u, in rising order, where the normal or an edge of the cone passes through a point.

    Of each side one at the most for each of the three: where the arm of that line changes its sign.
    """
    every = np.arange(len(sides.ends))
    found = []
    for slope in {-friction, 0.0, friction}:
        lo, hi = sides.ends.T
        begin = _arms(sides, every, lo, point, slope)
        on = np.flatnonzero(begin * _arms(sides, every, hi, point, slope) <= 0)
        lo, hi, begin = lo[on], hi[on], begin[on]
        for _ in range(_HALVINGS):
            middle = 0.5 * (lo + hi)
            before = begin * _arms(sides, on, middle, point, slope) > 0
            lo, hi = np.where(before, middle, lo), np.where(before, hi, middle)
        found += [(int(side), float(at)) for side, at in zip(on, hi, strict=True)]
    found = sorted(set(found), key=lambda place: place[::-1])
    found = found[:: -(-len(found) // _MOST)] if found else []
    return np.array([side for side, _ in found], int), np.array([at for _, at in found])


def _arms(sides: Sides, on: np.ndarray, u: Array, point: Array, slope: float) -> Array:
    """The torques about a point of forces n + slope t at places, of any positive factor."""
    if isinstance(sides, CurvedSides):
        at, normals, _ = sides.frames(u)
    else:
        at, along = sides.points(on, u), sides.vectors[sides.edges[on]]
        normals = np.stack([-along[:, 1], along[:, 0]], axis=1)
    forces = normals + slope * np.stack([normals[:, 1], -normals[:, 0]], axis=1)
    arms: Array = (at[:, 0] - point[0]) * forces[:, 1] - (at[:, 1] - point[1]) * forces[:, 0]
    return arms
