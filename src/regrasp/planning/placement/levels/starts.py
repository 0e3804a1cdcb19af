"""Placements of three fingers with little friction to start from, on polygons of many sides."""

from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.levels.climbing import improved
from regrasp.planning.placement.levels.level import SURE, FrictionLevel
from regrasp.planning.placement.search import Search

_SIDES = 600  # the longest, and as many evenly spread, that are looked at; then all beside the best
_KEPT = 32


def best_start(search: Search, level: FrictionLevel) -> float | None:
    """The best level that three fingers slide to from where normals meet; None where none holds."""
    best: float | None = None
    for places, u in little_friction(search, level.max_force, level.friction):
        if search.interrupted:  # (``improved``)
            break
        level.put(search, level.start)
        if search.holds(places, u, level.max_force * (1 - SURE)):
            reached, *at = improved(search, level, level.start, places, u)
            if best is None or reached > best:
                best = reached
                search.forget(reached, *at)
    return best


def little_friction(search: Search, limit: float, friction: float) -> list[tuple[np.ndarray, Array]]:
    """Sides and u of three fingers on middles of sides that use little of the friction, the best first.

    limit: of every force [N].
    """
    sides = search.sides
    count = len(sides.edges)
    lengths = np.diff(sides.ends, axis=1)[:, 0] * sides.lengths[sides.edges]
    spread = np.linspace(0, count - 1, min(_SIDES, count)).astype(int)
    rough = _best(search, limit, friction, np.union1d(spread, np.argsort(-lengths)[:_SIDES]))
    beside = np.arange(-(count // _SIDES), count // _SIDES + 1)
    near = np.unique((np.array([on for on, _ in rough], int).reshape(-1, 1) + beside) % count)
    return _best(search, limit, friction, near)


def _best(search: Search, limit: float, friction: float, on: np.ndarray) -> list[tuple[np.ndarray, Array]]:
    from regrasp.closed_form.compiled.meeting_normals import meeting

    sides = search.sides
    u = sides.ends[on].mean(axis=1)
    along = sides.vectors[sides.edges[on]] / sides.lengths[sides.edges[on]][:, None]
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1)
    order = np.argsort(np.arctan2(*normals.T[::-1]), kind="stable")
    places = np.column_stack([sides.points(on, u), normals])[order]
    found = np.column_stack([np.full(_KEPT, inf), np.zeros((_KEPT, 3))])
    for first in range(len(on)):  # an interrupt waits for one
        meeting(places, -search.loads, limit, friction, first, found)
    rows = found[np.isfinite(found[:, 0])]
    each = order[rows[np.argsort(rows[:, 0], kind="stable"), 1:].astype(int)]
    return [(on[few], u[few]) for few in np.sort(each, axis=1)]
