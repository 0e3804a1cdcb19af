"""Stances of four fingers in space: every hold is a triple of contacts (docs/facts.md, 7)."""

from itertools import combinations, permutations
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds.stances import REACH, Holds, Places, Stances
from regrasp.planning.holds.triples import TripleGraph

if TYPE_CHECKING:
    from regrasp.closed_form.compiled.hold_paths import Moves


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
        self.margins = graph.margins.T.copy(order="C")
        self.margins[self.margins < max(least, 0.0)] = -1.0
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

    @property
    def moves(self) -> "Moves":
        """The compiled loops over stances."""
        from regrasp.closed_form.compiled.stances import TRIPLES

        return TRIPLES

    def of(self, contacts: Places) -> Holds:
        """The holds of four contacts, of fingers 1 to 4 where it matters."""
        numbers = self.holds[0]
        if self.allowed is None:
            places = [self.graph.triple(*three) for three in combinations(sorted(contacts), 3)]
        else:
            spots = sorted(self._spots[f, v] for f, v in enumerate(contacts))
            places = [place_among(self.count, *three) for three in combinations(spots, 3)]
        return tuple(int(numbers[place]) for place in places)

    def start(self, contacts: Places) -> Places:
        """The contacts in the order in which ``ways`` gives them."""
        return contacts if self.allowed is not None else tuple(sorted(contacts))

    def ways(self, contacts: Places) -> list[Places]:
        """How the fingers may take four contacts: one way where it does not matter which is which."""
        if self.allowed is None:
            return [tuple(sorted(contacts))]
        return [w for w in permutations(contacts) if all(self.allowed[f, v] for f, v in enumerate(w))]

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
