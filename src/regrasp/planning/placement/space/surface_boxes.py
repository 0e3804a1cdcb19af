"""Boxes of patches of a surface, and rounds of a branch and bound that threads share.

The best boxes that are open are looked at side by side; then one after the other is excluded or split, and
what they are split into is bounded side by side again. So threads change no number of a search.
"""

from heapq import heappop, heappush
from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.planning.placement.laws import Law
from regrasp.planning.placement.parts import PARTS, side_by_side, whole
from regrasp.planning.placement.space.patches import Patches

FIRST_BOXES = 4096
TRIED = 4096
TRY_PRECISE = 1e-6
_PRECISE, _ROUGH = 1e-3, 0.05  # of bounds below the best, and below a level, which need not say by how much
_AT_A_TIME, _ROWS = 512, 3000  # boxes, on so many rows
_ROUND, _SHARE = 64, 8  # boxes of a round at most, and of so many open ones one
_OFTEN = 16  # boxes of which one at least is excluded by all loads together
STRICT = 1e-9
"""Of a limit, by which excluded boxes must be above it."""
HELD = 1e-2
"""Of ``NEVER``: a load is held by less, so by forces of at most a thousand times its size."""
_ASIDE = 1e-7  # of the largest load: a placement that holds nothing so far beside a load is on a knife's edge
_SLIPPERY = 1e-3  # friction, below which that is said of every placement


class SurfaceBoxes:
    """Boxes that give each finger a patch, those that are open, and the best placement found.

    apart: least distance of fingers [m]. tolerance: of which bounds of boxes may be off a tenth, a fraction.
    limit: of forces, where a level is sought at which they are below it [N].
    """

    def __init__(
        self,
        patches: Patches,
        fingers: int,
        friction: float,
        loads: Array,
        law: Law,
        apart: float,
        tolerance: float,
        limit: float | None = None,
    ) -> None:
        from regrasp.closed_form.compiled.patches.patch_gauge import NEVER
        from regrasp.closed_form.compiled.patches.patch_joint import LOADS, room_together
        from regrasp.closed_form.compiled.patches.patch_search import spare
        from regrasp.closed_form.compiled.places.wrench_gauge import LARGEST

        self.patches, self.fingers, self.law, self.apart = patches, fingers, law, apart
        self.size = float(np.linalg.norm(patches.rows[:, :3], axis=1).max()) or 1.0
        self._unit = np.repeat([1.0, self.size], 3)
        self.unit = limit or float(np.abs(loads / self._unit).max()) or 1.0
        self._precision = min(0.1 * tolerance, _PRECISE) if limit is None else _ROUGH
        self.put(friction, loads)
        together = min(len(loads), LOADS)
        self._spares = [(spare(fingers), room_together(together, fingers)) for _ in range(PARTS)]
        self._joins = self.law.codes()[1] == LARGEST and 1 < len(loads) <= LOADS
        rows = patches.rows / [self.size, self.size, self.size, 1, 1, 1]
        room = 2 * len(patches.spans) + FIRST_BOXES
        self._rows = _room(rows, len(rows) + 3 * room)
        self._spans, self._tree = _room(patches.spans, room), _room(patches.tree, room)
        self._radius = _room(patches.radius / self.size, room)
        self._balls = patches.balls / np.repeat([self.size, 1.0], [4, 5])
        self._boxes = _memory(FIRST_BOXES, fingers)
        self._heap = [(0.0, 0)]  # bounds of the boxes that are open; the newest of equal ones first
        self._state = np.array([1, 0, len(patches.spans), len(rows), 0, 0, 0, 0])
        self._together = np.zeros((FIRST_BOXES, len(loads), 6))
        self._never = HELD * NEVER  # boxes are excluded from there, while nothing is found
        self._found = np.full(1 + 6 * fingers, self._never / (1 - tolerance))
        self._tried = np.zeros((TRIED, 1 + 6 * fingers))
        self.closed = self.interrupted = False

    def put(self, friction: float, loads: Array) -> None:
        """From now on with this friction, under these loads (L, 6) [N, N m].

        What has bounded boxes must still: friction gets less, or loads go on away from the first of them.
        """
        self.friction, self.loads = friction, loads
        self._wanted = np.ascontiguousarray(-loads / self._unit / self.unit)
        # two fingers hold no torque about their line, and three hold nothing aside without friction
        every = self.fingers > 2 and friction >= _SLIPPERY and loads.any()
        aside = np.vstack([np.eye(6), np.full(6, -1.0)]) * (_ASIDE if every else 0.0)
        self._trials = np.vstack([self._wanted, (self._wanted[:, None] + aside).reshape(-1, 6)])
        self._law = (friction, *self.law.codes(), self._precision)
        self._usable = kept_friction(friction, 2 * RESERVE)

    def some(self, tolerance: float, narrow: float) -> int:
        """Some rounds; why they end, as of ``placement_search``."""
        from regrasp.closed_form.compiled.places.placement_search import PAUSED

        each = max(_AT_A_TIME * _ROWS // max(_ROWS, len(self.patches.rows)), 1)  # lest an interrupt waits
        before = self.count
        if before == 1 and self._boxes[1][0] == 0.0:
            self._bounded(np.zeros(1, np.int64), inf, narrow)
        ended = None
        while ended is None and self.count - before < each:
            ended = whole(lambda: self._round(tolerance, narrow))
        return PAUSED if ended is None else ended

    def _round(self, tolerance: float, narrow: float) -> int | None:
        """Look at the best boxes that are open, side by side, and split them; why no more of them may be."""
        from regrasp.closed_form.compiled.patches.patch_search import split
        from regrasp.closed_form.compiled.places.placement_search import CLOSED, FULL, PAUSED

        level, boxes, heap = self._found[0] * (1 - tolerance), self._boxes, self._heap
        many = min(self._room_for(), max(min(len(heap) // _SHARE, _ROUND), 1))
        if heap and heap[0][0] < level and not many:
            return FULL
        few: list[int] = []
        while heap and heap[0][0] < level and len(few) < many:
            few.append(-heappop(heap)[1])
        if not few:
            boxes[4][[-node for _, node in heap]] = 1
            heap.clear()
            return CLOSED
        nodes = np.array(few)
        values, proven, twists = self._looked_at(nodes, level)
        self._state[4] = sum(int(own[8][15][0] + room[-1][0]) for own, room in self._spares)
        tried = np.column_stack([values, boxes[6][nodes].reshape(len(nodes), -1)])
        self._tried[(self._state[1] + np.arange(len(nodes))) % TRIED] = tried
        self._state[1] += len(nodes)
        best = int(values.argmin())
        if values[best] < self._found[0]:
            self._found[:] = tried[best]
            level = values[best] * (1 - tolerance)
            if tolerance < 0:
                self._at = int(nodes[best])
                for node in few:
                    heappush(heap, (boxes[1][node], -node))
                return PAUSED
        self._state[6] += np.count_nonzero(proven)
        self._state[7] += np.count_nonzero(proven >= level)
        first = self.count
        split(
            nodes, self._surface, self._radius, level, self.apart / self.size, boxes, self._state,
            self._spares[0][0], proven, twists, self._together,
        )  # fmt: skip
        made = first + np.flatnonzero(boxes[4][first : self.count] == 0)
        self._bounded(made, level, narrow)
        gone = boxes[1][made] >= level
        boxes[4][made[gone]] = 1
        for node in made[~gone].tolist():
            heappush(heap, (boxes[1][node], -node))
        return None

    def _looked_at(self, nodes: np.ndarray, level: float) -> tuple[Array, Array, Array]:
        """(n,) what placements of some boxes need, (n,) what all loads together prove, by (n, L, 6)."""
        from regrasp.closed_form.compiled.patches.patch_search import look

        values, proven = np.zeros(len(nodes)), np.zeros(len(nodes))
        twists = np.zeros((len(nodes), len(self.loads), 6))
        # while it pays: where it seldom excludes a box, few more are tried
        joining = self._joins and self._state[6] <= _OFTEN * (self._state[7] + _OFTEN)
        side_by_side(
            lambda i: look(
                i, PARTS, nodes, self._surface, self._wanted, self._trials, self._law, self._usable,
                self._found[0], level, self.apart / self.size, self._boxes, *self._spares[i], joining, values,
                proven, twists,
            ),
            len(nodes),
        )  # fmt: skip
        return values, proven, twists

    def _bounded(self, nodes: np.ndarray, level: float, narrow: float) -> None:
        """Bound some boxes, up to a level of the norm."""
        from regrasp.closed_form.compiled.patches.patch_search import bound

        side_by_side(
            lambda i: bound(
                i, PARTS, nodes, self._surface, self._radius, self._wanted, self._law, level, narrow,
                self._boxes, self._spares[i][0],
            ),
            len(nodes),
        )  # fmt: skip

    def _room_for(self) -> int:
        """Boxes that there is room to split."""
        rooms = (
            (len(self._boxes[1]) - self.count) // (self.fingers + 1),
            (len(self._spans) - int(self._state[2])) // 2,
            (len(self._rows) - int(self._state[3])) // 6,
            len(self._together) - int(self._state[5]),
        )
        return min(rooms)

    def _grow(self, most: int) -> bool:
        have = len(self._boxes[1])
        room = min(2 * have, most) if self.count + self.fingers + 1 > have else have
        if self.count + self.fingers + 1 > room:
            return False
        if room > have:
            larger = _memory(room, self.fingers)
            for old, new in zip(self._boxes, larger, strict=True):
                new[:have] = old
            self._boxes = larger
        if self._state[5] == len(self._together):
            self._together = _room(self._together, 2 * len(self._together))
        patches, rows = int(self._state[2]), int(self._state[3])
        if patches + 2 > len(self._spans) or rows + 6 > len(self._rows):
            self._rows = _room(self._rows, 2 * len(self._rows))
            self._spans, self._tree = (_room(a, 2 * len(a)) for a in (self._spans, self._tree))
            self._radius = _room(self._radius, 2 * len(self._radius))
        return True

    @property
    def count(self) -> int:
        """Boxes made."""
        return int(self._state[0])

    @property
    def _surface(self) -> tuple[np.ndarray, ...]:
        return self._rows, self._spans, self._tree, self._balls

    def excluded(self, boxes: np.ndarray) -> int:
        """How many of some boxes hold no loads by forces up to the limit now, before one that may."""
        done, some = 0, 1
        while done < len(boxes):
            few = boxes[done : done + some]
            self._boxes[1][few], self._boxes[8][few] = 0.0, -1
            self._bounded(few, 1 + STRICT, 0.0)
            gone = self._boxes[1][few] >= 1 + STRICT
            self._boxes[4][few] = gone
            if not gone.all():
                return done + int(gone.argmin())
            done, some = done + len(few), min(2 * some, _ROUND)
        return done


def _room(values: np.ndarray, room: int) -> np.ndarray:
    larger = np.zeros((room, *values.shape[1:]), values.dtype)
    larger[: len(values)] = values
    return larger


def _memory(room: int, k: int) -> tuple[np.ndarray, ...]:
    """Arrays for so many boxes, as the compiled search takes them."""
    return (
        np.zeros((room, k), np.int64), np.zeros(room), np.zeros((room, 6)), np.zeros(room, np.int64),
        np.zeros(room, np.int64), np.zeros((room, 2), np.int64), np.zeros((room, k, 6)),
        np.zeros(room, np.int64), np.full(room, -1),
    )  # fmt: skip
