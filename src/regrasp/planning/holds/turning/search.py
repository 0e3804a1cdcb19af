"""Sequences of holds over all orientations, in the order in which they are preferred.

Fewest finger moves, then the widest least margin, then fewest steps, then least turning. Margins come as
bounds in closed form first; only those of pairs on the best rows so far are found under the limits on forces,
until a best row has no bound left.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds.sequences import Sequence
from regrasp.planning.holds.stances import Places
from regrasp.planning.holds.turning.arcs import PEAKS, TOLERANCE, Arcs, Widest
from regrasp.planning.holds.turning.least_turning import Interval, Node, least_turning
from regrasp.planning.holds.turning.margins import Candidates, Pairs
from regrasp.planning.holds.turning.rows import Rows

_ALIKE = 1e-6  # margins nearer than this [rad] are one
_LESS = (2e-6, 1e-5, 1e-3)  # [rad]
_ASTRAY = 6  # numbers of moves one after the other of which no row is near enough from hold to hold
_MOST_AT_ONCE = 64  # holds whose following ones are looked at together
_AT_ONCE = 64  # holds whose margins or arcs are found together


@dataclass(frozen=True)
class TurningSequence:
    """A sequence of holds, the last entry of each the place of its angle among ``angles`` [rad]."""

    sequence: Sequence
    angles: tuple[float, ...]


class ExactSearch:
    """Sequences among contacts, of which two may hold at any orientation where ``apart`` (V, V) says so."""

    def __init__(
        self,
        candidates: Candidates,
        apart: NDArray[np.bool_],
        allowed: NDArray[np.bool_] | None,
        max_turn: float,
        least: float,
    ) -> None:
        self.arcs, self.max_turn, self.least = Arcs(candidates), max_turn, least
        self.allowed = allowed
        self.widest = np.where(apart, self.arcs.bounds(), -1.0)
        self.widest[self.widest < least] = -1.0
        self.known = self.widest < 0  # no bound any more
        self.angles = np.zeros(self.widest.shape)
        self.peaks: dict[tuple[int, int], Array] = {}
        self._rows: Rows | None = None

    def sequences(
        self, start: Places, goal: Places, goal_angle: float, extra: int = 0, most: int | None = None
    ) -> list[TurningSequence]:
        """The best sequence, and those of up to ``extra`` more moves with wider margins; empty where none is.

        start, goal: places of three contacts. goal_angle: of the object in the end [rad]. most: finger moves.
        """
        found: list[TurningSequence] = []
        top, count, astray = -1.0, len(set(goal) - set(start)), 0
        limit: float = inf if most is None else most
        self._rows = None
        while count <= limit:
            best = self._best(start, goal, count)
            if best is not None and best.margin > top + (_ALIKE if found else 0.0):
                walked = self._walked(best, goal_angle)
                astray = 0 if walked is not None else astray + 1
                if walked is not None:
                    limit = min(limit, count + extra) if not found else limit
                    found.append(walked)
                    top = best.margin
            floor = top + _ALIKE if found else top
            if count >= limit or astray == _ASTRAY or not self._rows_of(start, goal).leads(floor):
                break
            count += 1
        return found

    def _rows_of(self, start: Places, goal: Places) -> Rows:
        """By the margins known so far."""
        if self._rows is None:
            self._rows = Rows(self.widest, self.allowed, start, goal)
        return self._rows

    def _best(self, start: Places, goal: Places, moves: int) -> "_Best | None":
        """The widest margin of rows of ``moves`` holds, or of one without a move, without any bound left."""
        count = max(moves, 1)
        while True:
            rows = self._rows_of(start, goal)
            margin = rows.margin(count)
            if margin < 0:
                return None
            if all(self.known[node[1:]] for node in rows.row(count)):
                return _Best(margin, moves, count, rows)
            alike = [node for node in rows.passed(count, margin, _AT_ONCE) if not self.known[node[1:]]]
            self._find({_pair(node) for node in [*rows.row(count), *alike] if not self.known[node[1:]]})

    def _find(self, pairs: set[tuple[int, int]]) -> None:
        first, second = np.array(sorted((min(p), max(p)) for p in pairs)).T
        found = self.arcs.widest((first, second), self.widest[first, second])
        margins = np.where(found.margins >= self.least, found.margins, -1.0)
        for a, b in ((first, second), (second, first)):
            self.widest[a, b], self.angles[a, b], self.known[a, b] = margins, found.angles, True
        if found.peaks is not None:
            self.peaks.update(
                zip(zip(first.tolist(), second.tolist(), strict=True), found.peaks, strict=True)
            )
        self._rows = None

    def _walked(self, best: "_Best", goal_angle: float) -> TurningSequence | None:
        """The sequence of fewest steps, then least turning, of those as wide as the best.

        Holds at their widest may be half a turn apart, which is more than fingers turn between two: then of
        those a little less wide; None where these are as far apart.
        """
        levels = [best.margin * (1 - TOLERANCE), *(max(best.margin - less, self.least) for less in _LESS)]
        ways = (self._way(best, goal_angle, level) for level in dict.fromkeys(levels))
        way = next((way for way in ways if way is not None), None)
        if way is None:
            return None
        holds = tuple((*_pair(node), k) for k, (node, _) in enumerate(way))
        angles = tuple(angle for _, angle in way)
        pairs: Pairs = (np.array([h[0] for h in holds]), np.array([h[1] for h in holds]))
        margin = float(self.arcs.candidates.margins(pairs, np.array(angles)).min())
        return TurningSequence(Sequence(holds, margin, best.moves), angles)

    def _way(self, best: "_Best", goal_angle: float, level: float) -> list[tuple[Node, float]] | None:
        """Holds of a margin of ``level`` or more with their angles [rad]."""
        arcs: dict[tuple[int, int], list[Interval]] = {}

        def ready(nodes: list[Node]) -> list[Node]:
            missing = {_pair(node) for node in nodes} - arcs.keys()
            unknown = {pair for pair in missing if not self.known[pair]}
            if unknown:
                self._find(unknown)
            missing_now = [pair for pair in sorted(missing) if self.widest[pair] >= level]
            arcs.update((pair, []) for pair in missing)
            if missing_now:
                first, second = np.array(missing_now).T
                widest = Widest(self.widest[first, second], self.angles[first, second])
                if self.peaks:
                    none = np.full(PEAKS, np.nan)
                    peaks = np.array([self.peaks.get(pair, none) for pair in missing_now])
                    peaks = np.where(np.isnan(peaks), widest.angles[:, None], peaks)
                    widest = widest._replace(peaks=peaks)
                arcs.update(zip(missing_now, self.arcs.at((first, second), level, widest), strict=True))
            return nodes

        onward: dict[tuple[int, Node], list[Node]] = {}
        unlooked: list[dict[Node, None]] = [{} for _ in range(best.count + 1)]  # holds, by layers
        together = 1

        def after(layer: int, node: Node) -> list[Node]:
            if (layer, node) not in onward:
                onward[layer, node] = best.rows.onward(node, best.count - layer - 1, level)
            return onward[layer, node]

        def following(layer: int, node: Node) -> list[Node]:
            nonlocal together
            nodes = after(layer, node)
            unlooked[layer].pop(node, None)
            if any(_pair(each) not in arcs for each in nodes):
                # and those after other holds that will be asked for next, each time twice as many
                more = list(unlooked[layer])[:together]
                ready([*nodes, *(each for other in more for each in after(layer, other))])
                together = min(2 * together, _MOST_AT_ONCE)
                for other in more:
                    del unlooked[layer][other]
            unlooked[layer + 1].update(dict.fromkeys(n for n in nodes if arcs[_pair(n)]))
            return nodes

        ready(best.rows.passed(best.count, level, _AT_ONCE))
        first = ready(best.rows.first(best.count, level))
        unlooked[0] = dict.fromkeys(first)
        return least_turning(
            first,
            following,
            best.count,
            lambda node: arcs[_pair(node)],
            goal_angle,
            self.max_turn,
        )


@dataclass(frozen=True, eq=False)
class _Best:
    """The widest margin of rows of holds, how many these are, and the rows."""

    margin: float
    moves: int
    count: int
    rows: Rows


def _pair(node: Node) -> tuple[int, int]:
    """The contacts of a hold, the first below the second."""
    return min(node[1:]), max(node[1:])


def apart_from_each_other(points: Array, least: float) -> NDArray[np.bool_]:
    """(V, V) which points are at least so far apart, and no two that are one."""
    distance = np.hypot(*(points[:, None] - points).transpose(2, 0, 1))
    result: NDArray[np.bool_] = distance >= max(least, 1e-9 * float(abs(points).max()))
    return result
