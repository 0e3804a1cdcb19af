"""The search for what set-points withstand: boxes of groups of edges, bounded by ``Ties``.

What excludes one box often excludes its neighbours and groups of edges: known duals are tried first.
Only then programs are solved: of a placement, whose duals may do, then of the corners at the ends of all
arcs, which the corner joins where duals found so far do the most work.
"""

from collections.abc import Callable
from contextlib import suppress
from heapq import heappop, heappush
from itertools import combinations

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.planning.placement.levels.known_duals import KnownDuals
from regrasp.planning.placement.levels.level import AnsweredLevel
from regrasp.planning.placement.levels.tied import Ties, Withstood
from regrasp.planning.placement.levels.tied_boxes import Boxes, Corners
from regrasp.planning.placement.search import Progress, Search
from regrasp.planning.placement.sliding import Placed

STRICT = 1e-9
"""Of the limit, by which excluded boxes must be above it."""
_BOXES = 25  # that a program counts for
_NARROW = 1e-6  # of the size, of arcs that are not split
_EVEN = 0.2  # of an arc, that counts where its fingers press in one place under all loads
_TURN = 0.5  # of the size, that a turn by one radian counts for
_GIVEN = 1e-6  # of a factor, that solvers may be off by
_ROUNDS = 4  # programs of a box
_LOOSE = 1.2  # bound by what corners together withstand, from where on another corner helps little


class TiedSearch:
    """Boxes that are left of a search, those that may withstand most first.

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
        self.boxes = Boxes(search.sides, search.friction)
        self.tried = Boxes(search.sides, kept_friction(search.friction, 2 * RESERVE))
        self.known = KnownDuals(self.ties)
        self.tolerance = tolerance
        self.begin()
        self.open: dict[int, tuple[float, int]] = {}  # boxes' bounds, and the duals that prove them
        self._rows: dict[int, int] = {}  # of the proof, of duals known

    def begin(self) -> None:
        """Begin from the placements known."""
        self.best = max((-placed[0] for placed in self.kept), default=-1.0)
        self.aim = self.level.beyond(max(self.best, 0.0), self.tolerance)
        self.solved = 0

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
        reached = max(self.aim, *(self.open.get(node, (beyond, -1))[0] for node in left), self.aim)
        if not search.closed or reached >= beyond:
            search.closed = False
            return beyond
        level.put(search, reached)
        for node in left:
            if (number := self.open[node][1]) >= 0:
                self._leave(node, number)
        open_ones = search.left
        search.closed = search.excluded(open_ones, level.max_force * (1 + STRICT)) == len(open_ones)
        return reached

    def _split_all(self, most: int, progress: Progress | None, beyond: float) -> None:
        search = self.search
        left = search.left.tolist()
        self.open = dict.fromkeys(left, (beyond, -1))
        heap = [(-beyond, i, node) for i, node in enumerate(left)]
        made, programs = len(heap), most // _BOXES
        while heap and -heap[0][0] > self.aim and self.solved < programs:
            bounded, _, node = heappop(heap)
            if progress is not None:
                progress(-bounded, self.best)
            spread = self._bounded(node)
            if spread is None:
                continue
            finger = self._widest(node, spread)
            if finger is None:
                continue
            inside = self._parted(node, finger, most)
            if not inside:
                break
            bound = self.open.pop(node)
            self.open |= dict.fromkeys(inside, bound)
            for child in inside:
                made += 1
                heappush(heap, (-bound[0], made, child))

    def _bounded(self, node: int) -> Array | None:
        """Exclude a box: None; or note its best bound, and how far (k,) centres of pressure are apart."""
        search, (arcs, ends) = self.search, self.search.box(node)
        alike = np.ones(len(arcs))
        self.level.put(search, self.aim)
        if search.excluded(np.array([node]), self.level.max_force * (1 + STRICT)):
            return None
        corners = self.boxes.corners(arcs, ends)
        if corners is None:
            return alike
        if (arcs[:, 0] == arcs[:, 1]).all() and self._are_near(corners):
            search.leave(node, None)
            return None
        bound, number = self.open[node]
        if bound > self.aim:
            number = self.known.excluding(corners, self.aim)
        if number >= 0:
            self._leave(node, number)
            return None
        found = self._tried(arcs, ends)
        worst = None if found is None else self._noted(node, corners, found)
        if found is None or worst is None or found.factor > self.aim:
            return alike if found is None or worst is not None else None
        at = np.vstack([corners.outermost, worst])
        for _ in range(_ROUNDS):
            points, rays, u = corners.at(np.unique(at, axis=0))
            found = self._answer(points, rays)
            if found is None:
                break
            worst = self._noted(node, corners, found)
            if worst is None:
                return None
            pressed = found.pressed.sum(axis=0) + _GIVEN
            even = _GIVEN * u.mean(axis=0)[:, None]
            centres = ((u[:, :, None] * found.pressed).sum(axis=0) + even) / pressed
            alike = np.ptp(centres, axis=1) / np.diff(ends, axis=1)[:, 0] + _EVEN
            if found.factor > self.aim or self.open[node][0] > _LOOSE * found.factor:
                break
            at = np.vstack([at, worst])
        return alike

    def _noted(self, node: int, corners: Corners, found: Withstood) -> np.ndarray | None:
        """Exclude a box by duals: None; or note the bound by them, and the corner that it is due to."""
        n = self.known.add(found.duals, corners.middle)
        factor, worst = self.known.factor(corners, n)
        if factor < self.open[node][0]:
            self.open[node] = factor, n
        if factor > self.aim:
            return worst
        self._leave(node, n)
        return None

    def _leave(self, node: int, number: int) -> None:
        """Exclude a box by duals, in the units of the proof."""
        if number not in self._rows:
            size = self.search.sides.size
            twists, ties = np.split(self.known.rows[number], [3 * len(self.ties.deviations) + 3])
            self.search.duals.append(np.append(twists.reshape(-1, 3) / [1, 1, size], ties / size))
            self._rows[number] = len(self.search.duals) - 1
        self.search.leave(node, self._rows[number])

    def _tried(self, arcs: np.ndarray, ends: Array) -> Withstood | None:
        """What fingers in the middle of their arcs withstand."""
        sides, search = self.search.sides, self.search
        middle = [(arc[0], arc_ends.mean()) for arc, arc_ends in zip(arcs, ends, strict=True)]
        for i in np.flatnonzero(arcs[:, 0] < arcs[:, 1]).tolist():
            on = self.boxes.stretches(arcs[i], ends[i])
            until = np.cumsum([(hi - lo) * sides.lengths[sides.edges[j]] for j, lo, hi in on])
            j, lo, hi = on[int(np.searchsorted(until, 0.5 * until[-1]))]
            middle[i] = j, 0.5 * (lo + hi)
        places, u = np.array([j for j, _ in middle]), np.array([v for _, v in middle])
        if not search.are_apart(places, u):
            return None
        found = self.answered(places, u)
        if found is None or found.factor < 0:
            return found
        factor = found.factor * (1 - _GIVEN)
        if factor > self.best:
            factor = min(factor, self.factor(places, u))
            if factor > self.best:
                self.best = factor
                self.aim = max(self.aim, self.level.beyond(factor, self.tolerance))
        if factor >= 0:
            self.kept.append((-factor, places, u))
        return found

    def answered(self, places: np.ndarray, u: Array) -> Withstood | None:
        """What a placement withstands, but for what solvers are off by; None where they do not say."""
        k = len(u)
        corner = self.tried.corners(places.repeat(2).reshape(k, 2), u.repeat(2).reshape(k, 2))
        return None if corner is None else self._answer(*corner.at(np.zeros((1, k), np.int64))[:2])

    def _answer(self, points: Array, rays: Array) -> Withstood | None:
        self.solved += 1
        return self.ties.answer(points, rays)

    def _widest(self, node: int, spread: Array) -> int | None:
        """The finger whose arc is to be split; None where all are narrow."""
        sides, (arcs, ends) = self.search.sides, self.search.box(node)
        matters = np.zeros(len(arcs))
        for i, (arc, arc_ends) in enumerate(zip(arcs, ends, strict=True)):
            on = self.boxes.stretches(arc, arc_ends)
            reach, turn = _extent([sides.part(*side) for side in (on[0], on[len(on) // 2], on[-1])])
            matters[i] = reach + _TURN * turn * sides.size
        wide = (matters > _NARROW * sides.size) | (arcs[:, 0] < arcs[:, 1])
        return int(np.where(wide, matters * spread, -1.0).argmax()) if wide.any() else None

    def _parted(self, node: int, finger: int, most: int) -> range:
        """The boxes that one is split into, an arc of a finger in halves; none without room."""
        sides, (arcs, ends) = self.search.sides, self.search.box(node)
        on = self.boxes.stretches(arcs[finger], ends[finger])
        if len(on) == 1:
            return self.search.halved(node, finger, float(ends[finger].mean()), most)
        until = np.cumsum([(hi - lo) * sides.lengths[sides.edges[j]] for j, lo, hi in on])
        after = on[int(np.abs(until[:-1] - 0.5 * until[-1]).argmin())][0]
        return self.search.halved(node, finger, 0.0, most, after)

    def _are_near(self, corners: Corners) -> bool:
        """Whether two fingers are nearer than they must be, wherever they are."""
        points = [p[:n] * self.search.sides.size for p, n in zip(corners.points, corners.counts, strict=True)]
        return any(
            np.hypot(*(p[:, None] - q).transpose(2, 0, 1)).max() < self.search.apart
            for p, q in combinations(points, 2)
        )


def _extent(parts: list[tuple[Array, Array]]) -> tuple[float, float]:
    """How far points of some sides are apart, and their tangents."""
    points, tangents = (np.concatenate(values) for values in zip(*parts, strict=True))
    reach, turn = (np.hypot(*(v[:, None] - v).transpose(2, 0, 1)).max() for v in (points, tangents))
    return float(reach), float(turn)
