"""What limits the way between two grasps in the hold graph, however many finger moves it takes.

Points and orientations are nodes, one for each contact that has a hold there. A hold joins its two points
with its margin; a turn joins two orientations of a point, less than pi apart, with the smaller of the widest
margins that the point has at both: three fingers hold everything between. The widest way is then the one in a
maximum spanning tree.
"""

from dataclasses import dataclass, field
from math import degrees, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, instance, number, whole
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.sequences import Hold
from regrasp.planning.holds.stances import REACH

# Above every margin: the tree of least weights wants them positive.
_ABOVE = 4.0


@dataclass(frozen=True)
class Bottleneck:
    """The hold that limits every way from a start to a goal, and what all ways have in common.

    Args:
        margin: the widest least margin of any way [rad].
        hold: two contacts and an orientation, by their places in the graph, where the widest way found is
            that narrow; no way does without a hold as narrow.
        points: contacts, by their places in the graph, without which no way is left, at whatever orientation.
        pairs: pairs of contacts, at whatever orientation, without which no way is left.
        graph: the holds among which was looked.
    """

    margin: float
    hold: Hold
    points: tuple[int, ...]
    pairs: tuple[tuple[int, int], ...]
    graph: HoldGraph = field(repr=False, compare=False)

    def __str__(self) -> str:
        def name(i: int) -> str:
            return str(self.graph.contacts[i].name)

        i, j, o = self.hold
        pairs = ", ".join(f"{name(a)} with {name(b)}" for a, b in self.pairs)
        return (
            f"the widest way keeps {degrees(self.margin):.2f} deg, limited by the hold of {name(i)} and "
            f"{name(j)} at {degrees(self.graph.angles[o]):.4g} deg\n"
            f"points that every way needs: {', '.join(map(name, self.points)) or 'none'}\n"
            f"pairs that every way needs: {pairs or 'none'}"
        )


def bottleneck(
    graph: HoldGraph,
    start: tuple[int, ...],
    goal: tuple[int, ...],
    goal_orientation: int = 0,
    *,
    max_turn: float = REACH,
) -> Bottleneck | None:
    """What limits the way from a hold of three contacts to a hold of three; None where there is no way.

    Every finger may touch everywhere. Where the object turns by more than one step may, three fingers hold it
    in between.

    Args:
        graph: of planar contacts.
        start: three contacts by their places in the graph, held at its first angle.
        goal: three contacts by their places in the graph, held at the angle of place ``goal_orientation``.
        goal_orientation: the place of the last angle in the graph's angles.
        max_turn: largest turn of the object from one hold to the next, in however many steps, below pi [rad].

    Raises:
        InvalidInput: For what are no places.
    """
    instance(graph, "graph", HoldGraph)
    whole(goal_orientation, "goal_orientation", least=0, most=len(graph.angles) - 1)
    if not 0 < number(max_turn, "max_turn") < pi:
        raise InvalidInput(f"max_turn must be above 0 and below pi, got {shown(max_turn)}")
    for what, places in (("start", start), ("goal", goal)):
        try:
            given = [whole(place, what, least=0) for place in places]
            valid = len(set(given)) == 3 and max(given) < len(graph.contacts)
        except TypeError:
            valid = False
        if not valid:
            raise InvalidInput(
                f"{what} must be three contacts by their places in the graph, 0 to "
                f"{len(graph.contacts) - 1}, got {shown(places)}"
            )
    ends = _Ends(graph, start, goal, goal_orientation, max_turn)
    way = ends.widest(graph.margins)
    if way is None:
        return None
    points = sorted({v for hold in way for v in hold[:2]})
    pairs = sorted({(hold[0], hold[1]) for hold in way})
    narrow = min(way, key=lambda hold: graph.margin(*hold))

    def needed(without: NDArray[np.bool_]) -> bool:
        return not ends.connected(np.where(without, np.float32(-1.0), graph.margins))

    first, second = graph.pairs
    return Bottleneck(
        graph.margin(*narrow),
        narrow,
        tuple(v for v in points if needed((first == v) | (second == v))),
        tuple(pair for pair in pairs if needed((first == pair[0]) & (second == pair[1]))),
        graph,
    )


def connected(graph: HoldGraph, start: tuple[int, ...], goal: tuple[int, ...], goal_orientation: int) -> bool:
    """Whether any sequence of holds leads from the start to the goal."""
    return _Ends(graph, start, goal, goal_orientation).connected(graph.margins)


class _Links(NamedTuple):
    """Links between nodes: (E,) ends and margins. best: (V, O) the other point of each node's widest hold."""

    a: NDArray[np.int64]
    b: NDArray[np.int64]
    margin: Array
    best: NDArray[np.int64]


class _Ends:
    """Node v * O + o is contact v at orientation o; the last two nodes are the start and the goal."""

    def __init__(
        self, graph: HoldGraph, start: tuple[int, ...], goal: tuple[int, ...], o: int, reach: float = REACH
    ) -> None:
        self.points, self.turns = len(graph.contacts), len(graph.angles)
        apart = abs((graph.angles[:, None] - graph.angles + pi) % (2 * pi) - pi)
        self.near = np.nonzero(np.triu(apart <= reach + 1e-9, 1))
        self.graph = graph
        self.ends = tuple(
            (places, np.flatnonzero(apart[end] <= reach + 1e-9)) for places, end in ((start, 0), (goal, o))
        )
        self.nodes = self.points * self.turns + 2

    def connected(self, margins: NDArray[np.float32]) -> bool:
        """Whether the goal can be reached over holds of these (O, P) margins."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components

        links = self._links(margins)
        ones = np.ones(links.a.size, dtype=np.int8)
        joined = coo_matrix((ones, (links.a, links.b)), (self.nodes, self.nodes))
        _, labels = connected_components(joined, directed=False)
        return bool(labels[-2] == labels[-1])

    def widest(self, margins: NDArray[np.float32]) -> list[Hold] | None:
        """Holds of a way whose least margin is the widest, or None."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

        links = self._links(margins)
        joined = coo_matrix((_ABOVE - links.margin, (links.a, links.b)), (self.nodes, self.nodes))
        tree = minimum_spanning_tree(joined.tocsr())
        _, before = breadth_first_order(tree, self.nodes - 2, directed=False)
        node, way = self.nodes - 1, []
        if before[node] < 0:
            return None
        while before[node] >= 0:
            way.append((int(before[node]), node))
            node = int(before[node])
        return [hold for link in way for hold in self._holds(link, links)]

    def _links(self, margins: NDArray[np.float32]) -> _Links:
        first, second = (ends.astype(np.int64) for ends in self.graph.pairs)
        o, p = np.nonzero(margins >= 0)
        a, b, width = first[p] * self.turns + o, second[p] * self.turns + o, margins[o, p].astype(np.float64)
        top, best = np.full(self.nodes, -1.0), np.full(self.nodes, -1, dtype=np.int64)
        order = np.argsort(width, kind="stable")  # the widest is written last
        for here, there in ((a, b), (b, a)):
            wider = width[order] > top[here[order]]
            top[here[order][wider]], best[here[order][wider]] = width[order][wider], there[order][wider]
        table = top[:-2].reshape(self.points, self.turns)
        v, k = np.nonzero(np.minimum(table[:, self.near[0]], table[:, self.near[1]]) >= 0)
        from_, to = self.near[0][k], self.near[1][k]
        parts = [
            (a, b, width),
            (v * self.turns + from_, v * self.turns + to, np.minimum(table[v, from_], table[v, to])),
        ]
        for end, (places, at) in enumerate(self.ends):
            for i in places:
                width = np.max([margins[at, self.graph.pair(i, j)] for j in places if j != i], axis=0)
                held = width >= 0
                node = np.full(int(held.sum()), self.nodes - 2 + end)
                parts.append((node, i * self.turns + at[held], width[held].astype(np.float64)))
        a, b, width = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        return _Links(a, b, width, best)

    def _holds(self, link: tuple[int, int], links: _Links) -> list[Hold]:
        """The hold of a link, or both of a turn: the widest of its point at either orientation."""
        (v, o), (w, p) = (divmod(node, self.turns) for node in link)
        if max(link) >= self.nodes - 2:
            places, _ = self.ends[max(link) - self.nodes + 2]
            i, at = divmod(min(link), self.turns)
            j = max((j for j in places if j != i), key=lambda j: self.graph.margin(i, j, at))
            return [(min(i, j), max(i, j), at)]
        if v != w:
            return [(min(v, w), max(v, w), o)]
        others = [int(links.best[node]) // self.turns for node in link]
        return [(min(v, u), max(v, u), k) for u, k in zip(others, (o, p), strict=True)]
