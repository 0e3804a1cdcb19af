"""The sequence of holds of least cost, by moves from both ends.

A way costs ``move`` for each finger move, ``turning`` per radian of the object's turns, ``step`` for every
step, an exchange or a turn, and ``worth`` of each hold it passes. With F_i(h, o) the least cost of a way from
the start to a hold with at most i moves, and B_j(h, o) the same from the goal, the least cost of i + j + 1
moves is the least of F_i + move + B_j - worth over all holds and orientations. More moves are tried until
they cannot pay.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds.stances import Holds, Places, Stances

Node = tuple[int, int]
"""A hold by its number, and the place of an orientation."""


@dataclass(frozen=True, eq=False)
class Costs:
    """worth: (P, O) of each pair at each orientation, inf where it must not be used. step must be above 0."""

    worth: Array
    move: float
    turning: float
    step: float


class CheapEnd:
    """Least costs of ways from one end, move by move; ``tables[i]`` with at most i moves."""

    def __init__(self, fingers: Stances, costs: Costs, ways: list[Places], o: int, other: int) -> None:
        self.fingers, self.costs, self.ends = fingers, costs, [fingers.of(way) for way in ways]
        turns = costs.turning * fingers.apart + costs.step * np.where(
            fingers.further < inf, fingers.further, 0.0
        )
        self.turns = np.take_along_axis(turns, fingers.near, axis=1)
        self.rest = costs.turning * fingers.apart[other]  # the turn to the other end, at the least
        count = fingers.rows.size
        first = np.full((count, costs.worth.shape[1]), inf)
        for holds in self.ends:
            for h in holds:  # all fingers hold at the end, and turn with the object to any of its holds
                within = fingers.further[o] < inf
                first[h] = np.where(within, costs.worth[fingers.rows[h]] + turns[o], inf)
        self.first, reached = first, first.copy()
        for holds in self.ends:
            for h, row in zip(holds, self._inside(holds, first, 0.0), strict=True):
                reached[h] = np.minimum(reached[h], row)
        self.tables = [reached]
        self.fresh: NDArray[np.bool_] = np.any(reached < inf, axis=1)

    @property
    def last(self) -> Array:
        """(H, O) least costs with the most moves so far."""
        return self.tables[-1]

    def move(self, most: float) -> None:
        """One finger move further, for whole ways that cost at most ``most``."""
        fingers, costs = self.fingers, self.costs
        bound = np.asarray(most * (1 + 1e-12) - self.rest)
        frontier = np.flatnonzero(self.fresh)
        table, self.fresh = fingers.moves.cheapest(
            frontier, self.fresh, self.last, costs.move, costs.worth, fingers.rows, fingers.holds,
            fingers.count, fingers.near, self.turns, costs.step, bound,
        )  # fmt: skip
        self.tables.append(table)

    def way(self, node: Node, moves: int) -> list[Node]:
        """A least way with at most ``moves`` moves, from the end to ``node``."""
        others = self.fingers.moves.others
        (h, o), way = node, [node]
        while True:
            value = self.tables[moves][h, o]
            while moves > 0 and self.tables[moves - 1][h, o] <= value:
                moves -= 1
            known, move = (self.tables[moves - 1], self.costs.move) if moves else (self.first, 0.0)
            points = range(self.fingers.count)
            around = ((h, *others(self.fingers.holds, h, point)) for point in points)
            for holds in self.ends if moves == 0 else (t for t in around if min(t) >= 0):
                if h not in holds:
                    continue
                inside = self._inside(holds, known, move)
                if inside[holds.index(h), o] <= value * (1 + 1e-12):
                    break
            steps = self._back(holds, inside, known[list(holds)] + move, (holds.index(h), o))
            way += [(holds[q], o) for q, o in steps]
            h, o = way[-1]
            if moves == 0:
                return way[::-1]
            moves -= 1

    def _inside(self, holds: Holds, known: Array, move: float) -> Array:
        """(n, O) least costs within a stance."""
        from regrasp.closed_form.compiled.hold_paths import cheapen

        fingers, costs = self.fingers, self.costs
        result = np.empty((len(holds), known.shape[1]))
        free = np.full(known.shape[1], inf)
        cheapen(
            tuple(int(h) for h in holds), known, move, costs.worth, fingers.rows, fingers.near,
            self.turns, costs.step, free, result,
        )  # fmt: skip
        return result

    def _back(self, holds: Holds, inside: Array, entry: Array, at: Node) -> list[Node]:
        """Steps within a stance, backwards, from a node to where the way entered it."""
        steps: list[Node] = []
        while inside[at] < entry[at]:
            o = at[1]
            before = inside[:, self.fingers.near[o]] + self.turns[o]
            q, k = np.unravel_index(int(np.argmin(before)), before.shape)
            at = (int(q), int(self.fingers.near[o, k]))
            steps.append(at)
        return steps


@dataclass(frozen=True)
class Cheapest:
    """Holds by their numbers with their orientations, one after the other; finger moves; the whole cost."""

    way: tuple[Node, ...]
    moves: int
    cost: float


def cheapest(
    fingers: Stances,
    costs: Costs,
    start: Places,
    goal: Places,
    o: int,
    split: tuple[int, int] | None = None,
) -> Cheapest | None:
    """The way of least cost, or None. split: most moves from each end; without it as many as pay."""
    goals = fingers.ways(goal)
    start = fingers.start(start)
    ends = CheapEnd(fingers, costs, [start], 0, o), CheapEnd(fingers, costs, goals, o, 0)
    best: tuple[float, int, int, Node] | None = None
    for h in fingers.of(start) if start in goals else ():
        worth = costs.worth[fingers.rows[h]]
        whole = ends[0].last[h] + ends[1].first[h] - np.where(worth < inf, worth, 0.0)
        if whole.min() < (best[0] if best else inf):
            best = float(whole.min()), 0, -1, (h, int(whole.argmin()))
    while True:
        i, j = (len(end.tables) - 1 for end in ends)
        if split is None or (i, j) == split:
            total = ends[0].last + costs.move + ends[1].last
            total -= np.where(total < inf, costs.worth[fingers.rows], 0.0)
            at = np.unravel_index(int(np.argmin(total)), total.shape)
            if total[at] < (best[0] if best else inf):
                best = float(total[at]), i, j, (int(at[0]), int(at[1]))
        most = best[0] if best else inf
        if split is not None:
            if (i, j) == split:
                break
            ends[0 if i < split[0] else 1].move(most)
            continue
        least = costs.move * (i + j + 2) + costs.turning * float(fingers.apart[0, o])
        if least >= most or not (ends[0].fresh.any() and ends[1].fresh.any()):
            break
        min(ends, key=lambda end: int(end.fresh.sum())).move(most)
    if best is None:
        return None
    cost, i, j, node = best
    way = ends[0].way(node, i)
    if j >= 0:
        way += ends[1].way(node, j)[-2::-1]
    return Cheapest(tuple(way), moves_of(fingers, start, way, goal), cost)


def moves_of(fingers: Stances, start: Places, way: list[Node], goal: Places) -> int:
    """How often a finger goes to another point: how often the stance changes."""
    here, moves = frozenset(start), 0
    for (a, _), (b, _) in pairwise(way):
        points = frozenset((*fingers.points(a), *fingers.points(b)))
        if len(points) == len(start):
            moves += points != here
            here = points
    return moves + (here != frozenset(goal))
