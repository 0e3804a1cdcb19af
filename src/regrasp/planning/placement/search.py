"""Running the compiled branch and bound, and reading what it found."""

from collections.abc import Callable
from math import inf

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.reserve import RESERVE, kept_friction
from regrasp.planning.placement.laws import Law
from regrasp.planning.placement.proof import PlacementProof
from regrasp.planning.placement.sides import Sides

MOST_BOXES = 200_000
"""Boxes of a search unless told otherwise: about 500 bytes each for three fingers."""
_FIRST_BOXES = 2048
_AT_A_TIME = 256
_TRIED = 4096
_PRECISE = 1e-7
_SAFE = 1e-9  # of a bound, given up to rounding

Progress = Callable[[float, float], object]


class Search:
    """A search for the best places of fingers on sides: boxes, the placements tried, and how it ended."""

    def __init__(
        self, sides: Sides, fingers: int, friction: float, loads: Array, law: Law, apart: float
    ) -> None:
        self.sides, self.fingers, self.friction, self.law, self.apart = sides, fingers, friction, law, apart
        self.loads = loads
        wanted = -loads / [1, 1, sides.size]
        self.unit = float(np.abs(wanted).max()) or 1.0
        self._wanted = np.ascontiguousarray(wanted / self.unit)
        self._table = np.ascontiguousarray(sides.table())
        self._boxes = _memory(_FIRST_BOXES, fingers)
        arcs, ends = self._boxes[:2]
        arcs[0, :, 1] = len(self._table) - 1
        ends[0] = sides.ends[0, 0], sides.ends[-1, 1]
        self._heap = np.zeros(_FIRST_BOXES, np.int64)
        self._state = np.array([1, 1, 0])
        self._found = np.full(1 + 2 * fingers, inf)
        self._tried = np.zeros((_TRIED, 1 + 2 * fingers))
        self.interrupted = False

    def run(self, tolerance: float, most: int, progress: Progress | None) -> None:
        """Search until no placement can be better by the fraction ``tolerance``, or ``most`` boxes are used.

        An interrupt from the keyboard ends the search, too, and leaves what it has found.
        """
        from regrasp.closed_form.compiled.placement_search import CLOSED, FULL, search

        law = (self.friction, kept_friction(self.friction, 2 * RESERVE), *self.law.codes(), _PRECISE)
        try:
            while True:
                ended = search(
                    self._table, self._wanted, law, inf, tolerance, self.apart / self.sides.size,
                    self._boxes, self._heap, self._state, self._found, self._tried, _AT_A_TIME,
                )  # fmt: skip
                if progress is not None:
                    progress(self.bound, self.best)
                if ended == CLOSED:
                    return
                if ended == FULL and not self._grow(most):
                    return
        except KeyboardInterrupt:
            if self.best == inf:
                raise
            self.interrupted = True

    def _grow(self, most: int) -> bool:
        have = len(self._heap)
        room = min(2 * have, most)
        if room <= have:
            return False
        larger = _memory(room, self.fingers)
        for old, new in zip(self._boxes[:-1], larger[:-1], strict=True):
            new[:have] = old
        self._boxes = larger
        self._heap = np.concatenate([self._heap, np.zeros(room - have, np.int64)])
        return True

    @property
    def count(self) -> int:
        """Boxes made."""
        return int(self._state[0])

    @property
    def best(self) -> float:
        """The least norm found [N]; infinite before one is."""
        return float(self._found[0]) * self.unit

    @property
    def bound(self) -> float:
        """No placement has a smaller norm [N]."""
        bounds, kinds = self._boxes[2][: self.count], self._boxes[5][: self.count]
        open_ones = bounds[(kinds == 0) | (kinds == 1)]
        return float(open_ones.min(initial=inf)) * self.unit * (1 - _SAFE)

    @property
    def largest(self) -> float:
        """What a box proves that holds a load for no forces, at least [N]."""
        from regrasp.closed_form.compiled.wrench_gauge import FAR

        sizes = np.abs(self._wanted).sum(axis=1)
        return FAR * float(sizes[sizes > 0].min(initial=inf)) * self.unit * (1 - _SAFE)

    def placements(self) -> list[tuple[float, np.ndarray, Array]]:
        """Placements tried, the best first: their norm [N], the sides and the u of their fingers."""
        rows = self._tried[: min(int(self._state[2]), _TRIED)]
        rows = np.vstack([self._found, rows])
        rows = rows[np.isfinite(rows[:, 0])]
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        return [(row[0] * self.unit, row[1::2].astype(int), row[2::2]) for row in rows]

    def proof(self, bound: float, vertices: Array, centre: Array) -> PlacementProof:
        """That no norm is below ``bound`` [N]; polygon and centre of mass as they were given [m]."""
        n = self.count
        arcs, ends, _, twists, numbers, kinds, children, *_ = (values[:n] for values in self._boxes)
        sides = np.column_stack([self.sides.edges, self.sides.ends])
        number = np.where(kinds == 3, -1, numbers)
        split = kinds == 2
        given = {"sides": sides, "loads": self.loads, "arcs": arcs, "ends": ends}
        given["children"] = np.where(split[:, None], children, 0)
        given["number"] = np.where(split, 0, number)
        given["twists"] = np.where(split[:, None], 0.0, twists / [1, 1, self.sides.size])
        return PlacementProof(
            vertices, centre, fingers=self.fingers, friction=self.friction, size=self.law.size,
            norm=self.law.norm, min_distance=self.apart, bound=bound,
            **{name: _frozen(values) for name, values in given.items()},
        )  # fmt: skip


def _frozen(values: np.ndarray) -> np.ndarray:
    copy = values.copy()
    copy.setflags(write=False)
    return copy


def _memory(room: int, k: int) -> tuple[np.ndarray, ...]:
    """Arrays for so many boxes, as the compiled search takes them."""
    return (
        np.zeros((room, k, 2), np.int64), np.zeros((room, k, 2)), np.zeros(room), np.zeros((room, 3)),
        np.zeros(room, np.int64), np.zeros(room, np.int64), np.zeros((room, 2), np.int64),
        np.zeros((room, k, 8)), np.zeros((1, 3)),
    )  # fmt: skip
