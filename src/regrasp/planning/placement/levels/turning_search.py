"""The search of boxes on curves that fixed twists do not exclude, by twists that turn with the fingers."""

from contextlib import suppress
from copy import deepcopy
from math import log
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.boxes import Twists
from regrasp.planning.placement.levels.climbing import settled
from regrasp.planning.placement.levels.level import SURE, Level
from regrasp.planning.placement.levels.moving_search import Found, Moving
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sliding import Placed

WIDE = 0.2
"""Of the size: arcs of less are left to these twists."""
_FAR, _NEARER = 0.5, 64  # of the best level, the first searches are so far from it, then so many times nearer
_NUMBERS = 100  # of twists, for each box that may be
_BEGINS = 8  # placements that the first of them begins from
_TRIES, _STEP = 300, 1e-3  # of a simplex of placements, its size as a part of the boundary
_NEAR_TOP = 10  # of what is left to the level without friction, the size of the simplex near it


def closed_by_turning(
    search: Search, level: Level, best: float, beyond: float, tolerance: float, most: int,
    progress: Progress | None,
) -> tuple[Search, float]:  # fmt: skip
    """A search that excludes more, and a level that no placement is beyond.

    First one that is some way from the best, then nearer, from the boxes that this took: what is closed is a
    bound where the next is cut short.

    search: that ended with ``best`` and ``beyond``, of forces on curves; it is returned where no more is
    excluded.
    """
    kept, steps = search.placements(), max(int(log(_FAR / tolerance, _NEARER)), 0)
    begun, begins = search.anew(), kept[:_BEGINS]
    begun.narrow = WIDE
    with suppress(KeyboardInterrupt):
        for step in range(steps, -1, -1):
            turning = Turning(begun, level, best, tolerance * _NEARER**step)
            try:
                closed = turning.close(begins, most, beyond, progress)
            finally:
                best = turning.best
                kept = sorted(kept + turning.search.placements(), key=lambda placed: placed[0])
            begins = kept[:1]
            if turning.search.closed and turning.aim < beyond:
                search, beyond = turning.search, turning.aim
            if not closed:
                break
            moving, turning.search.moving = turning.search.moving, {}
            begun = deepcopy(turning.search)
            turning.search.moving = moving
            begun.take([])
    search.take(kept)
    level.put(search, beyond)
    return search, beyond


class Turning(Moving):
    """The same on curves, nearer to a level step by step."""

    def __init__(self, search: Search, level: Level, best: float, tolerance: float) -> None:
        super().__init__(search, level, best, tolerance)
        self.top, self.free = level.top(search), 0

    def memory(self, loads: int, fingers: int) -> tuple[Any, ...]:
        """That of the compiled search of twists."""
        from regrasp.closed_form.compiled.places.turning_twists import room_to_turn

        return room_to_turn(loads, fingers)

    def close(self, begins: list[Placed], most: int, known: float, progress: Progress | None) -> bool:
        """Whether no box is left. The aim is a level that no placement is beyond, where the search is closed.

        begins: placements to go on from. known: a level that no placement is beyond.
        """
        self.free = _NUMBERS * most
        for _, places, u in begins:
            self.better(*self._nearby(places, u))
        if not self.goes_on():
            return False

        def told() -> None:
            if progress is not None:
                progress(self.level.value(known), self.level.value(self.best))

        self.run(most, told)
        aim = self.aim
        self.aim = settled(self.search, self.level, aim, self.limit)
        return self.search.closed and self.aim == aim

    def goes_on(self) -> bool:
        """Not at the top, without friction: that level is held, as is each beyond it. Nor without memory."""
        return self.aim < self.top and self.free > 0

    def look(self, search: Search, node: int, room: Any) -> Found:
        """Twists that exclude a box in whose middle no placement holds."""
        from regrasp.closed_form.compiled.places.turning_twists import polynomial_twists

        size, k = search.sides.size, search.fingers
        arcs, ends = search.box(node)
        middle: Array = ends.mean(axis=1)
        if search.holds(arcs[:, 0].copy(), middle, self.level.max_force * (1 - SURE)):
            return middle
        if not search.friction > 0:
            return None
        each = zip(arcs[:, 0].tolist(), ends.tolist(), strict=True)
        parts = np.array([search.sides.part(j, lo, hi)[0] for j, (lo, hi) in each]) / size
        terms, loads = (k + 1) * (k + 2) // 2, -search.loads / [1, 1, size] / self.limit
        found = np.zeros((len(loads), 3 * terms + k * 3**k))
        if not polynomial_twists(parts, search.friction, loads, found, room):
            return None
        found[:, 2 * terms : 3 * terms] /= size
        few = np.flatnonzero(found.any(axis=1))
        return few, found[few]

    def leave(self, node: int, twists: Twists) -> None:
        """Take a box for excluded, as long as there is memory."""
        super().leave(node, twists)
        self.free -= twists[1].size

    def better(self, places: np.ndarray, u: Array) -> tuple[np.ndarray, Array] | None:
        """Go on from a placement that is better, and from those that are better still."""
        at = None
        while self.goes_on() and (found := super().better(places, u)) is not None:
            at = found
            places, u = self._nearby(*found)
        return at

    def _nearby(self, places: np.ndarray, u: Array) -> tuple[np.ndarray, Array]:
        """A placement of less norm at the level aimed at, by the simplex of Nelder and Mead."""
        from scipy.optimize import minimize

        search, far = self.search, 1e6 * self.level.max_force
        self.level.put(search, self.aim)

        def moved(ways: Array) -> tuple[np.ndarray, Array]:
            on = [search.sides.moved(int(j), *at) for j, *at in zip(places, u.tolist(), ways, strict=True)]
            return np.array([j for j, _ in on]), np.array([v for _, v in on])

        def norm(ways: Array) -> float:
            at = moved(ways)
            return min(search.norm_at(*at, most=far), far) if search.are_apart(*at) else far

        ways = np.zeros(len(u))
        steps = {_STEP, min(_STEP, _NEAR_TOP * (self.top - self.best))}  # as near to the top as levels are
        for step in sorted(steps, reverse=True):
            simplex = ways + step * np.vstack([np.zeros(len(u)), np.eye(len(u))])
            options = {"initial_simplex": simplex, "maxfev": _TRIES, "xatol": 1e-6 * step, "fatol": 1e-9}
            ways = minimize(norm, ways, method="Nelder-Mead", options=options).x
        return moved(ways)
