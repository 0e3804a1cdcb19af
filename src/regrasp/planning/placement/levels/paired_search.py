"""Boxes of three fingers, two of them on few sides and one anywhere, with twists for each side of that one.

On polygons of many sides with less friction than they turn groups of sides in all three arcs prove nothing,
and triples of sides are too many. Pairs are not: ``side_twists`` has few twists of which one excludes nearly
each side of the third finger. Sides that it leaves are boxes of their own, for twists that move.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.levels.climbing import settled
from regrasp.planning.placement.levels.level import FrictionLevel
from regrasp.planning.placement.levels.moving_search import Moving
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sides import Sides

_GAPS = (0.03,)  # proven on the way, while less is asked
_BLOCK = 128  # sides that are cut from the ends of an arc on which fingers are alike
_COARSE = 16  # sides of both other fingers, from which on sides at the ends of the wide arc are left out
_FEWER = 0.9  # of the wide arc, what is left of it then at most
_NARROW = 1e-6  # of the size, of arcs that are not split
_SHORTEST = 2e-3  # of the size, of stretches of a side
_TURNED = 0.1  # of the distance at which a normal passes the centre, the longest stretch of a side


def closed_by_pairs(
    search: Search, level: FrictionLevel, best: float, tolerance: float, most: int, progress: Progress | None
) -> tuple[Search, float, float]:
    """A search that is closed, or the given one, which was not begun; the best level, and one beyond all.

    best: a level that was reached, at the placements of ``search``.
    """
    beyond, found, kept = level.top(search), search, search.placements()
    sides = finer(search.sides, level.coefficient(best))
    for gap in (*(t for t in _GAPS if t > tolerance), tolerance):
        if level.beyond(best, gap) >= beyond:
            continue
        trying = Search(sides, 3, search.friction, search.loads, search.law, search.apart, search.narrow)
        paired = Paired(trying, level, best, gap)

        def told(paired: Paired = paired, known: float = beyond) -> None:
            if progress is not None:
                progress(level.value(known), level.value(paired.best))

        try:
            paired.run(most, told)
            reached = settled(trying, level, paired.aim, paired.limit)
        except KeyboardInterrupt:
            trying.closed, trying.interrupted = False, True
        best = paired.best
        kept += [(norm, _placed(search.sides, sides.edges[on], u), u) for norm, on, u in trying.placements()]
        if trying.closed and reached < beyond:
            found, beyond = trying, reached
        if not trying.closed or reached > paired.aim:
            found.interrupted = trying.interrupted
            break
    every = [(norm, search.sides.edges[on], u) for norm, on, u in kept]
    found.take([(norm, _placed(found.sides, edges, u), u) for norm, edges, u in every])
    level.put(found, beyond)
    return found, best, beyond


def finer(sides: Sides, friction: float) -> Sides:
    """The same sides, long ones in stretches along which a force moves by no more than friction tilts it."""
    edges, (lo, hi) = sides.edges, sides.ends.T
    lengths = (hi - lo) * sides.lengths[edges] / sides.size
    middle, along = sides.points(np.arange(len(edges)), 0.5 * (lo + hi)) / sides.size, sides.vectors[edges]
    arms = np.abs((middle * along).sum(axis=1)) / sides.lengths[edges]
    most = np.maximum(max(friction, _SHORTEST), _TURNED * (arms - 0.5 * lengths))
    parts = np.ceil(lengths / most).astype(int)
    ends = [np.linspace(a, b, n + 1) for a, b, n in zip(lo, hi, parts, strict=True)]
    cut = np.concatenate([np.column_stack([at[:-1], at[1:]]) for at in ends])
    return replace(sides, edges=np.repeat(edges, parts), ends=cut)


class Paired(Moving):
    """All boxes, from the first on."""

    def __init__(self, search: Search, level: FrictionLevel, best: float, tolerance: float) -> None:
        from regrasp.closed_form.compiled.side_twists import MOST_TWISTS, room_for_sides

        super().__init__(search, level, best, tolerance)
        self.top, edges = level.top(search), search.sides.edges
        self._is_long = np.bincount(edges)[edges] > 1
        self._how, self._memory = np.zeros(len(edges), np.int8), room_for_sides()
        self._room = self.memory(len(search.loads), search.fingers)
        self._twists, self._loads = np.zeros((MOST_TWISTS, 3)), np.zeros(MOST_TWISTS, np.int64)

    def run(self, most: int, told: Callable[[], None]) -> None:
        """Exclude boxes or split them."""
        waiting = [(0, -1)]
        while waiting and self.aim < self.top:
            told()
            node, hard = waiting[-1]
            inside = self._looked_at(node, hard, most)
            if inside is None:
                break
            waiting.pop()
            waiting += inside

    def _looked_at(self, node: int, hard: int, most: int) -> list[tuple[int, int]] | None:
        """Boxes that one is split into, and the side to look at first; none where it is done."""
        from regrasp.closed_form.compiled.side_twists import LEFT, covered

        search = self.search
        arcs, ends = search.box(node)
        edges, counts = search.sides.edges[arcs], arcs[:, 1] - arcs[:, 0] + 1
        on_one = edges[:, 0] == edges[:, 1]
        if on_one.all():
            return self._on_edges(node, arcs, ends, most)
        alike = [(arcs[1] == arcs[i]).all() and (ends[1] == ends[i]).all() for i in (0, 2)]
        if any(alike) and counts[1] > _BLOCK:
            after = arcs[1, 0] + _BLOCK - 1 if alike[0] else arcs[1, 1] - _BLOCK
            return _each(search.halved(node, 1, 0.0, most, int(after)), hard)
        wide = int(counts.argmax())
        others = np.delete(np.arange(3), wide)
        apart = bool(on_one[others].all())
        used, left = covered(
            *search.terms(self.limit), arcs, ends, wide, hard, apart, self._how, self._twists, self._loads,
            self._memory,
        )  # fmt: skip
        first, last = arcs[wide]
        open_ = first + np.flatnonzero(self._how[first : last + 1] == LEFT)
        if not used:  # none is found: the motion of none, which excludes nothing, keeps how the box is split
            self._loads[0], self._twists[0], used = 0, 0.0, 1
        few = self._loads[:used].copy(), self._twists[:used] / [1, 1, search.sides.size]
        if not left:
            parts = search.parted(node, wide, np.zeros((0, 2), int), few, most)
            return None if parts is None else []
        if apart and (counts[others].max() == 1 or self._is_long[open_].all()):
            breaks = np.diff(open_) > 1
            breaks |= np.diff(search.sides.edges[open_]) != 0
            runs = np.split(open_, np.flatnonzero(breaks) + 1)
            return _each(search.parted(node, wide, np.array([(r[0], r[-1]) for r in runs]), few, most), -1)
        hull = np.array([[open_[0], open_[-1]]])
        if counts[others].min() >= _COARSE and open_[-1] - open_[0] < _FEWER * counts[wide]:
            within = search.parted(node, wide, hull, few, most)
            if not within:
                return None
            node = within[0]
        i = int(others[counts[others].argmax()])
        return _each(search.halved(node, i, 0.0, most, int(arcs[i].sum()) // 2), int(open_[0]))

    def _on_edges(self, node: int, arcs: np.ndarray, ends: Array, most: int) -> list[tuple[int, int]] | None:
        """The same of fingers on one edge each."""
        search, sides = self.search, self.search.sides
        if self._is_near(arcs, ends):
            search.leave(node, None)
            return []
        found = self.look(search, node, self._room)
        if isinstance(found, tuple):
            self.leave(node, found)
            return []
        if isinstance(found, np.ndarray):
            self.better(arcs[:, 0].copy(), found)
        lengths = np.diff(ends, axis=1)[:, 0] * sides.lengths[sides.edges[arcs[:, 0]]]
        i = int(lengths.argmax())
        if lengths[i] > _NARROW * sides.size:
            after = int(arcs[i].sum()) // 2 if arcs[i, 0] < arcs[i, 1] else None
            return _each(search.halved(node, i, float(ends[i].mean()), most, after), -1)
        return [(node, -1)] if self.raised(arcs[:, 0].copy(), ends.mean(axis=1)) else []

    def better(self, places: np.ndarray, u: Array) -> tuple[np.ndarray, Array] | None:
        """The same, of places anywhere on the edges of these sides."""
        sides = self.search.sides
        return super().better(_placed(sides, sides.edges[places], u), u)

    def _is_near(self, arcs: np.ndarray, ends: Array) -> bool:
        """Whether two fingers on one side each are nearer than they may be, wherever they are."""
        search, single = self.search, np.flatnonzero(arcs[:, 0] == arcs[:, 1])
        at = np.stack([search.sides.points(arcs[single, 0], ends[single, c]) for c in (0, 1)])
        far = np.linalg.norm(at[:, None, :, None] - at[None, :, None], axis=-1).max(axis=(0, 1))
        return bool((far[np.triu_indices(len(single), 1)] < search.apart).any())


def _placed(sides: Sides, edges: np.ndarray, u: Array) -> np.ndarray:
    """The sides of edges that places are on; at a corner there are two edges."""
    first, last = (np.searchsorted(sides.edges, edges, end) for end in ("left", "right"))
    on: np.ndarray = np.clip(sides.on(u), first, last - 1)
    return on


def _each(boxes: range | None, hard: int) -> list[tuple[int, int]] | None:
    return [(box, hard) for box in boxes] if boxes else None
