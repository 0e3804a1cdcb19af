"""The widest least arc around the places of a grasp on straight sides, and the proof that none is wider.

A box of arcs that are all at least W long contains one whose arcs begin where its do and are W long, or end
at the place if that is farther; and what a box holds its parts hold. So starts of arcs are all that is
searched: boxes of starts, whose members all contain what is between the last of the starts and W after the
first. Where a corner of that fails, no member holds.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from heapq import heappop, heappush
from itertools import count, product

import numpy as np

from regrasp.mechanics.checks import Array, read_only
from regrasp.planning.placement.regions.cuts import Cuts
from regrasp.planning.placement.regions.growing import farthest
from regrasp.planning.placement.regions.widest_proof import WidestProof

TOLERANCE = 0.01
MOST = 300  # boxes of starts
_ROUNDING = 1e-9  # of the bound
_PARTS = (1 - 1e-5, 1 - 1e-3, 0.99, 0.95)  # of arcs, about the places: at their ends rounding decides
_HALVINGS, _TRIES = 20, 40


@dataclass(frozen=True, order=True)
class _Cell:
    negative: float
    number: int
    starts: Array


class LeastArc:
    """A search for the widest least arc; u (k,) are the places; holds: of boxes that are taken."""

    def __init__(self, cuts: Cuts, u: Array, holds: Callable[[Array], bool]) -> None:
        self.cuts, self.u, self.holds = cuts, u, holds
        edges = cuts.sides.edges[cuts.on]
        self.lengths: Array = cuts.sides.lengths[edges]
        self.edges = edges.astype(float)
        self._number = count()
        self.starts, self.width = u.copy(), 0.0
        self._held: list[Array] = []

    def run(self, starts: Array, tolerance: float = TOLERANCE, most: int = MOST) -> WidestProof:
        """From some starts search until none can be wider by a fraction, or so many boxes were looked at."""
        first = np.stack([self.edges, self.u], axis=1)
        cells = [_Cell(-self._most(first), next(self._number), first)]
        looked = 0
        for each in (starts, 0.5 * (self.edges + self.u)):
            self._slide(each)
        while looked < most and -cells[0].negative > self.width * (1 + tolerance):
            starts = heappop(cells).starts
            looked += 1
            below, bound = self._between(partial(self._inner, starts), starts[:, 0])
            if bound > self.width * (1 + tolerance) and not self._fails(self._inner(starts, below)):
                for each in (starts.mean(axis=1), starts[:, 1]):  # the latest may be the places themselves
                    self._slide(each)
                for half, most_of_it in self._halved(starts):
                    heappush(cells, _Cell(-min(bound, most_of_it), next(self._number), half))
            else:  # no wider, or by a new twist less wide
                heappush(cells, _Cell(-self._most(starts), next(self._number), starts))
        return self._proof([cell.starts for cell in cells], -cells[0].negative)

    def box(self, starts: Array, width: float) -> Array:
        """(k, 2) arcs of a width from some starts, or to the place where that is farther."""
        return np.stack([starts, np.maximum(self.u, starts + width / self.lengths)], axis=1)

    def _inner(self, starts: Array, width: float) -> Array:
        """What is in all boxes of a width that begin in ``starts`` (k, 2)."""
        ends = np.maximum(self.u, starts[:, 0] + width / self.lengths)
        return np.stack([starts[:, 1], ends], axis=1)

    def _room(self, starts: Array) -> float:
        """How wide arcs that begin there can be before the first side ends."""
        return float(((self.edges + 1.0 - starts) * self.lengths).min())

    def _most(self, starts: Array) -> float:
        """No box that begins in ``starts`` is wider, as far as the twists so far tell."""
        return self._between(partial(self._inner, starts), starts[:, 0])[1]

    def _between(self, box: Callable[[float], Array], starts: Array) -> tuple[float, float]:
        """A width whose box no twist so far excludes, and just above it one that is excluded, or no room."""
        room = self._room(starts)
        width = farthest(lambda width: self.cuts.known(box(width)) is None, room, _HALVINGS)
        excluded = min(width + 1.001 * room / 2**_HALVINGS, room)  # past the last halving, rounding too
        return width, width if width == room else excluded

    def _halved(self, starts: Array) -> list[tuple[Array, float]]:
        """Both halves of a box of starts, cut where that helps most, and what is no wider in each."""
        found, wide = [], (starts[:, 1] - starts[:, 0]) * self.lengths
        for i in np.flatnonzero(wide > 1e-3 * wide.max()):
            halves = [starts.copy(), starts.copy()]
            halves[0][i, 1] = halves[1][i, 0] = starts[i].mean()
            most = [self._most(half) for half in halves]
            found.append((max(most), sum(most), -float(wide[i]), list(zip(halves, most, strict=True))))
        return min(found, key=lambda one: one[:3])[3]

    def _fails(self, box: Array) -> bool:
        """Whether a box fails; those within one that was seen to hold do not."""
        if any((h[:, 0] <= box[:, 0]).all() and (h[:, 1] >= box[:, 1]).all() for h in self._held):
            return False
        if self.cuts.fails(box):
            return True
        self._held.append(box)
        return False

    def _try(self, starts: Array) -> bool:
        """Take the widest box from some starts, if it is wider than any so far."""
        for _ in range(_TRIES):
            width = self._between(partial(self.box, starts), starts)[0]
            if width <= self.width * (1 + 1e-4):
                return False
            if self._fails(self.box(starts, width)):
                continue
            for part in _PARTS:
                least, near = part * width, self.u + part * (starts - self.u)
                if least > self.width and self.holds(self.box(near, least)):
                    self.starts, self.width = near, least
                    return True
            return False
        return False

    def _slide(self, starts: Array) -> None:
        """Move starts to where arcs are wider, one after the other, while that helps."""
        if not self._try(starts):
            return
        step = 0.25
        while step > 1e-3:
            helped = False
            for i, way in product(range(len(starts)), (-step, step)):
                moved = self.starts.copy()
                moved[i] = np.clip(moved[i] + way, self.edges[i], self.u[i])
                helped = self._try(moved) or helped
            step *= 1.0 if helped else 0.5

    def _proof(self, leaves: list[Array], bound: float) -> WidestProof:
        cells, at = [], []
        loads, twists = np.zeros((0, 3)), np.zeros((0, 3))
        for starts in leaves:
            if self._room(starts[:, 0]) <= bound * (1 + _ROUNDING):
                continue
            found = self.cuts.known(self._inner(starts, bound))
            assert found is not None
            cells.append(starts)
            at.append(found[0])
            loads = np.vstack([loads, self.cuts.loads[self.cuts.numbers[found[1]]]])
            twists = np.vstack([twists, self.cuts.twists[found[1]]])
        k = len(self.u)
        rows = (np.array(cells).reshape(-1, k, 2), np.array(at).reshape(-1, k), loads, twists)
        return WidestProof(
            bound * (1 + _ROUNDING), read_only(self.u.copy()), *map(read_only, map(np.array, rows))
        )
