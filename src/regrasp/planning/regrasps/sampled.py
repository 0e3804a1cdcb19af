"""Sequences of holds among sampled orientations, in the plane and in space."""

from dataclasses import replace
from math import inf

import numpy as np

from regrasp.errors import Infeasible, SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.planning.holds.barred import Barred, BarredSearch
from regrasp.planning.holds.cost_search import cheapest
from regrasp.planning.holds.graphs import place_of
from regrasp.planning.holds.pairs import HoldGraph
from regrasp.planning.holds.sequences import Hold, Sequence, as_sequence, preferred
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
    graph = problem.graph
    stances = problem.setting.stances(graph, turn, reach, problem.allowed, problem.least_margin)
    pressed = problem.judges_holds or (isinstance(graph, TripleGraph) and problem.criteria.presses)
    known = {} if known is None else known
    if problem.judges_holds and isinstance(graph, HoldGraph):
        stances.margins[~problem.kept_pairs] = -1.0

    def note(hold: Hold) -> None:
        row, o = place_of(graph, hold[:-1]), hold[-1]
        margin = known[hold]
        stances.margins[row, o] = (
            -1.0 if margin < problem.least_margin else min(stances.margins[row, o], margin)
        )

    for hold in known:
        note(hold)
    while True:
        found = _best(problem, stances, extra, barred)
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
