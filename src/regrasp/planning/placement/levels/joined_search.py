"""Boxes of groups of edges, excluded by twists of all loads together (``all_loads``), for levels of forces.

The widest boxes come first, so that placements from all over raise the level early. Fingers on one short side
each are left to twists that move with them (``moving_twists``).
"""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.boxes import Twists
from regrasp.planning.placement.levels.climbing import improved, next_level, settled
from regrasp.planning.placement.levels.level import SURE, Level
from regrasp.planning.placement.levels.moving_search import twists_or_place
from regrasp.planning.placement.levels.rounds import Rounds
from regrasp.planning.placement.search import Progress, Search

MOST_LOADS = 64
"""Loads that are looked at together."""
_SIDES = 400  # of an arc, from which on it is split without a look
_COARSE = 0.1  # of the size: arcs of less are left to twists that move
_NARROW = 1e-6  # of the size, of arcs that are not split
_STRICT = 1e-9
_LEAST = 0.15  # of an arc, that each part has
_GAPS = (0.03,)  # proven on the way, while less is asked

Place = tuple[np.ndarray, Array]


@dataclass(frozen=True)
class _Found:
    """Of a box: what excludes it, placements that hold, where to split it: a finger, u, a side or None."""

    near: bool = False
    twists: Twists | None = None
    places: Sequence[Place] = ()
    at: tuple[int, float, int | None] | None = None


def run_joined(
    search: Search, level: Level, tolerance: float, most: int, progress: Progress | None
) -> tuple[float | None, float]:
    """As ``run_level``, of a search on straight sides."""
    joined = _Joined(search, level, tolerance, most)

    def told() -> None:
        if progress is not None:
            best = nan if joined.best is None else level.value(joined.best)
            progress(level.value(level.top(search)), best)

    try:
        joined.run(told)
    except KeyboardInterrupt:
        search.interrupted = True
        if joined.best is None:
            return None, joined.aim
        return joined.best, joined.cut_short()
    if joined.best is None:
        left = search.left
        search.closed = not joined.waiting and search.excluded(left, joined.limit) == len(left)
        return None, joined.aim
    if joined.waiting:
        return joined.best, joined.cut_short()
    passed = [] if joined.passed is None else [joined.passed]
    try:
        return joined.best, settled(search, level, joined.aim, joined.limit, passed)
    except KeyboardInterrupt:
        search.interrupted, search.closed = True, False
        return joined.best, level.top(search)


class _Joined:
    """Boxes not looked at, ``waiting``, the widest first."""

    def __init__(self, search: Search, level: Level, tolerance: float, most: int) -> None:
        self.search, self.level, self.most = search, level, most
        self.limit = level.max_force * (1 + _STRICT)
        self.best: float | None = None
        self.aim = level.start
        self.waiting = deque([0])
        self.passed: float | None = None  # a level at which all was excluded, by ``_loose``
        self._loose: dict[int, Twists] = {}
        self._parent: dict[int, int] = {}
        self._gaps, self._tolerance = [t for t in _GAPS if t > tolerance], tolerance
        self._rounds = Rounds(search, self._judged, self._memory)

    def run(self, told: Callable[[], None]) -> None:
        """Exclude boxes or split them, at one gap after the other."""
        search = self.search
        self._put(self.aim)
        while self._emptied(told) and self.best is not None and self._gaps:
            self._gaps.pop(0)
            if not len(search.left):
                self.passed, self._loose = self.aim, dict(search.moving)
            self._put_beyond(self.best)
            search.reopen()
            search.moving.clear()
            self.waiting.extend(search.left.tolist())

    def cut_short(self) -> float:
        """The level that was passed, at which the search is left; else the largest there is."""
        search = self.search
        left = [(node, self._known(node)) for node in search.left.tolist()]
        search.closed = self.passed is not None and all(twists is not None for _, twists in left)
        if self.passed is None or not search.closed:
            return self.level.top(search)
        for node, twists in left:
            search.leave(node, None, twists)
        self.level.put(search, self.passed)
        return self.passed

    def _put(self, aim: float) -> None:
        self.aim = min(aim, self.level.top(self.search))
        self.level.put(self.search, self.aim)

    def _put_beyond(self, best: float) -> None:
        top = self.level.top(self.search)
        self._put(next_level(self.level, best, self._gaps, self._tolerance, top))

    def _emptied(self, told: Callable[[], None]) -> bool:
        """Whether all boxes were looked at."""
        while self.waiting and self.aim < self.level.top(self.search):
            aim = self.aim
            for node, found in self._rounds.next(self.waiting):
                inside = self._inside(node, found)
                if inside is None:
                    return False
                self._parent.update(dict.fromkeys(inside, self.waiting.popleft()))
                self.waiting.extend(inside)
                if self.aim != aim:
                    self._rounds.begin()
                    break
            told()
        return not self.waiting

    def _inside(self, node: int, found: _Found) -> range | None:
        """The boxes that one is split into: none where it is excluded or narrow; None without room."""
        if found.near or found.twists is not None:
            self.search.leave(node, None, found.twists)
        for places, u in found.places:
            if self.search.holds(places, u, self.level.max_force * (1 - SURE)):
                self.best, *at = improved(self.search, self.level, self.aim, places, u)
                self.search.forget(self.best, *at)
                if self.search.interrupted:
                    raise KeyboardInterrupt
                self._put_beyond(self.best)
        if found.at is None:
            return range(0)
        finger, u_at, after = found.at
        return self.search.halved(node, finger, u_at, self.most, after) or None

    def _memory(self) -> tuple[Any, ...]:
        from regrasp.closed_form.compiled.places.all_loads import room_for_all
        from regrasp.closed_form.compiled.places.moving_twists import room_to_move

        loads, k = len(self.search.loads), self.search.fingers
        out = np.zeros((loads, 3)), np.zeros((k, 5, 2)), np.zeros(k)
        return out, room_for_all(loads, k), room_to_move(loads, k)

    def _judged(self, search: Search, node: int, room: Any) -> _Found:
        from regrasp.closed_form.compiled.places.all_loads import GONE, NEAR, joined

        sides, most = search.sides, self.level.max_force * (1 - SURE)
        arcs, ends = search.box(node)
        counts = arcs[:, 1] - arcs[:, 0] + 1
        i = int(counts.argmax())
        if counts[i] > _SIDES:
            return _Found(at=(i, 0.0, int(arcs[i].sum()) // 2))
        (twists, seen, spread), to_join, to_move = room
        apart = search.apart / sides.size
        how = joined(*search.terms(self.limit), arcs, ends, apart, twists, seen, spread, to_join)
        if how == NEAR:
            return _Found(near=True)
        if how == GONE:
            few = np.flatnonzero(twists.any(axis=1))
            moving = np.zeros((len(few), 3 + 2 * search.fingers))
            moving[:, :3] = twists[few] / [1, 1, sides.size]
            return _Found(twists=(few, moving))
        pressed = seen[:, 0].mean(axis=1)
        places = [place for place in [self._nearest(arcs, ends, pressed)] if search.holds(*place, most)]
        if counts[i] > 1:
            i = int(np.where(counts > 1, spread, -1.0).argmax())
            first, last = arcs[i].tolist()
            at = int(np.searchsorted(sides.ends[:, 1], pressed[i]))
            least = int(_LEAST * counts[i])
            return _Found(places=places, at=(i, 0.0, min(max(at, first + least), last - 1 - least)))
        lengths = np.diff(ends, axis=1)[:, 0] * sides.lengths[sides.edges[arcs[:, 0]]]
        i = int(lengths.argmax())
        if lengths[i] < _COARSE * sides.size:
            found = twists_or_place(search, node, self.limit, to_move)
            if isinstance(found, tuple):
                return _Found(twists=found, places=places)
            places += [] if found is None else [(arcs[:, 0].copy(), found)]
        narrow = lengths[i] <= _NARROW * sides.size
        return _Found(places=places, at=None if narrow else (i, float(ends[i].mean()), None))

    def _nearest(self, arcs: np.ndarray, ends: Array, u: Array) -> tuple[np.ndarray, Array]:
        """Places on sides near to u."""
        sides = self.search.sides
        places = np.clip(np.searchsorted(sides.ends[:, 1], u), arcs[:, 0], arcs[:, 1])
        return places, np.clip(np.clip(u, *sides.ends[places].T), *ends.T)

    def _known(self, node: int) -> Twists | None:
        """What excluded a box, or one around it, at the level that was passed."""
        around = node
        while around not in self._loose:
            if around not in self._parent:
                return None
            around = self._parent[around]
        few, twists = self._loose[around]
        (lo, hi), (begin, end) = (self.search.box(box)[1].T for box in (around, node))
        wide = np.where(hi > lo, hi - lo, 1.0)
        adds = twists[:, 3:].reshape(len(few), 2, -1)
        still = twists[:, :2] + adds @ ((begin - lo) / wide)
        more = adds * ((end - begin) / wide)
        return few, np.column_stack([still, twists[:, 2], more.reshape(len(few), -1)])
