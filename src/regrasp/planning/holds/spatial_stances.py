"""Stances of four fingers in space: every hold is a triple of contacts (docs/facts.md, 7)."""

from copy import copy
from itertools import combinations
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds.stances import REACH, Holds, Places, Stances
from regrasp.planning.holds.triples import TripleGraph

if TYPE_CHECKING:
    from regrasp.closed_form.compiled.hold_paths import Moves


_CHUNK = 2**16  # stances looked at together
_THREES = tuple((slice(None), list(three)) for three in combinations(range(4), 3))


class Quads(Stances):
    """Four fingers on the contacts of a graph, three of which hold.

    directions: (O, 3) unit directions of the load, seen from the object, of the graph's loads. While the
    object turns the load goes along the great circle from one to the other, by at most ``max_turn`` [rad] in
    one step and ``reach`` within a stance. least: margin [rad] below which a triple does not hold. allowed:
    (4, V) which finger may touch which contact; None where all may touch all. Then a *spot* is a contact with
    a finger on it, in the place of a contact.
    """

    fingers: ClassVar[int] = 4

    def __init__(
        self,
        graph: TripleGraph,
        directions: Array,
        max_turn: float,
        least: float = 0.0,
        reach: float = REACH,
        allowed: NDArray[np.bool_] | None = None,
    ) -> None:
        self.graph, self.allowed = graph, allowed
        self.least = max(least, 0.0)
        self._forget()
        if allowed is None:
            self.count = len(graph.contacts)
            self.rows = np.arange(len(graph.triples))
            self.holds = np.append(self.rows, self.count), graph.triples.astype(np.int64)
        else:
            self._finger, self._contact = (places.astype(np.int64) for places in np.nonzero(allowed))
            self.count = self._finger.size
            self._spots = {
                (f, v): n
                for n, (f, v) in enumerate(zip(self._finger.tolist(), self._contact.tolist(), strict=True))
            }
            *holds, self.rows = _of_fingers(graph, self._finger, self._contact)
            self.holds = tuple(holds)
        sines = np.linalg.norm(np.cross(directions[:, None], directions), axis=-1)
        self.apart = np.arctan2(sines, directions @ directions.T)
        self.turns(max_turn, reach)

    def among(self, few: NDArray[np.int64], least: float) -> "Quads":
        """The same in some directions, by their places, and with another least margin [rad]."""
        some = copy(self)
        some.graph = self.graph if few.size == len(self.apart) else self.graph.under(few)
        some.least, some.apart = max(least, self.least), self.apart[np.ix_(few, few)]
        some._forget()
        some.turns(*self.largest)
        return some

    def bounded(self) -> "Quads":
        """The same with bounds in the place of margins: 0 [rad] wherever these may not be below the least."""
        bounds = copy(self)
        bounds._forget()
        bounds._bounds = True
        return bounds

    def _forget(self) -> None:
        self._bounds = False
        self.margins = np.full((len(self.graph.triples), len(self.graph.loads)), -1.0, dtype=np.float32)
        self._seen = np.zeros(len(self.graph.triples), dtype=np.bool_)

    @property
    def moves(self) -> "Moves":
        """The compiled loops over stances."""
        from regrasp.closed_form.compiled.stances import TRIPLES

        return TRIPLES

    def look_at(self, holds: Any) -> None:
        """Finds the margins of their triples, of those that were not looked at before."""
        self._look_at_rows(self.rows[holds])

    def lower(self, row: int, o: int, margin: float) -> None:
        """Of a hold no more than a margin [rad] counts."""
        self._look_at_rows(np.array([row]))
        super().lower(row, o, margin)

    def _look_at_rows(self, rows: NDArray[np.int64]) -> None:
        seen = self._seen.copy()
        seen[rows] = True
        new = np.flatnonzero(seen & ~self._seen)
        if self._bounds:
            self.margins[new] = self.graph.bounds_of(new, self.least)
        else:
            margins = self.graph.margins_of(new, self.least)
            self.margins[new] = np.where(margins < self.least, np.float32(-1.0), margins)
        self._seen = seen

    def look_around(self, frontier: NDArray[np.int64], wanted: NDArray[np.bool_]) -> None:
        """The same for the holds of stances of a frontier (n,) that have a ``wanted`` hold."""
        numbers, corners = self.holds
        few = max(1, _CHUNK // self.count)
        for k in range(0, frontier.size, few):
            three = corners[frontier[k : k + few]]
            shape = (len(three), self.count, 1)
            fourth = np.broadcast_to(np.arange(self.count)[:, None], shape)
            four = np.sort(np.concatenate([np.broadcast_to(three[:, None], (*shape[:2], 3)), fourth], 2))
            four = four[(np.diff(four) > 0).all(axis=2)]
            stances = np.stack(
                [numbers[place_among(self.count, *three.T)] for three in map(four.__getitem__, _THREES)], 1
            )
            stances = stances[(stances >= 0).all(axis=1)]
            self.look_at(stances[wanted[stances].any(axis=1)].ravel())

    def look_at_all(self) -> None:
        """The same for all."""
        self.look_at(slice(None))

    def of(self, contacts: Places) -> Holds:
        """The holds of four contacts, of fingers 1 to 4 where it matters."""
        numbers = self.holds[0]
        if self.allowed is None:
            places = [self.graph.triple(*three) for three in combinations(sorted(contacts), 3)]
        else:
            spots = sorted(self._spots[f, v] for f, v in enumerate(contacts))
            places = [place_among(self.count, *three) for three in combinations(spots, 3)]
        return tuple(int(numbers[place]) for place in places)

    def points(self, hold: int) -> tuple[int, ...]:
        """The contacts of a hold, rising."""
        corners = self.holds[1][hold]
        return tuple(sorted((corners if self.allowed is None else self._contact[corners]).tolist()))

    def renumbered(self, numbers: NDArray[np.int64], kept: NDArray[np.int64]) -> tuple[Any, ...]:
        """``holds`` with other numbers, of the holds ``kept``."""
        known, corners = self.holds
        new = np.where(known[:-1] < 0, -1, numbers[known[:-1]])
        return np.append(new, self.count), corners[kept]


def _of_fingers(graph: TripleGraph, finger: NDArray[np.int64], contact: NDArray[np.int64]) -> tuple[Any, ...]:
    """Triples of spots, of different fingers on different contacts: numbers, spots and rows of margins."""
    from regrasp.closed_form.compiled.triples import triples_of

    spots = triples_of(finger.size).astype(np.int64)
    able = np.ones(len(spots), dtype=np.bool_)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        one, two = spots[:, a], spots[:, b]
        able &= (finger[one] != finger[two]) & (contact[one] != contact[two])
    numbers = np.full(len(spots) + 1, -1, dtype=np.int64)
    numbers[:-1][able] = np.arange(int(able.sum()))
    numbers[-1] = finger.size
    corners = spots[able]
    i, j, k = np.sort(contact[corners], axis=1).T
    return numbers, corners, place_among(len(graph.contacts), i, j, k)


def place_among(count: int, i: Any, j: Any, k: Any) -> Any:
    """The place of i < j < k, numbers or arrays, among all triples of ``count``."""
    m, rest = count - i, count - j
    before = (count * (count - 1) * (count - 2) - m * (m - 1) * (m - 2)) // 6
    return before + ((m - 1) * (m - 2) - rest * (rest - 1)) // 2 + k - j - 1
