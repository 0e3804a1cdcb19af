"""What limits the way between two grasps in the hold graph, however many finger moves it takes.

Parts of holds and orientations are nodes: contacts in the plane, pairs of contacts in space. A hold joins its
parts with its margin; a turn joins two orientations of a part, half a turn apart at most, with the smaller
of the widest margins that the part has at both: all fingers hold everything between. The widest way is then
the one in a maximum spanning tree.
"""

from dataclasses import dataclass, field
from itertools import combinations
from math import degrees, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, instance, number, whole
from regrasp.planning.holds.graphs import AnyGraph, Part, Parts, holding, place_of, turns_between
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.planar_stances import HALF_TURN
from regrasp.planning.holds.sequences import Hold
from regrasp.planning.holds.stances import REACH
from regrasp.planning.holds.triples import TripleGraph

# Above every margin: the tree of least weights wants them positive.
_ABOVE = 4.0


@dataclass(frozen=True)
class Bottleneck:
    """The hold that limits every way from a start to a goal, and what all ways have in common.

    Args:
        margin: the widest least margin of any way [rad].
        hold: its contacts and an orientation, by their places in the graph, where the widest way found is
            that narrow; no way does without a hold as narrow.
        points: contacts, by their places in the graph, without which no way is left, at whatever orientation.
        pairs: pairs of contacts, in space triples, at whatever orientation, without which no way is left.
        graph: the holds among which was looked.
    """

    margin: float
    hold: Hold
    points: tuple[int, ...]
    pairs: tuple[tuple[int, ...], ...]
    graph: AnyGraph = field(repr=False, compare=False)

    def __str__(self) -> str:
        def name(i: int) -> str:
            return str(self.graph.contacts[i].name)

        *most, last, o = self.hold
        graph, pairs = self.graph, ", ".join(" with ".join(map(name, pair)) for pair in self.pairs)
        if isinstance(graph, HoldGraph):
            what, where = "pairs", f"at {degrees(graph.angles[o]):.4g} deg"
        else:
            x, y, z = np.round(graph.loads[o, :3] / np.linalg.norm(graph.loads[o, :3]), 9) + 0.0
            what, where = "triples", f"with the load along ({x:.3g}, {y:.3g}, {z:.3g})"
        return (
            f"the widest way keeps {degrees(self.margin):.2f} deg, limited by the hold of "
            f"{', '.join(map(name, most))} and {name(last)} {where}\n"
            f"points that every way needs: {', '.join(map(name, self.points)) or 'none'}\n"
            f"{what} that every way needs: {pairs or 'none'}"
        )


def bottleneck(
    graph: AnyGraph,
    start: tuple[int, ...],
    goal: tuple[int, ...],
    goal_orientation: int = 0,
    *,
    max_turn: float | None = None,
) -> Bottleneck | None:
    """What limits the way from a hold of three contacts to a hold of three; None where there is no way.

    Every finger may touch everywhere. Where the object turns by more than one step may, all fingers hold it
    in between.

    Args:
        graph: of planar contacts, or of triples in space.
        start: three contacts, in space four, by their places in the graph, held at its first angle or load.
        goal: as many, held at the angle or under the load of place ``goal_orientation``.
        goal_orientation: the place of the last angle in the graph's angles, or of the last load.
        max_turn: largest turn of the object from one hold to the next, in however many steps, below pi [rad];
            if not given half a turn in the plane, and a little less in space.

    Raises:
        InvalidInput: For what are no places.
    """
    if not isinstance(graph, TripleGraph):
        instance(graph, "graph", HoldGraph)
    fingers = 3 if isinstance(graph, HoldGraph) else 4
    whole(goal_orientation, "goal_orientation", least=0, most=len(graph.loads) - 1)
    if max_turn is not None and not 0 < number(max_turn, "max_turn") < pi:
        raise InvalidInput(f"max_turn must be above 0 and below pi, got {shown(max_turn)}")
    for what, places in (("start", start), ("goal", goal)):
        try:
            given = [whole(place, what, least=0) for place in places]
            valid = len(given) == len(set(given)) == fingers and max(given) < len(graph.contacts)
        except TypeError:
            valid = False
        if not valid:
            raise InvalidInput(
                f"{what} must be {'three' if fingers == 3 else 'four'} contacts by their places in the "
                f"graph, 0 to {len(graph.contacts) - 1}, got {shown(places)}"
            )
    reach = max_turn or (HALF_TURN if isinstance(graph, HoldGraph) else REACH)
    ends = _Ends(graph, start, goal, goal_orientation, reach)
    way = ends.widest(graph.margins)
    if way is None:
        return None
    members, margins = ends.parts.members, graph.margins
    points = sorted({v for hold in way for v in hold[:-1]})
    pairs = sorted({hold[:-1] for hold in way})

    def margin(hold: Hold) -> float:
        return float(margins[hold[-1], place_of(graph, hold[:-1])])

    def needed(without: NDArray[np.bool_]) -> bool:
        return not ends.connected((margins >= 0) & ~without)

    def only(pair: tuple[int, ...]) -> NDArray[np.bool_]:
        which: NDArray[np.bool_] = np.arange(len(members)) == place_of(graph, pair)
        return which

    narrow = min(way, key=margin)
    return Bottleneck(
        margin(narrow),
        narrow,
        tuple(v for v in points if needed((members == v).any(axis=1))),
        tuple(pair for pair in pairs if needed(only(pair))),
        graph,
    )


def connected(graph: AnyGraph, start: tuple[int, ...], goal: tuple[int, ...], goal_orientation: int) -> bool:
    """Whether any sequence of holds leads from the start to the goal."""
    return _Ends(graph, start, goal, goal_orientation).connected(holding(graph))


class _Links(NamedTuple):
    """Links between nodes: (E,) ends and margins. best: (parts * O,) the widest hold of each node."""

    a: NDArray[np.int64]
    b: NDArray[np.int64]
    margin: Array
    best: NDArray[np.int64]


class _Ends:
    """Node p * O + o is part p at orientation o; the last two nodes are the start and the goal."""

    def __init__(
        self, graph: AnyGraph, start: tuple[int, ...], goal: tuple[int, ...], o: int, reach: float = REACH
    ) -> None:
        self.graph, self.parts, self.turns = graph, Parts(graph), len(graph.loads)
        apart = turns_between(graph)
        self.near = np.nonzero(np.triu(apart <= reach + 1e-9, 1))
        self.ends = tuple(
            (places, np.flatnonzero(apart[end] <= reach + 1e-9)) for places, end in ((start, 0), (goal, o))
        )
        self.nodes = self.parts.count * self.turns + 2

    def connected(self, holds: NDArray[np.bool_]) -> bool:
        """Whether the goal can be reached over holds (O, P)."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components

        links = self._links(np.where(holds, np.float32(0.0), np.float32(-1.0)))
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
        return [hold for link in way for hold in self._holds(link, margins, links)]

    def _links(self, margins: NDArray[np.float32]) -> _Links:
        o, p = np.nonzero(margins >= 0)
        width = margins[o, p].astype(np.float64)
        nodes = self.parts.of[p] * self.turns + o[:, None]
        top, best = np.full(self.nodes, -1.0), np.full(self.nodes, -1, dtype=np.int64)
        order = np.argsort(width, kind="stable")  # the widest is written last
        for here in nodes.T:
            wider = width[order] > top[here[order]]
            top[here[order][wider]], best[here[order][wider]] = width[order][wider], p[order][wider]
        table = top[:-2].reshape(self.parts.count, self.turns)
        v, k = np.nonzero(np.minimum(table[:, self.near[0]], table[:, self.near[1]]) >= 0)
        from_, to = self.near[0][k], self.near[1][k]
        links = [(a, b, width) for a, b in zip(nodes.T[:-1], nodes.T[1:], strict=True)]
        links.append((v * self.turns + from_, v * self.turns + to, np.minimum(table[v, from_], table[v, to])))
        for end, (places, at) in enumerate(self.ends):
            for part in combinations(sorted(places), self.parts.of.shape[1] - 1):
                width = self._of_end(places, part, at, margins).max(axis=0)
                held = width >= 0
                node = np.full(int(held.sum()), self.nodes - 2 + end)
                number = self.parts.number(part)
                links.append((node, number * self.turns + at[held], width[held].astype(np.float64)))
        a, b, width = (np.concatenate(arrays) for arrays in zip(*links, strict=True))
        return _Links(a, b, width, best)

    def _of_end(
        self, places: tuple[int, ...], part: Part, at: NDArray[np.int64], margins: NDArray[np.float32]
    ) -> NDArray[np.float32]:
        """(holds, orientations) margins of an end's holds with a part."""
        rest = [j for j in places if j not in part]
        return np.array([margins[at, place_of(self.graph, (*part, j))] for j in rest])

    def _holds(self, link: tuple[int, int], margins: NDArray[np.float32], links: _Links) -> list[Hold]:
        """The hold of a link, or both of a turn: the widest of its part at either orientation."""
        (v, o), (w, p) = (divmod(node, self.turns) for node in link)
        if max(link) >= self.nodes - 2:
            places, _ = self.ends[max(link) - self.nodes + 2]
            number, at = divmod(min(link), self.turns)
            part = self.parts.contacts(number)
            values = self._of_end(places, part, np.array([at]), margins)[:, 0]
            j = [j for j in places if j not in part][int(values.argmax())]
            return [(*sorted((*part, j)), at)]
        if v != w:
            return [(*sorted({*self.parts.contacts(v), *self.parts.contacts(w)}), o)]
        return [
            (*self.parts.members[links.best[node]].tolist(), k) for node, k in zip(link, (o, p), strict=True)
        ]
