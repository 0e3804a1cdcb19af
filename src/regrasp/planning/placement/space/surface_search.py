"""Running the branch and bound over patches of a surface, and reading what it found."""

from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.planning.placement.laws import Law
from regrasp.planning.placement.proofs.box_rows import strongest
from regrasp.planning.placement.search import Progress
from regrasp.planning.placement.space.patches import Patches

MOST_BOXES = 1_000_000
"""Boxes of a search in space unless told otherwise: 500 bytes each for three fingers, with their proof."""
MOST_LOOKS = 1_500_000_000
"""Corners and groups of faces looked at, unless told how many boxes."""
_FIRST_BOXES = 4096
_AT_A_TIME, _ROWS = 512, 3000  # boxes, on so many rows
_TRIED = 4096
_PRECISE, _TRY_PRECISE = 1e-3, 1e-6
_SAFE = 1e-9  # of a bound, given up to rounding
_STRICT = 1e-9  # of a limit, by which excluded boxes must be above it
_NEVER_TOGETHER = 1 << 40
_STEP, _SHORTEST = 0.2, 1e-5  # of slides, of the size
HELD = 1e-2
"""Of ``NEVER``: a load is held by less, so by forces of at most a thousand times its size."""
_ASIDE = 1e-7  # of the largest load: a placement that holds nothing so far beside a load is on a knife's edge
_SLIPPERY = 1e-3  # friction, below which that is said of every placement
_GAINED = 0.01  # a placement better by so much is worth a slide


class SurfaceSearch:
    """A search for the best places of fingers on patches.

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

        self.patches, self.fingers, self.law, self.apart = patches, fingers, law, apart
        self.size = float(np.linalg.norm(patches.rows[:, :3], axis=1).max()) or 1.0
        self._unit = np.repeat([1.0, self.size], 3)
        self.unit = limit or float(np.abs(loads / self._unit).max()) or 1.0
        self._precision = min(0.1 * tolerance, _PRECISE) if limit is None else _TRY_PRECISE
        self.put(friction, loads)
        self._spare, self._for_all = spare(fingers), room_together(min(len(loads), LOADS))
        rows = patches.rows / [self.size, self.size, self.size, 1, 1, 1]
        room = 2 * len(patches.spans) + _FIRST_BOXES
        self._rows = _room(rows, len(rows) + 3 * room)
        self._spans, self._tree = _room(patches.spans, room), _room(patches.tree, room)
        self._radius = _room(patches.radius / self.size, room)
        self._balls = patches.balls / np.repeat([self.size, 1.0], [4, 5])
        self._boxes = _memory(_FIRST_BOXES, fingers)
        self._heap = np.zeros(_FIRST_BOXES, np.int64)
        self._state = np.array([1, 1, 0, len(patches.spans), len(rows), 0, 0, 0, 0])
        self._together = np.zeros((_FIRST_BOXES, len(loads), 6))
        self._never = HELD * NEVER  # boxes are excluded from there, while nothing is found
        self._found = np.full(1 + 6 * fingers, self._never / (1 - tolerance))
        self._tried = np.zeros((_TRIED, 1 + 6 * fingers))
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

    def run(
        self, tolerance: float, most: int, narrow: float, progress: Progress | None, looks: float = inf
    ) -> None:
        """Search until no placement can be better by the fraction ``tolerance``, or ``most`` boxes are used.

        looks: corners and groups of faces looked at, after which it ends, too.

        An interrupt from the keyboard ends the search, too, and leaves what it has found.
        """
        from regrasp.closed_form.compiled.places.placement_search import CLOSED, FULL

        slid, due = inf, _FIRST_BOXES
        try:
            while True:
                ended = self._some(tolerance, narrow)
                if self._found[0] < slid * (1 - _GAINED) or self.count >= due:
                    fine = ended == CLOSED or self.count >= due
                    self._slide(_STEP, _SHORTEST if fine else 0.1 * _STEP)
                    slid, due = self._found[0], max(due, 2 * self.count if fine else due)
                if progress is not None:
                    progress(self.bound, self.best)
                self.closed = ended == CLOSED
                if self.closed or self._state[5] > looks or (ended == FULL and not self._grow(most)):
                    break
            self._slide(0.1 * _STEP, _SHORTEST)
        except KeyboardInterrupt:
            self.interrupted = True
            if self.best == inf:
                raise

    def _some(self, tolerance: float, narrow: float) -> int:
        from regrasp.closed_form.compiled.patches.patch_search import search

        each = max(_AT_A_TIME * _ROWS // max(_ROWS, len(self.patches.rows)), 1)  # lest an interrupt waits
        return int(search(
            self._surface, self._radius, self._wanted, self._trials, self._law, self._usable, tolerance,
            self.apart / self.size, narrow, self._boxes, self._heap, self._state, self._found, self._tried,
            each, self._spare, self._together, self._for_all,
        ))  # fmt: skip

    def begin_level(self, *, together: bool) -> None:
        """Look for a placement with forces up to the limit; whether loads may be taken together."""
        self._found[0] = 1.0
        self._state[7] = 0 if together else _NEVER_TOGETHER

    def goes_on(self, narrow: float, most: int, looks: float) -> bool:
        """Some more boxes at a level. False where none is left, or no room for more of them."""
        from regrasp.closed_form.compiled.places.placement_search import CLOSED, FULL

        ended = self._some(-_STRICT, narrow)
        self.closed = ended == CLOSED
        return not self.closed and self._state[5] <= looks and (ended != FULL or self._grow(most))

    @property
    def found(self) -> Array | None:
        """The spots (k, 6) [m] of a placement with forces up to the limit; None before there is one."""
        scale = [self.size, self.size, self.size, 1, 1, 1]
        return self._found[1:].reshape(-1, 6) * scale if self._found[0] < 1.0 else None

    def pass_over(self) -> None:
        """Try no placement of the box that comes next: its fingers in one place are none."""
        self._boxes[6][self._heap[0]] = self._boxes[6][self._heap[0], :1]

    def excluded(self, boxes: np.ndarray) -> int:
        """How many of some boxes hold no loads by forces up to the limit now, before one that may."""
        from regrasp.closed_form.compiled.patches.patch_search import search

        for number, box in enumerate(boxes):
            one = tuple(values[box : box + 1] for values in self._boxes)
            one[1][0], one[4][0], one[8][0] = 0.0, 0, -1
            state = np.array([1, 1, 0, *self._state[3:5], 0, 0, 0, 0])
            search(
                self._surface, self._radius, self._wanted, self._trials, self._law, self._usable, -_STRICT,
                0.0, 0.0, one, np.zeros(1, np.int64), state, np.full(len(self._found), 1.0), self._tried[:1],
                0, self._spare, self._together, self._for_all,
            )  # fmt: skip
            if one[4][0] == 0:
                return number
        return len(boxes)

    @property
    def left(self) -> np.ndarray:
        """Numbers of boxes not excluded: not looked at, or too small to be split; the least bound first."""
        open_ones = np.flatnonzero(self._boxes[4][: self.count] == 0)
        return open_ones[np.argsort(self._boxes[1][open_ones], kind="stable")]

    def slid(self, spots: Array) -> tuple[float, Array]:
        """The norm [N] and the spots (k, 6) [m] that fingers come to by sliding from these."""
        found = self._found.copy()
        self._found[1:] = self._scaled(spots).ravel()
        self._found[0] = self._value(self._scaled(spots))
        self._slide(0.1 * _STEP, _SHORTEST)
        norm, at = self.best, self._found[1:].reshape(-1, 6) * [self.size, self.size, self.size, 1, 1, 1]
        self._found[:] = found
        return norm, at

    @property
    def _surface(self) -> tuple[np.ndarray, ...]:
        return self._rows, self._spans, self._tree, self._balls

    def keep_one_on(self, patch: int) -> None:
        """One finger is on a patch; to be said before the search."""
        self._boxes[0][0, 0] = patch

    def accept(self, spots: Array) -> None:
        """Take a placement (k, 6) [m] for found, where it is better."""
        scaled = self._scaled(spots)
        self._take(scaled, self._value(scaled))

    def norm_at(self, spots: Array) -> float:
        """The norm of forces of fingers at spots (k, 6) [m], for the worst load [N]."""
        return self._held(self._value(self._scaled(spots)))

    def _scaled(self, spots: Array) -> Array:
        return np.array(spots / [self.size, self.size, self.size, 1, 1, 1])

    def _take(self, scaled: Array, value: float) -> None:
        if value < self._found[0]:
            self._found[0], self._found[1:] = value, scaled.ravel()
            row = self._state[2] % _TRIED
            self._state[2] += 1
            self._tried[row] = self._found

    def _value(self, scaled: Array) -> float:
        from regrasp.closed_form.compiled.patches.patch_search import spare
        from regrasp.closed_form.compiled.patches.patch_slide import slide

        law = (self._usable, *self._law[1:3], _TRY_PRECISE)
        return float(
            slide(
                self._rows, 0, self._trials, law, self.apart / self.size, 0.0, 1.0, scaled, inf,
                scaled.copy(), np.zeros((2, 3)), spare(self.fingers),
            )
        )  # fmt: skip

    def _slide(self, step: float, shortest: float) -> None:
        from regrasp.closed_form.compiled.patches.patch_search import spare
        from regrasp.closed_form.compiled.patches.patch_slide import slide

        if self.best == inf or not self._radius[: len(self.patches.order)].any():
            return
        spots = self._found[1:].reshape(-1, 6).copy()
        law = (self._usable, *self._law[1:3], _TRY_PRECISE)
        value = slide(
            self._rows, len(self.patches.order), self._trials, law, self.apart / self.size, step, shortest,
            spots, self._found[0], spots.copy(), np.zeros((2, 3)), spare(self.fingers),
        )  # fmt: skip
        self._take(spots, value)

    def _grow(self, most: int) -> bool:
        have = len(self._heap)
        room = min(2 * have, most) if self.count + self.fingers + 1 > have else have
        if self.count + self.fingers + 1 > room:
            return False
        if room > have:
            larger = _memory(room, self.fingers)
            for old, new in zip(self._boxes, larger, strict=True):
                new[:have] = old
            self._boxes, self._heap = larger, _room(self._heap, room)
        if self._state[6] == len(self._together):
            self._together = _room(self._together, 2 * len(self._together))
        patches, rows = int(self._state[3]), int(self._state[4])
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
    def best(self) -> float:
        """The least norm found [N]; infinite before one is."""
        return self._held(self._found[0])

    def _held(self, norm: float) -> float:
        return float(norm) * self.unit if norm < self._never else inf

    @property
    def bound(self) -> float:
        """No placement has a smaller norm [N]."""
        bounds, kinds = self._boxes[1][: self.count], self._boxes[4][: self.count]
        return float(bounds[(kinds == 0) | (kinds == 1)].min(initial=inf)) * self.unit * (1 - _SAFE)

    def placements(self) -> list[tuple[float, Array]]:
        """Placements tried, the best first: their norm [N] and spots (k, 6) [m]."""
        rows = np.vstack([self._found, self._tried[: min(int(self._state[2]), _TRIED)]])
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        scale = [self.size, self.size, self.size, 1, 1, 1]
        found = ((self._held(row[0]), row[1:].reshape(-1, 6) * scale) for row in rows)
        return [(norm, spots) for norm, spots in found if norm < inf]

    def arrays(self) -> dict[str, Array]:
        """What a proof is made of, arrays of their own: patches, boxes, and what bounds them."""
        n, p = self.count, int(self._state[3])
        patches, _, twists, critical, kinds, children, _, _, joined = (values[:n] for values in self._boxes)
        spans = self._spans[: len(self.patches.spans)] // 3
        split = kinds == 2
        rows = np.flatnonzero(~split & (kinds != 3) & (joined >= 0))
        number = np.where(split, 0, np.where(kinds == 3, -1, critical))
        number[rows] = -2 - np.arange(len(rows))
        twists = np.where(split[:, None] | (number < -1)[:, None], 0.0, twists / self._unit)
        number = np.where(split | (number < 0), number, strongest(twists, self.loads))
        return {
            "spans": spans,
            "halves": self._tree[:p].copy(),
            "boxes": patches.copy(),
            "children": np.where(split[:, None], children, 0),
            "number": number,
            "twists": twists,
        } | ({"together": self._together[joined[rows]] / self._unit} if len(rows) else {})


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
