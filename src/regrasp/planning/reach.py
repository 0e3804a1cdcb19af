"""Which holds can be reached in how many exchanges, and with which least margin on the way.

A path in the hold graph goes from hold to hold over a shared point. While a finger is exchanged the object
may turn, by less than pi, for two holds under loads that far apart hold everything between them
(docs/facts.md, 6). So with P_k(o, v) the widest least margin of a path of k steps to a hold with point v at
orientation o,

    Q_k(o, v)     = max of P_k(o', v) over |o' - o| <= the largest turn
    P_k+1(o, v)   = max over holds (v, w) of min( max(Q_k(o, v), Q_k(o, w)), margin(v, w, o) ):

levels of a breadth-first search that carry the bottleneck along. A turn in one hold is a step, too. The first
level to reach the goal has the fewest steps, and its value is the widest margin of all such sequences.
"""

from dataclasses import dataclass
from itertools import combinations, pairwise
from math import pi

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds import HoldGraph

# Margins of a graph are in single precision.
_ALIKE = 1e-6

Hold = tuple[int, int, int]
"""Two contacts and an orientation, by their places in the graph."""

MAX_TURN = 2 * pi / 3
"""Default largest turn during one exchange [rad]: forces grow by 1 / cos(turn / 2) = 2 at most on the way."""


MOST_STEPS = 12
"""Most steps between two holds that are searched."""


@dataclass(frozen=True)
class Sequence:
    """Holds one after the other, and the least of their margins [rad]."""

    holds: tuple[Hold, ...]
    margin: float

    @property
    def exchanges(self) -> int:
        """How often a finger is exchanged; a turn in one hold is none."""
        return sum(a[:2] != b[:2] for a, b in pairwise(self.holds))


class Search:
    """Levels of the search from the holds within ``start`` at orientation 0."""

    def __init__(self, graph: HoldGraph, start: tuple[int, ...], max_turn: float) -> None:
        self.graph = graph
        self.start = [(i, j, 0) for i, j in combinations(sorted(start), 2) if graph.margin(i, j, 0) >= 0]
        angles = graph.angles
        apart = abs((angles[:, None] - angles + pi) % (2 * pi) - pi)
        self.near = apart <= max_turn + 1e-9
        self.apart = apart
        first = np.full((len(angles), len(graph.contacts)), -1.0)
        for i, j, _ in self.start:
            for v in (i, j):
                first[0, v] = max(first[0, v], graph.margin(i, j, 0))
        self.levels: list[Array] = [first]
        self.reaches: list[Array] = []

    def extend(self) -> bool:
        """One exchange further; whether anything new or wider was reached."""
        from regrasp.closed_form.compiled_holds import relaxed

        last = self.levels[-1]
        reach = np.stack([last[near].max(axis=0) for near in self.near])
        following = np.full_like(last, -1.0)
        relaxed(*self.graph.pairs, self.graph.margins, reach, following)
        self.reaches.append(reach)
        self.levels.append(following)
        return bool((following > last + 1e-12).any())

    def best(self, goal: tuple[int, ...], o: int) -> Sequence | None:
        """The sequence of one step a level to a hold within ``goal`` at orientation ``o``, or None."""
        k = len(self.levels) - 1
        ends = [(self._value(k, (i, j, o)), (i, j, o)) for i, j in combinations(sorted(goal), 2)]
        value = max(reached for reached, _ in ends)
        if value < 0:
            return None
        # Of holds that are as good but for rounding, the widest; of these the first.
        good = [hold for reached, hold in ends if reached >= value - _ALIKE]
        widest = max(self.graph.margin(*hold) for hold in good)
        hold = next(hold for hold in good if self.graph.margin(*hold) >= widest - _ALIKE)
        value = self._value(k, hold)
        holds = [hold]
        while k > 0:
            hold = self._before(k, hold, value)
            holds.append(hold)
            k -= 1
        return Sequence(tuple(reversed(holds)), value)

    def _value(self, k: int, hold: Hold) -> float:
        """The widest least margin of a path of k exchanges to a hold; negative for none."""
        i, j, o = hold
        margin = self.graph.margin(i, j, o)
        if k == 0:
            return margin if hold in self.start else -1.0
        if margin < 0:
            return -1.0
        reach = self.reaches[k - 1]
        return float(min(max(reach[o, i], reach[o, j]), margin))

    def _before(self, k: int, hold: Hold, value: float) -> Hold:
        """A hold one exchange before ``hold`` with no less than ``value``; the least turn first."""
        i, j, o = hold
        level, found = self.levels[k - 1], []
        enough = value - 1e-9
        for v in (i, j):
            there = np.flatnonzero(self.near[o] & (level[:, v] >= enough))
            found += [(round(self.apart[o, at], 9), v, int(at)) for at in there]
        for _, v, at in sorted(found):
            if k == 1:
                others = [a + b - v for a, b, _ in self.start if v in (a, b) and at == 0]
            else:
                others = np.argsort(-self.graph.row(v, at)).tolist()
            for w in others:
                before = (min(v, w), max(v, w), at)
                if w != v and self._value(k - 1, before) >= enough:
                    return before
        raise AssertionError("a level is reached from the one before it")


def sequences(
    graph: HoldGraph,
    start: tuple[int, ...],
    goal: tuple[int, ...],
    goal_orientation: int = 0,
    *,
    max_turn: float = MAX_TURN,
    most_steps: int = MOST_STEPS,
    extra: int = 0,
) -> list[Sequence]:
    """The sequence of fewest steps from a hold within ``start`` to one within ``goal``, of widest margin.

    With ``extra`` steps allowed, also each longer one with a wider margin. Empty where none is.
    """
    search = Search(graph, start, max_turn)
    found: list[Sequence] = []
    more = bool(search.start)
    for _ in range(most_steps + 1):
        sequence = search.best(goal, goal_orientation)
        if sequence is not None and (not found or sequence.margin > found[-1].margin + 1e-9):
            found.append(sequence)
        if not more or (found and len(search.levels) - 1 >= len(found[0].holds) - 1 + extra):
            break
        more = search.extend()
    return found


def reachable(graph: HoldGraph, start: tuple[int, ...]) -> NDArray[np.bool_]:
    """(V,) the contacts in some hold that can be reached from ``start`` with turns of any size below pi."""
    search = Search(graph, start, pi - 1e-6)
    while search.extend():
        pass
    return np.asarray((np.stack(search.levels) >= 0).any(axis=(0, 1)))
