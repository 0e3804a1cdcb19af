"""The arcs of all pairs of a hold graph, over all angles of the object in the place of those of the graph."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, number
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.turning.arcs import Arcs
from regrasp.planning.holds.turning.margins import Candidates
from regrasp.planning.holds.turning.search import apart_from_each_other

MOST_PAIRS = 100_000
"""Whose arcs are found at once, with 26 angles of each in memory."""


class HoldArcs(NamedTuple):
    """Pairs that hold at some angle, their widest margins (m,) [rad], and arcs (lo, hi) of angles [rad]."""

    pairs: tuple[NDArray[np.int64], NDArray[np.int64]]
    margins: Array
    arcs: list[list[tuple[float, float]]]


def hold_arcs(graph: HoldGraph, level: float = 0.0) -> HoldArcs:
    """At which angles of the object pairs hold with margins of a ``level`` [rad], whatever ``graph.angles``.

    Raises ``InvalidInput`` for a graph with a filter, which says nothing about angles between, and for one of
    too many pairs.
    """
    number(level, "level", least=0)
    if graph.keep is not None:
        raise InvalidInput("arcs are of all angles, and a filter (keep) is asked at some; leave it out")
    first, second = (ends.astype(np.int64) for ends in graph.pairs)
    if first.size > MOST_PAIRS:
        raise InvalidInput(
            f"arcs are found of {MOST_PAIRS:,} pairs at most, got {first.size:,}; take fewer contacts"
        )
    candidates = candidates_of(graph)
    arcs = Arcs(candidates)
    bounds = arcs.bounds()[first, second]
    kept = (bounds >= level) & apart_from_each_other(candidates.points, graph.min_distance)[first, second]
    pairs = first[kept], second[kept]
    widest = arcs.widest(pairs, bounds[kept])
    found = arcs.at(pairs, level, widest)
    some = np.array([bool(each) for each in found], dtype=np.bool_)
    return HoldArcs((pairs[0][some], pairs[1][some]), widest.margins[some], [each for each in found if each])


def candidates_of(graph: HoldGraph) -> Candidates:
    """The contacts of a graph and what limits their forces."""
    return Candidates(graph.contacts, graph.load, graph.peak_ratio, graph.one_finger, graph.min_normal)
