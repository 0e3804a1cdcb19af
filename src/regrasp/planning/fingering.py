"""Where three fingers stand: every hold that two of them can make, numbered (docs/facts.md, 7).

The third finger is free. A triple of points has three holds; a finger move leads from a triple to another one
that shares a hold. Where all fingers may touch everywhere it does not matter which is which; otherwise a hold
is of two certain fingers.
"""

from copy import copy
from itertools import permutations
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds import HoldGraph

_FINGERS = ((0, 1), (0, 2), (1, 2))
"""The two fingers of a hold, by its slot."""

Places = tuple[int, ...]
"""Three contacts by their places in the graph; of fingers 1, 2, 3 where it matters which is which."""

Triple = tuple[int, int, int]
"""The numbers of three holds: of fingers 1 and 2, 1 and 3, 2 and 3."""


class Fingering:
    """The holds of three fingers on the contacts of a graph.

    max_turn: of the object at a time [rad]. least: margin [rad] below which a pair does not hold. allowed:
    (3, V) which finger may touch which contact; None where all may touch all.
    holds: numbers of holds by slot and points, and of each hold its slot, points and row of margins; as
    ``compiled_paths`` takes them. margins: (rows, O) [rad]; -1 where a pair does not hold.
    near: (O, k) from where the object may turn to an orientation in one step, the nearest first; turning:
    (O, k) these turns [rad]; apart: (O, O) angles between all orientations [rad].
    """

    def __init__(
        self, graph: HoldGraph, max_turn: float, least: float = 0.0, allowed: NDArray[np.bool_] | None = None
    ) -> None:
        self.allowed = allowed
        self.margins: NDArray[np.float32] = np.ascontiguousarray(graph.margins.T)
        if least > 0:
            self.margins[self.margins < least] = -1.0
        self.holds = _alike(graph) if allowed is None else _of_fingers(graph, allowed)
        angles = graph.angles
        self.apart: Array = abs((angles[:, None] - angles + pi) % (2 * pi) - pi)
        within = self.apart <= max_turn + 1e-9
        order = np.argsort(np.round(self.apart, 9), axis=1, kind="stable")[:, : within.sum(axis=1).max()]
        own = np.arange(len(order))[:, None]  # fills the row where fewer are near
        self.near = np.where(np.take_along_axis(within, order, axis=1), order, own).astype(np.int64)
        self.turning: Array = np.take_along_axis(self.apart, self.near, axis=1)

    def only(self, useful: NDArray[np.bool_]) -> "Fingering":
        """The same with useful holds numbered alone; the last number stands for all others: no holds."""
        few = copy(self)
        ids, slots, first, second, rows = self.holds
        kept = np.append(np.flatnonzero(useful), 0)
        numbers = np.where(useful, np.cumsum(useful) - 1, kept.size - 1)
        few.margins = self.margins[rows[kept]]
        few.margins[-1] = -1.0
        few.holds = (
            np.where(ids < 0, -1, numbers[ids]), slots[kept], first[kept], second[kept], np.arange(kept.size),
        )  # fmt: skip
        return few

    def of(self, contacts: Places) -> Triple:
        """The holds of fingers 1, 2, 3 on three contacts."""
        a, b, c = contacts
        ids = self.holds[0]
        return int(ids[0, a, b]), int(ids[1, a, c]), int(ids[2, b, c])

    def start(self, contacts: Places) -> Places:
        """The contacts in the order in which ``ways`` gives them."""
        return contacts if self.allowed is not None else tuple(sorted(contacts))

    def ways(self, contacts: Places) -> list[Places]:
        """How the fingers may take three contacts: one way where it does not matter which is which."""
        if self.allowed is None:
            return [tuple(sorted(contacts))]
        return [w for w in permutations(contacts) if all(self.allowed[f, v] for f, v in enumerate(w))]

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
