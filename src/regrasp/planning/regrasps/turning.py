"""Sequences of a planar regrasp over all orientations of the object, in closed form."""

from regrasp.errors import InvalidInput
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.turning.margins import Candidates
from regrasp.planning.holds.turning.search import ExactSearch, TurningSequence, apart_from_each_other
from regrasp.planning.regrasps.asked import Asked


def turning_sequences(problem: Asked, extra: int, least_margin: float) -> list[TurningSequence]:
    """The best sequence, and those of up to ``extra`` more moves with wider margins.

    Where each finger goes straight to its place only contacts of both ends hold: these are looked at first.
    """
    if not isinstance(problem.graph, HoldGraph):
        raise InvalidInput("all orientations are looked at in the plane; in space ask for sequences()")
    start, goal, last = problem.places
    angle = float(problem.graph.angles[last])
    if not extra:
        few = len({*start, *goal})  # contacts of both ends come first
        direct = _search(problem, few, least_margin)
        found = direct.sequences(start, goal, angle, most=len(set(goal) - set(start)))
        if found:
            return found
    return _search(problem, len(problem.contacts), least_margin).sequences(start, goal, angle, extra)


def _search(problem: Asked, count: int, least_margin: float) -> ExactSearch:
    """The search among the first ``count`` contacts."""
    graph = problem.graph
    assert isinstance(graph, HoldGraph)
    candidates = Candidates(
        graph.contacts[:count], problem.load, graph.peak_ratio, problem.one_finger, graph.min_normal
    )
    allowed = None if problem.allowed is None else problem.allowed[:, :count]
    apart = apart_from_each_other(candidates.points, problem.min_distance)
    return ExactSearch(candidates, apart, allowed, problem.largest_turn, least_margin)
