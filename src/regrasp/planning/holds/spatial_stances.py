"""Stances of four fingers in space: every hold is a triple of contacts (docs/facts.md, 7)."""

from itertools import combinations
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
    one step and ``reach`` within a stance. least: margin [rad] below which a triple does not hold.
    """

    fingers: ClassVar[int] = 4

    def __init__(
        self,
        graph: TripleGraph,
        directions: Array,
        max_turn: float,
        least: float = 0.0,
        reach: float = REACH,
    ) -> None:
        self.graph, self.count = graph, len(graph.contacts)
        self.margins = np.ascontiguousarray(graph.margins.T)
        self.margins[self.margins < max(least, 0.0)] = -1.0
        self.rows = np.arange(len(graph.triples))
        self.holds = np.append(self.rows, self.count), graph.triples.astype(np.int64)
        sines = np.linalg.norm(np.cross(directions[:, None], directions), axis=-1)
        self.apart = np.arctan2(sines, directions @ directions.T)
        self.turns(max_turn, reach)

    @property
    def moves(self) -> "Moves":
        """The compiled loops over stances."""
        from regrasp.closed_form.compiled.stances import TRIPLES

        return TRIPLES

    def of(self, contacts: Places) -> Holds:
        """The holds of four contacts."""
        numbers = self.holds[0]
        return tuple(int(numbers[self.graph.triple(*three)]) for three in combinations(sorted(contacts), 3))

    def points(self, hold: int) -> tuple[int, ...]:
        """The contacts of a hold, rising."""
        return tuple(self.holds[1][hold].tolist())

    def renumbered(self, numbers: NDArray[np.int64], kept: NDArray[np.int64]) -> tuple[Any, ...]:
        """``holds`` with other numbers, of the holds ``kept``."""
        known, corners = self.holds
        return np.append(numbers[known[:-1]], self.count), corners[kept]
