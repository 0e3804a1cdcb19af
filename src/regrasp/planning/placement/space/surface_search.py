"""Running the branch and bound over patches of a surface, and reading what it found."""

from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.proofs.box_rows import strongest
from regrasp.planning.placement.search import Progress
from regrasp.planning.placement.space.surface_boxes import (
    FIRST_BOXES,
    STRICT,
    TRIED,
    TRY_PRECISE,
    SurfaceBoxes,
)

MOST_BOXES = 200_000
"""Boxes of a search in space unless told otherwise: 500 bytes each for three fingers, with their proof."""
MOST_LOOKS = 1_500_000_000
"""Corners and groups of faces looked at, unless told how many boxes."""
_SAFE = 1e-9  # of a bound, given up to rounding
_NEVER_TOGETHER = 1 << 40
_STEP, _SHORTEST = 0.2, 1e-5  # of slides, of the size
_GAINED = 0.01  # a placement better by so much is worth a slide


class SurfaceSearch(SurfaceBoxes):
    """A search for the best places of fingers on patches."""

    def run(
        self, tolerance: float, most: int, narrow: float, progress: Progress | None, looks: float = inf
    ) -> None:
        """Search until no placement can be better by the fraction ``tolerance``, or ``most`` boxes are used.

        looks: corners and groups of faces looked at, after which it ends, too.

        An interrupt from the keyboard ends the search, too, and leaves what it has found.
        """
        from regrasp.closed_form.compiled.places.placement_search import CLOSED, FULL

        slid, due = inf, FIRST_BOXES
        try:
            while True:
                ended = self.some(tolerance, narrow)
                if self._found[0] < slid * (1 - _GAINED) or self.count >= due:
                    fine = ended == CLOSED or self.count >= due
                    self._slide(_STEP, _SHORTEST if fine else 0.1 * _STEP)
                    slid, due = self._found[0], max(due, 2 * self.count if fine else due)
                if progress is not None:
                    progress(self.bound, self.best)
                self.closed = ended == CLOSED
                if self.closed or self._state[4] > looks or (ended == FULL and not self._grow(most)):
                    break
            self._slide(0.1 * _STEP, _SHORTEST)
        except KeyboardInterrupt:
            self.interrupted = True

    def begin_level(self, *, together: bool) -> None:
        """Look for a placement with forces up to the limit; whether loads may be taken together."""
        self._found[0] = 1.0
        self._state[6] = 0 if together else _NEVER_TOGETHER

    def goes_on(self, narrow: float, most: int, looks: float) -> bool:
        """Some more boxes at a level. False where none is left, or no room for more of them."""
        from regrasp.closed_form.compiled.places.placement_search import CLOSED, FULL

        ended = self.some(-STRICT, narrow)
        self.closed = ended == CLOSED
        return not self.closed and self._state[4] <= looks and (ended != FULL or self._grow(most))

    @property
    def found(self) -> Array | None:
        """The spots (k, 6) [m] of a placement with forces up to the limit; None before there is one."""
        scale = [self.size, self.size, self.size, 1, 1, 1]
        return self._found[1:].reshape(-1, 6) * scale if self._found[0] < 1.0 else None

    def pass_over(self) -> None:
        """Try the placement found no more: with all fingers in one place it is none."""
        self._boxes[6][self._at] = self._boxes[6][self._at, :1]

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
            row = self._state[1] % TRIED
            self._state[1] += 1
            self._tried[row] = self._found

    def _value(self, scaled: Array) -> float:
        from regrasp.closed_form.compiled.patches.patch_search import spare
        from regrasp.closed_form.compiled.patches.patch_slide import slide

        law = (self._usable, *self._law[1:3], TRY_PRECISE)
        return float(
            slide(
                self._rows, 0, self._trials, law, self.apart / self.size, 0.0, 1.0, scaled, inf,
                scaled.copy(), np.zeros((2, 3)), np.zeros_like(self._trials), spare(self.fingers),
            )
        )  # fmt: skip

    def _slide(self, step: float, shortest: float) -> None:
        from regrasp.closed_form.compiled.patches.patch_search import spare
        from regrasp.closed_form.compiled.patches.patch_slide import slide

        if self.best == inf or not self._radius[: len(self.patches.order)].any():
            return
        spots = self._found[1:].reshape(-1, 6).copy()
        law = (self._usable, *self._law[1:3], TRY_PRECISE)
        value = slide(
            self._rows, len(self.patches.order), self._trials, law, self.apart / self.size, step, shortest,
            spots, self._found[0], spots.copy(), np.zeros((2, 3)), np.zeros_like(self._trials),
            spare(self.fingers),
        )  # fmt: skip
        self._take(spots, value)

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
        rows = np.vstack([self._found, self._tried[: min(int(self._state[1]), TRIED)]])
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        scale = [self.size, self.size, self.size, 1, 1, 1]
        found = ((self._held(row[0]), row[1:].reshape(-1, 6) * scale) for row in rows)
        return [(norm, spots) for norm, spots in found if norm < inf]

    def arrays(self) -> dict[str, Array]:
        """What a proof is made of, arrays of their own: patches, boxes, and what bounds them."""
        n, p = self.count, int(self._state[2])
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
