"""Sequences of holds among sampled orientations, in the plane and in space."""

from dataclasses import replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.holds.barred import Barred, BarredSearch
from regrasp.planning.holds.cost_search import cheapest
from regrasp.planning.holds.few_directions import few_directions_first
from regrasp.planning.holds.graphs import AnyGraph, place_of
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.sequences import Hold, Sequence, as_sequence, preferred
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.stances import Stances
from regrasp.planning.holds.triples import TripleGraph
from regrasp.planning.regrasps.asked import Asked
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import ANGLE, FORCE

MOST_JUDGED = 1000
"""Holds whose states are asked for, which are there without more, before no sequence is found."""


def sampled_sequences(
    problem: Asked,
    extra: int,
    turn: float,
    reach: float,
    known: dict[Hold, float] | None = None,
    barred: Barred | None = None,
) -> list[Sequence]:
    """The best, with turns of at most ``reach`` [rad] from one hold to the next, in steps of ``turn``.

    Triples in space are judged without least normal forces: where these are asked for, the margins found so
    are bounds, and those of the holds of the best sequences are found, until these have no bound left. Where
    linear limits or deviations are, the holds of the best sequences must keep them, too, and are ranked by
    their margins without. known: margins [rad] of holds, below 0 of such as are not to be used; it grows.
    barred: what fingers may not do; without ``extra``.
    """
    known = {} if known is None else known
    start, goal, _ = problem.places
    if isinstance(problem.graph, TripleGraph) and not (extra or problem.weights or barred):
        both = len({*start, *goal})  # where each finger goes straight to its place no other contacts hold
        direct = _among(problem, problem.graph_on(problem.contacts[:both]), 0, turn, reach, known)
        if direct and direct[0].moves == len(set(goal) - set(start)):
            return direct
    return _among(problem, problem.graph, extra, turn, reach, known, barred)


def _among(
    problem: Asked,
    graph: AnyGraph,
    extra: int,
    turn: float,
    reach: float,
    known: dict[Hold, float],
    barred: Barred | None = None,
) -> list[Sequence]:
    """The best among the holds of a graph, on the first contacts of the problem or on all."""
    allowed = None if problem.allowed is None else problem.allowed[:, : len(graph.contacts)]
    stances = problem.setting.stances(graph, turn, reach, allowed, problem.least_margin)
    every = np.arange(len(problem.setting.orientations))

    def search(some: Stances, places: NDArray[np.int64]) -> list[Sequence]:
        more = extra if places.size == every.size else 0
        return _searched(problem, graph, some, places, more, known, barred)

    if isinstance(stances, Quads) and not (problem.weights or barred or problem.judges_holds):
        return few_directions_first(stances, *problem.places, search, every)
    return search(stances, every)


def _searched(
    problem: Asked,
    graph: AnyGraph,
    stances: Stances,
    places: NDArray[np.int64],
    extra: int,
    known: dict[Hold, float],
    barred: Barred | None,
) -> list[Sequence]:
    """The best among stances, whose orientations have these places (O,) among all, as the holds found."""
    pressed = problem.judges_holds or (isinstance(graph, TripleGraph) and problem.criteria.presses)
    if problem.judges_holds and isinstance(graph, HoldGraph):
        stances.margins[~problem.kept_pairs] = -1.0
    here = {o: n for n, o in enumerate(places.tolist())}

    def note(hold: Hold) -> None:
        if hold[-1] in here and max(hold[:-1]) < len(graph.contacts):
            stances.lower(place_of(graph, hold[:-1]), here[hold[-1]], known[hold])

    for hold in known:
        note(hold)
    while True:
        found = [_placed(sequence, places) for sequence in _best(problem, stances, extra, barred)]
        new = {hold for sequence in found for hold in sequence.holds} - known.keys() if pressed else set()
        if not new:
            return found
        if len(known) > MOST_JUDGED:
            raise Infeasible(
                f"no sequence was found of which every hold keeps linear limits and withstands what is "
                f"asked, among {len(known)} holds that were tried; it is not proven that there is none"
            )
        for hold in sorted(new):
            judge = _kept_margin if problem.judges_holds else _pressed_margin
            known[hold] = judge(problem, hold[:-1], hold[-1])
            note(hold)


def _placed(sequence: Sequence, places: NDArray[np.int64]) -> Sequence:
    return replace(sequence, holds=tuple((*hold[:-1], int(places[hold[-1]])) for hold in sequence.holds))


def _best(problem: Asked, stances: Stances, extra: int, barred: Barred | None) -> list[Sequence]:
    start, goal, last = problem.places
    search = None if barred is None else BarredSearch(stances, start, goal, last, barred)
    if problem.weights is None:
        return preferred(stances, start, goal, last, extra) if search is None else search.preferred()
    stances.look_at_all()
    costs = problem.weights.costs(problem.graph, stances.margins, problem.step_duration)
    if search is not None:
        return search.cheapest(costs)
    found = cheapest(stances, costs, start, goal, last)
    return [] if found is None else [as_sequence(stances, found)]


def _pressed_margin(problem: Asked, places: tuple[int, ...], o: int) -> float:
    """The widest angle margin [rad] of a hold whose fingers push with the least normal force; -1 for none."""
    grasp, forces = _forces(problem, places, o, replace(problem.criteria, objective=ANGLE))
    return -1.0 if forces is None else _least_angle(grasp, forces)


def _kept_margin(problem: Asked, places: tuple[int, ...], o: int) -> float:
    """No bound [rad] for a hold that keeps linear limits and withstands the set; -1 for others.

    Which finger of its own stiffness is where only a whole sequence says: its states are judged then.
    """
    criteria = replace(problem.criteria, objective=FORCE)
    if not criteria.withstands or isinstance(criteria.stiffness, tuple):
        criteria = replace(criteria, disturbance=None, stiffness=1.0, early_loss=False)
    return -1.0 if _forces(problem, places, o, criteria)[1] is None else inf


def _forces(
    problem: Asked, places: tuple[int, ...], o: int, criteria: Criteria
) -> tuple[Grasp, Array | None]:
    """A hold and its best forces; None where there are none."""
    grasp = Grasp(problem.contacts[i] for i in places)
    load = problem.setting.seen(problem.setting.orientations[o])
    try:
        return grasp, np.array(choose_forces(grasp, load, criteria).forces)
    except (Infeasible, SolverFailed):
        return grasp, None


def _least_angle(grasp: Grasp, forces: np.ndarray) -> float:
    normal = (forces * grasp.normals).sum(axis=1)
    across = np.linalg.norm(forces - normal[:, None] * grasp.normals, axis=1)
    return max(float((np.arctan(grasp.frictions) - np.arctan2(across, normal)).min()), 0.0)
