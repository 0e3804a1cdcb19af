"""What the hold graphs of the plane and of space have in common.

A hold is of all fingers but one: a pair of contacts in the plane, a triple in space. Its *parts* are its
contacts, or its pairs of contacts: two holds that share a part can be exchanged, for together they use one
finger more.
"""

from itertools import combinations
from math import pi

import numpy as np
from numpy.typing import NDArray

from regrasp.mechanics.checks import Array
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.triples import TripleGraph

AnyGraph = HoldGraph | TripleGraph
Part = tuple[int, ...]
"""Contacts that stay while a hold is exchanged for another."""


class Parts:
    """The parts of all holds of a graph, numbered.

    members: (P, k) contacts of each hold. of: (P, k) its parts. count: how many parts there are.
    """

    def __init__(self, graph: AnyGraph) -> None:
        contacts = len(graph.contacts)
        if isinstance(graph, HoldGraph):
            self.members = np.stack(graph.pairs, axis=1).astype(np.int64)
            self.of, self.count = self.members, contacts
            self._contacts = np.arange(contacts)[:, None]
        else:
            self.members = graph.triples.astype(np.int64)
            first, second = np.triu_indices(contacts, 1)
            number = np.zeros((contacts, contacts), dtype=np.int64)
            number[first, second] = number[second, first] = np.arange(first.size)
            i, j, k = self.members.T
            self.of, self.count = np.stack([number[i, j], number[j, k], number[i, k]], axis=1), first.size
            self._contacts = np.stack([first, second], axis=1)
        self._numbers = {tuple(c): n for n, c in enumerate(self._contacts.tolist())}

    def contacts(self, part: int) -> Part:
        """The contacts of a part."""
        return tuple(self._contacts[part].tolist())

    def number(self, contacts: Part) -> int:
        """The number of the part of some contacts."""
        return self._numbers[tuple(sorted(contacts))]

    def components(self, holds: NDArray[np.bool_]) -> NDArray[np.int32]:
        """(count,) the component of each part among (P,) holds; -1 without any."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components

        some = self.of[holds]
        a, b = some[:, :-1].ravel(), some[:, 1:].ravel()
        _, labels = connected_components(
            coo_matrix((np.ones(a.size), (a, b)), (self.count, self.count)), directed=False
        )
        used = np.zeros(self.count, dtype=bool)
        used[some.ravel()] = True
        return np.where(used, labels, -1).astype(np.int32)


def place_of(graph: AnyGraph, hold: tuple[int, ...]) -> int:
    """The place of a hold's contacts among the holds of a graph."""
    return graph.pair(*hold) if isinstance(graph, HoldGraph) else graph.triple(*hold)


def holds_within(graph: AnyGraph, places: tuple[int, ...]) -> list[int]:
    """The places of all holds of some contacts."""
    size = 2 if isinstance(graph, HoldGraph) else 3
    return [place_of(graph, hold) for hold in combinations(sorted(places), size)]


def holding(graph: AnyGraph) -> NDArray[np.bool_]:
    """(O, P) whether holds hold."""
    return graph.margins >= 0 if isinstance(graph, HoldGraph) else graph.holds


def widest_of_pairs(graph: AnyGraph, o: int | None = None) -> Array:
    """(V, V) the widest margin [rad] of any hold with both of two contacts; negative where there is none.

    o: the place of an orientation; None for the best of all.
    """
    margins = np.asarray(graph.margins.max(axis=0) if o is None else graph.margins[o], dtype=np.float64)
    result = np.full((len(graph.contacts),) * 2, -1.0)
    members = Parts(graph).members
    for a, b in combinations(range(members.shape[1]), 2):
        np.maximum.at(result, (members[:, a], members[:, b]), margins)
    both: Array = np.maximum(result, result.T)
    return both


def turns_between(graph: AnyGraph) -> Array:
    """(O, O) turns of the object from one orientation to another [rad]."""
    if isinstance(graph, HoldGraph):
        return np.abs((graph.angles[:, None] - graph.angles + pi) % (2 * pi) - pi)
    ways = graph.loads[:, :3] / np.linalg.norm(graph.loads[:, :3], axis=1)[:, None]
    turns: Array = np.arctan2(np.linalg.norm(np.cross(ways[:, None], ways), axis=-1), ways @ ways.T)
    return turns
