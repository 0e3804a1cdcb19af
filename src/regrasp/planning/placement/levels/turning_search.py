"""The search of boxes on curves that fixed twists do not exclude, by twists that turn with the fingers."""

from collections import deque
from contextlib import suppress
from copy import deepcopy
from math import log

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.levels.climbing import improved, settled
from regrasp.planning.placement.levels.level import SURE, Level
from regrasp.planning.placement.levels.turning import TurningTwists
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sliding import Placed

_COARSE = 0.2  # of the size: arcs of less are left to these twists
_NARROW = 1e-6  # of the size, of arcs that are not split
_STRICT = 1e-9
_FAR, _NEARER = 0.5, 8  # of the best level, the first searches are so far from it, then so many times nearer
_TRIES, _STEP = 300, 1e-3  # of a simplex of placements, its size as a part of the boundary


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
    programs = most // 3**search.fingers
    kept, steps = search.placements(), max(int(log(_FAR / tolerance, _NEARER)), 0)
    begun = search.anew()
    begun.narrow = _COARSE
    with suppress(KeyboardInterrupt):
        for step in range(steps, -1, -1):
            turning = _Turning(begun, level, best, tolerance * _NEARER**step, programs)
            if step and turning.aim >= beyond:
                continue
            try:
                closed = turning.close(kept, most, beyond, progress)
            finally:
                best, programs = turning.best, turning.programs
                kept = sorted(kept + turning.search.placements(), key=lambda placed: placed[0])
            if turning.search.closed and turning.aim < beyond:
                search, beyond = turning.search, turning.aim
            if not closed:
                break
            begun = deepcopy(turning.search)
            begun.take([])
            begun.moving.clear()
            begun.reopen()
    search.take(kept)
    level.put(search, beyond)
    return search, beyond


class _Turning:
    """Boxes of one side for each finger, the widest first."""

    def __init__(self, search: Search, level: Level, best: float, tolerance: float, programs: int) -> None:
        self.search, self.level, self.best, self.tolerance = search, level, best, tolerance
        self.programs = programs
        self.limit = level.max_force * (1 + _STRICT)
        self.twists = TurningTwists(search.fingers)
        self.aim, self.top = level.beyond(best, tolerance), level.top(search)

    def close(self, placements: list[Placed], most: int, known: float, progress: Progress | None) -> bool:
        """Whether no box is left. The aim is a level that no placement is beyond, where the search is closed.

        placements: to begin from. known: a level that no placement is beyond.
        """
        search, level = self.search, self.level
        self.settle(placements)
        if self.aim >= self.top:
            return False
        while search.goes_on(self.limit, 0.0, most, only=True):
            if progress is not None:
                progress(level.value(known), level.value(self.best))
        self.run(most, known, progress)
        aim = self.aim
        self.aim = settled(search, level, aim, self.limit)
        return search.closed and self.aim == aim

    def settle(self, placements: list[tuple[float, np.ndarray, Array]]) -> None:
        """Begin from the best of some placements, and from what is best near to it."""
        if placements:
            _, places, u = placements[0]
            self._better(*self._nearby(places, u))
        self.level.put(self.search, self.aim)

    def run(self, most: int, known: float, progress: Progress | None) -> None:
        """Exclude or split boxes."""
        search, waiting = self.search, deque(self.search.left.tolist())
        while waiting and self.programs > 0 and self.aim < self.top:
            node = waiting.popleft()
            if progress is not None:
                progress(self.level.value(known), self.level.value(self.best))
            arcs, ends = search.box(node)
            if (arcs[:, 0] != arcs[:, 1]).any():
                break
            self._better(arcs[:, 0].copy(), ends.mean(axis=1))
            if search.excludes(np.array([node]), self.limit):
                continue
            self.programs -= 1
            if self._excluded(node, arcs[:, 0], ends):
                continue
            lengths = np.diff(ends, axis=1)[:, 0] * search.sides.lengths[search.sides.edges[arcs[:, 0]]]
            i = int(lengths.argmax())
            if lengths[i] > _NARROW * search.sides.size:
                waiting += search.halved(node, i, float(ends[i].mean()), most)

    def _better(self, places: np.ndarray, u: Array) -> None:
        """Go on from a placement that is better, and from those that are better still."""
        search, level = self.search, self.level
        level.put(search, self.aim)
        # at the top no friction is left to do without: the level there is held, and so is each beyond it
        while self.aim < self.top:
            if not search.are_apart(places, u) or search.norm_at(places, u) > level.max_force * (1 - SURE):
                break
            self.best, places, u = improved(search, level, self.aim, places, u)
            search.forget(self.best, places, u)
            self.aim = level.beyond(self.best, self.tolerance)
            level.put(search, self.aim)
            places, u = self._nearby(places, u)

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
            return min(search.norm_at(*at), far) if search.are_apart(*at) else far

        simplex = _STEP * np.vstack([np.zeros(len(u)), np.eye(len(u))])
        options = {"initial_simplex": simplex, "maxfev": _TRIES, "xatol": 1e-9, "fatol": 1e-9}
        return moved(minimize(norm, simplex[0], method="Nelder-Mead", options=options).x)

    def _excluded(self, node: int, places: np.ndarray, ends: Array) -> bool:
        search = self.search
        size = search.sides.size
        each = zip(places, ends.tolist(), strict=True)
        parts = np.array([search.sides.part(int(j), lo, hi)[0] for j, (lo, hi) in each]) / size
        wanted = -search.loads / [1, 1, size] / self.level.max_force
        found = self.twists.excluding(parts, search.friction, wanted)
        if found is None:
            return False
        loads, polynomials = found
        polynomials[:, 2] /= size
        search.leave(node, None, (loads, polynomials.reshape(len(loads), -1)))
        return True
