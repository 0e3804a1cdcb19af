"""The widest least margin that so many finger moves can keep.

With F_i(h, o) the widest least margin of a way from the start to hold h at orientation o with i moves, and
B_j(h, o) the same from the goal,

    F_i+1 = best over all triples T of the ways inside T that begin with F_i,
    widest margin with i + j + 1 moves = max over h, o of min(F_i(h, o), B_j(h, o)).

Both ends advance in turn, the smaller one first, so that few triples are looked at for the usual few moves.
The last move goes only to where the other end has been: what else it reaches waits until one more is made.
"""

from collections.abc import Iterator
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.planning.holds.stances import Places, Stances

ALIKE = 1e-6
"""Margins nearer than this [rad] are one: those of a graph are in single precision."""

_NONE = -0.5  # below every margin, above the mark of no hold


class Widest(NamedTuple):
    """The widest least margin with so many moves, and how many of them each end made.

    useful: (H,) holds that a way of that margin can pass.
    """

    moves: int
    margin: float
    forward: int
    backward: int
    useful: NDArray[np.bool_]


class WideEnd:
    """What is reached from one end, move by move.

    known: (H, O) widest margins [rad], -1 where nothing is reached; top: (H,) the widest of each hold. fresh:
    (H,) whether the last move widened it.
    """

    def __init__(self, fingers: Stances, ways: list[Places], o: int) -> None:
        from regrasp.closed_form.compiled.hold_paths import widen

        self.fingers, self.moves = fingers, 0
        margins, rows = fingers.margins, fingers.rows
        ends = [fingers.of(way) for way in ways]
        fingers.look_at(np.unique(ends))
        known = np.full((rows.size, margins.shape[1]), -1.0, dtype=np.float32)
        for holds in ends:
            for h in holds:  # all fingers hold at the end and turn with the object to any of its holds
                known[h] = np.where(fingers.further[o] < np.inf, margins[rows[h]], -1.0)
        result, inside = np.empty((fingers.fingers, margins.shape[1])), []
        for holds in ends:
            widen(holds, known, margins, rows, fingers.near, _NONE, result)
            inside.append(result.astype(np.float32))
        for holds, reached in zip(ends, inside, strict=True):
            for h, row in zip(holds, reached, strict=True):
                known[h] = np.maximum(known[h], row)
        self.known, self.top = known, known.max(axis=1)
        self.fresh = self.top >= 0

    def moved(self, floor: float, wanted: NDArray[np.bool_]) -> "WideEnd":
        """One finger move further, to stances of ``wanted`` (H,) holds, to margins above ``floor``."""
        fingers, after = self.fingers, copy(self)
        fresh = self.fresh & (self.top > floor)
        frontier = np.flatnonzero(fresh)
        fingers.look_around(frontier, wanted)
        after.known, after.top = self.known.copy(), self.top.copy()
        after.fresh = fingers.moves.widest(
            frontier, fresh, wanted, after.known, fingers.margins, fingers.rows, fingers.holds, fingers.count,
            fingers.near, floor,
        )  # fmt: skip
        after.top[after.fresh] = after.known[after.fresh].max(axis=1)
        after.moves += 1
        return after


def widest_by_moves(fingers: Stances, start: Places, goal: Places, o: int, extra: int) -> Iterator[Widest]:
    """The widest margin of the fewest moves, then that of more moves wherever it is wider.

    The start is held by all its fingers at the first orientation, the goal at that of place ``o``. At most
    ``extra`` moves more than the fewest.
    """
    goals = fingers.ways(goal)
    start = fingers.start(start)
    ends = [WideEnd(fingers, [start], 0), WideEnd(fingers, goals, o)]
    met, every = tuple(ends), np.ones(fingers.rows.size, dtype=np.bool_)
    floor, moves, fewest = _NONE, 0, None
    waiting: tuple[int, float] | None = None  # the end that moved to the other only, and its floor
    same = list(fingers.of(start)) if start in goals else []
    together = np.minimum(ends[0].known[same], ends[1].known[same])
    while True:
        margin = float(together.max(initial=-1.0))
        if margin > floor:
            fewest = moves if fewest is None else fewest
            useful = np.maximum(met[0].top, met[1].top) >= margin - ALIKE
            yield Widest(moves, margin, met[0].moves, met[1].moves, useful)
            floor = margin + ALIKE
        if fewest is not None and moves >= fewest + extra:
            return
        moves += 1
        if moves > 1:
            if waiting is not None:
                last, before = waiting
                ends[last] = ends[last].moved(before, every)
            if not (ends[0].fresh.any() and ends[1].fresh.any()):
                return  # one end has reached all it can
            last = int(ends[1].fresh.sum() < ends[0].fresh.sum())
            waiting, other = (last, floor), ends[1 - last]
            trial = ends[last].moved(floor, other.top > floor)
            met = (other, trial) if last else (trial, other)
        both = np.flatnonzero(np.minimum(met[0].top, met[1].top) > floor)
        together = np.minimum(met[0].known[both], met[1].known[both])
