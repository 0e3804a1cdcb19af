"""Where three fingers stand: every hold that two of them can make, numbered (docs/facts.md, 7).

The third finger is free. A triple of points has three holds; a finger move leads from a triple to another one
that shares a hold. Where all fingers may touch everywhere it does not matter which is which; otherwise a hold
is of two certain fingers.
"""

from math import pi
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.stances import Holds, Places, Stances

if TYPE_CHECKING:
    from regrasp.closed_form.compiled.hold_paths import Moves

HALF_TURN = pi
"""Between two holds of one stance, sampled [rad].

Each holds all loads about its own where it has a margin, and loads about f and about -f add up to all loads:
the three fingers hold every one. Without a margin, or within limits on forces, they may not, and a plan that
meets such a load keeps to ``REACH``.
"""

_FINGERS = ((0, 1), (0, 2), (1, 2))
"""The two fingers of a hold, by its slot."""


class Fingering(Stances):
    """The holds of three fingers on the contacts of a graph.

    max_turn: of the object in one step [rad]; reach: within a stance [rad]. least: margin [rad] below which a
    pair does not hold. allowed: (3, V) which finger may touch which contact; None where all may touch all.
    Holds are numbered by slot and points, ``holds`` has of each its slot and points.
    """

    fingers: ClassVar[int] = 3

    def __init__(
        self,
        graph: HoldGraph,
        max_turn: float,
        least: float = 0.0,
        allowed: NDArray[np.bool_] | None = None,
        reach: float = HALF_TURN,
    ) -> None:
        self.allowed, self.least = allowed, max(least, 0.0)
        self.margins = graph.margins.T.copy(order="C")
        if least > 0:
            self.margins[self.margins < least] = -1.0
        self.count = len(graph.contacts)
        *holds, self.rows = _alike(graph) if allowed is None else _of_fingers(graph, allowed)
        self.holds = tuple(holds)
        angles = graph.angles
        self.apart = abs((angles[:, None] - angles + pi) % (2 * pi) - pi)
        self.turns(max_turn, reach)

    @property
    def moves(self) -> "Moves":
        """The compiled loops over stances."""
        from regrasp.closed_form.compiled.stances import PAIRS

        return PAIRS

    def renumbered(self, numbers: NDArray[np.int64], kept: NDArray[np.int64]) -> tuple[Any, ...]:
        """``holds`` with other numbers, of the holds ``kept``."""
        ids, slots, first, second = self.holds
        return np.where(ids < 0, -1, numbers[ids]), slots[kept], first[kept], second[kept]

    def of(self, contacts: Places) -> Holds:
        """The holds of fingers 1, 2, 3 on three contacts."""
        a, b, c = contacts
        ids = self.holds[0]
        return int(ids[0, a, b]), int(ids[1, a, c]), int(ids[2, b, c])

    def points(self, hold: int) -> tuple[int, int]:
        """The contacts of a hold, the first below the second."""
        a, b = int(self.holds[2][hold]), int(self.holds[3][hold])
        return min(a, b), max(a, b)


def _alike(graph: HoldGraph) -> tuple[Any, ...]:
    count = len(graph.contacts)
    first, second = (ends.astype(np.int64) for ends in graph.pairs)
    numbers, rows = np.full((count, count), -1, dtype=np.int64), np.arange(first.size)
    numbers[first, second] = numbers[second, first] = rows
    return np.stack([numbers] * 3), np.zeros_like(rows), first, second, rows


def _of_fingers(graph: HoldGraph, allowed: NDArray[np.bool_]) -> tuple[Any, ...]:
    pair = _alike(graph)[0][0]
    may = np.stack([np.outer(allowed[f], allowed[g]) & (pair >= 0) for f, g in _FINGERS])
    slots, first, second = np.nonzero(may)
    ids = np.full(may.shape, -1, dtype=np.int64)
    ids[slots, first, second] = np.arange(first.size)
    return ids, slots, first, second, pair[first, second]
