"""The search for what set-points withstand: boxes of one side for each finger, bounded by ``Ties``."""

from collections.abc import Callable
from contextlib import suppress
from heapq import heappop, heappush
from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.planning.placement.levels.level import AnsweredLevel
from regrasp.planning.placement.levels.tied import Ties, Withstood
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sliding import Placed

STRICT = 1e-9
"""Of the limit, by which excluded boxes must be above it."""
_BOXES = 50  # that a program counts for; half of the programs are for first looks at most
_NARROW = 1e-6  # of the size, of arcs that are not split
_EVEN = 0.02  # of an arc, that counts where its fingers press in one place under all loads
_GIVEN = 1e-6  # of a factor, that solvers may be off by


class TiedSearch:
    """Boxes that a search left open, the one that may withstand most first.

    factor: what a placement withstands. kept: placements known, the negative of their factors first.
    """

    def __init__(
        self,
        level: AnsweredLevel,
        search: Search,
        factor: Callable[[np.ndarray, Array], float],
        kept: list[Placed],
        tolerance: float,
    ) -> None:
        self.level, self.search, self.factor, self.kept = level, search, factor, kept
        scale = level.max_force * np.array([1.0, 1.0, search.sides.size])
        self.ties = Ties(search.fingers, level.center / scale, level.deviations / scale)
        self.best = max((-placed[0] for placed in kept), default=-1.0)
        self.aim = level.beyond(max(self.best, 0.0), tolerance)
        self.tolerance = tolerance
        self.solved = 0
        self.open: dict[int, tuple[float, Withstood | None]] = {}

    def run(self, most: int, progress: Progress | None, beyond: float) -> float:
        """Search; a level that no placement is beyond, at which the search is left.

        beyond: such a level, by what is answered.
        """
        with suppress(KeyboardInterrupt):
            self._split_all(most, progress, beyond)
        search, level = self.search, self.level
        left = search.left.tolist()
        search.closed = search.closed and all(node in self.open for node in left)
        search.take(sorted(self.kept, key=lambda placed: placed[0]))
        reached = max(self.aim, *(self.open.get(node, (beyond, None))[0] for node in left), self.aim)
        if not search.closed or reached >= beyond:
            search.closed = False
            return beyond
        level.put(search, reached)
        for node in left:
            if (found := self.open.get(node, (beyond, None))[1]) is not None:
                self._leave(node, found)
        search.closed = search.excludes(search.left, level.max_force * (1 + STRICT))
        return reached

    def _split_all(self, most: int, progress: Progress | None, beyond: float) -> None:
        search, heap = self.search, list[tuple[float, int]]()
        self.open = dict.fromkeys(search.left.tolist(), (beyond, None))
        programs = most // _BOXES
        for node in list(self.open):
            arcs, _ = search.box(node)
            if 2 * self.solved > programs:
                break
            if (arcs[:, 0] == arcs[:, 1]).all():
                self._bound(node, heap)
        while heap and -heap[0][0] > self.aim and self.solved < programs:
            node = heappop(heap)[1]
            bound, found = self.open[node]
            parts, grid = self._parts(node)
            _, ends = search.box(node)
            matters = np.array([np.hypot(*(points[-1] - points[0])) for points, _ in parts])
            wide, middles = matters > _NARROW * search.sides.size, np.full(len(parts), 0.5)
            if found is not None:
                at = grid / (np.array([len(points) for points, _ in parts]) - 1)
                pressed = found.pressed.sum(axis=0) + _GIVEN
                centres = ((at[:, :, None] * found.pressed).sum(axis=0) + 0.5 * _GIVEN) / pressed
                middles = centres.mean(axis=1)
                matters *= np.ptp(centres, axis=1) + _EVEN + [1 - abs(t[0] @ t[-1]) for _, t in parts]
            self._try(node, ends[:, 0] + middles * np.diff(ends, axis=1)[:, 0])
            if not wide.any():
                continue
            i = int(np.where(wide, matters, -1.0).argmax())
            inside = search.halved(node, i, float(ends[i].mean()), most)
            if not inside:
                break
            del self.open[node]
            self.open |= dict.fromkeys(inside, (bound, found))
            for child in inside:
                self._bound(child, heap)
            if progress is not None:
                progress(max(self.aim, -heap[0][0] if heap else 0.0), self.best)

    def _bound(self, node: int, heap: list[tuple[float, int]]) -> None:
        """Exclude a box, or leave it for later with the best bound known."""
        search = self.search
        parts, grid = self._parts(node)
        points = self._corners(parts, grid) * search.sides.size
        away = np.hypot(*(points[:, :, None] - points[:, None]).transpose(3, 0, 1, 2)).max(axis=0)
        if (away + np.diag(np.full(len(parts), inf)) < search.apart).any():
            search.leave(node, None)
            return
        self.level.put(search, self.aim)
        if search.excludes(np.array([node]), self.level.max_force * (1 + STRICT)):
            return
        found = self._answer(parts, grid, search.friction)
        if found is not None and found.factor < self.open[node][0]:
            self.open[node] = found.factor, found
        bound, known = self.open[node]
        if known is not None and bound <= self.aim:
            self._leave(node, known)
        else:
            heappush(heap, (-bound, node))

    def _leave(self, node: int, found: Withstood) -> None:
        """Exclude a box by duals, in the units of the proof."""
        size = self.search.sides.size
        twists, ties = np.split(found.duals, [3 * len(self.ties.deviations) + 3])
        self.search.leave(node, np.concatenate([(twists.reshape(-1, 3) / [1, 1, size]).ravel(), ties / size]))

    def _try(self, node: int, u: Array) -> None:
        """What fingers within a box withstand."""
        places, search = self.search.box(node)[0][:, 0].copy(), self.search
        if not search.are_apart(places, u):
            return
        parts = [search.sides.part(int(j), v, v) for j, v in zip(places, u.tolist(), strict=True)]
        friction = kept_friction(search.friction, 2 * RESERVE)
        found = self._answer(parts, np.zeros((1, len(parts)), np.int64), friction)
        if found is None or found.factor < 0:
            return
        factor = found.factor * (1 - _GIVEN)
        if factor > self.best:
            factor = min(factor, self.factor(places, u))
            if factor > self.best:
                self.best = factor
                self.aim = max(self.aim, self.level.beyond(factor, self.tolerance))
        if factor >= 0:
            self.kept.append((-factor, places, u))

    def _parts(self, node: int) -> tuple[list[tuple[Array, Array]], np.ndarray]:
        """Points and tangents of each finger's arc, and (C, k) which points make the corners of a box."""
        arcs, ends = self.search.box(node)
        on = zip(arcs[:, 0].tolist(), ends.tolist(), strict=True)
        parts = [self.search.sides.part(j, lo, hi) for j, (lo, hi) in on]
        return parts, np.indices([len(points) for points, _ in parts]).reshape(len(parts), -1).T

    def _corners(self, parts: list[tuple[Array, Array]], grid: np.ndarray) -> Array:
        points = [points[at] for (points, _), at in zip(parts, grid.T, strict=True)]
        result: Array = np.stack(points, axis=1) / self.search.sides.size
        return result

    def _answer(
        self, parts: list[tuple[Array, Array]], grid: np.ndarray, friction: float
    ) -> Withstood | None:
        rays = np.array([_rays(tangents, friction) for _, tangents in parts])
        first, last = rays[:, 0], rays[:, 1]
        across = first[:, 0] * last[:, 1] - first[:, 1] * last[:, 0]
        if not ((across > 0) | ((first * last).sum(axis=1) > 0)).all():
            return None  # half of all directions and more
        self.solved += 1
        return self.ties.answer(self._corners(parts, grid), rays)


def _rays(tangents: Array, friction: float) -> Array:
    """(2, 2) clockwise and other edge of all cones between those of some tangents."""
    x, y = tangents.sum(axis=0)
    turned = np.arctan2(x * tangents[:, 1] - y * tangents[:, 0], tangents @ [x, y])
    outer = tangents[[turned.argmin(), turned.argmax()]]
    edges = outer[:, ::-1] * [-1, 1] + outer * [[friction], [-friction]]
    result: Array = edges / np.hypot(*edges.T)[:, None]
    return result
