"""The search of boxes that fixed twists do not exclude, by twists that move with the fingers (``moving``)."""

from collections import deque
from contextlib import suppress

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.levels.climbing import improved, settled
from regrasp.planning.placement.levels.level import SURE, Level
from regrasp.planning.placement.levels.moving import MovingTwists
from regrasp.planning.placement.search import Progress, Search

_COARSE = 0.02  # of the size: arcs of less are left to these twists
_CRITICAL = 4  # loads that count
_BOXES = 25  # that a program of three fingers counts for; one of more has so many more rows
_NARROW = 1e-6  # of the size, of arcs that are not split
_STRICT = 1e-9


def closed_by_moving(
    search: Search, level: Level, best: float, beyond: float, tolerance: float, most: int,
    progress: Progress | None,
) -> tuple[Search, float]:  # fmt: skip
    """A search that excludes more, and a level that no placement is beyond.

    search: that ended with ``best`` and ``beyond``, of forces on straight sides; it is returned where no more
    is excluded.
    """
    found = search.anew()
    found.narrow = _COARSE
    moving = _Moving(found, level, best, tolerance)
    with suppress(KeyboardInterrupt):
        while found.goes_on(moving.limit, 0.0, most, only=True):
            if progress is not None:
                progress(level.value(beyond), level.value(best))
        aim = settled(found, level, moving.run(most, progress), moving.limit)
        if found.closed and aim < beyond:
            found.take(sorted(search.placements() + found.placements(), key=lambda placed: placed[0]))
            return found, aim
    search.take(sorted(search.placements() + found.placements(), key=lambda placed: placed[0]))
    level.put(search, beyond)
    return search, beyond


class _Moving:
    """Boxes of one side for each finger, the widest first."""

    def __init__(self, search: Search, level: Level, best: float, tolerance: float) -> None:
        self.search, self.level, self.best, self.tolerance = search, level, best, tolerance
        self.limit = level.max_force * (1 + _STRICT)
        self.twists = MovingTwists(search.fingers)
        self.aim = level.beyond(best, tolerance)
        level.put(search, self.aim)

    def run(self, most: int, progress: Progress | None) -> float:
        """Exclude or split boxes; the level at which they are."""
        search, waiting = self.search, deque(self.search.left.tolist())
        programs = 24 * most // (_BOXES * search.fingers * 2**search.fingers)
        while waiting and programs > 0:
            node = waiting.popleft()
            arcs, ends = search.box(node)
            if (arcs[:, 0] != arcs[:, 1]).any():
                break
            self._try(arcs[:, 0].copy(), ends.mean(axis=1))
            if search.excludes(np.array([node]), self.limit):
                continue
            programs -= 1
            if self._excluded(node, arcs[:, 0], ends):
                continue
            lengths = np.diff(ends, axis=1)[:, 0] * search.sides.lengths[search.sides.edges[arcs[:, 0]]]
            i = int(lengths.argmax())
            if lengths[i] > _NARROW * search.sides.size:
                waiting += search.halved(node, i, float(ends[i].mean()), most)
            if progress is not None:
                progress(self.level.value(self.aim), self.level.value(self.best))
        return self.aim

    def _try(self, places: np.ndarray, u: Array) -> None:
        """Go on from a placement that is better."""
        search, level = self.search, self.level
        if search.are_apart(places, u) and search.norm_at(places, u) <= level.max_force * (1 - SURE):
            self.best, *at = improved(search, level, self.aim, places, u)
            search.forget(self.best, *at)
            self.aim = level.beyond(self.best, self.tolerance)
            level.put(search, self.aim)

    def _excluded(self, node: int, places: np.ndarray, ends: Array) -> bool:
        search = self.search
        size, loads = search.sides.size, search.loads
        worst = []
        for load in loads:
            search.under(load[None])
            worst.append(search.norm_at(places, ends.mean(axis=1)))
        search.under(loads)
        few = np.argsort(worst)[::-1][:_CRITICAL]
        parts = [search.sides.part(int(j), lo, hi) for j, (lo, hi) in zip(places, ends.tolist(), strict=True)]
        points = np.array([points for points, _ in parts]) / size
        normals = np.array([[-y, x] for _, ((x, y),) in parts])
        wanted = -loads[few] / [1, 1, size] / self.level.max_force
        twists = self.twists.excluding(points, normals, search.friction, wanted)
        if twists is None:
            return False
        search.leave_to(node, few, twists / np.where(np.arange(twists.shape[1]) == 2, size, 1.0))
        return True
