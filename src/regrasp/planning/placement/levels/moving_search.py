"""Boxes that fixed twists do not exclude, tried by twists that move with the fingers (``moving_twists``)."""

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.boxes import Twists
from regrasp.planning.placement.levels.climbing import improved, settled
from regrasp.planning.placement.levels.level import SURE, Level
from regrasp.planning.placement.levels.rounds import Rounds
from regrasp.planning.placement.search import Progress, Search

COARSE = 0.1
"""Of the size: arcs of less are left to these twists."""
_NARROW = 1e-6  # of the size, of arcs that are not split
_RAISED = 0.1  # of the tolerance, the least that a placement in such an arc is better by
_STRICT = 1e-9
WIDE, EXCLUDED = "a finger on sides", "by fixed twists"

Found = str | Twists | Array | None
"""Of a box: one of those, twists that exclude it, where (k,) a placement holds, or nothing."""


def closed_by_moving(
    search: Search, level: Level, best: float, beyond: float, tolerance: float, most: int,
    progress: Progress | None,
) -> float:  # fmt: skip
    """A level that no placement is beyond, at which the search is left.

    search: of forces on straight sides, that ended with ``best`` and ``beyond``; boxes that it left are
    excluded or split.
    """
    moving = Moving(search, level, best, tolerance)

    def told() -> None:
        if progress is not None:
            progress(level.value(beyond), level.value(moving.best))

    try:
        moving.run(most, told)
    except KeyboardInterrupt:
        search.interrupted = True
    try:
        beyond = settled(search, level, moving.aim, moving.limit, [beyond])
    except KeyboardInterrupt:
        search.interrupted, search.closed, beyond = True, False, level.top(search)
    with suppress(KeyboardInterrupt):
        told()
    return beyond


def twists_or_place(search: Search, node: int, limit: float, room: Any) -> Twists | Array | None:
    """Twists that move with fingers and exclude a box at a level [N]; or (k,) where a placement holds."""
    from regrasp.closed_form.compiled.places.moving_twists import GONE, HELD, moved

    (arcs, ends), k = search.box(node), search.fingers
    u, twists = np.zeros(k), np.zeros((len(search.loads), 3 + 2 * k))
    how = moved(*search.terms(limit), arcs, ends, u, twists, room)
    if how == GONE:
        few, twists[:, 2] = np.flatnonzero(twists.any(axis=1)), twists[:, 2] / search.sides.size
        return few, twists[few]
    lo, hi = ends.T
    return lo + u * (hi - lo) if how == HELD else None


class Moving:
    """Boxes of one side for each finger, the widest first."""

    def __init__(self, search: Search, level: Level, best: float, tolerance: float) -> None:
        self.search, self.level, self.best, self.tolerance = search, level, best, tolerance
        self.limit = level.max_force * (1 + _STRICT)
        self.aim = level.beyond(best, tolerance)
        self._rounds = Rounds(search, self._judged, lambda: self.memory(len(search.loads), search.fingers))
        level.put(search, self.aim)

    def memory(self, loads: int, fingers: int) -> tuple[Any, ...]:
        """That of the compiled search of twists."""
        from regrasp.closed_form.compiled.places.moving_twists import room_to_move

        return room_to_move(loads, fingers)

    def run(self, most: int, told: Callable[[], None]) -> None:
        """Exclude boxes or split them."""
        search = self.search
        if search.count > 1:
            search.reopen()  # what other levels exclude
        while search.goes_on(self.limit, 0.0, most, only=True):
            told()
        waiting = deque(search.left.tolist())
        while waiting and self.goes_on():
            told()
            aim = self.aim
            for node, found in self._rounds.next(waiting):
                if not self.goes_on() or not self._taken(node, found, waiting, most):
                    return
                if self.aim != aim:
                    self._rounds.begin()
                    break

    def _judged(self, search: Search, node: int, room: Any) -> Found:
        arcs, _ = search.box(node)
        if (arcs[:, 0] != arcs[:, 1]).any():
            return WIDE
        return EXCLUDED if search.excluded(np.array([node]), self.limit) else self.look(search, node, room)

    def _taken(self, node: int, found: Found, waiting: deque[int], most: int) -> bool:
        """Go on from the first box that waits, by what was found of it; whether that is possible."""
        search = self.search
        arcs, ends = search.box(node)
        lengths = np.diff(ends, axis=1)[:, 0] * search.sides.lengths[search.sides.edges[arcs[:, 0]]]
        i = int(lengths.argmax())
        if isinstance(found, tuple):
            self.leave(node, found)
        elif isinstance(found, np.ndarray) and self.better(arcs[:, 0].copy(), found) is not None:
            return True  # it is judged again
        elif found is WIDE:
            return False
        elif found is not EXCLUDED and lengths[i] > _NARROW * search.sides.size:
            inside = search.halved(node, i, float(ends[i].mean()), most)
            waiting += inside
            if not inside:
                return False
        elif found is not EXCLUDED and self.raised(arcs[:, 0].copy(), ends.mean(axis=1)):
            waiting.append(node)
        waiting.popleft()
        return True

    def goes_on(self) -> bool:
        """Whether there is a better level."""
        return True

    def look(self, search: Search, node: int, room: Any) -> Found:
        """Twists that exclude a box, or where a placement holds."""
        return twists_or_place(search, node, self.limit, room)

    def leave(self, node: int, twists: Twists) -> None:
        """Take a box for excluded."""
        self.search.leave(node, None, twists)

    def raised(self, places: np.ndarray, u: Array) -> bool:
        """Whether a placement in a box that is not split is better, by less than what is asked.

        The best is its neighbour where neither slides to the other, on a ridge.
        """
        search, level, before = self.search, self.level, self.best
        if search.are_apart(places, u):
            reached = level.reached(search, before, places, u)
            if reached > before + _RAISED * (self.aim - before):
                self._take(reached, places, u)
        level.put(search, self.aim)
        return self.best > before

    def _take(self, best: float, places: np.ndarray, u: Array) -> None:
        self.best = best
        self.search.forget(best, places, u)
        self.aim = self.level.beyond(best, self.tolerance)

    def better(self, places: np.ndarray, u: Array) -> tuple[np.ndarray, Array] | None:
        """Go on from a placement where it is better, to the best near to it; None where it is not."""
        search, level = self.search, self.level
        level.put(search, self.aim)
        if not search.holds(places, u, level.max_force * (1 - SURE)):
            return None
        best, places, u = improved(search, level, self.aim, places, u)
        self._take(best, places, u)
        level.put(search, self.aim)
        if search.interrupted:
            raise KeyboardInterrupt
        return places, u
