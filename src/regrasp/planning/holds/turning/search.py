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
from regrasp.planning.holds.turning.arcs import TOLERANCE, Arcs, Widest
from regrasp.planning.holds.turning.layers import SLOTS, Layer, Layers, row_of
from regrasp.planning.holds.turning.least_turning import Interval, Node, least_turning
from regrasp.planning.holds.turning.margins import Candidates, Pairs

_ALIKE = 1e-6  # margins nearer than this [rad] are one
_LESS = (2e-6, 1e-5, 1e-3)  # [rad]
_AT_ONCE = 512  # pairs whose margins are found together


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
        count = len(apart)
        self.allowed = np.ones((3, count), dtype=np.bool_) if allowed is None else allowed
        self.widest = np.where(apart, self.arcs.bounds(), -1.0)
        self.widest[self.widest < least] = -1.0
        self.known = self.widest < 0  # no bound any more
        self.angles = np.zeros(self.widest.shape)

    def sequences(
        self, start: Places, goal: Places, goal_angle: float, extra: int = 0, most: int | None = None
    ) -> list[TurningSequence]:
        """The best sequence, and those of up to ``extra`` more moves with wider margins; empty where none is.

        start, goal: places of three contacts. goal_angle: of the object in the end [rad]. most: finger moves.
        """
        found: list[TurningSequence] = []
        top, count = -1.0, len(set(goal) - set(start))
        limit: float = inf if most is None else most
        while count <= limit:
            best = self._best(start, goal, count)
            if best is not None and best.margin > top + (_ALIKE if found else 0.0):
                walked = self._walked(best, goal_angle)
                if walked is not None:
                    limit = min(limit, count + extra) if not found else limit
                    found.append(walked)
                    top = best.margin
            if count >= limit or self._exhausted(start, goal, count, top):
                break
            count += 1
        return found

    def _exhausted(self, start: Places, goal: Places, count: int, top: float) -> bool:
        """Whether more moves lead to no wider margin."""
        layers, first, last = self._layers(start, goal)
        reached, ways = first, 1
        while True:
            further = np.maximum(reached, layers.after(reached))
            if (further == reached).all():
                break
            reached, ways = further, ways + 1
        widest = float(np.minimum(reached, last).max())
        return widest < 0 or (count >= max(ways, 1) + 1 and widest <= top + _ALIKE)

    def _layers(self, start: Places, goal: Places) -> tuple[Layers, Layer, Layer]:
        layers = Layers(self.widest, self.allowed)
        return layers, layers.start(start), layers.goal(goal)

    def _best(self, start: Places, goal: Places, moves: int) -> "_Best | None":
        """The widest margin of rows of ``moves`` holds, or of one without a move, without any bound left."""
        count = max(moves, 1)
        while True:
            layers, first, last = self._layers(start, goal)
            ways = [first]
            for _ in range(count - 1):
                ways.append(layers.after(ways[-1]))
            total = np.minimum(ways[-1], last)
            margin = float(total.max())
            if margin < 0:
                return None
            slot, u, v = (int(k) for k in np.unravel_index(int(total.argmax()), total.shape))
            row = row_of(ways, slot, u, v)
            unknown = {_pair(hold) for hold in row if not self.known[hold[1:]]}
            if not unknown:
                return _Best(margin, moves, layers, ways, last)
            alike = np.argwhere((total >= margin) & ~self.known)[:_AT_ONCE].tolist()
            self._find({*unknown, *(_pair((s, a, b)) for s, a, b in alike)})

    def _find(self, pairs: set[tuple[int, int]]) -> None:
        first, second = np.array(sorted((min(p), max(p)) for p in pairs)).T
        found = self.arcs.widest((first, second), self.widest[first, second])
        margins = np.where(found.margins >= self.least, found.margins, -1.0)
        for a, b in ((first, second), (second, first)):
            self.widest[a, b], self.angles[a, b], self.known[a, b] = margins, found.angles, True

    def _walked(self, best: "_Best", goal_angle: float) -> TurningSequence | None:
        """The sequence of fewest steps, then least turning, of those as wide as the best.

        Holds at their widest may be half a turn apart, which is more than fingers turn between two: then of
        those a little less wide; None where these are as far apart.
        """
        way = self._way(best, goal_angle, best.margin * (1 - TOLERANCE))
        for less in _LESS:
            if way is None:
                way = self._way(best, goal_angle, max(best.margin - less, self.least))
        if way is None:
            return None
        holds = tuple((*_pair(node), k) for k, (node, _) in enumerate(way))
        angles = tuple(angle for _, angle in way)
        pairs: Pairs = (np.array([h[0] for h in holds]), np.array([h[1] for h in holds]))
        margin = float(self.arcs.candidates.margins(pairs, np.array(angles)).min())
        return TurningSequence(Sequence(holds, margin, best.moves), angles)

    def _way(self, best: "_Best", goal_angle: float, level: float) -> list[tuple[Node, float]] | None:
        """Holds of a margin of ``level`` or more with their angles [rad]."""
        layers = best.layers
        toward = [best.last]  # and backwards, so that no row leads astray
        for _ in range(len(best.ways) - 1):
            toward.append(layers.after(toward[-1]))
        toward.reverse()
        useful = [np.minimum(way, rest) >= level for way, rest in zip(best.ways, toward, strict=True)]
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
                arcs.update(zip(missing_now, self.arcs.at((first, second), level, widest), strict=True))
            return nodes

        def following(layer: int, node: Node) -> list[Node]:
            slot, u, v = node
            f, g = SLOTS[slot]
            (e,) = {0, 1, 2} - {f, g}
            nodes: list[Node] = []
            for finger, at, away in ((f, u, v), (g, v, u)):
                near = SLOTS.index((min(finger, e), max(finger, e)))
                line = useful[layer + 1][near, at] if finger < e else useful[layer + 1][near, :, at]
                for x in np.flatnonzero(line).tolist():
                    if x != away:
                        nodes.append((near, at, x) if finger < e else (near, x, at))
            return ready(nodes)

        begin = ready([(int(s), int(u), int(v)) for s, u, v in np.argwhere(useful[0])])
        return least_turning(
            begin, following, len(best.ways), lambda node: arcs[_pair(node)], goal_angle, self.max_turn
        )


@dataclass(frozen=True, eq=False)
class _Best:
    """The widest margin of rows of holds, and the layers that reach it."""

    margin: float
    moves: int
    layers: Layers
    ways: list[Layer]
    last: Layer


def _pair(node: Node) -> tuple[int, int]:
    """The contacts of a hold, the first below the second."""
    return min(node[1:]), max(node[1:])


def apart_from_each_other(points: Array, least: float) -> NDArray[np.bool_]:
    """(V, V) which points are at least so far apart, and no two that are one."""
    distance = np.hypot(*(points[:, None] - points).transpose(2, 0, 1))
    result: NDArray[np.bool_] = distance >= max(least, 1e-9 * float(abs(points).max()))
    return result
